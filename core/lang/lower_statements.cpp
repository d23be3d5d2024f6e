#include <utility>

#include "core/lang/lowerer.h"

namespace aerosol::lang {

namespace {

/// Beyond this many blocks in each other, early exits are left as jumps.
constexpr int maximumNestedExits = 40;

/// Whether every path through the statement ends in the jump that leads to where `tail` goes anyway.
bool alwaysExits(const Statement& statement, Tail tail) {
  if (tail == Tail::function && std::holds_alternative<Return>(statement.node)) return true;
  if (const auto* jump = std::get_if<Jump>(&statement.node))
    return tail == Tail::loop && jump->kind == Jump::Kind::continueLoop;
  if (const auto* block = std::get_if<Block>(&statement.node))
    return !block->statements.empty() && block->statements.back() && alwaysExits(*block->statements.back(), tail);
  if (const auto* branch = std::get_if<If>(&statement.node))
    return branch->yes && branch->no && alwaysExits(*branch->yes, tail) && alwaysExits(*branch->no, tail);
  return false;
}

bool alwaysJumps(const Statement& statement) {
  if (std::holds_alternative<Return>(statement.node) || std::holds_alternative<Jump>(statement.node)) return true;
  if (const auto* block = std::get_if<Block>(&statement.node))
    return !block->statements.empty() && block->statements.back() && alwaysJumps(*block->statements.back());
  if (const auto* branch = std::get_if<If>(&statement.node))
    return branch->yes && branch->no && alwaysJumps(*branch->yes) && alwaysJumps(*branch->no);
  return false;
}

}  // namespace

void Lowerer::lowerStatements(const std::vector<StatementPtr>& statements, std::size_t begin, Tail tail) {
  for (std::size_t i = begin; i < statements.size(); ++i) {
    if (!statements[i]) continue;
    const bool isLast = i + 1 == statements.size();
    if (!isLast && lowerEarlyExit(statements, i, tail)) return;
    lowerStatement(*statements[i], isLast ? tail : Tail::none);
    if (alwaysJumps(*statements[i])) return;
  }
}

/// `if (c) return a; rest` becomes `if (c) a else rest`: no jump, and no mask of those that have left.
bool Lowerer::lowerEarlyExit(const std::vector<StatementPtr>& statements, std::size_t at, Tail tail) {
  const auto* statement = std::get_if<If>(&statements[at]->node);
  if (!statement || tail == Tail::none || nesting_ > maximumNestedExits) return false;
  const bool yesExits = alwaysExits(*statement->yes, tail);
  const bool noExits = statement->no && alwaysExits(*statement->no, tail);
  if (!yesExits && !noExits) return false;
  position_ = statements[at]->position;
  const VariableId condition = lowerCondition(*statement->condition);
  const auto side = [&](const StatementPtr& body, bool exits) {
    return [this, &body, exits, &statements, at, tail] {
      if (body) lowerStatement(*body, exits ? tail : Tail::none);
      if (!exits) lowerStatements(statements, at + 1, tail);
    };
  };
  branch(condition, side(statement->yes, yesExits), side(statement->no, noExits));
  return true;
}

void Lowerer::lowerStatement(const Statement& statement, Tail tail) {
  if (!countWork(statement.position)) return;
  position_ = statement.position;
  if (const auto* expression = std::get_if<ExpressionStatement>(&statement.node)) {
    if (expression->expression) lower(*expression->expression);
  } else if (const auto* declaration = std::get_if<DeclarationStatement>(&statement.node)) {
    for (const auto& variable : declaration->variables) lowerDeclaration(*variable);
  } else if (const auto* block = std::get_if<Block>(&statement.node)) {
    lowerStatements(block->statements, 0, tail);
  } else if (const auto* branching = std::get_if<If>(&statement.node)) {
    lowerIf(*branching, tail);
  } else if (const auto* loop = std::get_if<Loop>(&statement.node)) {
    lowerLoop(*loop);
  } else if (const auto* jump = std::get_if<Jump>(&statement.node)) {
    if (jump->kind == Jump::Kind::breakLoop) {
      append(Op::breakLoop);
    } else if (tail != Tail::loop) {
      append(Op::continueLoop);
    }
  } else if (const auto* leave = std::get_if<Return>(&statement.node)) {
    lowerReturn(*leave, tail);
  }
}

void Lowerer::lowerDeclaration(const VariableDeclaration& variable) {
  position_ = variable.position;
  if (!variable.initializer) {
    if (!variable.isAssigned) {
      bind(variable, zeroValue(variable.type));
      return;
    }
    const Value value = localValue(variable.type, variable.name);
    if (loopDepth_ > 0) assign(value, zeroValue(variable.type));
    bind(variable, value);
    return;
  }
  Value initial = lowerTo(*variable.initializer, variable.type);
  position_ = variable.position;
  if (variable.isAssigned) {
    const Value value = localValue(variable.type, variable.name);
    assign(value, initial);
    bind(variable, value);
    return;
  }
  // Never written again: the name stands for the value itself, unless that is a variable which may change.
  if (!std::holds_alternative<InitializerList>(variable.initializer->node)) initial = copied(initial);
  // Reports of indices out of range name what was indexed.
  const bool hasParts = variable.type.isArray() || variable.type.isTriple() || variable.type.base == BaseType::matrix;
  if (hasParts) nameValue(initial, variable.name);
  bind(variable, std::move(initial));
}

void Lowerer::lowerIf(const If& statement, Tail tail) {
  const VariableId condition = lowerCondition(*statement.condition);
  branch(
      condition, [&] { lowerStatement(*statement.yes, tail); },
      [&] {
        if (statement.no) lowerStatement(*statement.no, tail);
      });
}

void Lowerer::lowerLoop(const Loop& loop) {
  const Position position = position_;
  if (loop.initial) lowerStatement(*loop.initial, Tail::none);
  position_ = position;
  ++loopDepth_;
  VariableId condition = noVariable;
  std::vector<Code> bodies;
  bodies.push_back(collect([&] { condition = loop.condition ? lowerCondition(*loop.condition) : constantInt(1); }));
  const auto known = constantOf(condition);
  if (known && known->asInt() == 0 && !loop.testsLast) {
    --loopDepth_;
    std::move(bodies[0].begin(), bodies[0].end(), std::back_inserter(*code_));
    return;
  }
  bodies.push_back(collect([&] {
    if (loop.body) lowerStatement(*loop.body, Tail::loop);
  }));
  bodies.push_back(collect([&] {
    if (loop.step) lower(*loop.step);
  }));
  --loopDepth_;
  position_ = position;
  Instruction& instruction = append(Op::loop);
  instruction.testsLast = loop.testsLast;
  instruction.arguments = {condition};
  instruction.bodies = std::move(bodies);
}

void Lowerer::lowerReturn(const Return& statement, Tail tail) {
  const Position position = position_;
  if (statement.value && frames_.back().function) {
    const Value value = lowerTo(*statement.value, frames_.back().function->type);
    Frame& frame = frames_.back();
    if (frame.isDirect) {
      frame.result = value;
      return;
    }
    assign(frame.result, value);
  }
  if (tail == Tail::function) return;
  position_ = position;
  frames_.back().usesLeave = true;
  append(Op::leave).scopeId = frames_.back().scopeId;
}

}  // namespace aerosol::lang
