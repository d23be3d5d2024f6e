// Where a path stands, and the branches of a path that was split.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/render/aov/path_record.h"
#include "core/render/direct_light.h"
#include "core/render/path_context.h"

namespace aerosol::render {

/// A path as it grows.
struct PathState {
  Ray<World> ray;
  Color throughput{1.0f};
  Color worth{1.0f};  ///< By what roulette is played: the throughput before a direction out of a medium was chosen.
  DirectionRecord direction;                       ///< How the ray's direction was found.
  const volume::Medium* boundaryMedium = nullptr;  ///< Surface-defined medium around the ray.
  std::optional<accel::SurfaceHit> touching;       ///< A surface right where the ray begins, to be met first.
  float splitThreshold = neverSplit;               ///< Of light sampling at the ray's end.
  /// Lights beside this ray, and those beside the ray before, which the record of this one's direction refers to.
  std::array<std::optional<LightsAlongRay>, 2> lights;
  bool lightsReach = false;  ///< Since lights were sampled the path has only gone through what lets shadow
                             ///< rays pass straight.
  int length = 1;            ///< Segments so far, this ray's included.
  int scatterings = 0;       ///< Before the ray, without those that let pass straight.
  float wayBefore = 0;       ///< From the camera to where the ray begins; for AOVs.
  std::uint32_t rayTypes = shading::ray::camera;
};

/// One of the directions in which a path goes on, to be followed later.
struct PathBranch {
  PathState state;
  SampleStream random;
  volume::MediumStack media;
  RayFootprint footprint;
  std::optional<PathRecord::Place> place;  ///< Of the path's record, where there is one.
};

/// Those of one path, the last one first. They take memory where a path is split alone.
class PathBranches {
 public:
  /// Paths with more branches than these to follow are not split.
  static constexpr std::size_t most = 64;

  bool hasRoom() const { return branches_.size() < most; }
  /// Begins a branch of `state`, number `index` there, with random numbers of its own.
  PathBranch& begin(PathContext& path, const PathState& state, int index);
  /// It has left the vertex where `state` is, and so the path's footprint, which was `seen` there, and its record. Both
  /// go back.
  void finish(PathContext& path, const PathState& state, const RayFootprint& seen);
  /// Puts the path where its last branch begins; false where none is left.
  bool resumeLast(PathContext& path, PathState& state);

 private:
  std::vector<std::unique_ptr<PathBranch>> branches_;
  std::optional<PathRecord::Place> before_;  ///< The branch that has begun.
};

}  // namespace aerosol::render
