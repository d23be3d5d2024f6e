#include "tests/unit/jit/interpreter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "core/base/hash.h"
#include "core/lang/abi.h"

namespace aerosol::jit::test {

using lang::BaseType;
using lang::Code;
using lang::Instruction;
using lang::Op;
using lang::Type;
using lang::VariableId;

namespace {

using Bits = std::vector<std::uint64_t>;

float toFloat(std::uint64_t bits) { return std::bit_cast<float>(static_cast<std::uint32_t>(bits)); }
std::int32_t toInt(std::uint64_t bits) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(bits)); }
std::uint64_t fromFloat(float x) { return std::bit_cast<std::uint32_t>(x); }
std::uint64_t fromInt(std::int64_t x) { return static_cast<std::uint32_t>(x); }

std::size_t componentsOf(const Type& type) {
  return type.base == BaseType::matrix ? 16 : type.element().isTriple() ? 3 : 1;
}
std::size_t leavesOf(const Type& type) {
  return componentsOf(type) * static_cast<std::size_t>(type.isArray() ? type.arrayLength : 1);
}
BaseType baseOf(const Type& type) {
  return type.base == BaseType::integer || type.base == BaseType::string ? type.base : BaseType::floating;
}

Bits bitsOf(const Type& type, const lang::ConstantValue& value) {
  Bits bits(leavesOf(type), 0);
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&value)) bits[i] = fromInt(ints->at(i));
    if (const auto* floats = std::get_if<std::vector<float>>(&value)) bits[i] = fromFloat(floats->at(i));
    if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) bits[i] = hashString(texts->at(i));
  }
  return bits;
}

std::uint64_t operate(Op op, BaseType base, std::uint64_t a, std::uint64_t b) {
  if (base == BaseType::string) return op == Op::equal ? a == b : a != b;
  if (base == BaseType::floating) {
    const float x = toFloat(a), y = toFloat(b);
    switch (op) {
      case Op::add:
        return fromFloat(x + y);
      case Op::subtract:
        return fromFloat(x - y);
      case Op::multiply:
        return fromFloat(x * y);
      case Op::divide:
        return fromFloat(y == 0 ? 0 : x / y);
      case Op::less:
        return x < y;
      case Op::lessEqual:
        return x <= y;
      case Op::greater:
        return x > y;
      case Op::greaterEqual:
        return x >= y;
      case Op::equal:
        return x == y;
      case Op::notEqual:
        return x != y;
      default:
        throw std::logic_error("no such operator on floats");
    }
  }
  const std::int64_t x = toInt(a), y = toInt(b);
  const std::uint32_t shift = static_cast<std::uint32_t>(y) & 31u;
  switch (op) {
    case Op::add:
      return fromInt(x + y);
    case Op::subtract:
      return fromInt(x - y);
    case Op::multiply:
      return fromInt(x * y);
    case Op::divide:
      return fromInt(y == 0 ? 0 : x / y);
    case Op::modulo:
      return fromInt(y == 0 ? 0 : x % y);
    case Op::bitAnd:
      return fromInt(x & y);
    case Op::bitOr:
      return fromInt(x | y);
    case Op::bitXor:
      return fromInt(x ^ y);
    case Op::shiftLeft:
      return fromInt(x << shift);
    case Op::shiftRight:
      return fromInt(x >> shift);
    case Op::less:
      return x < y;
    case Op::lessEqual:
      return x <= y;
    case Op::greater:
      return x > y;
    case Op::greaterEqual:
      return x >= y;
    case Op::equal:
      return x == y;
    case Op::notEqual:
      return x != y;
    case Op::logicalAnd:
      return x != 0 && y != 0;
    case Op::logicalOr:
      return x != 0 || y != 0;
    default:
      throw std::logic_error("no such operator on ints");
  }
}

std::int32_t truncated(float x) {
  if (x != x) return 0;
  if (x >= 2147483648.0f) return std::numeric_limits<std::int32_t>::max();
  if (x < -2147483648.0f) return std::numeric_limits<std::int32_t>::min();
  return static_cast<std::int32_t>(x);
}

enum class Flow { normal, breaks, continues, leaves };

class Interpreter {
 public:
  Interpreter(const lang::Program& program, std::uint32_t budget) : program_(program), budget_(budget) {}

  PointOutcome outcome;
  std::vector<Bits> values;

  Flow run(const Code& code) {
    for (const Instruction& instruction : code) {
      const Flow flow = run(instruction);
      if (flow != Flow::normal) return flow;
    }
    return Flow::normal;
  }

 private:
  const Type& type(VariableId id) const { return program_.variables[id].type; }
  int line(const Instruction& instruction) const { return program_.locations[instruction.location].line; }
  bool isTrue(VariableId id) const { return toInt(values[id][0]) != 0; }

  Flow run(const Instruction& instruction) {
    switch (instruction.op) {
      case Op::branch:
        return run(instruction.bodies[isTrue(instruction.arguments[0]) ? 0 : 1]);
      case Op::loop:
        return loop(instruction);
      case Op::scope: {
        const Flow flow = run(instruction.bodies[0]);
        return flow == Flow::leaves && left_ == instruction.scopeId ? Flow::normal : flow;
      }
      case Op::breakLoop:
        return Flow::breaks;
      case Op::continueLoop:
        return Flow::continues;
      case Op::leave:
        left_ = instruction.scopeId;
        return Flow::leaves;
      case Op::message:
        message(instruction);
        return Flow::normal;
      case Op::call:
        call(instruction);
        return Flow::normal;
      default:
        values[instruction.result] = operation(instruction);
        return Flow::normal;
    }
  }

  Flow loop(const Instruction& instruction) {
    bool test = !instruction.testsLast;
    for (;;) {
      if (test) {
        if (const Flow flow = run(instruction.bodies[0]); flow != Flow::normal) return flow;
        if (!isTrue(instruction.arguments[0])) return Flow::normal;
      }
      test = true;
      if (++rounds_[&instruction] > budget_) {
        outcome.records.push_back({AEROSOL_REPORT_BUDGET, line(instruction), 0, {}});
        return Flow::normal;
      }
      const Flow flow = run(instruction.bodies[1]);
      if (flow == Flow::breaks) return Flow::normal;
      if (flow == Flow::leaves) return flow;
      if (const Flow stepFlow = run(instruction.bodies[2]); stepFlow != Flow::normal) return stepFlow;
    }
  }

  void message(const Instruction& instruction) {
    Record record{instruction.function, line(instruction), 0, {}};
    for (std::size_t i = 1; i < instruction.arguments.size(); ++i) {
      const VariableId argument = instruction.arguments[i];
      for (const std::uint64_t bits : values[argument])
        record.values.push_back(canonical(bits, baseOf(type(argument))));
    }
    outcome.records.push_back(std::move(record));
  }

  void call(const Instruction& instruction) {
    const std::string& symbol = program_.functions[instruction.function].symbol;
    const float x = toFloat(values[instruction.arguments[0]][0]);
    float result = 0;
    if (symbol == "sqrt_f_f") {
      result = x <= 0 ? 0 : std::sqrt(x);
    } else if (symbol == "floor_f_f") {
      result = std::floor(x);
    } else if (symbol == "abs_f_f") {
      result = std::fabs(x);
    } else {
      throw std::logic_error("the interpreter does not know " + symbol);
    }
    values[instruction.result] = {fromFloat(result)};
  }

  std::size_t index(const Instruction& instruction, VariableId id, std::size_t length) {
    const std::int32_t given = toInt(values[id][0]);
    if (given >= 0 && given < static_cast<std::int32_t>(length)) return static_cast<std::size_t>(given);
    outcome.records.push_back({AEROSOL_REPORT_INDEX, line(instruction), 0, {fromInt(given), length}});
    return given < 0 ? 0 : length - 1;
  }

  Bits operation(const Instruction& instruction) {
    const auto& arguments = instruction.arguments;
    const auto value = [&](std::size_t i) -> const Bits& { return values[arguments[i]]; };
    switch (instruction.op) {
      case Op::assign:
        return value(0);
      case Op::toFloat:
        return {fromFloat(static_cast<float>(toInt(value(0)[0])))};
      case Op::toInt:
        return {fromInt(truncated(toFloat(value(0)[0])))};
      case Op::toTriple:
        return Bits(3, value(0)[0]);
      case Op::toMatrix: {
        Bits matrix(16, 0);
        for (std::size_t i = 0; i < 16; i += 5) matrix[i] = value(0)[0];
        return matrix;
      }
      case Op::makeTriple:
      case Op::makeMatrix: {
        Bits result;
        for (std::size_t i = 0; i < arguments.size(); ++i) result.push_back(value(i)[0]);
        return result;
      }
      case Op::toBool: {
        const BaseType base = baseOf(type(arguments[0]));
        return {std::any_of(value(0).begin(), value(0).end(),
                            [base](std::uint64_t x) { return base == BaseType::floating ? toFloat(x) != 0 : x != 0; })};
      }
      case Op::component:
        return {value(0)[index(instruction, arguments[1], 3)]};
      case Op::setComponent: {
        Bits result = values[instruction.result];
        result[index(instruction, arguments[0], 3)] = value(1)[0];
        return result;
      }
      case Op::matrixElement: {
        const std::size_t row = index(instruction, arguments[1], 4);
        return {value(0)[row * 4 + index(instruction, arguments[2], 4)]};
      }
      case Op::setMatrixElement: {
        Bits result = values[instruction.result];
        const std::size_t row = index(instruction, arguments[0], 4);
        result[row * 4 + index(instruction, arguments[1], 4)] = value(2)[0];
        return result;
      }
      case Op::element: {
        const Type& array = type(arguments[0]);
        const std::size_t size = componentsOf(array);
        const std::size_t at = index(instruction, arguments[1], static_cast<std::size_t>(array.arrayLength)) * size;
        return Bits(value(0).begin() + static_cast<std::ptrdiff_t>(at),
                    value(0).begin() + static_cast<std::ptrdiff_t>(at + size));
      }
      case Op::setElement: {
        Bits result = values[instruction.result];
        const Type& array = type(instruction.result);
        const std::size_t size = componentsOf(array);
        const std::size_t at = index(instruction, arguments[0], static_cast<std::size_t>(array.arrayLength)) * size;
        std::copy(value(1).begin(), value(1).end(), result.begin() + static_cast<std::ptrdiff_t>(at));
        return result;
      }
      case Op::negate: {
        Bits result = value(0);
        const bool isFloat = baseOf(type(arguments[0])) == BaseType::floating;
        for (std::uint64_t& x : result) x = isFloat ? fromFloat(-toFloat(x)) : fromInt(-std::int64_t{toInt(x)});
        return result;
      }
      case Op::bitNot:
        return {fromInt(~toInt(value(0)[0]))};
      case Op::logicalNot:
        return {toInt(value(0)[0]) == 0};
      case Op::select: {
        const Bits& chosen = isTrue(arguments[0]) ? value(1) : value(2);
        return chosen.size() == 1 ? Bits(leavesOf(type(instruction.result)), chosen[0]) : chosen;
      }
      default:
        return binary(instruction);
    }
  }

  Bits binary(const Instruction& instruction) {
    const Bits& a = values[instruction.arguments[0]];
    const Bits& b = values[instruction.arguments[1]];
    const BaseType base = baseOf(type(instruction.arguments[0]));
    if (a.size() == 16 && b.size() == 16 && instruction.op == Op::multiply) return product(a, b);
    Bits result;
    for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
      result.push_back(operate(instruction.op, base, a.size() == 1 ? a[0] : a[i], b.size() == 1 ? b[0] : b[i]));
    }
    const bool all = std::all_of(result.begin(), result.end(), [](std::uint64_t x) { return x != 0; });
    const bool any = std::any_of(result.begin(), result.end(), [](std::uint64_t x) { return x != 0; });
    if (instruction.op == Op::equal) return {all};
    if (instruction.op == Op::notEqual) return {any};
    return result;
  }

  static Bits product(const Bits& a, const Bits& b) {
    Bits result;
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t column = 0; column < 4; ++column) {
        float sum = toFloat(a[row * 4]) * toFloat(b[column]);
        for (std::size_t k = 1; k < 4; ++k) sum = sum + toFloat(a[row * 4 + k]) * toFloat(b[k * 4 + column]);
        result.push_back(fromFloat(sum));
      }
    }
    return result;
  }

  const lang::Program& program_;
  std::uint32_t budget_;
  std::uint32_t left_ = 0;
  std::map<const Instruction*, std::uint32_t> rounds_;
};

}  // namespace

PointOutcome interpret(const lang::Program& program, const Batch& batch, std::size_t point,
                       const std::vector<lang::ConstantValue>& values) {
  Interpreter interpreter(program, batch.loopBudget);
  for (VariableId id = 0; id < program.variables.size(); ++id) {
    const lang::Variable& variable = program.variables[id];
    Bits bits(leavesOf(variable.type), 0);
    if (variable.storage == lang::Storage::constant) bits = bitsOf(variable.type, variable.value);
    if (variable.storage == lang::Storage::global) {
      for (std::size_t i = 0; i < bits.size(); ++i) {
        const auto pointer = static_cast<std::size_t>(globalPointer(variable.global)) + i;
        bits[i] = fromFloat(batch.globals[pointer][point]);
      }
    }
    if (variable.storage == lang::Storage::parameter) {
      const lang::Parameter& parameter = program.parameters[variable.parameter];
      const bool isGiven =
          variable.parameter < values.size() && !std::holds_alternative<std::monostate>(values[variable.parameter]);
      if (parameter.isSet == id) {
        bits[0] = isGiven ? 1 : 0;
      } else if (isGiven) {
        bits = bitsOf(variable.type, values[variable.parameter]);
      } else if (parameter.hasConstantDefault) {
        bits = bitsOf(variable.type, parameter.defaultValue);
      }
    }
    interpreter.values.push_back(std::move(bits));
  }
  interpreter.run(program.body);
  for (const lang::Output& output : program.outputs) {
    const BaseType base = baseOf(program.variables[output.variable].type);
    for (const std::uint64_t bits : interpreter.values[output.variable]) {
      interpreter.outcome.outputs.push_back(canonical(bits, base));
    }
  }
  return std::move(interpreter.outcome);
}

}  // namespace aerosol::jit::test
