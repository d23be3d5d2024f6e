// The recursive-descent parser. Its functions are spread over parser*.cpp.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/lang/parser.h"

namespace aerosol::lang {

/// Every function consumes the tokens of what it is named after. A syntax error is reported where it is found and
/// thrown as `Failure` to the nearest list (of statements, parameters, declarations), which skips to its next member.
class Parser {
 public:
  Parser(const TokenStream& tokens, const SourceMap& map, Diagnostics& diagnostics, bool strict)
      : stream_(tokens), map_(map), diagnostics_(diagnostics), strict_(strict) {}

  SourceFile run();

 private:
  struct Failure {};

  /// An expression and the depth of its tree.
  struct Parsed {
    ExpressionPtr tree;
    int depth = 1;
    bool isVariable = false;  ///< A name, or an element or a field of one: what may be assigned to.
  };

  /// Counts one level of nesting for its lifetime.
  class Nest {
   public:
    explicit Nest(Parser& parser);
    ~Nest() { --parser_.nesting_; }
    Nest(const Nest&) = delete;
    Nest& operator=(const Nest&) = delete;

   private:
    Parser& parser_;
  };

  // Tokens and errors (parser.cpp)
  const Token& peek(std::size_t ahead = 0) const;
  const Token& previous() const;
  bool at(TokenKind kind, std::size_t ahead = 0) const { return peek(ahead).kind == kind; }
  const Token& next();
  bool accept(TokenKind kind);
  /// Consumes a token of this kind; anything else is an error: "expected ';' <context>, found …".
  const Token& expect(TokenKind kind, std::string_view context);
  /// As `expect`, but goes on as if the token had been there.
  void demand(TokenKind kind, std::string_view context);
  const Token& expectName(std::string_view what);
  void error(Position position, std::string message, std::vector<std::string> notes = {});
  void report(Diagnostic diagnostic);
  void warning(Position position, std::string message);
  /// Refuses what stands here where other compilers do.
  void refuseHere(const std::string& what) {
    if (strict_ && !map_.isInPrelude(peek().position)) error(peek().position, what + ": other compilers refuse it");
  }
  void reportExpected(const std::string& what, std::string_view context, std::vector<std::string> notes = {});
  [[noreturn]] void failExpected(const std::string& what, std::string_view context,
                                 std::vector<std::string> notes = {});
  /// Reports, and gives up the whole file.
  [[noreturn]] void giveUp(Position position, std::string message);
  bool firstErrorOfItsLine(Position position);

  // Recovery (parser.cpp)
  void skipToDeclaration();
  /// Consumes at least one token if none was since `before`, except a closing brace.
  void skipToStatement(std::size_t before);
  /// To the comma or the closing token of a list; false when neither comes before the end of the surrounding construct.
  bool skipToListMember(TokenKind close);
  bool startsFileScopeDeclaration() const;

  // Types (parser_declarations.cpp)
  static std::optional<BaseType> simpleType(TokenKind kind);
  bool startsType() const;
  TypeName typeName();
  struct ArraySpec {
    int length = Type::scalar;
    ExpressionPtr expression;
  };
  ArraySpec arraySpec();

  // Declarations (parser_declarations.cpp)
  void declaration(SourceFile& file);
  void skipQualifiers();
  void unknownDeclaration(SourceFile& file);
  std::unique_ptr<StructDeclaration> structDeclaration();
  void structField(StructDeclaration& declaration);
  std::unique_ptr<ShaderDeclaration> shaderDeclaration();
  std::unique_ptr<FunctionDeclaration> functionDeclaration(TypeName resultType);
  using Parameters = std::vector<std::unique_ptr<VariableDeclaration>>;
  void parameters(Parameters& list, bool ofShader, bool* variadic);
  std::unique_ptr<VariableDeclaration> parameter(bool ofShader);
  std::unique_ptr<VariableDeclaration> declaredVariable(const TypeName& type, std::string_view what);
  bool atBracketMetadata() const { return at(TokenKind::leftBracket) && at(TokenKind::leftBracket, 1); }
  /// In either form, [[ ]] or {{ }}.
  bool atMetadata() const { return atBracketMetadata() || (at(TokenKind::leftBrace) && at(TokenKind::leftBrace, 1)); }
  std::vector<Metadata> metadata();
  void moreMetadata(std::vector<Metadata>& list);
  Metadata metadatum();

  // Statements (parser_statements.cpp)
  StatementPtr statement();
  StatementPtr block();
  StatementPtr ifStatement();
  StatementPtr whileStatement();
  StatementPtr doStatement();
  StatementPtr forStatement();
  StatementPtr returnStatement();
  StatementPtr jumpStatement();
  StatementPtr declarationStatement();
  std::unique_ptr<StructDeclaration> localStruct();
  StatementPtr variables(TypeName type, Position position);
  StatementPtr expressionStatement();
  ExpressionPtr condition(std::string_view keyword);
  void closeCondition(std::string_view context);
  bool startsDeclaration() const;

  // Expressions (parser_expressions.cpp)
  ExpressionPtr expression() { return commaExpression().tree; }
  ExpressionPtr assignmentExpression() { return assignment().tree; }
  ExpressionPtr conditionalExpression() { return conditional().tree; }
  Parsed commaExpression();
  Parsed assignment();
  Parsed assigned(Parsed target);
  bool atAssignment() const;
  Parsed conditional();
  Parsed binary(int minimumPrecedence);
  Parsed unary();
  Parsed cast();
  Parsed postfix();
  Parsed primary();
  Parsed literal();
  Parsed parenthesized();
  Parsed call();
  Parsed construct();
  Parsed initializerList();
  Parsed reservedExpression();
  int arguments(std::vector<ExpressionPtr>& list, std::string_view of);
  bool atCast() const;
  bool isTarget(const Parsed& expression) const;
  void requireTarget(const Parsed& expression, std::string_view operation);
  template <class Node>
  Parsed make(Position position, Node node, int depth);

  const TokenStream& stream_;
  const SourceMap& map_;
  Diagnostics& diagnostics_;
  bool strict_;
  std::size_t index_ = 0;
  int nesting_ = 0;
  int openInitializers_ = 0;  ///< `{` of initialisers that an error has left open.
  bool givenUp_ = false;
  std::optional<Position> lastErrorPosition_;
  std::unordered_set<std::string> structNames_;
};

/// One level deeper; `depth` is that of the deepest child.
template <class Node>
Parser::Parsed Parser::make(Position position, Node node, int depth) {
  Parsed result{std::make_unique<Expression>(), depth + 1};
  result.tree->position = position;
  result.tree->node = std::move(node);
  if (result.depth > maximumExpressionDepth) {
    error(position, "this expression is too deep: more than " + std::to_string(maximumExpressionDepth) +
                        " operators, one upon the other");
    throw Failure();
  }
  return result;
}

}  // namespace aerosol::lang
