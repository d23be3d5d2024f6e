// How large the results of instructions can be.
#pragma once

#include <span>

#include "core/lang/program.h"

namespace aerosol::lang {

/// Positions, directions and times of shading points are not larger than this.
inline constexpr double largestGlobal = 1e30;

/// A bound on the magnitude of every component of the result, given those of the arguments; infinite where the result
/// may be infinite or not a number, or where nothing is known. Bounds of floats include rounding.
double magnitudeOf(const Program& program, const Instruction& instruction, std::span<const double> arguments);

/// The same of a variable that no instruction writes: a constant or a global.
double magnitudeOf(const Variable& variable);

/// Whether adding something of at most this magnitude to the number leaves every bit of it.
bool absorbs(float number, double magnitude);

}  // namespace aerosol::lang
