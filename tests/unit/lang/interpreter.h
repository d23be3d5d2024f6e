// Runs a program for one point with the C++ library's mathematics: slow, simple, and independent of the code generator.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/lang/fold.h"
#include "core/lang/program.h"

namespace aerosol::lang::testing {

struct PointInputs {
  std::map<std::string, std::vector<float>> globals;      ///< By name; the others are zero.
  std::map<std::string, ConstantValue> parameters;        ///< Instance values by name.
  std::map<std::string, std::array<float, 16>> toCommon;  ///< Named spaces besides "common" and "world", row vectors.
};

struct PointResult {
  std::map<std::string, Constant> outputs;  ///< Parameters by name; coefficients as "sigmaT", "lobeSigmaS0" …
  std::vector<std::string> messages;        ///< "print: text", "warning: text", "error: text", "index: i n"
};

/// Fails the current test when the program calls a function that has no counterpart here.
PointResult interpret(const Program& program, const PointInputs& inputs);

}  // namespace aerosol::lang::testing
