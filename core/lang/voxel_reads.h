// Which grids of which files a program is sure to name in calls of texture3d.
#pragma once

#include <string>
#include <vector>

#include "core/lang/analysis.h"

namespace aerosol::lang {

/// A call of texture3d whose file, and whatever says which of its grids, is known before the render.
struct VoxelRead {
  std::string file;
  std::string grid;  ///< By name; empty: by `number`.
  int number = 0;
  std::uint32_t location = 0;  ///< Index into `Program::locations`.
};

/// Those of the program with these parameters. Left out are calls that have an answer of their own for files that
/// cannot be read (`missingcolor`, `errormessage` …), and what is not known. Order: that of the program.
std::vector<VoxelRead> findVoxelReads(const Program& program, const ParameterValues& values);

}  // namespace aerosol::lang
