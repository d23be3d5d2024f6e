#include "core/lang/parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "core/lang/lexer.h"
#include "core/lang/parser_internal.h"
#include "core/lang/preprocessor.h"

namespace aerosol::lang {

// Tokens and errors ---------------------------------------------------------------------------------------------------

Parser::Nest::Nest(Parser& parser) : parser_(parser) {
  if (parser_.nesting_ >= maximumNesting) {
    parser_.giveUp(parser_.peek().position, fmt::format("nested too deeply: more than {} levels", maximumNesting));
  }
  ++parser_.nesting_;
}

const Token& Parser::peek(std::size_t ahead) const {
  return stream_.tokens[std::min(index_ + ahead, stream_.tokens.size() - 1)];
}

const Token& Parser::previous() const { return stream_.tokens[index_ > 0 ? index_ - 1 : 0]; }

const Token& Parser::next() {
  const Token& token = peek();
  if (token.kind != TokenKind::end) ++index_;
  return token;
}

bool Parser::accept(TokenKind kind) {
  if (!at(kind)) return false;
  next();
  return true;
}

const Token& Parser::expect(TokenKind kind, std::string_view context) {
  if (!at(kind)) failExpected(describe(kind), context);
  return next();
}

void Parser::demand(TokenKind kind, std::string_view context) {
  if (accept(kind)) return;
  reportExpected(describe(kind), context);
  accept(TokenKind::invalid);
}

const Token& Parser::expectName(std::string_view what) {
  const Token& token = peek();
  const TokenKind kind = token.kind;
  if (kind == TokenKind::identifier) return next();
  const bool isWord = kind == TokenKind::reserved || wordKind(token.text) != TokenKind::identifier;
  if (!isWord || kind == TokenKind::end || token.text.empty()) failExpected(std::string(what), "");
  const bool operatorWord = token.text == "and" || token.text == "or" || token.text == "not";
  error(token.position, fmt::format("expected {}, found the {} '{}'", what,
                                    kind == TokenKind::reserved ? "reserved word" : "keyword", token.text));
  // As a name it makes sense only where no other reading does.
  if (operatorWord || (!at(TokenKind::assign, 1) && !at(TokenKind::leftParen, 1) && !at(TokenKind::leftBracket, 1) &&
                       !at(TokenKind::semicolon, 1) && !at(TokenKind::comma, 1) && !at(TokenKind::rightParen, 1))) {
    throw Failure();
  }
  return next();
}

/// What follows an error on its line is seldom a second one; it is not reported.
bool Parser::firstErrorOfItsLine(Position position) {
  const bool first = !lastErrorPosition_ || !map_.onSameLine(*lastErrorPosition_, position);
  lastErrorPosition_ = position;
  return first;
}

void Parser::error(Position position, std::string message, std::vector<std::string> notes) {
  if (!givenUp_ && firstErrorOfItsLine(position)) report(map_.error(position, std::move(message), std::move(notes)));
}

void Parser::report(Diagnostic diagnostic) {
  if (diagnostics_.errorCount() < maximumErrors) diagnostics_.add(std::move(diagnostic));
  if (diagnostics_.errorCount() < maximumErrors) return;
  givenUp_ = true;
  index_ = stream_.tokens.size() - 1;
  throw Failure();
}

void Parser::warning(Position position, std::string message) {
  if (!map_.warningsSuppressed(position)) diagnostics_.add(map_.warning(position, std::move(message)));
}

void Parser::giveUp(Position position, std::string message) {
  error(position, std::move(message));
  givenUp_ = true;
  index_ = stream_.tokens.size() - 1;
  throw Failure();
}

/// Where something is missing is told by the token that is found instead, as by other compilers of the language.
void Parser::reportExpected(const std::string& what, std::string_view context, std::vector<std::string> notes) {
  const Token& found = peek();
  if (found.kind == TokenKind::invalid) {  // The lexer has reported it.
    lastErrorPosition_ = found.position;
    return;
  }
  error(found.position,
        fmt::format("expected {}{}{}, found {}", what, context.empty() ? "" : " ", context, describe(found)),
        std::move(notes));
}

void Parser::failExpected(const std::string& what, std::string_view context, std::vector<std::string> notes) {
  reportExpected(what, context, std::move(notes));
  throw Failure();
}

// Recovery ------------------------------------------------------------------------------------------------------------

/// In the first column: a type, `struct` or the kind of a shader, and a name.
bool Parser::startsFileScopeDeclaration() const {
  if (at(TokenKind::end) || map_.location(peek().position).column != 1) return false;
  if (at(TokenKind::kwStruct)) return true;
  const bool typed = simpleType(peek().kind) && at(TokenKind::identifier, 1) && at(TokenKind::leftParen, 2);
  const bool shader = at(TokenKind::identifier) && at(TokenKind::identifier, 1) &&
                      (at(TokenKind::leftParen, 2) || at(TokenKind::leftBracket, 2));
  return typed || shader;
}

void Parser::skipToDeclaration() {
  openInitializers_ = 0;
  int depth = 0;
  for (bool first = true; !at(TokenKind::end); first = false) {
    if (!first && startsFileScopeDeclaration()) return;
    const TokenKind kind = next().kind;
    if (kind == TokenKind::leftBrace) ++depth;
    if (kind == TokenKind::rightBrace && --depth <= 0) {
      accept(TokenKind::semicolon);
      return;
    }
    if (kind == TokenKind::semicolon && depth == 0) return;
  }
}

void Parser::skipToStatement(std::size_t before) {
  int depth = std::exchange(openInitializers_, 0);
  const bool isInitializer = depth > 0;
  while (!at(TokenKind::end)) {
    if (depth == 0) {
      if (at(TokenKind::rightBrace)) return;
      if (at(TokenKind::leftBrace) && previous().kind == TokenKind::rightParen && index_ != before) return;
    }
    if ((depth == 0 || isInitializer) && accept(TokenKind::semicolon)) return;
    const TokenKind kind = next().kind;
    if (kind == TokenKind::leftBrace) ++depth;
    if (kind == TokenKind::rightBrace && --depth == 0 && !isInitializer) {
      accept(TokenKind::semicolon);
      return;
    }
  }
}

bool Parser::skipToListMember(TokenKind close) {
  int depth = std::exchange(openInitializers_, 0);
  while (!at(TokenKind::end)) {
    const TokenKind kind = peek().kind;
    if (depth == 0 && (kind == TokenKind::comma || kind == close)) return true;
    if (kind == TokenKind::semicolon || (depth == 0 && kind == TokenKind::rightBrace)) return false;
    if (kind == TokenKind::leftBrace && depth == 0 && previous().kind != TokenKind::assign) return false;
    if (kind == TokenKind::leftParen || kind == TokenKind::leftBrace || kind == TokenKind::leftBracket) ++depth;
    if (kind == TokenKind::rightParen || kind == TokenKind::rightBrace || kind == TokenKind::rightBracket) {
      if (depth == 0) return false;
      --depth;
    }
    next();
  }
  return false;
}

// Entry ---------------------------------------------------------------------------------------------------------------

SourceFile Parser::run() {
  SourceFile file;
  while (!at(TokenKind::end)) {
    const std::size_t before = index_;
    try {
      declaration(file);
    } catch (const Failure&) {
      skipToDeclaration();
      if (index_ == before) next();
    }
  }
  return file;
}

SourceFile parseTokens(const TokenStream& tokens, const SourceMap& sourceMap, Diagnostics& diagnostics, bool strict) {
  return Parser(tokens, sourceMap, diagnostics, strict).run();
}

namespace {

/// Preprocessor, lexer and parser each report from top to bottom; together, their messages are put in the order of
/// lines.
Diagnostics sortedByPlace(const Diagnostics& diagnostics) {
  const auto& entries = diagnostics.entries();
  std::map<std::string, int> fileOrder;
  for (const Diagnostic& entry : entries) fileOrder.emplace(entry.location.file, static_cast<int>(fileOrder.size()));
  std::vector<std::tuple<int, int, int, std::size_t>> order;
  for (const Diagnostic& entry : entries) {
    order.emplace_back(fileOrder.at(entry.location.file), entry.location.line, entry.location.column, order.size());
  }
  std::sort(order.begin(), order.end());
  Diagnostics result;
  for (const auto& place : order) result.add(entries[std::get<3>(place)]);
  return result;
}

Result<ParsedSource> parse(const PreprocessRequest& request, bool strict) {
  PreprocessResult preprocessed = preprocess(request);
  Diagnostics diagnostics = std::move(preprocessed.diagnostics);
  if (!preprocessed.complete && diagnostics.hasErrors()) return diagnostics;
  const TokenStream tokens = tokenize(preprocessed, diagnostics);
  ParsedSource result;
  result.file = parseTokens(tokens, *preprocessed.sourceMap, diagnostics, strict);
  diagnostics = sortedByPlace(diagnostics);
  if (diagnostics.hasErrors()) return diagnostics;
  result.sourceMap = std::move(preprocessed.sourceMap);
  result.dependencies = std::move(preprocessed.dependencies);
  result.warnings = std::move(diagnostics);
  return result;
}

PreprocessRequest requestFor(const CompileOptions& options) {
  return {.mainFile = {},
          .text = {},
          .includePaths = options.includePaths,
          .defines = options.defines,
          .undefines = options.undefines,
          .prelude = options.standardLibrary};
}

}  // namespace

Result<ParsedSource> parseFile(const std::filesystem::path& path, const CompileOptions& options) {
  PreprocessRequest request = requestFor(options);
  request.mainFile = path.string();
  return parse(request, options.strict);
}

Result<ParsedSource> parseString(const std::string& text, const std::string& name, const CompileOptions& options) {
  PreprocessRequest request = requestFor(options);
  request.mainFile = name;
  request.text = text;
  return parse(request, options.strict);
}

}  // namespace aerosol::lang
