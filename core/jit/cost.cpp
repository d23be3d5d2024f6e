#include "core/jit/cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace aerosol::jit {

using lang::BaseType;
using lang::Instruction;
using lang::Op;
using lang::VariableId;

namespace {

constexpr double unknownRounds = 8;

struct SymbolCost {
  std::string_view prefix;
  double cost;
};
/// By the beginning of the symbol, the first that fits.
constexpr std::array symbolCosts = {
    SymbolCost{"simplex", 120},    SymbolCost{"usimplex", 120}, SymbolCost{"perlin", 100},
    SymbolCost{"uperlin", 100},    SymbolCost{"snoise", 100},   SymbolCost{"pperlin", 130},
    SymbolCost{"puperlin", 130},   SymbolCost{"cell", 30},      SymbolCost{"hash", 30},
    SymbolCost{"pcell", 40},       SymbolCost{"phash", 40},     SymbolCost{"gabor", 1000},
    SymbolCost{"spline", 40},      SymbolCost{"pow", 30},       SymbolCost{"sin", 15},
    SymbolCost{"cos", 15},         SymbolCost{"tan", 20},       SymbolCost{"asin", 15},
    SymbolCost{"acos", 15},        SymbolCost{"atan", 20},      SymbolCost{"exp", 12},
    SymbolCost{"log", 15},         SymbolCost{"erf", 20},       SymbolCost{"cbrt", 15},
    SymbolCost{"fmod", 10},        SymbolCost{"mod", 10},       SymbolCost{"inverse_", 120},
    SymbolCost{"determinant", 40}, SymbolCost{"normalize", 12}, SymbolCost{"transform", 25},
    SymbolCost{"getmatrix", 60},
};
constexpr double otherCallCost = 5;
constexpr double hostCallCost = 100;

}  // namespace

double Cost::components(VariableId id) const {
  const lang::Type& type = program_.variables[id].type;
  const double one = type.isArray() ? std::max(type.arrayLength, 1) : 1;
  return one * (type.base == BaseType::matrix ? 16 : type.element().isTriple() ? 3 : 1);
}

bool Cost::constantInt(VariableId id, double& value) const {
  const auto* ints = std::get_if<std::vector<std::int32_t>>(&program_.variables[id].value);
  if (program_.variables[id].storage != lang::Storage::constant || !ints || ints->size() != 1) return false;
  value = (*ints)[0];
  return true;
}

double Cost::ofCall(const Instruction& instruction) const {
  if (program_.functions[instruction.function].host) return hostCallCost;
  const std::string& symbol = program_.functions[instruction.function].symbol;
  for (const SymbolCost& entry : symbolCosts) {
    if (symbol.starts_with(entry.prefix)) {
      const bool givesTriple = symbol.find("_v_") != std::string::npos && symbol.find("perlin") != std::string::npos;
      return givesTriple ? 2 * entry.cost : entry.cost;
    }
  }
  return otherCallCost;
}

double Cost::ofOperation(const Instruction& instruction) const {
  if (instruction.op == Op::call) return ofCall(instruction);
  if (instruction.op == Op::message) return 20;
  if (instruction.op == Op::element || instruction.op == Op::setElement) return 4;
  if (instruction.result == lang::noVariable) return 1;
  const bool isProduct = instruction.op == Op::multiply || instruction.op == Op::divide;
  const bool isMatrix = program_.variables[instruction.result].type.base == BaseType::matrix;
  return components(instruction.result) * (isProduct && isMatrix ? 7 : 1);
}

/// `for (i = a; i < b; i += c)` with constants; the variable's own writes in the body are not looked for.
double Cost::rounds(std::span<const Instruction> code, std::size_t loop) const {
  const Instruction& instruction = code[loop];
  const lang::Code& test = instruction.bodies[0];
  const lang::Code& step = instruction.bodies[2];
  if (test.empty() || step.empty()) return unknownRounds;
  const Instruction& comparison = test.back();
  const bool inclusive = comparison.op == Op::lessEqual;
  double first = 0, last = 0, increment = 0;
  if (comparison.op != Op::less && !inclusive) return unknownRounds;
  if (!constantInt(comparison.arguments[1], last)) return unknownRounds;
  const VariableId counter = comparison.arguments[0];
  const Instruction& advance = step.back();
  if (advance.op != Op::add || advance.arguments[0] != counter || !constantInt(advance.arguments[1], increment)) {
    return unknownRounds;
  }
  for (std::size_t i = loop; i-- > 0;) {
    if (code[i].result != counter) continue;
    if (code[i].op != Op::assign || !constantInt(code[i].arguments[0], first)) return unknownRounds;
    const double count = increment > 0 ? std::ceil((last - first + (inclusive ? 1 : 0)) / increment) : unknownRounds;
    return std::clamp(count, 0.0, 1e6);
  }
  return unknownRounds;
}

double Cost::withoutBodies(std::span<const Instruction> code) const {
  double sum = 0;
  for (const Instruction& instruction : code) sum += ofOperation(instruction);
  return sum;
}

double Cost::of(std::span<const Instruction> code) const {
  double sum = 0;
  for (std::size_t i = 0; i < code.size(); ++i) {
    double bodies = 0;
    for (const lang::Code& body : code[i].bodies) bodies += of(body);
    sum += ofOperation(code[i]) + (code[i].op == Op::loop ? rounds(code, i) * bodies : bodies);
  }
  return sum;
}

}  // namespace aerosol::jit
