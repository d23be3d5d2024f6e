// Expressions: recursive descent, with precedence climbing for binary operators.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/lang/parser_internal.h"

namespace aerosol::lang {

namespace {

struct BinaryOperator {
  int precedence = -1;  ///< As in C; -1: not a binary operator.
  BinaryOp op{};
};

BinaryOperator binaryOperator(TokenKind kind) {
  switch (kind) {
    case TokenKind::pipePipe:
      return {0, BinaryOp::logicalOr};
    case TokenKind::ampersandAmpersand:
      return {1, BinaryOp::logicalAnd};
    case TokenKind::pipe:
      return {2, BinaryOp::bitOr};
    case TokenKind::caret:
      return {3, BinaryOp::bitXor};
    case TokenKind::ampersand:
      return {4, BinaryOp::bitAnd};
    case TokenKind::equalEqual:
      return {5, BinaryOp::equal};
    case TokenKind::notEqual:
      return {5, BinaryOp::notEqual};
    case TokenKind::less:
      return {6, BinaryOp::less};
    case TokenKind::lessEqual:
      return {6, BinaryOp::lessEqual};
    case TokenKind::greater:
      return {6, BinaryOp::greater};
    case TokenKind::greaterEqual:
      return {6, BinaryOp::greaterEqual};
    case TokenKind::shiftLeft:
      return {7, BinaryOp::shiftLeft};
    case TokenKind::shiftRight:
      return {7, BinaryOp::shiftRight};
    case TokenKind::plus:
      return {8, BinaryOp::add};
    case TokenKind::minus:
      return {8, BinaryOp::subtract};
    case TokenKind::star:
      return {9, BinaryOp::multiply};
    case TokenKind::slash:
      return {9, BinaryOp::divide};
    case TokenKind::percent:
      return {9, BinaryOp::modulo};
    default:
      return {};
  }
}

/// The operator of a compound assignment.
std::optional<BinaryOp> compoundOperator(TokenKind kind) {
  switch (kind) {
    case TokenKind::plusAssign:
      return BinaryOp::add;
    case TokenKind::minusAssign:
      return BinaryOp::subtract;
    case TokenKind::starAssign:
      return BinaryOp::multiply;
    case TokenKind::slashAssign:
      return BinaryOp::divide;
    case TokenKind::percentAssign:
      return BinaryOp::modulo;
    case TokenKind::ampersandAssign:
      return BinaryOp::bitAnd;
    case TokenKind::pipeAssign:
      return BinaryOp::bitOr;
    case TokenKind::caretAssign:
      return BinaryOp::bitXor;
    case TokenKind::shiftLeftAssign:
      return BinaryOp::shiftLeft;
    case TokenKind::shiftRightAssign:
      return BinaryOp::shiftRight;
    default:
      return std::nullopt;
  }
}

std::optional<UnaryOp> prefixOperator(TokenKind kind) {
  switch (kind) {
    case TokenKind::plus:
      return UnaryOp::plus;
    case TokenKind::minus:
      return UnaryOp::minus;
    case TokenKind::exclamation:
      return UnaryOp::logicalNot;
    case TokenKind::tilde:
      return UnaryOp::bitNot;
    case TokenKind::plusPlus:
      return UnaryOp::preIncrement;
    case TokenKind::minusMinus:
      return UnaryOp::preDecrement;
    default:
      return std::nullopt;
  }
}

constexpr std::int64_t intLimit = std::int64_t{1} << 31;

}  // namespace

/// By the grammar a name, or elements and fields of one, without parentheses around it.
bool Parser::isTarget(const Parsed& expression) const {
  const auto& node = expression.tree->node;
  const bool isPlace =
      std::holds_alternative<Name>(node) || std::holds_alternative<Index>(node) || std::holds_alternative<Field>(node);
  return isPlace && (expression.isVariable || !strict_);
}

Parser::Parsed Parser::commaExpression() {
  Parsed result = assignment();
  while (at(TokenKind::comma)) {
    const Position position = next().position;
    Parsed second = assignment();
    const int depth = std::max(result.depth, second.depth);
    result = make(position, Comma{std::move(result.tree), std::move(second.tree)}, depth);
  }
  return result;
}

Parser::Parsed Parser::assignment() {
  Parsed target = conditional();
  return atAssignment() ? assigned(std::move(target)) : std::move(target);
}

bool Parser::atAssignment() const {
  if (strict_ && at(TokenKind::percentAssign)) return false;  // Other compilers do not have it.
  return at(TokenKind::assign) || compoundOperator(peek().kind);
}

/// The assignment to `target` whose operator comes next.
Parser::Parsed Parser::assigned(Parsed target) {
  const auto compound = compoundOperator(peek().kind);
  requireTarget(target, "assigned to");
  const Position position = next().position;
  const Nest nest(*this);
  Parsed value = assignment();
  const int depth = std::max(target.depth, value.depth);
  Assign node{std::move(target.tree), std::move(value.tree), compound.has_value(), compound.value_or(BinaryOp{})};
  return make(position, std::move(node), depth);
}

void Parser::requireTarget(const Parsed& expression, std::string_view operation) {
  if (!isTarget(expression)) {
    error(expression.tree->position,
          fmt::format("expected a variable, an element or a field: this expression cannot be {}", operation));
  }
}

Parser::Parsed Parser::conditional() {
  Parsed test = binary(0);
  if (!at(TokenKind::question)) return test;
  const Position position = next().position;
  const Nest nest(*this);
  Parsed yes = assignment();
  expect(TokenKind::colon, "in the conditional expression");
  Parsed no = conditional();
  const int depth = std::max({test.depth, yes.depth, no.depth});
  return make(position, Conditional{std::move(test.tree), std::move(yes.tree), std::move(no.tree)}, depth);
}

Parser::Parsed Parser::binary(int minimumPrecedence) {
  Parsed left = unary();
  while (true) {
    const BinaryOperator found = binaryOperator(peek().kind);
    if (found.precedence < minimumPrecedence) return left;
    const Position position = next().position;
    Parsed right = binary(found.precedence + 1);
    const int depth = std::max(left.depth, right.depth);
    left = make(position, Binary{found.op, std::move(left.tree), std::move(right.tree)}, depth);
  }
}

Parser::Parsed Parser::unary() {
  const auto op = prefixOperator(peek().kind);
  if (!op && atCast()) return cast();
  if (!op) {
    Parsed operand = postfix();
    // An assignment is an operand, as in other compilers of the language: `a + b = c` adds `b = c` to a.
    return isTarget(operand) && atAssignment() ? assigned(std::move(operand)) : std::move(operand);
  }
  const Position position = next().position;
  if (*op == UnaryOp::minus && at(TokenKind::intLiteral) && peek().integer == intLimit) {
    next();
    return make(position, IntLiteral{std::numeric_limits<std::int32_t>::min()}, 0);
  }
  const Nest nest(*this);
  Parsed operand = unary();
  if (*op == UnaryOp::preIncrement || *op == UnaryOp::preDecrement) {
    requireTarget(operand, *op == UnaryOp::preIncrement ? "incremented" : "decremented");
  }
  return make(position, Unary{*op, std::move(operand.tree)}, operand.depth);
}

bool Parser::atCast() const {
  if (!at(TokenKind::leftParen)) return false;
  if (at(TokenKind::kwClosure, 1)) return at(TokenKind::rightParen, 3);
  return simpleType(peek(1).kind) && at(TokenKind::rightParen, 2);
}

Parser::Parsed Parser::cast() {
  const Nest nest(*this);
  Construct node;
  const Position position = next().position;
  node.type = typeName();
  node.isCast = true;
  expect(TokenKind::rightParen, "after the type of the cast");
  Parsed operand = unary();
  node.arguments.push_back(std::move(operand.tree));
  return make(position, std::move(node), operand.depth);
}

/// By the grammar only variables have elements and components. `f(x)[0]` and `(a + b).x` mean something all the same,
/// and are understood unless what other compilers refuse is to be refused.
Parser::Parsed Parser::postfix() {
  const bool isVariable = at(TokenKind::identifier) && !at(TokenKind::leftParen, 1);
  Parsed result = primary();
  result.isVariable = isVariable;
  while (true) {
    const Token& token = peek();
    if (token.kind == TokenKind::leftBracket || token.kind == TokenKind::period) {
      if (atMetadata()) return result;
      if (strict_ && !result.isVariable && map_.isInMainFile(token.position)) {
        error(token.position,
              fmt::format("expected an operator or the end of the expression, found '{}': only "
                          "variables have elements and components",
                          token.text),
              {"give the value a name first"});
        throw Failure();
      }
    }
    if (token.kind == TokenKind::leftBracket) {
      next();
      const Nest nest(*this);
      Parsed index = commaExpression();
      expect(TokenKind::rightBracket, "after the index");
      const int depth = std::max(result.depth, index.depth);
      const bool ofVariable = result.isVariable;
      result = make(token.position, Index{std::move(result.tree), std::move(index.tree)}, depth);
      result.isVariable = ofVariable;
    } else if (token.kind == TokenKind::period) {
      next();
      const Token& field = expectName("a field's name after '.'");
      const bool ofVariable = result.isVariable;
      result = make(field.position, Field{std::move(result.tree), std::string(field.text)}, result.depth);
      result.isVariable = ofVariable;
    } else if (token.kind == TokenKind::plusPlus || token.kind == TokenKind::minusMinus) {
      const bool increment = token.kind == TokenKind::plusPlus;
      requireTarget(result, increment ? "incremented" : "decremented");
      next();
      const UnaryOp op = increment ? UnaryOp::postIncrement : UnaryOp::postDecrement;
      result = make(token.position, Unary{op, std::move(result.tree)}, result.depth);
    } else {
      return result;
    }
  }
}

Parser::Parsed Parser::primary() {
  const Token& token = peek();
  switch (token.kind) {
    case TokenKind::intLiteral:
    case TokenKind::floatLiteral:
    case TokenKind::stringLiteral:
      return literal();
    case TokenKind::leftParen:
      return parenthesized();
    case TokenKind::leftBrace:
      return initializerList();
    case TokenKind::reserved:
      return reservedExpression();
    case TokenKind::identifier: {
      if (at(TokenKind::leftParen, 1)) return structNames_.contains(std::string(token.text)) ? construct() : call();
      next();
      return make(token.position, Name{std::string(token.text), nullptr}, 0);
    }
    case TokenKind::kwIlluminance:
    case TokenKind::kwIlluminate:
      error(token.position,
            fmt::format("expected an expression, found the keyword '{}', which has no use in this version "
                        "of the language",
                        token.text));
      throw Failure();
    default:
      break;
  }
  if (token.kind == TokenKind::kwClosure || simpleType(token.kind)) return construct();
  failExpected("an expression", "");
}

Parser::Parsed Parser::literal() {
  const Token& token = next();
  const bool hasSuffix = token.text.ends_with('f') || token.text.ends_with('F');
  if (strict_ && token.kind == TokenKind::floatLiteral && hasSuffix && !map_.isInPrelude(token.position))
    error(token.position, fmt::format("'{}' is not a number: numbers have no suffix", token.text));
  if (token.kind == TokenKind::floatLiteral) return make(token.position, FloatLiteral{token.floating}, 0);
  if (token.kind == TokenKind::stringLiteral) {
    return make(token.position, StringLiteral{stream_.strings[token.string]}, 0);
  }
  std::int64_t value = token.integer;
  if (value == intLimit) return make(token.position, IntLiteral{std::numeric_limits<std::int32_t>::min()}, 0);
  if (value > intLimit) {
    error(token.position, fmt::format("the integer {} is too large: int has 32 bits", token.text));
    value = 0;
  }
  return make(token.position, IntLiteral{static_cast<std::int32_t>(value)}, 0);
}

Parser::Parsed Parser::parenthesized() {
  const Nest nest(*this);
  next();
  Parsed result = commaExpression();
  expect(TokenKind::rightParen, "after the expression");
  return result;
}

Parser::Parsed Parser::call() {
  Call node;
  const Token& name = next();
  node.name = std::string(name.text);
  const int depth = arguments(node.arguments, fmt::format("'{}'", name.text));
  return make(name.position, std::move(node), depth);
}

Parser::Parsed Parser::construct() {
  Construct node;
  const Position position = peek().position;
  node.type = typeName();
  if (!at(TokenKind::leftParen)) failExpected("'('", "after the name of a type in an expression");
  const int depth = arguments(node.arguments, "the constructor");
  return make(position, std::move(node), depth);
}

/// `(a, b, c)`; returns the depth of the deepest.
int Parser::arguments(std::vector<ExpressionPtr>& list, std::string_view of) {
  const Nest nest(*this);
  int depth = 0;
  expect(TokenKind::leftParen, "");
  if (accept(TokenKind::rightParen)) return depth;
  do {
    Parsed argument = assignment();
    depth = std::max(depth, argument.depth);
    list.push_back(std::move(argument.tree));
    if (at(TokenKind::comma) && at(TokenKind::rightParen, 1)) refuseHere("a ',' ends the arguments");
  } while (accept(TokenKind::comma) && !at(TokenKind::rightParen));
  if (!at(TokenKind::rightParen)) failExpected("',' or ')'", fmt::format("in the arguments of {}", of));
  next();
  return depth;
}

Parser::Parsed Parser::initializerList() {
  const Nest nest(*this);
  InitializerList node;
  int depth = 0;
  const Position position = next().position;
  ++openInitializers_;
  while (!at(TokenKind::rightBrace)) {
    Parsed element = assignment();
    depth = std::max(depth, element.depth);
    node.elements.push_back(std::move(element.tree));
    if (at(TokenKind::comma) && at(TokenKind::rightBrace, 1)) refuseHere("a ',' ends the initialiser");
    if (!accept(TokenKind::comma)) break;
  }
  if (!at(TokenKind::rightBrace)) failExpected("',' or '}'", "in the initialiser");
  next();
  --openInitializers_;
  return make(position, std::move(node), depth);
}

/// `true` and `false` are understood for the sake of what follows; other reserved words mean nothing.
Parser::Parsed Parser::reservedExpression() {
  const Token& token = next();
  std::vector<std::string> notes;
  const bool truth = token.text == "true" || token.text == "false";
  if (truth) notes.push_back(fmt::format("write {}", token.text == "true" ? 1 : 0));
  error(token.position, fmt::format("expected an expression, found the reserved word '{}'", token.text),
        std::move(notes));
  if (!truth) throw Failure();
  return make(token.position, IntLiteral{token.text == "true"}, 0);
}

}  // namespace aerosol::lang
