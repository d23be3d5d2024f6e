#include <algorithm>

#include "core/lang/lowerer.h"
#include "core/lang/root_expression.h"

namespace aerosol::lang {

namespace {

bool contains(const Statement& statement, int& returns) {
  if (std::holds_alternative<Return>(statement.node)) ++returns;
  if (const auto* block = std::get_if<Block>(&statement.node)) {
    for (const StatementPtr& inner : block->statements)
      if (inner) contains(*inner, returns);
  } else if (const auto* branch = std::get_if<If>(&statement.node)) {
    if (branch->yes) contains(*branch->yes, returns);
    if (branch->no) contains(*branch->no, returns);
  } else if (const auto* loop = std::get_if<Loop>(&statement.node)) {
    if (loop->body) contains(*loop->body, returns);
  }
  return returns > 0;
}

/// The one return stands at the very end.
bool endsInOnlyReturn(const Block& body) {
  int returns = 0;
  for (const StatementPtr& statement : body.statements)
    if (statement) contains(*statement, returns);
  return returns == 1 && body.statements.back() && std::holds_alternative<Return>(body.statements.back()->node);
}

bool anyOf(const std::vector<ExpressionPtr>& expressions, bool (*test)(const Expression&)) {
  return std::any_of(expressions.begin(), expressions.end(), [&](const auto& one) { return test(*one); });
}

int costOf(const Expression& expression) {
  static constexpr int dear = 1000;
  const auto& node = expression.node;
  const auto sum = [](const std::vector<ExpressionPtr>& list) {
    int total = 0;
    for (const ExpressionPtr& one : list) total = std::min(total + costOf(*one), dear);
    return total;
  };
  if (const auto* unary = std::get_if<Unary>(&node)) return unary->function ? dear : 1 + costOf(*unary->operand);
  if (const auto* binary = std::get_if<Binary>(&node)) {
    const int own = binary->op == BinaryOp::divide || binary->op == BinaryOp::modulo ? 6 : 1;
    return binary->function ? dear : own + costOf(*binary->left) + costOf(*binary->right);
  }
  if (const auto* conditional = std::get_if<Conditional>(&node))
    return 1 + costOf(*conditional->condition) + costOf(*conditional->yes) + costOf(*conditional->no);
  if (const auto* index = std::get_if<Index>(&node)) {
    // An index that is not constant may be out of range, which is reported: not where it is not asked for.
    const bool isConstant = std::holds_alternative<IntLiteral>(index->index->node);
    return isConstant ? 1 + costOf(*index->base) : dear;
  }
  if (const auto* field = std::get_if<Field>(&node)) return costOf(*field->base);
  if (const auto* call = std::get_if<Call>(&node)) {
    static constexpr std::string_view light[] = {"abs",   "fabs", "min",  "max",   "clamp",
                                                 "floor", "ceil", "step", "select"};
    const bool isLight = call->builtin && std::find(std::begin(light), std::end(light), call->name) != std::end(light);
    return isLight ? 2 + sum(call->arguments) : dear;
  }
  if (const auto* construct = std::get_if<Construct>(&node)) {
    const bool hasSpace = !construct->arguments.empty() && construct->arguments[0]->type == types::string;
    return hasSpace || construct->type.base == BaseType::structure ? dear : sum(construct->arguments);
  }
  const bool isAtom = std::holds_alternative<IntLiteral>(node) || std::holds_alternative<FloatLiteral>(node) ||
                      std::holds_alternative<StringLiteral>(node) || std::holds_alternative<Name>(node);
  return isAtom ? 0 : dear;
}

}  // namespace

bool hasEffects(const Expression& expression) {
  const auto& node = expression.node;
  if (std::holds_alternative<Assign>(node)) return true;
  if (const auto* unary = std::get_if<Unary>(&node))
    return unary->op >= UnaryOp::preIncrement || unary->function || hasEffects(*unary->operand);
  if (const auto* binary = std::get_if<Binary>(&node))
    return binary->function || hasEffects(*binary->left) || hasEffects(*binary->right);
  if (const auto* conditional = std::get_if<Conditional>(&node))
    return hasEffects(*conditional->condition) || hasEffects(*conditional->yes) || hasEffects(*conditional->no);
  if (const auto* index = std::get_if<Index>(&node)) return hasEffects(*index->base) || hasEffects(*index->index);
  if (const auto* field = std::get_if<Field>(&node)) return hasEffects(*field->base);
  if (const auto* call = std::get_if<Call>(&node))
    return call->function || (call->builtin && (call->builtin->outputs != 0 || !call->builtin->row->pure)) ||
           anyOf(call->arguments, hasEffects);
  if (const auto* construct = std::get_if<Construct>(&node)) return anyOf(construct->arguments, hasEffects);
  if (const auto* list = std::get_if<InitializerList>(&node)) return anyOf(list->elements, hasEffects);
  if (const auto* comma = std::get_if<Comma>(&node)) return hasEffects(*comma->first) || hasEffects(*comma->second);
  return false;
}

bool isCheap(const Expression& expression) {
  constexpr int branchCost = 12;
  return !hasEffects(expression) && costOf(expression) <= branchCost;
}

Value Lowerer::lowerCall(const Expression& expression, const Call& called) {
  if (called.closure) return lowerClosure(expression, called);
  if (called.builtin) return lowerBuiltin(expression, called);
  if (called.function) return callFunction(*called.function, called.arguments, expression.position);
  // A structure's constructor, parsed as a call.
  Value result{expression.type, {}};
  for (std::size_t i = 0; i < called.arguments.size(); ++i) {
    Value field = lowerTo(*called.arguments[i], expression.type.structure->fields[i].type);
    field = protect(std::move(field), std::span(called.arguments).subspan(i + 1));
    result.leaves.insert(result.leaves.end(), field.leaves.begin(), field.leaves.end());
  }
  return result;
}

bool Lowerer::isVariable(const Expression& expression, const Type& type) const {
  const Expression* const root = &rootOf(expression);
  const auto* name = std::get_if<Name>(&root->node);
  if (!name || !name->declaration || name->declaration->isGlobal) return false;
  const Type from = expression.type.element(), to = type.element();
  const bool isKind = from == to || (from.isTriple() && to.isTriple() && !from.closure && !to.closure);
  return isKind && expression.type.isArray() == type.isArray() &&
         (name->declaration->isAssigned || name->declaration->isOutput);
}

Value Lowerer::bindArgument(const VariableDeclaration& formal, const Expression& actual,
                            std::span<const ExpressionPtr> later, std::vector<std::pair<Place, Value>>& copiesBack) {
  // One that is written all the same stands for the caller's variable, as an output does: shaders rely on it.
  const bool isPlace = std::holds_alternative<Name>(rootOf(actual).node);
  const bool isWritten = isPlace && (formal.isOutput || (formal.isAssigned && isVariable(actual, formal.type)));
  if (!isWritten && (formal.isAssigned || formal.isOutput)) {
    const Value value = lowerTo(actual, formal.type);
    const Value copy = localValue(value.type, formal.name);
    assign(copy, value);
    return copy;
  }
  if (!isWritten) {
    // Arrays are passed as they are: a shorter or longer one is seen with its own length.
    if (formal.type.arrayLength == Type::unsized && !std::holds_alternative<InitializerList>(actual.node))
      return protect(lower(actual), later);
    return protect(lowerTo(actual, formal.type), later);
  }
  const Place target = place(actual);
  const bool sameLength = !formal.type.isArray() || formal.type.arrayLength == Type::unsized ||
                          formal.type.arrayLength == target.type.arrayLength;
  if (target.isWhole() && sameLength) return {target.type, target.leaves};
  const Value copy = localValue(target.type, formal.name);
  assign(copy, load(target));
  copiesBack.emplace_back(target, copy);
  return copy;
}

Value Lowerer::callFunction(const FunctionDeclaration& declared, std::span<const ExpressionPtr> arguments,
                            Position position) {
  const auto defined = source_.definitions.find(&declared);
  const FunctionDeclaration& function = defined == source_.definitions.end() ? declared : *defined->second;
  std::vector<Value> values;
  std::vector<std::pair<Place, Value>> copiesBack;
  const std::size_t count = function.parameters.size();
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(bindArgument(*function.parameters[i], *arguments[i], arguments.subspan(i + 1), copiesBack));
  // Options of a closure that only another renderer has.
  for (std::size_t i = count; i < arguments.size(); ++i) lower(*arguments[i]);
  Value result = inlineFunction(function, std::move(values), position);
  for (const auto& [target, copy] : copiesBack) store(target, copy);
  return result;
}

Value Lowerer::inlineFunction(const FunctionDeclaration& declared, std::vector<Value> arguments, Position position) {
  const auto defined = source_.definitions.find(&declared);
  const FunctionDeclaration& function = defined == source_.definitions.end() ? declared : *defined->second;
  const bool isActive =
      std::any_of(frames_.begin(), frames_.end(), [&](const Frame& frame) { return frame.function == &function; });
  if (failed_ || !countWork(position)) return zeroValue(function.type);
  if (!isActive && isDeclaredClosure(function)) return makeDeclaredClosure(function, arguments, position);
  if (!isActive && isNative(function)) return callNative(function, arguments, position);
  if (isActive) {
    stop(position, "function '" + function.name + "' calls itself: shaders cannot recurse");
  } else if (!function.body) {
    stop(position, "function '" + function.name + "' is declared but not defined");
  } else if (frames_.size() > static_cast<std::size_t>(maximumInlining)) {
    stop(position, "functions call each other more than " + std::to_string(maximumInlining) + " deep here");
  }
  if (failed_) return zeroValue(function.type);
  for (std::size_t i = 0; i < arguments.size(); ++i) bind(*function.parameters[i], std::move(arguments[i]));
  const auto& body = std::get<Block>(function.body->node);
  Frame frame;
  frame.function = &function;
  frame.call = position;
  frame.scopeId = scopeCount_++;
  const bool hasValue = !(function.type == types::none);
  frame.isDirect = hasValue && endsInOnlyReturn(body);
  if (hasValue && !frame.isDirect) {
    frame.result = localValue(function.type, function.name);
    if (loopDepth_ > 0 && !alwaysReturns(*function.body)) assign(frame.result, zeroValue(function.type));
  }
  frames_.push_back(std::move(frame));
  const Position outer = position_;
  Code code = collect([&] { lowerStatements(body.statements, 0, Tail::function); });
  position_ = outer;
  frame = std::move(frames_.back());
  frames_.pop_back();
  if (frame.usesLeave) {
    Instruction& scope = append(Op::scope);
    scope.scopeId = frame.scopeId;
    scope.bodies.push_back(std::move(code));
  } else {
    std::move(code.begin(), code.end(), std::back_inserter(*code_));
  }
  if (failed_ && hasValue) return zeroValue(function.type);
  return frame.result;
}

}  // namespace aerosol::lang
