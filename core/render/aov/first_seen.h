// AOVs of what a path sees first: a surface that is no mere boundary, or a place in a medium.
#pragma once

#include "core/render/aov/path_record.h"
#include "core/render/closure_mix.h"
#include "core/render/path_context.h"
#include "core/volume/medium.h"
#include "core/volume/task.h"

namespace aerosol::render {

/// `throughput` is the path's up to there; in a medium it includes what is scattered, whose mean is the albedo times
/// what is seen of it. The normal points to where the medium is thinner, found by differences of its extinction.
volume::Task<> seeMedium(PathContext& path, const volume::Medium& medium, Point<World> point, float distance,
                         Color throughput);
/// Right after the surface's shader has answered.
void seeSurface(PathContext& path, const ClosureMix& closures, const accel::SurfaceHit& hit, float distance,
                Color throughput);

/// How a surface's closures share what they scatter into a direction: by kind, and by label where they have labels.
class ScatterShares {
 public:
  /// By diffuse and glossy ones; `reflects`: the direction is on the viewer's side.
  ScatterShares(const ClosureMix& closures, Vector<World> direction, bool reflects);
  /// Of a sample: as above, or all by one that mirrors, bends or lets pass.
  ScatterShares(const ClosureMix& closures, const ClosureSample& sample, bool reflects);
  operator std::span<const ScatterShare>() const { return {shares_.data(), shares_.size()}; }

 private:
  void split(const ClosureMix& closures, Vector<World> direction, bool reflects);
  void splitByLabel(const ClosureMix& closures, Vector<World> direction, bool reflects);
  void add(PathEvent event, std::uint32_t label, Color part);

  SmallArray<ScatterShare, 2 * ClosureMix::usualTerms> shares_{1};
};

/// A medium scatters in one way alone.
inline constexpr ScatterShare inMedium[] = {{PathEvent::volume, Color(1.0f)}};

}  // namespace aerosol::render
