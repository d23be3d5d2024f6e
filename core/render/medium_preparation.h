// What preparation decides about a medium: whether it is constant, its bound, its method, its step.
#pragma once

#include <functional>
#include <span>

#include <optional>

#include "core/render/prepared_scene.h"
#include "core/scene/description.h"

namespace aerosol::render {

/// The coefficients of a medium whose compiled shader reads nothing that varies; nothing otherwise. Results that are
/// not sound (NaN, infinite, negative) make it count as varying, so that they are reported where they occur.
std::optional<volume::Coefficients> constantCoefficients(const PreparedScene& scene, const volume::Medium& medium);

/// The closures of one point, outside of any render.
SurfaceAnswer askSurface(const PreparedScene& scene, shading::InstanceRef shader, const shading::ShadingPoint& point);
/// The same at many points, in their order.
void askSurfaces(const PreparedScene& scene, shading::InstanceRef shader, std::span<const shading::ShadingPoint> points,
                 const std::function<void(const SurfaceAnswer&)>& take);
/// The extinction of a medium at many points, in their order; what is not sound is 0.
void askExtinction(const PreparedScene& scene, const volume::Medium& medium, std::span<const Point<World>> points,
                   const std::function<void(Color)>& take);
/// Weights of a surface shader's closures, when they do not vary.
std::optional<SurfaceAnswer> constantClosures(const PreparedScene& scene, shading::InstanceRef shader);

/// The bound that a shader declares: metadata `string extinction_bound = "density"` names a float or colour parameter
/// whose value extinction never exceeds.
std::optional<float> declaredBound(const shading::Family& family, const shading::Instance& instance);
/// Why that metadata means nothing; empty where it does, and where there is none.
std::string problemOfDeclaredBound(const lang::Program& program);

/// Where a medium is.
struct MediumPlace {
  float extent = 1;                   ///< Size, for the default step (a hundredth). World units.
  std::optional<Box<Object>> domain;  ///< Where most of it is, in its shader's space; nothing: unbounded.
  bool staysInside = false;           ///< It is nowhere else. (A surface may have holes.)
  float stepScale = 1;
};

/// Fills in coefficients, bounds, method and step of a medium, on up to `threads` threads. An error when null
/// scattering is asked for where no bound is known.
Diagnostics decideSampling(PreparedScene& scene, volume::Medium& medium, const scene::MediumSampling& sampling,
                           const scene::Integrator& integrator, const MediumPlace& place,
                           const volume::BoundBudget& budget, int threads);

}  // namespace aerosol::render
