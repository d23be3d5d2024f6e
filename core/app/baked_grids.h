// From a baked shader's coefficients to the grids that hold them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/grid/grid_writer.h"
#include "core/render/baker.h"

namespace aerosol::app {

/// What of some blocks is worth a grid.
struct BakedKinds {
  bool isChromatic = false;  ///< "density" is a vector grid.
  bool hasAlbedo = false;    ///< "albedo" varies from place to place.
  bool hasEmission = false;
  Color albedo;  ///< Where it is the same everywhere.

  std::string description() const;  ///< "density, emission".
};
/// Of blocks with any number of times.
BakedKinds findKinds(const std::vector<render::BakedBlock>& blocks);

/// "density" (extinction), with three channels where those differ; "albedo" where it varies; "emission" where there is
/// some. Without blocks.
std::vector<grid::NewGrid> emptyGrids(const BakedKinds& kinds, double voxelSize,
                                      const std::optional<grid::NewFrustum>& frustum = {});

/// The values of grid `name` in a block with one time, or at time number `time` of several: channels side by side.
std::vector<float> valuesOf(const render::BakedBlock& block, const grid::NewGrid& grid, std::size_t time = 0);

/// How a scene uses the file.
std::string sceneText(const BakedKinds& kinds, const render::BakeCounts& counts, const std::string& file, bool moving);

/// The name of frame `number`: in the place of "%04d" (any width), or before the extension.
std::string frameName(const std::string& pattern, std::size_t number);

}  // namespace aerosol::app
