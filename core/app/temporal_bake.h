// Voxels that change with time: from a baked shader, and from a sequence of files.
#pragma once

#include <string>
#include <vector>

#include "core/app/arguments.h"
#include "core/app/baked_grids.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"
#include "core/grid/temporal_file.h"

namespace aerosol::app {

std::vector<grid::TemporalCurves> emptyCurves(const std::vector<grid::NewGrid>& grids, const std::vector<float>& times);

/// The values of a grid in a block with `times` times.
grid::TemporalSamples samplesOf(const render::BakedBlock& block, const grid::NewGrid& grid, std::size_t times);

/// "1200 blocks of 8^3 curves with 2.3 values on average".
std::string describeCurves(const std::vector<grid::TemporalCurves>& grids);

/// Makes one file of curves of the arguments' files.
ExitCode joinFrames(const BakeArguments& arguments, const Console& console);

}  // namespace aerosol::app
