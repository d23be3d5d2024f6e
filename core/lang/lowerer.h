// Lowering's insides: shared by lower_*.cpp only.
#pragma once

#include <array>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/lang/checker.h"
#include "core/lang/fold.h"
#include "core/lang/lower.h"

namespace aerosol::lang {

/// The leaves of a type: one entry for each field of structures, arrays of structures become arrays of their fields.
struct Leaf {
  Type type;
  std::string suffix;  ///< "" or ".field.field"
};
void flatten(const Type& type, std::vector<Leaf>& leaves, const std::string& suffix = {});

/// A value: its type, and one variable for each leaf.
struct Value {
  Type type;
  std::vector<VariableId> leaves;

  VariableId single() const { return leaves.at(0); }
};

/// Something that can be read and written: a variable, a field, an element, a component.
struct Place {
  Type type;
  std::vector<VariableId> leaves;     ///< Variables of the whole thing that is picked from.
  VariableId index = noVariable;      ///< Element of an array.
  VariableId component = noVariable;  ///< Of a triple; of a matrix: the row.
  VariableId column = noVariable;     ///< Of a matrix.

  bool isWhole() const { return index == noVariable && component == noVariable; }
};

/// Where control goes when a statement ends: a jump to just there needs no instruction.
enum class Tail : std::uint8_t { none, function, loop };

class Lowerer {
 public:
  Lowerer(CheckedSource& source, const SourceMap& sourceMap, Diagnostics& diagnostics, NativeSource* natives)
      : source_(source), sourceMap_(sourceMap), diagnostics_(diagnostics), natives_(natives) {}

  Program run();
  Position positionOf(std::uint32_t location) const;

 private:
  /// A function that is being inlined, or the shader itself.
  struct Frame {
    const FunctionDeclaration* function = nullptr;
    Position call = 0;
    std::uint32_t scopeId = 0;
    bool usesLeave = false;
    bool isDirect = false;  ///< The only return is the last statement: its value is the call's.
    Value result;
  };

  // lower.cpp: variables, constants, instructions
  void lowerParameters();
  void lowerParameter(const VariableDeclaration& declaration);
  void lowerBody();
  std::vector<MetadataValue> lowerMetadata(const std::vector<Metadata>& metadata);
  VariableId addVariable(Variable variable);
  VariableId temporary(const Type& type);
  VariableId local(const Type& type, std::string name);
  Value localValue(const Type& type, const std::string& name);
  VariableId constant(const Constant& value);
  VariableId constantInt(std::int32_t value) { return constant(Constant::ofInt(value)); }
  VariableId constantFloat(float value) { return constant(Constant::ofFloat(value)); }
  VariableId constantString(std::string value) { return constant(Constant::ofString(std::move(value))); }
  void nameValue(Value& value, const std::string& name);
  Value zeroValue(const Type& type);
  std::optional<Constant> constantOf(VariableId variable) const;
  bool isConstantValue(const Value& value) const;
  const Type& typeOf(VariableId variable) const { return program_.variables[variable].type; }
  bool isMutable(VariableId variable) const;
  VariableId emit(Op op, const Type& type, std::initializer_list<VariableId> arguments);
  VariableId emit(Op op, const Type& type, std::vector<VariableId> arguments);
  std::optional<VariableId> simplify(Op op, const Type& type, std::span<const VariableId> arguments);
  Instruction& append(Op op);
  VariableId call(const std::string& base, const Type& result, std::vector<VariableId> arguments,
                  std::uint32_t outputs = 0, bool pure = true);
  void assign(VariableId target, VariableId value);
  void bind(const VariableDeclaration& declaration, Value value);
  void assign(const Value& target, const Value& given);
  void copyPrefix(VariableId target, VariableId source);
  template <class Yes, class No>
  void branch(VariableId condition, Yes&& yes, No&& no);
  std::uint32_t locationOf(Position position);
  void error(Position position, std::string message, std::vector<std::string> notes = {});
  void remark(Position position, std::string message);
  /// An error after which nothing more is lowered: what comes next would only cost time.
  void stop(Position position, std::string message);
  bool countWork(Position position);

  // lower_statements.cpp
  void lowerStatement(const Statement& statement, Tail tail);
  void lowerStatements(const std::vector<StatementPtr>& statements, std::size_t begin, Tail tail);
  bool lowerEarlyExit(const std::vector<StatementPtr>& statements, std::size_t at, Tail tail);
  void lowerDeclaration(const VariableDeclaration& variable);
  void lowerIf(const If& statement, Tail tail);
  void lowerLoop(const Loop& loop);
  void lowerReturn(const Return& statement, Tail tail);
  template <class Body>
  Code collect(Body&& body);

  // lower_expressions.cpp
  Value lower(const Expression& expression);
  Value lowerNode(const Expression& expression);
  Value lowerTo(const Expression& expression, const Type& type);
  VariableId lowerSingle(const Expression& expression, const Type& type) { return lowerTo(expression, type).single(); }
  VariableId lowerCondition(const Expression& expression);
  Value lowerUnary(const Expression& expression, const Unary& unary);
  Value lowerIncrement(const Expression& expression, const Unary& unary);
  Value lowerBinary(const Expression& expression, const Binary& binary);
  Value lowerLogical(const Binary& binary);
  Value lowerAssign(const Expression& expression, const Assign& assign);
  Value lowerConditional(const Expression& expression, const Conditional& conditional);
  Value arithmetic(BinaryOp op, const Type& result, Value left, Value right);
  Value closureArithmetic(BinaryOp op, const Value& left, const Value& right);
  Value lowerConstruct(const Expression& expression, const Construct& construct);
  Value lowerList(const InitializerList& list, const Type& type);
  Value lowerArrayList(const InitializerList& list, const Type& type);
  Value gatherArray(const std::vector<Value>& elements, const Type& type);
  VariableId gatherLeaf(const std::vector<Value>& elements, std::size_t leaf, const Type& type);
  Value convert(const Value& value, const Type& type);
  VariableId convertLeaf(VariableId variable, const Type& to);
  VariableId toBool(VariableId variable);
  Value protect(Value value, const Expression& next);
  Value protect(Value value, std::span<const ExpressionPtr> next);
  Value copied(const Value& value);

  // lower_places.cpp
  Place place(const Expression& expression);
  Value load(const Place& place);
  void store(const Place& place, const Value& value);
  void storeLeaf(const Place& place, VariableId leaf, VariableId value);
  Value variableValue(const Name& name);

  // lower_functions.cpp
  Value lowerCall(const Expression& expression, const Call& call);
  Value callFunction(const FunctionDeclaration& function, std::span<const ExpressionPtr> arguments, Position position);
  Value inlineFunction(const FunctionDeclaration& function, std::vector<Value> arguments, Position position);
  /// A variable, or a part of one, that a function may write: it is of the type, and not known to stay as it is.
  bool isVariable(const Expression& expression, const Type& type) const;
  Value bindArgument(const VariableDeclaration& formal, const Expression& actual, std::span<const ExpressionPtr> later,
                     std::vector<std::pair<Place, Value>>& copiesBack);

  // lower_builtins.cpp
  Value lowerBuiltin(const Expression& expression, const Call& call);
  Value lowerComponentwise(const BuiltinOverload& overload, const std::vector<Value>& arguments);
  Value componentwise(const std::string& base, const Type& result, const std::vector<Value>& arguments);
  Value lowerSpecial(const Expression& expression, const Call& call);
  Value lowerIsConnected(const Expression& expression, const Call& call);
  Value lowerSelect(const Type& type, const std::vector<Value>& arguments);
  Value lowerSincos(const Call& call);
  Value lowerNoise(const Expression& expression, const Call& call, bool periodic);
  Value lowerSpline(const Expression& expression, const Call& call);
  Value gaborNoise(const Expression& expression, const Call& call, std::vector<Value> coordinates, bool periodic,
                   const std::vector<Value>& options);
  std::array<Value, 2> gaborFootprint(const Value& point, const Value& doFilter);
  std::vector<Value> lowerNoiseOptions(const Call& called, VariableId kind);
  Value noiseCall(const std::string& kind, const Type& type, const std::vector<Value>& coordinates, bool periodic);
  /// At most `count` of them.
  std::vector<Value> lowerArguments(const Call& call, std::size_t count = ~std::size_t{0});
  VariableId componentOf(VariableId triple, int index);

  // lower_spaces.cpp
  Value lowerTransform(const Expression& expression, const Call& call);
  Value lowerTransformUnits(const Expression& expression, const Call& call);
  Value lowerRunTimeUnits(const std::vector<Value>& arguments, Position position);
  Value lowerGetMatrix(const Call& call);
  Value transformBy(VariableId matrix, const Value& value);
  VariableId spaceMatrix(VariableId from, VariableId to);
  Value betweenSpaces(VariableId from, VariableId to, const Value& value);
  Value lowerMatrixConstruct(const Construct& construct);

  // lower_messages.cpp
  Value lowerMessage(const Expression& expression, const Call& call);
  Value lowerConcat(const Expression& expression, const Call& called);
  Value lowerFormat(const Expression& expression, const Call& called);
  VariableId formatted(const Call& called, std::size_t first, VariableId format, Position position);
  std::optional<std::string> expandFormat(const Call& called, std::size_t first, std::string_view format,
                                          std::vector<VariableId>& scalars);
  void scalarsOf(const Value& value, std::vector<VariableId>& scalars);

  // lower_host.cpp
  struct HostUse {
    std::uint32_t outputs = 0;
    std::uint8_t traits = 0;
    bool pure = true;
    bool folds = true;  ///< At once, when all arguments are constants.
  };
  VariableId callHost(const std::string& function, const Type& result, std::vector<VariableId> arguments, HostUse use);
  std::optional<Constant> foldHostCall(const std::string& function, const Type& result,
                                       std::span<const VariableId> arguments) const;
  Value lowerHostCall(const Expression& expression, const Call& called);
  Value lowerGetAttribute(const Expression& expression, const Call& called);
  Value lowerIsConstant(const Expression& expression, const Call& called);
  Value lowerRandom(const Expression& expression, const Call& called);
  void bindUserData(const Parameter& parameter);

  // lower_closure_messages.cpp
  std::optional<std::string> messageName(const Expression& name);
  VariableId closureMessage(const std::string& name);
  Value lowerSetClosureMessage(const Expression& expression, const Call& called);
  Value lowerGetClosureMessage(const Expression& expression, const Call& called);

  // lower_native.cpp
  Value callNative(const FunctionDeclaration& function, const std::vector<Value>& arguments, Position position);

  // lower_textures.cpp
  Value lowerTexture(const Expression& expression, const Call& called);

  // lower_points.cpp
  Value lowerPointQuery(const Expression& expression, const Call& called);

  // lower_closures.cpp
  Value lowerClosure(const Expression& expression, const Call& call);
  Value lowerLayer(const Expression& expression, const Call& call);
  Value makeClosure(ClosureSite site, std::vector<VariableId> arguments, Position position);
  Value makeDeclaredClosure(const FunctionDeclaration& function, const std::vector<Value>& arguments,
                            Position position);

  CheckedSource& source_;
  const SourceMap& sourceMap_;
  Diagnostics& diagnostics_;
  NativeSource* natives_;
  Program program_;
  Code* code_ = nullptr;
  std::unordered_map<const VariableDeclaration*, Value> bindings_;
  std::map<std::string, VariableId> constants_;
  VariableId randomCalls_ = noVariable;                ///< How many random numbers the point has taken.
  std::map<std::string, VariableId> closureMessages_;  ///< By the message's name.
  std::map<Position, std::uint32_t> locations_;
  std::map<std::string, std::uint32_t> functions_;
  /// How temporaries that put triples together were made, for taking them apart again.
  std::unordered_map<VariableId, std::pair<Op, std::vector<VariableId>>> triples_;
  std::unordered_set<VariableId> truths_;  ///< Int temporaries that are 0 or 1.
  std::unordered_set<VariableId> named_;   ///< Temporaries that a name stands for: they may be read again.
  std::vector<Frame> frames_;
  Position position_ = 0;
  std::size_t work_ = 0, frameValues_ = 0;
  std::uint32_t scopeCount_ = 0, layeringCount_ = 0;
  int loopDepth_ = 0, nesting_ = 0, depth_ = 0;
  std::unordered_set<Position> reported_;  ///< Where there is an error already.
  std::unordered_set<Position> remarked_;
  bool namesMayBeUnits_ = false;  ///< Of spaces: those that there are not are no mistake.
  bool inBody_ = false;           ///< Otherwise in the default values of parameters.
  bool failed_ = false;
};

/// Whether a function without a body is one of a native plugin (see native.h).
bool isNative(const FunctionDeclaration& function);
/// Whether evaluating the expression changes a variable or leaves a message.
bool hasEffects(const Expression& expression);
/// Whether evaluating it although its value is not used costs less than a branch, and leaves no report.
bool isCheap(const Expression& expression);

template <class Body>
Code Lowerer::collect(Body&& body) {
  Code code;
  Code* const outer = std::exchange(code_, &code);
  ++nesting_;
  body();
  --nesting_;
  code_ = outer;
  return code;
}

template <class Yes, class No>
void Lowerer::branch(VariableId condition, Yes&& yes, No&& no) {
  if (const auto known = constantOf(condition)) {
    if (known->asInt() != 0) {
      yes();
    } else {
      no();
    }
    return;
  }
  const std::uint32_t location = locationOf(position_);
  std::vector<Code> bodies;
  bodies.push_back(collect(yes));
  bodies.push_back(collect(no));
  Instruction& instruction = append(Op::branch);
  instruction.location = location;
  instruction.arguments = {condition};
  instruction.bodies = std::move(bodies);
}

}  // namespace aerosol::lang
