// From a checked syntax tree to a program.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/base/diagnostic.h"
#include "core/lang/check.h"
#include "core/lang/program.h"

namespace aerosol::lang {

class NativeSource;

/// Bounds on one program; beyond them there is an error at the place that passed them.
inline constexpr std::size_t maximumInstructions = 200000;  ///< With all functions inlined.
inline constexpr std::size_t maximumFrameValues = 1 << 18;  ///< Ints, floats and strings of all variables together.
inline constexpr int maximumInlining = 128;                 ///< Calls inside of calls.

/// A shader in both of its forms.
struct LoweredShader {
  Program layer;
  Program program;  ///< `layer` made complete.
};

/// Lowers the shader of a source that was checked without errors: user functions inlined, structures flattened.
/// Nothing when `diagnostics` got errors.
/// `natives`: where functions of plugins come from; null: from nowhere.
std::optional<LoweredShader> lower(CheckedSource& source, const SourceMap& sourceMap, Diagnostics& diagnostics,
                                   NativeSource* natives = nullptr);

/// Says that something is wrong at `Program::locations[location]`.
using ReportAt = std::function<void(std::uint32_t location, std::string message)>;

/// Makes a program of its own from a layer: parameters have no connections, closures are taken apart, outputs computed
/// at the end. Parameters that are closures are gone, so that the others may have another index. Where it never writes
/// `Ci`, its only output that is a closure takes that place, as what MaterialX generates has it.
Program complete(Program layer, const ReportAt& report);

/// The parameter, where exactly one output is a closure.
std::optional<std::uint32_t> onlyClosureOutput(const Program& program);

/// Replaces closure values: every closure variable becomes, for each call site whose closure it may hold, variables for
/// what is linear in the weight (surfaces: the weight; volumes: extinction, scattering, emission) and for what is
/// averaged when two are added (parameters; mean cosine). Appends the outputs of `Ci`. Too many scattering sites in a
/// volume are reported.
void expandClosures(Program& program, const ReportAt& report);

}  // namespace aerosol::lang
