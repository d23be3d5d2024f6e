#include "core/lang/checker.h"
#include "core/lang/overload.h"

namespace aerosol::lang {

bool alwaysReturns(const Statement& statement) {
  if (std::holds_alternative<Return>(statement.node)) return true;
  if (const auto* block = std::get_if<Block>(&statement.node)) {
    for (const StatementPtr& inner : block->statements)
      if (inner && alwaysReturns(*inner)) return true;
    return false;
  }
  if (const auto* branch = std::get_if<If>(&statement.node))
    return branch->yes && branch->no && alwaysReturns(*branch->yes) && alwaysReturns(*branch->no);
  return false;
}

void Checker::checkStatement(Statement& statement) {
  if (auto* expression = std::get_if<ExpressionStatement>(&statement.node)) {
    if (expression->expression) check(*expression->expression, types::none);
  } else if (auto* declaration = std::get_if<DeclarationStatement>(&statement.node)) {
    checkVariables(*declaration);
  } else if (auto* block = std::get_if<Block>(&statement.node)) {
    scopes_.emplace_back();
    for (const StatementPtr& inner : block->statements) checkStatement(*inner);
    scopes_.pop_back();
  } else if (auto* branch = std::get_if<If>(&statement.node)) {
    checkCondition(*branch->condition);
    for (const StatementPtr* inner : {&branch->yes, &branch->no}) {
      if (!*inner) continue;
      scopes_.emplace_back();
      checkStatement(**inner);
      scopes_.pop_back();
    }
  } else if (auto* loop = std::get_if<Loop>(&statement.node)) {
    checkLoop(*loop);
  } else if (auto* jump = std::get_if<Jump>(&statement.node)) {
    const char* word = jump->kind == Jump::Kind::breakLoop ? "break" : "continue";
    if (loopDepth_ == 0) error(statement.position, std::string("'") + word + "' stands outside of any loop");
  } else if (auto* leave = std::get_if<Return>(&statement.node)) {
    checkReturn(*leave, statement.position);
  } else if (auto* structure = std::get_if<LocalStruct>(&statement.node)) {
    checkStruct(*structure->structure);
  } else if (auto* local = std::get_if<LocalFunction>(&statement.node)) {
    checkFunction(*local->function);
    if (local->function->body && !functionStates_.contains(local->function.get())) checkBody(*local->function);
  }
}

void Checker::checkVariables(DeclarationStatement& declaration) {
  for (const auto& variable : declaration.variables) {
    variable->type = resolveType(variable->typeName, resolveLength(*variable), nullptr);
    if (variable->type == types::none) {
      error(variable->position, "variable '" + variable->name + "' cannot be void");
      variable->type = poisoned;
    }
    if (variable->initializer) checkListInitializer(*variable);
    if (variable->initializer) {
      const std::string what = "the initial value of '" + variable->name + "'";
      variable->type = checkInitializer(*variable->initializer, variable->type, what, Truncation::warned);
    } else if (variable->type.arrayLength == Type::unsized) {
      error(variable->position, "array '" + variable->name + "' needs a length or an initial value");
      variable->type.arrayLength = 1;
    }
    declareVariable(*variable);
  }
}

/// As oslc has it: where a list in braces may stand as the initial value of a local variable, and arrays without a
/// length may not.
void Checker::checkListInitializer(const VariableDeclaration& variable) {
  if (!strict_ || isPoisoned(variable.type) || sourceMap_.isInPrelude(variable.position)) return;
  if (variable.type.arrayLength == Type::unsized)
    return error(variable.position, "array '" + variable.name + "' needs a length: only parameters may go without");
  const auto* list = std::get_if<InitializerList>(&variable.initializer->node);
  if (!list) return;
  if (list->elements.empty()) {
    error(variable.initializer->position, "an initialiser list needs at least one value");
  } else if (!variable.type.isArray() && !variable.type.isTriple() && variable.type.base != BaseType::structure &&
             variable.type.base != BaseType::matrix) {
    error(variable.initializer->position,
          "a value in braces is for arrays, structures, triples and matrices, not for " + toString(variable.type));
  }
}

void Checker::checkCondition(Expression& condition, const std::string& notForClosures) {
  const Type type = check(condition, types::integer);
  if (isPoisoned(type)) return;
  if (!isConditional(type)) {
    error(condition.position, "a value of type " + toString(type) + " cannot be a condition");
  } else if (type.closure && !notForClosures.empty()) {
    error(condition.position, "a closure cannot be " + notForClosures,
          {"'if', '!', '&&' and '||' tell whether one is empty"});
  }
}

void Checker::checkLoop(Loop& loop) {
  scopes_.emplace_back();
  if (loop.initial) checkStatement(*loop.initial);
  if (loop.condition) checkCondition(*loop.condition, "the condition of a loop");
  if (loop.step) check(*loop.step, types::none);
  ++loopDepth_;
  scopes_.emplace_back();
  if (loop.body) checkStatement(*loop.body);
  scopes_.pop_back();
  --loopDepth_;
  scopes_.pop_back();
}

void Checker::checkReturn(Return& statement, Position position) {
  const Type wanted = function_ ? function_->type : types::none;
  hasReturn_ = true;
  if (!statement.value) {
    if (!(wanted == types::none) && !isPoisoned(wanted))
      error(position, "function '" + function_->name + "' must return a value of type " + toString(wanted));
    return;
  }
  if (wanted == types::none) {
    check(*statement.value, types::none);
    error(statement.value->position,
          function_ ? "function '" + function_->name + "' is void and returns no value" : "a shader returns no value");
    return;
  }
  if (!isPoisoned(wanted)) checkInitializer(*statement.value, wanted, "the value returned");
}

}  // namespace aerosol::lang
