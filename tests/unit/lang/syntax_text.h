// Syntax trees as text in prefix notation, for comparison in tests.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "core/lang/ast.h"

namespace aerosol::lang {

inline std::string text(const Expression& expression);
inline std::string text(const Statement& statement);

inline std::string text(const TypeName& type, int arrayLength = Type::scalar) {
  std::string result =
      type.base == BaseType::structure ? type.structName : toString(Type{.base = type.base, .closure = type.closure});
  if (arrayLength == Type::unsized) return result + "[]";
  return arrayLength == Type::scalar ? result : fmt::format("{}[{}]", result, arrayLength);
}

inline std::string text(const ExpressionPtr& expression) { return expression ? text(*expression) : "-"; }
inline std::string text(const StatementPtr& statement) { return statement ? text(*statement) : "-"; }

inline std::string text(const std::vector<ExpressionPtr>& list) {
  std::string result;
  for (const auto& element : list) result += " " + text(element);
  return result;
}

inline const char* text(BinaryOp op) {
  constexpr const char* names[] = {"+",  "-", "*",  "/", "%",  "&",  "|",  "^",  "<<",
                                   ">>", "<", "<=", ">", ">=", "==", "!=", "&&", "||"};
  return names[static_cast<int>(op)];
}

inline const char* text(UnaryOp op) {
  constexpr const char* names[] = {"+", "-", "!", "~", "++_", "--_", "_++", "_--"};
  return names[static_cast<int>(op)];
}

struct ExpressionText {
  std::string operator()(const IntLiteral& e) const { return fmt::format("{}", e.value); }
  std::string operator()(const FloatLiteral& e) const { return fmt::format("{}f", e.value); }
  std::string operator()(const StringLiteral& e) const { return "\"" + e.value + "\""; }
  std::string operator()(const Name& e) const { return e.name; }
  std::string operator()(const Unary& e) const { return fmt::format("({} {})", text(e.op), text(e.operand)); }
  std::string operator()(const Binary& e) const {
    return fmt::format("({} {} {})", text(e.op), text(e.left), text(e.right));
  }
  std::string operator()(const Assign& e) const {
    return fmt::format("({}= {} {})", e.compound ? text(e.op) : "", text(e.target), text(e.value));
  }
  std::string operator()(const Conditional& e) const {
    return fmt::format("(? {} {} {})", text(e.condition), text(e.yes), text(e.no));
  }
  std::string operator()(const Index& e) const { return fmt::format("([] {} {})", text(e.base), text(e.index)); }
  std::string operator()(const Field& e) const { return fmt::format("(. {} {})", text(e.base), e.field); }
  std::string operator()(const Call& e) const { return fmt::format("(call {}{})", e.name, text(e.arguments)); }
  std::string operator()(const Construct& e) const {
    return fmt::format("({} {}{})", e.isCast ? "cast" : "new", text(e.type), text(e.arguments));
  }
  std::string operator()(const InitializerList& e) const { return fmt::format("{{{} }}", text(e.elements)); }
  std::string operator()(const Comma& e) const { return fmt::format("(, {} {})", text(e.first), text(e.second)); }
};

inline std::string text(const Expression& expression) { return std::visit(ExpressionText(), expression.node); }

inline std::string text(const std::vector<Metadata>& metadata) {
  std::string result;
  for (const Metadata& entry : metadata) {
    result += fmt::format(" [[{} {} {}]]", text(entry.type, entry.arrayLength), entry.name, text(entry.value));
  }
  return result;
}

inline std::string text(const VariableDeclaration& variable) {
  return fmt::format("{}{} {}{}{}{}", variable.isOutput ? "output " : "", text(variable.typeName, variable.arrayLength),
                     variable.name, variable.lengthExpression ? "@" + text(variable.lengthExpression) : "",
                     variable.initializer ? " = " + text(variable.initializer) : "", text(variable.metadata));
}

inline std::string text(const std::vector<std::unique_ptr<VariableDeclaration>>& variables) {
  std::string result;
  for (const auto& variable : variables) result += (result.empty() ? "" : "; ") + text(*variable);
  return result;
}

inline std::string text(const FunctionDeclaration& function) {
  return fmt::format("function {} {}({}{}){} {}", text(function.resultType, function.resultArrayLength), function.name,
                     text(function.parameters), function.variadic ? "..." : "", text(function.metadata),
                     text(function.body));
}

struct StatementText {
  std::string operator()(const ExpressionStatement& s) const { return text(s.expression); }
  std::string operator()(const DeclarationStatement& s) const { return text(s.variables); }
  std::string operator()(const Block& s) const {
    std::string result = "{";
    for (const auto& statement : s.statements) result += " " + text(statement) + ";";
    return result + " }";
  }
  std::string operator()(const If& s) const {
    return fmt::format("if {} {} {}", text(s.condition), text(s.yes), text(s.no));
  }
  std::string operator()(const Loop& s) const {
    return fmt::format("{} {} | {} | {} {}", s.testsLast ? "do" : "loop", text(s.initial), text(s.condition),
                       text(s.step), text(s.body));
  }
  std::string operator()(const Jump& s) const { return s.kind == Jump::Kind::breakLoop ? "break" : "continue"; }
  std::string operator()(const Return& s) const { return "return " + text(s.value); }
  std::string operator()(const LocalFunction& s) const { return text(*s.function); }
  std::string operator()(const LocalStruct& s) const {
    return fmt::format("struct {} {{ {} }}", s.structure->name, text(s.structure->fields));
  }
};

inline std::string text(const Statement& statement) { return std::visit(StatementText(), statement.node); }

struct DeclarationText {
  std::string operator()(const std::unique_ptr<FunctionDeclaration>& d) const { return text(*d); }
  std::string operator()(const std::unique_ptr<StructDeclaration>& d) const {
    return fmt::format("struct {} {{ {} }}", d->name, text(d->fields));
  }
  std::string operator()(const std::unique_ptr<ShaderDeclaration>& d) const {
    return fmt::format("{} {}{}({}) {}", d->kind, d->name, text(d->metadata), text(d->parameters), text(d->body));
  }
};

inline std::string text(const SourceFile& file) {
  std::string result;
  for (const auto& declaration : file.declarations) {
    result += (result.empty() ? "" : "\n") + std::visit(DeclarationText(), declaration);
  }
  return result;
}

}  // namespace aerosol::lang
