#include "core/jit/dear_part.h"

#include <algorithm>
#include <span>
#include <vector>

#include "core/jit/cost.h"

namespace aerosol::jit {

using lang::Code;
using lang::Instruction;
using lang::Op;
using Part = std::span<const Instruction>;

namespace {

constexpr double leastCost = 150;
constexpr double leastShare = 6.0 / 7;

class Search {
 public:
  Search(const lang::Program& program, const lang::Uniformity& uniformity)
      : program_(program), uniformity_(uniformity), cost_(program), total_(cost_.of(program.body)) {}

  std::optional<DearPart> run() {
    if (leavesTraces(program_.body, Traces::messages)) return {};
    return searchIn(program_.body);
  }

 private:
  enum class Traces : std::uint8_t { messages, reports };

  /// Later parts first, and inner ones before those around them: more conditions stand before them.
  std::optional<DearPart> searchIn(const Code& code) {
    for (std::size_t i = code.size(); i-- > 0;) {
      const Instruction& instruction = code[i];
      if (instruction.op != Op::scope && instruction.op != Op::branch) continue;
      for (const Code& body : instruction.bodies) {
        if (const auto found = searchIn(body)) return found;
      }
      if (instruction.op != Op::branch || !uniformity_.isVarying(instruction)) continue;
      if (isWorthIt(instruction.bodies[0])) return DearPart{&instruction, DearPart::Place::whenTrue};
      if (isWorthIt(instruction.bodies[1])) return DearPart{&instruction, DearPart::Place::whenFalse};
      std::vector<const Instruction*> enclosing;
      const Part rest = Part(code).subspan(i + 1);
      if (sendsSomeAway(instruction, enclosing) && isWorthIt(rest)) {
        return DearPart{&instruction, DearPart::Place::behind};
      }
    }
    return {};
  }

  bool isWorthIt(Part part) {
    const double cost = cost_.of(part);
    return cost >= leastCost && cost >= leastShare * total_ && !reportsOutside(program_.body, part);
  }

  /// Does some masked exit within lead further out?
  bool sendsSomeAway(const Instruction& instruction, std::vector<const Instruction*>& enclosing) const {
    if (lang::isExit(instruction.op)) {
      const bool staysInside = std::any_of(enclosing.begin(), enclosing.end(), [&](const Instruction* outer) {
        return instruction.op == Op::leave ? outer->op == Op::scope && outer->scopeId == instruction.scopeId
                                           : outer->op == Op::loop;
      });
      return !staysInside && uniformity_.isMasked(instruction);
    }
    enclosing.push_back(&instruction);
    bool found = false;
    for (const Code& body : instruction.bodies) {
      for (const Instruction& inner : body) found = found || sendsSomeAway(inner, enclosing);
    }
    enclosing.pop_back();
    return found;
  }

  bool isConstant(lang::VariableId id) const { return program_.variables[id].storage == lang::Storage::constant; }

  bool leavesTrace(const Instruction& instruction, Traces traces) const {
    switch (instruction.op) {
      case Op::message:
        return true;
      case Op::call: {
        const lang::FunctionUse& function = program_.functions[instruction.function];
        return !function.pure || (function.host && traces == Traces::reports);
      }
      case Op::loop:
        return traces == Traces::reports;
      case Op::component:
      case Op::element:
      case Op::matrixElement:
        return traces == Traces::reports && !std::all_of(instruction.arguments.begin() + 1, instruction.arguments.end(),
                                                         [&](lang::VariableId id) { return isConstant(id); });
      case Op::setComponent:
      case Op::setElement:
        return traces == Traces::reports && !isConstant(instruction.arguments[0]);
      case Op::setMatrixElement:
        return traces == Traces::reports &&
               !(isConstant(instruction.arguments[0]) && isConstant(instruction.arguments[1]));
      default:
        return false;
    }
  }

  bool leavesTraces(Part code, Traces traces) const {
    return std::any_of(code.begin(), code.end(), [&](const Instruction& instruction) {
      return leavesTrace(instruction, traces) ||
             std::any_of(instruction.bodies.begin(), instruction.bodies.end(),
                         [&](const Code& body) { return leavesTraces(body, traces); });
    });
  }

  /// Of the code without the part.
  bool reportsOutside(Part code, Part part) const {
    for (const Instruction& instruction : code) {
      if (!part.empty() && &instruction >= part.data() && &instruction < part.data() + part.size()) continue;
      if (leavesTrace(instruction, Traces::reports)) return true;
      for (const Code& body : instruction.bodies) {
        if (reportsOutside(body, part)) return true;
      }
    }
    return false;
  }

  const lang::Program& program_;
  const lang::Uniformity& uniformity_;
  Cost cost_;
  double total_;
};

}  // namespace

std::optional<DearPart> findDearPart(const lang::Program& program, const lang::Uniformity& uniformity) {
  return Search(program, uniformity).run();
}

}  // namespace aerosol::jit
