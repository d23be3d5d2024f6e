// The syntax tree of a shader source file, and the slots that the type checker fills in.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/lang/type.h"

namespace aerosol::lang {

/// A position as an index into `SourceMap`: cheap to keep on every node.
using Position = std::uint32_t;

struct Expression;
struct Statement;
struct FunctionDeclaration;
struct StructDeclaration;
struct VariableDeclaration;
struct BuiltinOverload;  // builtins.h
struct ClosureRow;       // closures.h
using ExpressionPtr = std::unique_ptr<Expression>;
using StatementPtr = std::unique_ptr<Statement>;

/// A type as written: `closure color`, `float`, `MyStruct`; array lengths stand with the declared name.
struct TypeName {
  BaseType base = BaseType::none;
  bool closure = false;
  std::string structName;  ///< When base is `structure`.
  Position position = 0;
};

enum class UnaryOp : std::uint8_t {
  plus,
  minus,
  logicalNot,
  bitNot,
  preIncrement,
  preDecrement,
  postIncrement,
  postDecrement
};
enum class BinaryOp : std::uint8_t {
  add,
  subtract,
  multiply,
  divide,
  modulo,
  bitAnd,
  bitOr,
  bitXor,
  shiftLeft,
  shiftRight,
  less,
  lessEqual,
  greater,
  greaterEqual,
  equal,
  notEqual,
  logicalAnd,
  logicalOr,
};

// Expressions ---------------------------------------------------------------------------------------------------------

struct IntLiteral {
  std::int32_t value = 0;
};
struct FloatLiteral {
  float value = 0;
};
struct StringLiteral {
  std::string value;
};  ///< Escapes resolved, adjacent literals joined.
struct Name {
  std::string name;
  VariableDeclaration* declaration = nullptr;
};
/// `function` of an operator is the author's overload (`__operator__neg__` …), where one is chosen.
struct Unary {
  UnaryOp op{};
  ExpressionPtr operand;
  const FunctionDeclaration* function = nullptr;
};
struct Binary {
  BinaryOp op{};
  ExpressionPtr left, right;
  const FunctionDeclaration* function = nullptr;
};
/// `target = value`, or `target op= value`.
struct Assign {
  ExpressionPtr target;
  ExpressionPtr value;
  bool compound = false;
  BinaryOp op{};
  const FunctionDeclaration* function = nullptr;
};
struct Conditional {
  ExpressionPtr condition, yes, no;
};
/// `base[index]`: array element, triple component, matrix row (a second Index gives its column).
struct Index {
  ExpressionPtr base, index;
};
/// `base.field`: struct field, or `.x .y .z .r .g .b` of a triple.
struct Field {
  ExpressionPtr base;
  std::string field;
};
/// `name(arguments)`; the type checker sets one of: `function` (the author's, also those of stdosl.h), `builtin`,
/// `closure`.
struct Call {
  std::string name;
  std::vector<ExpressionPtr> arguments;
  const FunctionDeclaration* function = nullptr;
  const BuiltinOverload* builtin = nullptr;
  const ClosureRow* closure = nullptr;
};
/// `color("hsv", a, b, c)`, `point(x, y, z)`, `float(i)`, `(float) i`, `matrix("object", "world")`, `MyStruct(a, b)`.
/// `function` is what makes the value of a colour in a named space.
struct Construct {
  TypeName type;
  std::vector<ExpressionPtr> arguments;
  bool isCast = false;
  const FunctionDeclaration* function = nullptr;
};
/// `{a, b, {c, d}}`: array or struct initialiser.
struct InitializerList {
  std::vector<ExpressionPtr> elements;
};
/// `a, b`
struct Comma {
  ExpressionPtr first, second;
};

struct Expression {
  Position position = 0;
  std::variant<IntLiteral, FloatLiteral, StringLiteral, Name, Unary, Binary, Assign, Conditional, Index, Field, Call,
               Construct, InitializerList, Comma>
      node;
  Type type;  ///< Filled by the type checker.
};

// Statements ----------------------------------------------------------------------------------------------------------

/// One `[[ type name = value ]]` entry.
struct Metadata {
  TypeName type;
  int arrayLength = Type::scalar;
  std::string name;
  ExpressionPtr value;
  Position position = 0;
};

/// A variable, a formal parameter or a shader parameter: `type name[length] = initial [[ metadata ]]`.
struct VariableDeclaration {
  TypeName typeName;
  std::string name;
  Position position = 0;
  int arrayLength = Type::scalar;
  ExpressionPtr lengthExpression;  ///< When the length is not a literal; the type checker folds it.
  ExpressionPtr initializer;       ///< May be null.
  std::vector<Metadata> metadata;
  bool isOutput = false;     ///< `output` on a parameter.
  bool isParameter = false;  ///< Formal parameter of a function or shader.
  bool isShaderParameter = false;
  bool isGlobal = false;    ///< Shader global (P, N, …).
  bool isAssigned = false;  ///< Filled by the type checker: written other than by its initializer.
  Type type;                ///< Filled by the type checker.
};

struct ExpressionStatement {
  ExpressionPtr expression;
};
struct DeclarationStatement {
  std::vector<std::unique_ptr<VariableDeclaration>> variables;
};
struct Block {
  std::vector<StatementPtr> statements;
};
struct If {
  ExpressionPtr condition;
  StatementPtr yes, no;
};
/// while, do-while and for alike. Missing parts are null.
struct Loop {
  StatementPtr initial;
  ExpressionPtr condition, step;
  StatementPtr body;
  bool testsLast = false;
};
struct Jump {
  enum class Kind : std::uint8_t { breakLoop, continueLoop } kind{};
};
struct Return {
  ExpressionPtr value;
};
struct LocalFunction {
  std::unique_ptr<FunctionDeclaration> function;
};
struct LocalStruct {
  std::unique_ptr<StructDeclaration> structure;
};

struct Statement {
  Position position = 0;
  std::variant<ExpressionStatement, DeclarationStatement, Block, If, Loop, Jump, Return, LocalFunction, LocalStruct>
      node;
};

// Declarations at file scope ------------------------------------------------------------------------------------------

struct FunctionDeclaration {
  TypeName resultType;
  int resultArrayLength = Type::scalar;
  std::string name;  ///< `__operator__add__` and the like for operator overloads.
  Position position = 0;
  std::vector<std::unique_ptr<VariableDeclaration>> parameters;
  bool variadic = false;  ///< `...`
  StatementPtr body;      ///< Null for a declaration without a body (a built-in).
  std::vector<Metadata> metadata;
  Type type;
};

struct StructDeclaration {
  std::string name;
  Position position = 0;
  std::vector<std::unique_ptr<VariableDeclaration>> fields;
};

struct ShaderDeclaration {
  std::string kind;  ///< surface | volume | displacement | shader
  std::string name;
  Position position = 0;
  std::vector<Metadata> metadata;
  std::vector<std::unique_ptr<VariableDeclaration>> parameters;
  StatementPtr body;
};

struct SourceFile {
  std::vector<std::variant<std::unique_ptr<FunctionDeclaration>, std::unique_ptr<StructDeclaration>,
                           std::unique_ptr<ShaderDeclaration>>>
      declarations;
};

}  // namespace aerosol::lang
