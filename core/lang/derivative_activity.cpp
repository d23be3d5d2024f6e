#include "core/lang/derivative_activity.h"

#include <algorithm>
#include <string_view>

#include "core/lang/analysis.h"
#include "core/lang/uniformity.h"
#include "core/lang/user_data.h"

namespace aerosol::lang {

namespace {

struct GlobalDerivatives {
  Global global;
  std::array<std::optional<Global>, axisCount> along;
};
constexpr std::array<GlobalDerivatives, 5> globalDerivatives = {{
    {Global::P, {Global::dPdx, Global::dPdy, Global::dPdz}},
    {Global::I, {Global::dIdx, Global::dIdy, std::nullopt}},
    {Global::u, {Global::dudx, Global::dudy, std::nullopt}},
    {Global::v, {Global::dvdx, Global::dvdy, std::nullopt}},
    {Global::Ps, {Global::dPsdx, Global::dPsdy, std::nullopt}},
}};

struct Query {
  std::string_view base;
  DerivativeQuery query;
};
constexpr std::array<Query, 6> queries = {{{"dx", DerivativeQuery::dx},
                                           {"dy", DerivativeQuery::dy},
                                           {"dz", DerivativeQuery::dz},
                                           {"filterwidth", DerivativeQuery::filterwidth},
                                           {"area", DerivativeQuery::area},
                                           {"calculatenormal", DerivativeQuery::calculatenormal}}};

bool wants(DerivativeQuery query, std::size_t axis) {
  switch (query) {
    case DerivativeQuery::dx:
      return axis == 0;
    case DerivativeQuery::dy:
      return axis == 1;
    case DerivativeQuery::dz:
      return axis == 2;
    default:
      return axis < 2;
  }
}

/// Whether the derivative of what the instruction computes depends on that of its argument number `i`.
bool passes(const Instruction& instruction, std::size_t i) {
  switch (instruction.op) {
    case Op::assign:
    case Op::toTriple:
    case Op::toMatrix:
    case Op::makeTriple:
    case Op::makeMatrix:
    case Op::negate:
    case Op::add:
    case Op::subtract:
    case Op::multiply:
    case Op::divide:
    case Op::modulo:
      return true;
    case Op::component:
    case Op::matrixElement:
    case Op::element:
      return i == 0;
    case Op::setComponent:
    case Op::setElement:
      return i == 1;
    case Op::setMatrixElement:
      return i == 2;
    case Op::select:
      return i > 0;
    default:
      return false;
  }
}

}  // namespace

std::optional<DerivativeQuery> queryOf(const Program& program, const Instruction& instruction) {
  if (instruction.op != Op::call) return {};
  return queryOf(program.functions[instruction.function]);
}

std::optional<DerivativeQuery> queryOf(const FunctionUse& function) {
  if (function.host) return {};
  const std::string_view base = takeApart(function.symbol).base;
  const auto* const found =
      std::find_if(queries.begin(), queries.end(), [&](const Query& query) { return query.base == base; });
  if (found == queries.end()) return {};
  return found->query;
}

std::optional<Global> derivativeGlobal(Global global, std::size_t axis) {
  for (const GlobalDerivatives& row : globalDerivatives)
    if (row.global == global) return row.along[axis];
  return {};
}

bool isContinuous(const Type& type) {
  return !type.closure && (type.base == BaseType::floating || type.base == BaseType::matrix || type.isTriple());
}

DerivativeActivity::DerivativeActivity(const Program& program) : program_(program) {
  const auto flow = [&](VariableId from, VariableId to) {
    if (isContinuous(program.variables[from].type) && isContinuous(program.variables[to].type))
      flows_.push_back({from, to});
  };
  forEachInstruction(program.body, [&](const Instruction& instruction) {
    if (instruction.op == Op::call) {
      const FunctionUse& function = program.functions[instruction.function];
      const FunctionRule* const rule = findFunctionRule(function);
      const bool isFlat = rule ? !rule->rule && !rule->outputRule && rule->gradient.empty() : !function.pure;
      if (isFlat) return;
    }
    for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
      if (writesArgument(program, instruction, i)) continue;
      if (instruction.op != Op::call && !passes(instruction, i)) continue;
      forEachWritten(program, instruction, [&](VariableId to) { flow(instruction.arguments[i], to); });
    }
  });
  seed();
  for (std::size_t axis = 0; axis < axisCount; ++axis) {
    spread(axis);
    gather(axis);
  }
}

void DerivativeActivity::seed() {
  for (std::size_t axis = 0; axis < axisCount; ++axis) {
    varied_[axis].assign(program_.variables.size(), false);
    wanted_[axis].assign(program_.variables.size(), false);
    for (VariableId id = 0; id < program_.variables.size(); ++id) {
      const Variable& variable = program_.variables[id];
      varied_[axis][id] = variable.storage == Storage::global && derivativeGlobal(variable.global, axis);
    }
  }
  forEachInstruction(program_.body, [&](const Instruction& instruction) {
    if (givesUserData(program_, instruction) && isContinuous(program_.variables[instruction.arguments[1]].type))
      for (std::size_t axis = 0; axis < 2; ++axis) varied_[axis][instruction.arguments[1]] = true;
    const auto query = queryOf(program_, instruction);
    if (!query) return;
    for (std::size_t axis = 0; axis < axisCount; ++axis)
      if (wants(*query, axis)) wanted_[axis][instruction.arguments[0]] = true;
  });
}

/// Flows stand in the order of the program: few rounds are needed.
void DerivativeActivity::spread(std::size_t axis) {
  std::vector<bool>& varied = varied_[axis];
  for (bool changed = true; changed;) {
    changed = false;
    for (const Flow& flow : flows_) {
      if (!varied[flow.from] || varied[flow.to]) continue;
      varied[flow.to] = changed = true;
    }
  }
}

void DerivativeActivity::gather(std::size_t axis) {
  std::vector<bool>& wanted = wanted_[axis];
  for (bool changed = true; changed;) {
    changed = false;
    for (auto flow = flows_.rbegin(); flow != flows_.rend(); ++flow) {
      if (!wanted[flow->to] || wanted[flow->from]) continue;
      wanted[flow->from] = changed = true;
    }
  }
}

}  // namespace aerosol::lang
