#include "core/lang/magnitude.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace aerosol::lang {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
/// Beyond this a float may have become infinite.
constexpr double largestFloat = 3.4e38;

double rounded(double magnitude) {
  const double result = magnitude * (1 + 1e-6) + 1e-44;
  return result < largestFloat ? result : infinite;
}

/// Functions with bounded values: of finite arguments, the result's magnitude is at most this.
struct BoundedFunction {
  std::string_view name;
  double bound;
};
constexpr std::array<BoundedFunction, 27> boundedFunctions = {{
    {"perlin", 4},   {"pperlin", 4},        {"uperlin", 3},        {"puperlin", 3}, {"simplex", 4},
    {"usimplex", 3}, {"cell", 1},           {"pcell", 1},          {"hash", 1},     {"phash", 1},
    {"sin", 1.001},  {"cos", 1.001},        {"tanh", 1.001},       {"erf", 1.001},  {"erfc", 2.001},
    {"asin", 1.6},   {"acos", 3.2},         {"atan", 1.6},         {"atan2", 3.2},  {"step", 1},
    {"sign", 1},     {"smoothstep", 1.001}, {"linearstep", 1.001}, {"isnan", 1},    {"isinf", 1},
    {"isfinite", 1}, {"normalize", 1.001},
}};

/// Functions whose result is not larger than the largest argument.
constexpr std::array<std::string_view, 8> selections = {"abs",   "min",  "max",   "clamp",
                                                        "floor", "ceil", "trunc", "round"};

double callMagnitude(std::string_view symbol, double largest) {
  const std::string_view name = symbol.substr(0, symbol.find('_'));
  const bool givesInt = symbol.substr(name.size()).starts_with("_i_");
  if (largest == infinite || (givesInt && name == "hash")) return infinite;
  // Sums of coordinates may overflow; angles are reduced with few digits when they are large.
  if (largest > 1e37) return infinite;
  if ((name == "sin" || name == "cos") && largest > 1e4) return infinite;
  for (const BoundedFunction& known : boundedFunctions)
    if (known.name == name) return known.bound;
  if (std::find(selections.begin(), selections.end(), name) == selections.end()) return infinite;
  const bool steps = name == "floor" || name == "ceil" || name == "round";
  return steps ? rounded(largest + 1) : largest;
}

}  // namespace

double magnitudeOf(const Program& program, const Instruction& instruction, std::span<const double> arguments) {
  const double largest = arguments.empty() ? infinite : *std::max_element(arguments.begin(), arguments.end());
  const bool isMatrix =
      instruction.result != noVariable && program.variables[instruction.result].type.base == BaseType::matrix;
  if (isMatrix) return infinite;
  switch (instruction.op) {
    case Op::assign:
    case Op::negate:
    case Op::toTriple:
    case Op::makeTriple:
      return largest;
    case Op::component:
      return arguments[0];
    case Op::select:
      return std::max(arguments[1], arguments[2]);
    case Op::toFloat:
      return 2147483648.0;
    case Op::toBool:
    case Op::logicalNot:
    case Op::logicalAnd:
    case Op::logicalOr:
      return 1;
    case Op::add:
    case Op::subtract:
      return rounded(arguments[0] + arguments[1]);
    case Op::multiply:
      // What is 0 times a bounded value is 0.
      return largest == infinite                ? infinite
             : arguments[0] * arguments[1] == 0 ? 0
                                                : rounded(arguments[0] * arguments[1]);
    case Op::call:
      return program.functions[instruction.function].host
                 ? infinite
                 : callMagnitude(program.functions[instruction.function].symbol, largest);
    default:
      return instruction.op >= Op::less && instruction.op <= Op::notEqual ? 1 : infinite;
  }
}

double magnitudeOf(const Variable& variable) {
  if (variable.storage == Storage::global) return variable.type.closure ? infinite : largestGlobal;
  if (variable.storage != Storage::constant || variable.type.base == BaseType::matrix) return infinite;
  double result = 0;
  if (const auto* floats = std::get_if<std::vector<float>>(&variable.value)) {
    for (const float value : *floats)
      result = std::isfinite(value) ? std::max(result, std::fabs(double{value})) : infinite;
    return result;
  }
  if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&variable.value)) {
    for (const std::int32_t value : *ints) result = std::max(result, std::fabs(static_cast<double>(value)));
    return result;
  }
  return infinite;
}

bool absorbs(float number, double magnitude) {
  if (!std::isfinite(number) || number == 0) return false;
  // Half of the distance to the nearer neighbour, which is the one towards 0; a tie could round away.
  const float below = std::nextafterf(number, 0.0f);
  return magnitude < std::fabs(double{number} - double{below}) / 2;
}

}  // namespace aerosol::lang
