#include <algorithm>
#include <array>

#include "core/lang/checker.h"
#include "core/lang/overload.h"
#include "core/lang/root_expression.h"

namespace aerosol::lang {

namespace {

/// How deep the checker follows expressions and functions into each other: stack, not time, is what this saves.
constexpr int maximumCheckDepth = 3000;

struct OperatorRow {
  std::string_view text;
  std::string_view overload;
};
constexpr std::array<OperatorRow, 18> binaryOperators = {{
    {"+", "__operator__add__"},
    {"-", "__operator__sub__"},
    {"*", "__operator__mul__"},
    {"/", "__operator__div__"},
    {"%", "__operator__mod__"},
    {"&", "__operator__bitand__"},
    {"|", "__operator__bitor__"},
    {"^", "__operator__xor__"},
    {"<<", "__operator__shl__"},
    {">>", "__operator__shr__"},
    {"<", "__operator__lt__"},
    {"<=", "__operator__le__"},
    {">", "__operator__gt__"},
    {">=", "__operator__ge__"},
    {"==", "__operator__eq__"},
    {"!=", "__operator__neq__"},
    {"&&", ""},
    {"||", ""},
}};
constexpr std::array<OperatorRow, 8> unaryOperators = {{
    {"+", ""},
    {"-", "__operator__neg__"},
    {"!", "__operator__not__"},
    {"~", "__operator__compl__"},
    {"++", ""},
    {"--", ""},
    {"++", ""},
    {"--", ""},
}};

bool isArithmetic(BinaryOp op) {
  return op == BinaryOp::add || op == BinaryOp::subtract || op == BinaryOp::multiply || op == BinaryOp::divide;
}
bool isIntegral(BinaryOp op) { return op >= BinaryOp::modulo && op <= BinaryOp::shiftRight; }
bool isOrder(BinaryOp op) { return op >= BinaryOp::less && op <= BinaryOp::greaterEqual; }
bool isEquality(BinaryOp op) { return op == BinaryOp::equal || op == BinaryOp::notEqual; }

bool isScalarTriple(const Type& type) { return type.isTriple() && !type.isArray(); }
bool isMatrix(const Type& type) { return type == types::matrix; }

/// Kind of the sum, difference, product or quotient of two triples: the difference of two points is a vector, any other
/// sum or difference with a point is a point, everything else is what stands on the left.
Type tripleResult(BinaryOp op, const Type& left, const Type& right) {
  const bool isSum = op == BinaryOp::add || op == BinaryOp::subtract;
  if (!isSum || (!(left == types::point) && !(right == types::point))) return left;
  return op == BinaryOp::subtract && left == right ? types::vector : types::point;
}

bool isWeight(const Type& type) { return type.isNumber() || type == types::color; }

}  // namespace

std::string_view overloadName(BinaryOp op) { return binaryOperators[static_cast<std::size_t>(op)].overload; }
std::string_view overloadName(UnaryOp op) { return unaryOperators[static_cast<std::size_t>(op)].overload; }
std::string_view spelling(BinaryOp op) { return binaryOperators[static_cast<std::size_t>(op)].text; }
std::string_view spelling(UnaryOp op) { return unaryOperators[static_cast<std::size_t>(op)].text; }

Type Checker::check(Expression& expression, const Type& expected) {
  if (!(expression.type == types::none)) return expression.type;
  if (depth_ > maximumCheckDepth) {
    error(expression.position, "expressions and functions are nested too deeply here");
    return expression.type = poisoned;
  }
  ++depth_;
  expression.type = checkNode(expression, expected);
  --depth_;
  return expression.type;
}

Type Checker::checkNode(Expression& expression, const Type& expected) {
  auto& node = expression.node;
  if (std::holds_alternative<IntLiteral>(node)) return types::integer;
  if (std::holds_alternative<FloatLiteral>(node)) return types::floating;
  if (std::holds_alternative<StringLiteral>(node)) return types::string;
  if (auto* name = std::get_if<Name>(&node)) return checkName(expression, *name);
  if (auto* unary = std::get_if<Unary>(&node)) return checkUnary(expression, *unary, expected);
  if (auto* binary = std::get_if<Binary>(&node)) return checkBinary(expression, *binary, expected);
  if (auto* assign = std::get_if<Assign>(&node)) return checkAssign(expression, *assign);
  if (auto* conditional = std::get_if<Conditional>(&node)) return checkConditional(expression, *conditional, expected);
  if (auto* index = std::get_if<Index>(&node)) return checkIndex(expression, *index, false);
  if (auto* field = std::get_if<Field>(&node)) return checkField(expression, *field);
  if (auto* call = std::get_if<Call>(&node)) return checkCall(expression, *call, expected);
  if (auto* construct = std::get_if<Construct>(&node)) return checkConstruct(expression, *construct, expected);
  if (auto* comma = std::get_if<Comma>(&node)) {
    check(*comma->first, types::none);
    return check(*comma->second, expected);
  }
  if (auto* list = std::get_if<InitializerList>(&node)) {
    if (!(expected == types::none) && !isPoisoned(expected)) return checkInitializerList(expression, *list, expected);
    error(expression.position, "the type of this initialiser list cannot be told from where it stands");
  }
  return poisoned;
}

Type Checker::checkName(Expression& expression, Name& name) {
  name.declaration = findVariable(name.name);
  if (!name.declaration) {
    const std::string note = didYouMean(name.name, visibleVariables());
    error(expression.position, "unknown name '" + name.name + "'",
          note.empty() ? std::vector<std::string>{} : std::vector<std::string>{note});
    return poisoned;
  }
  if (name.declaration->isGlobal) {
    static constexpr std::array<std::string_view, 4> surfaceOnly = {"N", "Ng", "dPdu", "dPdv"};
    const auto isSurfaceOnly = std::find(surfaceOnly.begin(), surfaceOnly.end(), name.name) != surfaceOnly.end();
    const bool inVolume = shaderKind_ == "volume", inDisplacement = shaderKind_ == "displacement";
    if ((inVolume && isSurfaceOnly) || (inDisplacement && (name.name == "I" || name.name == "Ci")) ||
        (name.name == "Ps" && (inDisplacement || shaderKind_ == "surface"))) {
      advise(expression.position,
             "the shader global '" + name.name + "' is not available in " + shaderKind_ + " shaders",
             {name.name == "Ci" ? "what it holds is not used" : "renders leave it zero"});
    }
  }
  return name.declaration->type;
}

bool Checker::checkWritable(const Expression& target) {
  const Expression* const root = &rootOf(target);
  const auto* name = std::get_if<Name>(&root->node);
  if (!name) {
    if (!isPoisoned(root->type)) error(target.position, "this expression cannot be assigned to: it is not a variable");
    return false;
  }
  VariableDeclaration* const variable = name->declaration;
  if (!variable) return true;
  variable->isAssigned = true;
  if ((variable->isParameter || variable->isShaderParameter) && !variable->isOutput) {
    const std::string message = "parameter '" + variable->name + "' is written though it is not declared 'output'";
    if (strict_ && variable->isShaderParameter) {
      error(root->position, message, {"assign a copy of it"});
      return false;
    }
    warning(root->position, message,
            {variable->isShaderParameter ? "assign a copy of it" : "a variable passed for it is changed, too"});
  }
  if (!variable->isGlobal || variable->name == "Ci") return true;
  const std::string_view global = variable->name;
  const bool writable = (global == "N" && shaderKind_ != "volume" && shaderKind_ != "shader") ||
                        (global == "P" && shaderKind_ == "displacement");
  // oslc takes P, N and I as written by any shader, and warns of the others.
  if (writable || (!advice_ && (global == "P" || global == "N" || global == "I"))) return true;
  const std::string kind = shaderKind_ == "shader" ? "generic" : shaderKind_;
  warning(root->position,
          "the shader global '" + variable->name + "' is not meant to be written in " + kind + " shaders",
          {"it changes for what follows, and nothing else does"});
  return true;
}

Type Checker::checkUnary(Expression& expression, Unary& unary, const Type& expected) {
  const Type type = check(*unary.operand, expected);
  if (isPoisoned(type)) return poisoned;
  if (!overloadName(unary.op).empty()) {
    Type result;
    unary.function = findOverload(overloadName(unary.op), {unary.operand.get()}, expression.position, expected, result);
    if (unary.function) return result;
  }
  const auto refuse = [&] {
    error(expression.position,
          "operator '" + std::string(spelling(unary.op)) + "' does not apply to type " + toString(type));
    return poisoned;
  };
  switch (unary.op) {
    case UnaryOp::plus:
    case UnaryOp::minus:
      return type.isNumber() || isScalarTriple(type) || isMatrix(type) || type == types::closure ? type : refuse();
    case UnaryOp::logicalNot:
      return isConditional(type) ? types::integer : refuse();
    case UnaryOp::bitNot:
      return type == types::integer ? type : refuse();
    default:
      if (!type.isNumber() && !isScalarTriple(type)) return refuse();
      checkWritable(*unary.operand);
      return type;
  }
}

Type Checker::checkBinary(Expression& expression, Binary& binary, const Type& expected) {
  const Type wanted = isArithmetic(binary.op) ? expected : types::none;
  const Type left = check(*binary.left, wanted);
  const Type right = check(*binary.right, wanted);
  if (isPoisoned(left) || isPoisoned(right)) return poisoned;
  const std::vector<Expression*> operands = {binary.left.get(), binary.right.get()};
  const std::string_view otherName = binary.op == BinaryOp::notEqual ? "__operator__ne__" : "";
  for (const std::string_view name : {overloadName(binary.op), otherName}) {
    if (name.empty()) continue;
    Type result;
    binary.function = findOverload(name, operands, expression.position, expected, result);
    if (binary.function) return result;
  }
  return binaryType(expression.position, binary.op, *binary.left, left, right);
}

Type Checker::binaryType(Position position, BinaryOp op, const Expression&, const Type& left, const Type& right) {
  const bool arrays = left.isArray() || right.isArray();
  if (!arrays && isArithmetic(op)) {
    if (left.isNumber() && right.isNumber())
      return left == types::integer && right == types::integer ? types::integer : types::floating;
    if (left.isTriple() && right.isTriple()) return tripleResult(op, left, right);
    if (left.isTriple() && right.isNumber()) return left;
    if (left.isNumber() && right.isTriple()) return right;
    const bool product = op == BinaryOp::multiply || op == BinaryOp::divide;
    if (product && ((isMatrix(left) && (isMatrix(right) || right.isNumber())) || (left.isNumber() && isMatrix(right))))
      return types::matrix;
    if (op == BinaryOp::add && left == types::closure && right == types::closure) return types::closure;
    const bool weighted = (left == types::closure && isWeight(right)) || (isWeight(left) && right == types::closure);
    if (op == BinaryOp::multiply && weighted) return types::closure;
  }
  if (isIntegral(op) && left == types::integer && right == types::integer) return types::integer;
  if (isOrder(op) && left.isNumber() && right.isNumber()) return types::integer;
  if (!arrays && isEquality(op) && !left.closure && !right.closure && left.base != BaseType::structure) {
    if (left == right && !(left == types::none)) return types::integer;
    const auto isNumeric = [](const Type& type) { return type.isNumber() || type.isTriple() || isMatrix(type); };
    const bool comparable = (left.isNumber() && isNumeric(right)) || (isNumeric(left) && right.isNumber()) ||
                            (left.isTriple() && right.isTriple());
    if (comparable) return types::integer;
  }
  if ((op == BinaryOp::logicalAnd || op == BinaryOp::logicalOr) && isConditional(left) && isConditional(right))
    return types::integer;
  error(position, "operator '" + std::string(spelling(op)) + "' does not apply to types " + toString(left) + " and " +
                      toString(right));
  return poisoned;
}

Type Checker::checkAssign(Expression& expression, Assign& assign) {
  const Type target = check(*assign.target, types::none);
  if (assign.compound) {
    const Type value = check(*assign.value, target);
    if (isPoisoned(target) || isPoisoned(value)) return poisoned;
    checkWritable(*assign.target);
    Type result;
    if (!overloadName(assign.op).empty()) {
      assign.function = findOverload(overloadName(assign.op), {assign.target.get(), assign.value.get()},
                                     expression.position, target, result);
    }
    if (!assign.function) result = binaryType(expression.position, assign.op, *assign.target, target, value);
    if (target == types::integer && result == types::floating) {
      warnOfTruncation(expression.position, "the result of '" + std::string(spelling(assign.op)) + "'");
    } else if (!isPoisoned(result) && !isAssignable(target, result)) {
      error(expression.position, "the result of '" + std::string(spelling(assign.op)) + "', of type " +
                                     toString(result) + ", cannot be assigned to type " + toString(target));
    }
    return target;
  }
  if (isPoisoned(target)) {
    if (!std::holds_alternative<InitializerList>(assign.value->node)) check(*assign.value, types::none);
    return poisoned;
  }
  checkWritable(*assign.target);
  checkInitializer(*assign.value, target, "the value assigned", Truncation::warned);
  return target;
}

Type Checker::checkConditional(Expression& expression, Conditional& conditional, const Type& expected) {
  checkCondition(*conditional.condition, "the condition of '?:'");
  const Type yes = check(*conditional.yes, expected), no = check(*conditional.no, expected);
  if (isPoisoned(yes) || isPoisoned(no)) return poisoned;
  const auto isKnownToOslc = [](const Type& type) { return !type.closure && type.base != BaseType::structure; };
  if (strict_ && !(isKnownToOslc(yes) && isKnownToOslc(no))) {
    error(expression.position, "'?:' chooses between " + toString(yes) + " and " + toString(no) +
                                   ", which other compilers refuse: use 'if'");
    return poisoned;
  }
  if (yes == no && !(yes == types::none) && !(strict_ && yes.isArray())) return yes;
  if (yes.closure && isZeroLiteral(*conditional.no)) return yes;
  if (no.closure && isZeroLiteral(*conditional.yes)) return no;
  if (!yes.isArray() && !no.isArray()) {
    if (isAssignable(no, yes)) return no;  // Of two kinds of triples it is the second one's.
    if (isAssignable(yes, no)) return yes;
  }
  error(expression.position, "the two values of '?:' do not go together: " + toString(yes) + " and " + toString(no));
  return poisoned;
}

Type Checker::checkIndex(Expression& expression, Index& index, bool rowAllowed) {
  Expression& base = *index.base;
  auto* inner = std::get_if<Index>(&base.node);
  Type type = base.type;
  if (type == types::none) type = base.type = inner ? checkIndex(base, *inner, true) : check(base, types::none);
  const Type indexType = check(*index.index, types::integer);
  if (isPoisoned(type) || isPoisoned(indexType)) return poisoned;
  if (!(indexType == types::integer)) {
    error(index.index->position, "an index must be an int, not " + toString(indexType));
    return poisoned;
  }
  int length = 0;
  Type result;
  if (type.isArray()) {
    length = type.arrayLength;
    result = type.element();
  } else if (type == matrixRow) {
    length = 4;
    result = types::floating;
  } else if (type.isTriple()) {
    length = 3;
    result = types::floating;
  } else if (isMatrix(type)) {
    length = 4;
    result = matrixRow;
  } else {
    error(expression.position, "a value of type " + toString(type) + " cannot be indexed");
    return poisoned;
  }
  if (result == matrixRow && !rowAllowed) {
    error(expression.position, "an element of a matrix has two indices: m[row][column]");
    return poisoned;
  }
  const auto constant = evaluateConstant(*index.index);
  if (constant && (constant->asInt() < 0 || (length > 0 && constant->asInt() >= length))) {
    advise(index.index->position,
           "index " + std::to_string(constant->asInt()) +
               " is out of range: " + toString(type.closure ? types::matrix : type) +
               (length > 0 ? " has indices 0 to " + std::to_string(length - 1) : " has no negative indices"),
           {"the nearest index is used"});
  }
  return result;
}

Type Checker::checkField(Expression& expression, Field& field) {
  const Type type = check(*field.base, types::none);
  if (isPoisoned(type)) return poisoned;
  if (isScalarTriple(type)) {
    const bool isColor = type.base == BaseType::color;
    const std::string_view components = !strict_ ? "xyzrgb" : isColor ? "rgb" : "xyz";
    if (field.field.size() == 1 && components.find(field.field[0]) != std::string_view::npos) return types::floating;
    error(expression.position, "a " + toString(type) + " has no component '" + field.field + "'",
          {"the components are .x .y .z or .r .g .b"});
    return poisoned;
  }
  if (type.base != BaseType::structure || type.isArray()) {
    error(expression.position, "a value of type " + toString(type) + " has no fields");
    return poisoned;
  }
  std::vector<std::string> names;
  for (const StructField& known : type.structure->fields) {
    if (known.name == field.field) return known.type;
    names.push_back(known.name);
  }
  const std::string near = didYouMean(field.field, names);
  std::string all = "the fields are:";
  for (const std::string& name : names) all += " " + name;
  error(expression.position, "structure '" + type.structure->name + "' has no field '" + field.field + "'",
        {near.empty() ? all : near});
  return poisoned;
}

}  // namespace aerosol::lang
