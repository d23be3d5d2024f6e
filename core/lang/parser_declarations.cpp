// Types and declarations at file scope, parameters, metadata.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/lang/parser_internal.h"

namespace aerosol::lang {

namespace {

constexpr std::array<std::string_view, 5> shaderKinds = {"surface", "volume", "displacement", "light", "shader"};

bool isShaderKind(std::string_view word) {
  return std::find(shaderKinds.begin(), shaderKinds.end(), word) != shaderKinds.end();
}

/// Reserved words that C and C++ put in front of types.
bool isQualifier(std::string_view word) {
  constexpr std::string_view words[] = {"const",  "static",  "extern",   "inline",   "uniform",   "varying", "virtual",
                                        "signed", "private", "volatile", "unsigned", "protected", "friend",  "typedef"};
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

/// The type that a reserved word for a type wants to be.
std::optional<BaseType> intendedType(std::string_view word) {
  if (word == "double") return BaseType::floating;
  if (word == "bool" || word == "char" || word == "short" || word == "long") return BaseType::integer;
  return std::nullopt;
}

}  // namespace

// Types ---------------------------------------------------------------------------------------------------------------

std::optional<BaseType> Parser::simpleType(TokenKind kind) {
  switch (kind) {
    case TokenKind::kwVoid:
      return BaseType::none;
    case TokenKind::kwInt:
      return BaseType::integer;
    case TokenKind::kwFloat:
      return BaseType::floating;
    case TokenKind::kwString:
      return BaseType::string;
    case TokenKind::kwColor:
      return BaseType::color;
    case TokenKind::kwPoint:
      return BaseType::point;
    case TokenKind::kwVector:
      return BaseType::vector;
    case TokenKind::kwNormal:
      return BaseType::normal;
    case TokenKind::kwMatrix:
      return BaseType::matrix;
    default:
      return std::nullopt;
  }
}

bool Parser::startsType() const {
  const Token& token = peek();
  if (token.kind == TokenKind::reserved) return intendedType(token.text) || isQualifier(token.text);
  return token.kind == TokenKind::kwClosure || token.kind == TokenKind::identifier || simpleType(token.kind);
}

/// Reports each reserved word in front of a type once and goes on without it.
void Parser::skipQualifiers() {
  while (at(TokenKind::reserved) && isQualifier(peek().text)) {
    error(peek().position, fmt::format("expected a type, found the reserved word '{}'", peek().text),
          {"the language has no such qualifier"});
    next();
  }
}

TypeName Parser::typeName() {
  skipQualifiers();
  TypeName type;
  type.position = peek().position;
  if (accept(TokenKind::kwClosure)) {
    expect(TokenKind::kwColor, "after 'closure'");
    type.base = BaseType::color;
    type.closure = true;
    return type;
  }
  if (const auto base = simpleType(peek().kind)) {
    type.base = *base;
    next();
    type.closure =
        *base == BaseType::color && accept(TokenKind::kwClosure);  // The order of the language's first years.
    return type;
  }
  if (at(TokenKind::identifier)) {
    type.base = BaseType::structure;
    type.structName = std::string(next().text);
    return type;
  }
  if (const auto base = at(TokenKind::reserved) ? intendedType(peek().text) : std::nullopt) {
    error(peek().position, fmt::format("expected a type, found the reserved word '{}'", peek().text),
          {fmt::format("the language has '{}' instead", *base == BaseType::floating ? "float" : "int")});
    type.base = *base;
    next();
    return type;
  }
  failExpected("a type", "");
}

Parser::ArraySpec Parser::arraySpec() {
  ArraySpec spec;
  expect(TokenKind::leftBracket, "");
  if (accept(TokenKind::rightBracket)) {
    spec.length = Type::unsized;
    return spec;
  }
  const Nest nest(*this);
  ExpressionPtr length = conditionalExpression();
  expect(TokenKind::rightBracket, "after the array's length");
  const auto* negation = std::get_if<Unary>(&length->node);
  const bool isNegative =
      negation && negation->op == UnaryOp::minus && std::get_if<IntLiteral>(&negation->operand->node);
  const auto* literal = std::get_if<IntLiteral>(&length->node);
  if (isNegative || (literal && literal->value <= 0)) error(length->position, "the length of an array is at least 1");
  if (literal) {
    spec.length = std::max(literal->value, 1);
  } else if (strict_ && !isNegative && !std::holds_alternative<Name>(length->node)) {
    error(length->position, "the length of an array is a whole number, not an expression");
    spec.length = 1;
  } else {
    spec.length = Type::unsized;
    spec.expression = std::move(length);
  }
  return spec;
}

// File scope ----------------------------------------------------------------------------------------------------------

void Parser::declaration(SourceFile& file) {
  if (at(TokenKind::semicolon)) {
    refuseHere("a ';' ends no declaration here");
    next();
    return;
  }
  if (at(TokenKind::kwStruct)) {
    file.declarations.emplace_back(structDeclaration());
    return;
  }
  if (at(TokenKind::kwPublic)) {
    refuseHere("'public' has no effect");
    if (!strict_) warning(peek().position, "'public' has no effect");
    next();
  }
  skipQualifiers();
  const bool isWord = at(TokenKind::identifier);
  if (isWord && !structNames_.contains(std::string(peek().text))) {
    const bool named = at(TokenKind::identifier, 1) || isShaderKind(peek().text);
    if (named && isShaderKind(peek().text)) {
      file.declarations.emplace_back(shaderDeclaration());
      return;
    }
    return unknownDeclaration(file);
  }
  if (!startsType()) failExpected("a function, a struct or a shader", "");
  const TypeName type = typeName();
  if (at(TokenKind::identifier) && !at(TokenKind::leftParen, 1)) {
    error(peek().position, fmt::format("expected a function, found the variable '{}' outside of a shader", peek().text),
          {"only functions, structs and shaders stand at file scope; constants are macros or parameters"});
    throw Failure();
  }
  file.declarations.emplace_back(functionDeclaration(type));
}

/// A name where a declaration begins, which is neither a struct nor the kind of a shader.
void Parser::unknownDeclaration(SourceFile& file) {
  const Token& word = peek();
  if (!at(TokenKind::identifier, 1)) failExpected("a function, a struct or a shader", "");
  std::vector<std::string> known = {"int",    "float",   "string", "color",        "point", "vector", "normal",
                                    "matrix", "surface", "volume", "displacement", "light", "shader", "struct"};
  known.insert(known.end(), structNames_.begin(), structNames_.end());
  std::sort(known.begin() + 14, known.end());
  std::vector<std::string> notes;
  if (const std::string hint = didYouMean(word.text, known); !hint.empty()) notes.push_back(hint);
  error(word.position,
        fmt::format("'{}' is neither a type nor a kind of shader (surface, volume, displacement, light, shader)",
                    word.text),
        std::move(notes));
  // The rest is still looked at for errors: as what it most resembles.
  const auto nearest = nearestNames(word.text, known, 1);
  const bool shader = at(TokenKind::leftBracket, 2) || (!nearest.empty() && isShaderKind(nearest[0]));
  if (shader) {
    file.declarations.emplace_back(shaderDeclaration());
  } else {
    const TypeName type = typeName();
    file.declarations.emplace_back(functionDeclaration(type));
  }
}

std::unique_ptr<StructDeclaration> Parser::structDeclaration() {
  auto result = std::make_unique<StructDeclaration>();
  expect(TokenKind::kwStruct, "");
  const Token& name = expectName("the struct's name");
  result->name = std::string(name.text);
  result->position = name.position;
  const Token& open = expect(TokenKind::leftBrace, "before the struct's fields");
  if (at(TokenKind::rightBrace)) error(name.position, fmt::format("the struct '{}' has no fields", name.text));
  while (!at(TokenKind::rightBrace)) {
    if (at(TokenKind::end)) {
      failExpected("'}'", fmt::format("to close the '{{' on line {}", map_.location(open.position).line));
    }
    const std::size_t before = index_;
    try {
      structField(*result);
    } catch (const Failure&) {
      if (givenUp_) throw;
      skipToStatement(before);
    }
  }
  next();
  structNames_.insert(result->name);
  demand(TokenKind::semicolon, "after the struct");
  return result;
}

void Parser::structField(StructDeclaration& declaration) {
  if (!startsType()) failExpected("a field's type", "");
  const TypeName type = typeName();
  do {
    auto field = declaredVariable(type, "a field's name");
    if (at(TokenKind::assign)) {
      error(peek().position, "expected ';' after the field, found '=': fields have no initial values");
      next();
      assignmentExpression();
    }
    declaration.fields.push_back(std::move(field));
  } while (accept(TokenKind::comma));
  demand(TokenKind::semicolon, "after the field");
}

std::unique_ptr<ShaderDeclaration> Parser::shaderDeclaration() {
  auto result = std::make_unique<ShaderDeclaration>();
  if (peek().text == "light") refuseHere("'light' is no kind of shader");
  result->kind = std::string(next().text);
  const Token& name = expectName("the shader's name");
  result->name = std::string(name.text);
  result->position = name.position;
  if (atMetadata()) result->metadata = metadata();
  expect(TokenKind::leftParen, "before the shader's parameters");
  parameters(result->parameters, true, nullptr);
  moreMetadata(result->metadata);
  if (!at(TokenKind::leftBrace)) failExpected("'{'", "before the shader's statements");
  result->body = block();
  return result;
}

/// The grammar has a place for metadata on either side of the parameters. Behind them two braces are the body and a
/// block in it.
void Parser::moreMetadata(std::vector<Metadata>& list) {
  if (!atBracketMetadata()) return;
  for (Metadata& entry : metadata()) list.push_back(std::move(entry));
}

/// From the function's name on (or from the array brackets of its result).
std::unique_ptr<FunctionDeclaration> Parser::functionDeclaration(TypeName resultType) {
  auto result = std::make_unique<FunctionDeclaration>();
  result->resultType = std::move(resultType);
  if (at(TokenKind::leftBracket)) result->resultArrayLength = arraySpec().length;
  const Token& name = expectName("a function's name");
  result->name = std::string(name.text);
  result->position = name.position;
  if (atMetadata()) result->metadata = metadata();
  expect(TokenKind::leftParen, "before the function's parameters");
  parameters(result->parameters, false, &result->variadic);
  moreMetadata(result->metadata);
  if (accept(TokenKind::semicolon)) return result;
  if (!at(TokenKind::leftBrace)) failExpected("'{' or ';'", "after the function's parameters");
  result->body = block();
  return result;
}

// Parameters ----------------------------------------------------------------------------------------------------------

/// Up to and with the closing parenthesis.
void Parser::parameters(Parameters& list, bool ofShader, bool* variadic) {
  while (!at(TokenKind::rightParen)) {
    try {
      if (variadic && accept(TokenKind::ellipsis)) {
        *variadic = true;
        break;
      }
      list.push_back(parameter(ofShader));
      if (!at(TokenKind::comma) && !at(TokenKind::rightParen)) failExpected("',' or ')'", "after the parameter");
    } catch (const Failure&) {
      if (givenUp_) throw;
      if (!skipToListMember(TokenKind::rightParen)) {
        if (at(TokenKind::leftBrace)) return;  // The parenthesis is missing: the body may still be read.
        throw;
      }
    }
    if (!accept(TokenKind::comma)) break;
  }
  expect(TokenKind::rightParen, "after the parameters");
}

std::unique_ptr<VariableDeclaration> Parser::parameter(bool ofShader) {
  const bool isOutput = accept(TokenKind::kwOutput);
  if (!startsType()) {
    std::vector<std::string> notes;
    if (!ofShader) notes.emplace_back("these are the parameters of a function; a variable is initialised with '='");
    failExpected("a parameter's type", "", std::move(notes));
  }
  auto result = declaredVariable(typeName(), "a parameter's name");
  result->isOutput = isOutput;
  result->isParameter = true;
  result->isShaderParameter = ofShader;
  if (at(TokenKind::assign)) {
    if (!ofShader)
      error(peek().position,
            "expected ',' or ')' after the parameter, found '=': parameters of functions have no initial values");
    next();
    result->initializer = assignmentExpression();
  } else if (ofShader) {
    reportExpected("'='", fmt::format("and the initial value of the parameter '{}'", result->name));
  }
  if (atMetadata()) result->metadata = metadata();
  return result;
}

/// A name, and the length of an array.
std::unique_ptr<VariableDeclaration> Parser::declaredVariable(const TypeName& type, std::string_view what) {
  auto result = std::make_unique<VariableDeclaration>();
  if (type.base == BaseType::none && !type.closure) error(type.position, "only functions can be void");
  result->typeName = type;
  if (at(TokenKind::leftBracket) && !atBracketMetadata()) {
    failExpected(std::string(what), "", {"the length of an array stands behind the name: float values[3]"});
  }
  const Token& name = expectName(what);
  result->name = std::string(name.text);
  result->position = name.position;
  if (at(TokenKind::leftBracket) && !atBracketMetadata()) {
    ArraySpec spec = arraySpec();
    result->arrayLength = spec.length;
    result->lengthExpression = std::move(spec.expression);
    if (at(TokenKind::leftBracket) && !atBracketMetadata()) error(peek().position, "arrays have one dimension");
  }
  return result;
}

// Metadata ------------------------------------------------------------------------------------------------------------

std::vector<Metadata> Parser::metadata() {
  std::vector<Metadata> list;
  const Position open = peek().position;
  const bool isInBraces = next().kind == TokenKind::leftBrace;
  if (!isInBraces && map_.location(peek().position).column != map_.location(open).column + 1)
    refuseHere("the brackets of metadata stand together, as '[['");
  const TokenKind close = isInBraces ? TokenKind::rightBrace : TokenKind::rightBracket;
  next();
  if (strict_ && at(close)) failExpected("the type of a metadata entry", "");
  while (!at(close)) {
    try {
      list.push_back(metadatum());
      if (!at(TokenKind::comma) && !at(close))
        failExpected(isInBraces ? "',' or '}}'" : "',' or ']]'", "after the metadata entry");
    } catch (const Failure&) {
      if (givenUp_ || !skipToListMember(close)) throw;
    }
    if (!accept(TokenKind::comma)) break;
  }
  expect(close, "after the metadata");
  expect(close, "after the metadata");
  return list;
}

Metadata Parser::metadatum() {
  Metadata result;
  skipQualifiers();
  if (!simpleType(peek().kind)) failExpected("the type of a metadata entry", "");
  result.type = typeName();
  const Token& name = expectName("the metadata entry's name");
  result.name = std::string(name.text);
  result.position = name.position;
  if (at(TokenKind::leftBracket)) {
    const ArraySpec spec = arraySpec();
    if (spec.expression) error(spec.expression->position, "the length of a metadata array is a number");
    result.arrayLength = spec.length;
  }
  expect(TokenKind::assign, "after the metadata entry's name");
  result.value = assignmentExpression();
  return result;
}

}  // namespace aerosol::lang
