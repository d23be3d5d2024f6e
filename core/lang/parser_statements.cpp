// Statements.
#include <fmt/format.h>

#include "core/lang/parser_internal.h"

namespace aerosol::lang {

namespace {

template <class Node>
StatementPtr makeStatement(Position position, Node node) {
  auto result = std::make_unique<Statement>();
  result->position = position;
  result->node = std::move(node);
  return result;
}

}  // namespace

StatementPtr Parser::statement() {
  const Nest nest(*this);
  const Position position = peek().position;
  switch (peek().kind) {
    case TokenKind::leftBrace:
      return block();
    case TokenKind::semicolon:
      next();
      return makeStatement(position, Block{});
    case TokenKind::kwIf:
      return ifStatement();
    case TokenKind::kwWhile:
      return whileStatement();
    case TokenKind::kwDo:
      return doStatement();
    case TokenKind::kwFor:
      return forStatement();
    case TokenKind::kwReturn:
      return returnStatement();
    case TokenKind::kwBreak:
    case TokenKind::kwContinue:
      return jumpStatement();
    case TokenKind::kwElse:
      error(position, "expected a statement, found 'else' without an 'if'");
      throw Failure();
    case TokenKind::kwStruct:
      refuseHere("a structure stands within a function or shader");
      return makeStatement(position, LocalStruct{localStruct()});
    case TokenKind::kwPublic:
      refuseHere("'public' has no effect");
      if (!strict_) warning(position, "'public' has no effect");
      next();
      return declarationStatement();
    default:
      return startsDeclaration() ? declarationStatement() : expressionStatement();
  }
}

StatementPtr Parser::block() {
  Block result;
  const Token& open = expect(TokenKind::leftBrace, "");
  while (!at(TokenKind::rightBrace)) {
    if (at(TokenKind::end)) {
      failExpected("'}'", fmt::format("to close the '{{' on line {}", map_.location(open.position).line));
    }
    const std::size_t before = index_;
    try {
      result.statements.push_back(statement());
    } catch (const Failure&) {
      if (givenUp_) throw;
      skipToStatement(before);
    }
  }
  next();
  return makeStatement(open.position, std::move(result));
}

/// A chain of `else if` is read by a loop, so that it does not count as nesting.
StatementPtr Parser::ifStatement() {
  struct Branch {
    Position position;
    ExpressionPtr condition;
    StatementPtr yes;
  };
  std::vector<Branch> branches;
  StatementPtr no;
  while (true) {
    const Position position = next().position;
    ExpressionPtr test = condition("'if'");
    branches.push_back({position, std::move(test), statement()});
    if (branches.size() > static_cast<std::size_t>(maximumElseIfs)) {
      giveUp(position, fmt::format("more than {} 'else if' in one chain", maximumElseIfs));
    }
    if (!accept(TokenKind::kwElse)) break;
    if (!at(TokenKind::kwIf)) {
      no = statement();
      break;
    }
  }
  while (!branches.empty()) {
    Branch& last = branches.back();
    no = makeStatement(last.position, If{std::move(last.condition), std::move(last.yes), std::move(no)});
    branches.pop_back();
  }
  return no;
}

ExpressionPtr Parser::condition(std::string_view keyword) {
  expect(TokenKind::leftParen, fmt::format("after {}", keyword));
  ExpressionPtr result = expression();
  closeCondition("after the condition");
  return result;
}

/// Where only the parenthesis before a block is missing, the block is read all the same.
void Parser::closeCondition(std::string_view context) {
  if (accept(TokenKind::rightParen)) return;
  reportExpected("')'", context);
  if (!at(TokenKind::leftBrace)) throw Failure();
}

StatementPtr Parser::whileStatement() {
  Loop loop;
  const Position position = next().position;
  loop.condition = condition("'while'");
  loop.body = statement();
  return makeStatement(position, std::move(loop));
}

StatementPtr Parser::doStatement() {
  Loop loop;
  loop.testsLast = true;
  const Position position = next().position;
  loop.body = statement();
  expect(TokenKind::kwWhile, "after the body of 'do'");
  loop.condition = condition("'while'");
  demand(TokenKind::semicolon, "after 'do … while (…)'");
  return makeStatement(position, std::move(loop));
}

StatementPtr Parser::forStatement() {
  Loop loop;
  const Position position = next().position;
  expect(TokenKind::leftParen, "after 'for'");
  if (!accept(TokenKind::semicolon)) {
    const Position initialPosition = peek().position;
    if (startsDeclaration()) {
      TypeName type = typeName();
      loop.initial = variables(std::move(type), initialPosition);
    } else {
      loop.initial =
          makeStatement(initialPosition, ExpressionStatement{strict_ ? assignmentExpression() : expression()});
      expect(TokenKind::semicolon, "after the start of 'for'");
    }
  }
  if (!at(TokenKind::semicolon)) loop.condition = expression();
  expect(TokenKind::semicolon, "after the condition of 'for'");
  if (!at(TokenKind::rightParen)) loop.step = expression();
  closeCondition("after the step of 'for'");
  loop.body = statement();
  return makeStatement(position, std::move(loop));
}

StatementPtr Parser::returnStatement() {
  Return result;
  const Position position = next().position;
  if (!at(TokenKind::semicolon)) {
    if (at(TokenKind::rightBrace)) failExpected("';'", "after 'return'");
    result.value = expression();
  }
  demand(TokenKind::semicolon, "after 'return'");
  return makeStatement(position, std::move(result));
}

StatementPtr Parser::jumpStatement() {
  const bool isBreak = at(TokenKind::kwBreak);
  const Position position = next().position;
  demand(TokenKind::semicolon, isBreak ? "after 'break'" : "after 'continue'");
  return makeStatement(position, Jump{isBreak ? Jump::Kind::breakLoop : Jump::Kind::continueLoop});
}

/// A type that is not the constructor `type(…)`, or two names in a row.
bool Parser::startsDeclaration() const {
  if (at(TokenKind::identifier)) return at(TokenKind::identifier, 1);
  if (at(TokenKind::kwClosure)) return !at(TokenKind::leftParen, 2);
  if (at(TokenKind::reserved)) return startsType();
  return startsType() && !at(TokenKind::leftParen, 1);
}

StatementPtr Parser::declarationStatement() {
  const Position position = peek().position;
  TypeName type = typeName();
  const bool isFunction = at(TokenKind::leftParen, 1) && at(TokenKind::identifier);
  if (!isFunction) return variables(std::move(type), position);
  return makeStatement(position, LocalFunction{functionDeclaration(std::move(type))});
}

/// Its name is not a type's behind the block: there, a call may be one of a function.
std::unique_ptr<StructDeclaration> Parser::localStruct() {
  const std::unordered_set<std::string> outside = structNames_;
  auto result = structDeclaration();
  structNames_ = outside;
  return result;
}

/// From the first name to the semicolon.
StatementPtr Parser::variables(TypeName type, Position position) {
  DeclarationStatement result;
  do {
    auto variable = declaredVariable(type, "a variable's name");
    if (accept(TokenKind::assign)) {
      const bool isArray = variable->arrayLength != Type::scalar || variable->lengthExpression;
      if (strict_ && isArray && !at(TokenKind::leftBrace))
        error(peek().position, fmt::format("expected '{{' before the values of the array '{}', found {}",
                                           variable->name, describe(peek())));
      variable->initializer = assignmentExpression();
    }
    if (atMetadata()) {
      error(peek().position, "expected ';' after the declaration, found '[['",
            {"only shaders, functions and parameters have metadata"});
      variable->metadata = metadata();
    }
    result.variables.push_back(std::move(variable));
  } while (accept(TokenKind::comma));
  demand(TokenKind::semicolon, "after the declaration");
  return makeStatement(position, std::move(result));
}

StatementPtr Parser::expressionStatement() {
  const Position position = peek().position;
  ExpressionPtr value = expression();
  demand(TokenKind::semicolon, "after the expression");
  return makeStatement(position, ExpressionStatement{std::move(value)});
}

}  // namespace aerosol::lang
