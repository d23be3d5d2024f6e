// What is done for one effect alone, counted: in a scene without the effect these stay at zero.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace aerosol::render {

/// Something that is done for an effect.
enum class Work : std::uint8_t {
  lens,              ///< Places on the lens that were drawn.
  time,              ///< Times that were drawn.
  cameraMotion,      ///< Places of the moving camera.
  probe,             ///< Paths that looked above where they begin.
  foundLight,        ///< Rays that left the scene towards lights of which no samples are taken.
  lightTexture,      ///< Light that a texture was asked for.
  movingLight,       ///< Light that was sampled of lights that move.
  lightTree,         ///< Lights found through the hierarchy.
  lightSplitting,    ///< Vertices where several clusters of lights were sampled.
  chosenDistance,    ///< Distances chosen for a light beside the ray.
  tabulatedLight,    ///< Rays along which lights were tabulated.
  lampDirection,     ///< Vertices that send some paths towards lamps in media.
  linkedLight,       ///< Light estimates where not all lights count.
  straightCrossing,  ///< Surfaces that a shadow ray asked whether they let it pass.
  mediumBoundary,    ///< Crossings of surfaces that only bound media.
  nesting,           ///< Faces judged by what is inside of them.
  overlap,           ///< Segments with several media.
  closedForm,        ///< Segments of constant media.
  voxels,            ///< Segments solved voxel by voxel.
  marching,          ///< Segments that were marched.
  nullScattering,    ///< Segments of null scattering.
  tree,              ///< Segments of media with a tree of bounds.
  chromatic,         ///< Segments whose constant extinction differs between channels.
  mediumScattering,  ///< Scattering events in media.
  mediumEmission,    ///< Rays along which media emitted.
  holdout,           ///< Paths that ended in a hole.
  laterScattering,   ///< Scattering events after a path's first.
  roulette,          ///< Games of Russian roulette.
  clamping,          ///< Light that was dimmed to the scene's limit.
  coarseVoxels,      ///< Rays that saw volumes with coarser voxels than others do.
  contribution,      ///< Looks at what a path may still bring.
  look,              ///< Points whose coefficients a volume's controls changed.
  footprint,         ///< Points of which shaders were told how they change from pixel to pixel.
  layers,            ///< Samples of which more than the picture was gathered.
  deep,              ///< Camera rays walked for a deep image.
  count
};

class WorkCounts {
 public:
  void add(Work work) { ++counts_[static_cast<std::size_t>(work)]; }
  std::uint64_t of(Work work) const { return counts_[static_cast<std::size_t>(work)]; }
  WorkCounts& operator+=(const WorkCounts& other) {
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
    return *this;
  }

 private:
  std::array<std::uint64_t, static_cast<std::size_t>(Work::count)> counts_{};
};

}  // namespace aerosol::render
