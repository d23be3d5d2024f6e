// The type checker's insides: shared by check_*.cpp only.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/lang/check.h"
#include "core/lang/closures.h"
#include "core/lang/fold.h"

namespace aerosol::lang {

/// Type of an expression in which an error was already reported: everything accepts it silently.
inline constexpr Type poisoned{BaseType::none, true};
/// Type of `m[i]` for a matrix m: only good for being indexed again.
inline constexpr Type matrixRow{BaseType::matrix, true};

inline bool isPoisoned(const Type& type) { return type == poisoned; }

/// The function that overloads an operator: `__operator__add__`. Empty where there is none.
std::string_view overloadName(BinaryOp op);
std::string_view overloadName(UnaryOp op);
/// As written: "+", "<=".
std::string_view spelling(BinaryOp op);
std::string_view spelling(UnaryOp op);

/// The constant value of an expression of literals, operators and constructors; nothing when it is not one. The
/// expression must have been checked.
std::optional<Constant> evaluateConstant(const Expression& expression);

/// A literal 0, which is also the null closure.
bool isZeroLiteral(const Expression& expression);

/// Whether control can never run past the end of the statement because each path returns.
bool alwaysReturns(const Statement& statement);

class Checker {
 public:
  Checker(const SourceMap& sourceMap, Diagnostics& diagnostics, bool advice, bool strict)
      : sourceMap_(sourceMap), diagnostics_(diagnostics), advice_(advice), strict_(strict) {}

  std::unique_ptr<CheckedSource> run(SourceFile& file);

 private:
  struct Scope {
    std::map<std::string, VariableDeclaration*, std::less<>> variables;
    std::map<std::string, std::vector<FunctionDeclaration*>, std::less<>> functions;
    std::map<std::string, std::pair<const StructType*, Position>, std::less<>> structs;
  };
  enum class State : std::uint8_t { checking, done, withoutReturn };

  /// What may be called by a name.
  struct Candidate {
    const FunctionDeclaration* function = nullptr;
    const BuiltinOverload* builtin = nullptr;
    const ClosureRow* closure = nullptr;
    Type result;
    std::vector<Type> parameters;
    bool variadic = false;
    std::uint32_t arrays = 0;
    std::uint32_t any = 0;
    int score = 0;
    int resultScore = 0;
  };

  // check.cpp: declarations
  void declareGlobals();
  void checkStruct(StructDeclaration& declaration);
  void checkFunction(FunctionDeclaration& function);
  void checkBody(FunctionDeclaration& function);
  void checkShader(ShaderDeclaration& shader);
  void checkShaderParameter(VariableDeclaration& parameter);
  void checkMetadata(std::vector<Metadata>& metadata);
  Type resolveType(const TypeName& name, int arrayLength, const Expression* length);
  int resolveLength(const VariableDeclaration& declaration);
  void declareVariable(VariableDeclaration& variable);
  void declareFunction(FunctionDeclaration& function);
  void warnWhenHiding(const VariableDeclaration& variable);
  bool isTaken(const VariableDeclaration& variable);

  // check_statements.cpp
  void checkStatement(Statement& statement);
  void checkVariables(DeclarationStatement& declaration);
  void checkListInitializer(const VariableDeclaration& variable);
  /// `notForClosures`: what stands there, where it may not be a closure.
  void checkCondition(Expression& condition, const std::string& notForClosures = {});
  void checkLoop(Loop& loop);
  void checkReturn(Return& statement, Position position);

  // check_expressions.cpp
  Type check(Expression& expression, const Type& expected);
  Type checkNode(Expression& expression, const Type& expected);
  Type checkName(Expression& expression, Name& name);
  Type checkUnary(Expression& expression, Unary& unary, const Type& expected);
  Type checkBinary(Expression& expression, Binary& binary, const Type& expected);
  Type binaryType(Position position, BinaryOp op, const Expression& left, const Type& leftType, const Type& rightType);
  Type checkAssign(Expression& expression, Assign& assign);
  Type checkConditional(Expression& expression, Conditional& conditional, const Type& expected);
  Type checkIndex(Expression& expression, Index& index, bool rowAllowed);
  Type checkField(Expression& expression, Field& field);
  /// Marks the variable as assigned. False when the target is none; that it may not be written is an error too.
  bool checkWritable(const Expression& target);

  // check_initializers.cpp
  /// A float may become an int where a variable gets a value, with a warning, as in other compilers.
  enum class Truncation : std::uint8_t { refused, warned };
  void requireAssignable(const Type& to, const Expression& from, std::string_view what,
                         Truncation truncation = Truncation::refused);
  void warnOfTruncation(Position position, std::string_view what);
  /// Checks `expression` as the initial value of something of type `target`; an unsized array gets its length.
  Type checkInitializer(Expression& expression, const Type& target, std::string_view what,
                        Truncation truncation = Truncation::refused);
  Type checkInitializerList(Expression& expression, InitializerList& list, const Type& target);

  // check_calls.cpp
  Type checkCall(Expression& expression, Call& call, const Type& expected);
  /// Calls among the arguments are chosen by the type that is expected of the call they stand in.
  Type checkArguments(const Expression& call, std::vector<ExpressionPtr>& arguments, std::vector<Type>& types,
                      const Type& expected);
  void gatherCandidates(std::string_view name, Position position, std::vector<Candidate>& candidates);
  void addCandidate(std::vector<Candidate>& candidates, Candidate candidate) const;
  const Candidate* choose(std::vector<Candidate>& candidates, const std::vector<ExpressionPtr>& arguments,
                          const std::vector<Type>& types, const Type& expected, Position position,
                          std::string_view name, bool complain);
  int scoreCandidate(const Candidate& candidate, const std::vector<ExpressionPtr>& arguments,
                     const std::vector<Type>& types) const;
  bool listFits(const Expression& list, const Type& type) const;
  static bool isLiteral(const Expression& expression);
  static void markWritten(const VariableDeclaration& formal, const Expression& argument);
  void bindArguments(const Candidate& candidate, std::vector<ExpressionPtr>& arguments, Position position);
  void useFunction(const FunctionDeclaration& function, Position position);
  Type checkClosureCall(Expression& expression, Call& call, const ClosureRow& row);
  void unknownFunction(Position position, std::string_view name);
  void checkTextureOptions(Call& call);
  static constexpr std::size_t maximumPointOutputs = 24;
  void checkPointOutputs(Call& call);
  std::string describe(const Candidate& candidate) const;
  const FunctionDeclaration* findOverload(std::string_view name, std::vector<Expression*> operands, Position position,
                                          const Type& expected, Type& result);

  // check_builtins.cpp: what signatures cannot say
  void checkBuiltin(const Expression& expression, Call& call);
  void checkNoise(const Expression& expression, Call& call);
  void checkNoiseOptions(const Call& call, std::size_t first);
  void checkSpline(const Expression& expression, Call& call);

  // check_constructors.cpp
  Type checkConstruct(Expression& expression, Construct& construct, const Type& expected);
  Type checkTriple(Expression& expression, Construct& construct, const Type& type);
  Type checkMatrix(Expression& expression, Construct& construct);
  Type checkCast(Expression& expression, Construct& construct, const Type& type);
  Type checkStructConstructor(Expression& expression, std::vector<ExpressionPtr>& arguments, const StructType& type,
                              Position position);
  void checkColorSpace(const Expression& space);
  /// The standard library's function of that name with so many parameters, of which the last is of type `last` (void:
  /// any type).
  const FunctionDeclaration* libraryFunction(std::string_view name, std::size_t parameters, Position position,
                                             const Type& last = types::none);

  // Names and messages
  VariableDeclaration* findVariable(std::string_view name) const;
  const StructType* findStruct(std::string_view name, Position position) const;
  std::vector<std::string> visibleVariables() const;
  void error(Position position, std::string message, std::vector<std::string> notes = {});
  void warning(Position position, std::string message, std::vector<std::string> notes = {});
  /// A warning that oslc does not give.
  void advise(Position position, std::string message, std::vector<std::string> notes = {}) {
    if (advice_) warning(position, std::move(message), std::move(notes));
  }
  std::string where(Position position) const;

  const SourceMap& sourceMap_;
  Diagnostics& diagnostics_;
  bool advice_, strict_;
  std::unique_ptr<CheckedSource> result_;
  std::vector<Scope> scopes_;
  std::map<const FunctionDeclaration*, State> functionStates_;
  std::map<const StructType*, std::size_t> structureLeaves_;
  std::string shaderKind_;
  const FunctionDeclaration* function_ = nullptr;  ///< The one whose body is being checked; null in a shader's body.
  Position libraryCall_ = 0;  ///< Where the author calls the library function that is being checked.
  int loopDepth_ = 0;
  bool hasReturn_ = false;  ///< Of the function.
  int depth_ = 0;
  static constexpr std::size_t shaderBodyScopes = 3;  ///< Of the file, of the parameters, of the body.
};

}  // namespace aerosol::lang
