#include "core/lang/program.h"

#include <array>
#include <cstdio>
#include <string_view>

namespace aerosol::lang {

namespace {

constexpr std::array<std::string_view, 50> opNames = {"assign",
                                                      "toFloat",
                                                      "toInt",
                                                      "toTriple",
                                                      "toMatrix",
                                                      "makeTriple",
                                                      "makeMatrix",
                                                      "toBool",
                                                      "component",
                                                      "setComponent",
                                                      "matrixElement",
                                                      "setMatrixElement",
                                                      "element",
                                                      "setElement",
                                                      "negate",
                                                      "bitNot",
                                                      "logicalNot",
                                                      "add",
                                                      "subtract",
                                                      "multiply",
                                                      "divide",
                                                      "modulo",
                                                      "bitAnd",
                                                      "bitOr",
                                                      "bitXor",
                                                      "shiftLeft",
                                                      "shiftRight",
                                                      "less",
                                                      "lessEqual",
                                                      "greater",
                                                      "greaterEqual",
                                                      "equal",
                                                      "notEqual",
                                                      "logicalAnd",
                                                      "logicalOr",
                                                      "select",
                                                      "call",
                                                      "message",
                                                      "closureMake",
                                                      "closureScale",
                                                      "closureAdd",
                                                      "closureWeight",
                                                      "closureParameter",
                                                      "closureLayer",
                                                      "branch",
                                                      "loop",
                                                      "breakLoop",
                                                      "continueLoop",
                                                      "scope",
                                                      "leave"};
static_assert(opNames.size() == static_cast<std::size_t>(Op::leave) + 1);

std::string_view nameOf(Op op) { return opNames[static_cast<std::size_t>(op)]; }

std::string show(float value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.9g", static_cast<double>(value));
  std::string text = buffer.data();
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string show(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '\n') {
      quoted += "\\n";
    } else {
      if (c == '"' || c == '\\') quoted += '\\';
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string show(std::int32_t value) { return std::to_string(value); }

std::string show(const ConstantValue& value) {
  return std::visit(
      [](const auto& leaves) -> std::string {
        if constexpr (std::is_same_v<std::decay_t<decltype(leaves)>, std::monostate>) {
          return "null";
        } else {
          if (leaves.size() == 1) return show(leaves[0]);
          std::string text = "(";
          for (std::size_t i = 0; i < leaves.size(); ++i) text += (i > 0 ? " " : "") + show(leaves[i]);
          return text + ")";
        }
      },
      value);
}

class Listing {
 public:
  explicit Listing(const Program& program) : program_(program) {}

  std::string text() {
    out_ = program_.kind + " " + program_.name + "\n";
    for (const Parameter& parameter : program_.parameters) {
      out_ += std::string(parameter.isOutput ? "output " : "parameter ") + toString(parameter.type) + " " +
              parameter.name + " = " + (parameter.hasConstantDefault ? show(parameter.defaultValue) : "computed") +
              "\n";
    }
    code(program_.body, 0);
    for (const Output& output : program_.outputs) {
      static constexpr std::array<std::string_view, 8> names = {
          "sigmaT", "sigmaS", "emission", "lobeSigmaS", "lobeAnisotropy", "siteWeight", "siteParameter", "parameter"};
      out_ += "result " + std::string(names[static_cast<std::size_t>(output.kind)]) + " " +
              std::to_string(output.index) + " " + std::to_string(output.subIndex) + " = " + name(output.variable) +
              "\n";
    }
    return std::move(out_);
  }

 private:
  std::string name(VariableId id) const {
    if (id == noVariable) return "-";
    const Variable& variable = program_.variables[id];
    if (variable.storage == Storage::constant) return show(variable.value);
    if (variable.storage == Storage::global) return variable.name;
    if (variable.storage == Storage::temporary) return "%" + std::to_string(id);
    if (variable.storage == Storage::parameter) return "$" + variable.name;
    return variable.name + "@" + std::to_string(id);
  }

  void code(const Code& instructions, int depth) {
    for (const Instruction& instruction : instructions) line(instruction, depth);
  }

  void line(const Instruction& instruction, int depth) {
    out_.append(static_cast<std::size_t>(depth) * 2, ' ');
    if (instruction.result != noVariable) {
      out_ += name(instruction.result) + " = ";
    }
    out_ += nameOf(instruction.op);
    if (instruction.op == Op::call) out_ += " " + program_.functions[instruction.function].symbol;
    if (instruction.op == Op::message) {
      static constexpr std::array<std::string_view, 3> kinds = {" print", " warning", " error"};
      out_ += instruction.function < kinds.size() ? kinds[instruction.function] : " file";
    }
    if (instruction.op == Op::closureMake) out_ += " " + program_.closureSites[instruction.site].closure;
    if (instruction.op == Op::scope || instruction.op == Op::leave) out_ += " " + std::to_string(instruction.scopeId);
    if (instruction.testsLast) out_ += " testsLast";
    for (const VariableId argument : instruction.arguments) out_ += " " + name(argument);
    if (instruction.result != noVariable) out_ += " : " + toString(program_.variables[instruction.result].type);
    out_ += "\n";
    for (std::size_t i = 0; i < instruction.bodies.size(); ++i) {
      if (i > 0) out_ += std::string(static_cast<std::size_t>(depth) * 2, ' ') + "--\n";
      code(instruction.bodies[i], depth + 1);
    }
    if (!instruction.bodies.empty()) out_ += std::string(static_cast<std::size_t>(depth) * 2, ' ') + "end\n";
  }

  const Program& program_;
  std::string out_;
};

}  // namespace

std::string toString(const Program& program) { return Listing(program).text(); }

}  // namespace aerosol::lang
