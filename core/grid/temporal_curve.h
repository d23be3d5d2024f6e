// Values that change with time as few straight lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace aerosol::grid {

/// Chooses samples of a curve so that the straight lines between them pass every sample at no more than `error`. The
/// first sample is always chosen, and alone when all others are within `error` of it. `times` ascend; at most 255.
/// Writes the numbers of those chosen, ascending, and returns how many there are.
///
/// Wrenninge, "Efficient Rendering of Volumetric Motion Blur Using Temporally Unstructured Volumes" (JCGT 5.1, 2016),
/// stores such curves voxel by voxel. Here each line is made as long as it can be: the slopes that pass all samples so
/// far within the error form an interval (Imai and Iri 1986), and a sample whose slope lies in it may end the line.
std::size_t fitCurve(std::span<const float> times, std::span<const float> values, float error, std::uint8_t* chosen);

}  // namespace aerosol::grid
