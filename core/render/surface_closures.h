// From what a surface shader answered to the closures that a path samples.
#pragma once

#include <span>

#include "core/render/closure_mix.h"
#include "core/render/path_context.h"
#include "core/render/prepared_scene.h"
#include "core/render/surface_answer.h"
#include "core/shading/shading_point.h"

namespace aerosol::render {

/// The shader globals of a hit. `toViewer` is unit.
shading::ShadingPoint shadingPointOf(const PreparedScene& scene, const accel::SurfaceHit& hit, const Ray<World>& ray);

/// The same on the ray that the path follows, with what its footprint covers where shaders ask for that.
shading::ShadingPoint shadingPointOf(PathContext& path, const accel::SurfaceHit& hit, const Ray<World>& ray);

/// The closures of one hit; owns what the mix refers to. `crossing` gives the indices of the media on both sides.
class SurfaceClosures {
 public:
  SurfaceClosures(const PreparedObject& object, const SurfaceAnswer& answer, const accel::SurfaceHit& hit,
                  Vector<World> direction, const volume::Crossing* crossing = nullptr);
  SurfaceClosures(const SurfaceClosures&) = delete;
  SurfaceClosures& operator=(const SurfaceClosures&) = delete;

  const ClosureMix& mix() const { return *mix_; }
  /// A call site whose weight or parameters are NaN or infinite: it is left out.
  std::optional<std::uint32_t> invalidSite() const { return invalidSite_; }

 private:
  Color weightBelow(const PreparedObject& object, std::uint32_t site, std::span<const bool> isSound,
                    const ClosurePoint& point) const;

  SurfaceAnswer answer_;
  SmallArray<WeightedClosure, SurfaceAnswer::usualSites> terms_;
  std::optional<ClosureMix> mix_;
  std::optional<std::uint32_t> invalidSite_;
};

}  // namespace aerosol::render
