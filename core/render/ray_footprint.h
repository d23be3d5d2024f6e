// How a path's ray changes from pixel to pixel: what derivatives in shaders come from.
#pragma once

#include "core/accel/scene.h"
#include "core/base/geometry.h"
#include "core/render/closure.h"
#include "core/shading/batch.h"

namespace aerosol::render {

/// The change of a vector to the next pixel in x (to the right) and in y (downwards).
struct PixelChange {
  Vector<World> x, y;
};

/// The differentials of a ray: to first order, where the rays of the neighbouring pixels run beside it.
///
/// Igehy 1999, "Tracing Ray Differentials": exact for cameras, transfer, mirrors and refraction, with the curvature of
/// what bends the ray. Where a direction is drawn from a lobe, the numbers that it is drawn with stay the same from
/// pixel to pixel, and the lobe's width is shared by the samples of it: Suykens and Willems 2001, "Path Differentials
/// and Applications", the interval of each random number being `lobeShare` here.
struct RayFootprint {
  Point<World> origin;
  Vector<World> direction;  ///< Unit.
  PixelChange originChange, directionChange;

  /// Where the ray passes nearest to a point: the change of that place, across the ray's line or slanted as it began.
  PixelChange at(Point<World> point) const;
};

/// The part of a lobe's width (the radius of a disk with its solid angle) that a ray in it stands for.
inline constexpr float lobeShare = 1.0f / 8;

/// The change of a point on a surface, of its texture coordinates, and of the direction in which it is seen. Changes of
/// position are no longer than `largest`.
struct SurfaceFootprint {
  PixelChange position, direction;
  std::array<float, 2> uv_x{}, uv_y{};  ///< Of u and v.
};
SurfaceFootprint footprintOn(const RayFootprint& ray, const accel::SurfaceHit& hit, float largest);

/// The change of u and v along a change of position: least squares over the tangents; 0 where there are none.
std::array<float, 2> changeOfUv(const accel::SurfaceHit& hit, Vector<World> step);

/// Of a point in a medium: across the ray as far as its neighbours, and along it as far as the mean of these.
shading::VolumeFootprint footprintIn(const RayFootprint& ray, Point<World> point, float largest);

/// Behind a surface from which the ray goes on as sampled.
RayFootprint footprintBehind(const RayFootprint& ray, const accel::Scene& scene, const accel::SurfaceHit& hit,
                             const ClosureSample& sample, float time, float largest);

/// Behind a scattering event at a point, with a density per steradian.
RayFootprint footprintScattered(const RayFootprint& ray, Point<World> point, Vector<World> direction, float pdf,
                                bool isDelta);

/// Of a ray that begins at a point of the path's ray for another reason, such as light: as wide as the path is there,
/// and no wider behind it.
RayFootprint footprintBeside(const RayFootprint& ray, const Ray<World>& other);

}  // namespace aerosol::render
