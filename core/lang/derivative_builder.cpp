#include "core/lang/derivative_builder.h"

#include <algorithm>

#include "core/lang/analysis.h"
#include "core/lang/builtins.h"
#include "core/lang/fold.h"

namespace aerosol::lang {

namespace {

bool isAffineConstant(const Variable& variable) {
  const auto* floats = std::get_if<std::vector<float>>(&variable.value);
  return variable.storage == Storage::constant && floats && floats->size() == 16 && (*floats)[3] == 0 &&
         (*floats)[7] == 0 && (*floats)[11] == 0 && (*floats)[15] == 1;
}

/// Is it surely none of the spaces that are projections?
bool isAffineSpace(const Variable& name) {
  const auto* texts = std::get_if<std::vector<std::string>>(&name.value);
  if (name.storage != Storage::constant || !texts || texts->size() != 1) return false;
  return texts->front() != "screen" && texts->front() != "NDC" && texts->front() != "raster";
}

/// Matrices that are written by getmatrix alone, or start as affine constants.
std::vector<bool> findAffine(const Program& program) {
  std::vector<bool> isWritten(program.variables.size(), false), isOther(program.variables.size(), false);
  forEachInstruction(program.body, [&](const Instruction& instruction) {
    const bool isSpaces = instruction.op == Op::call &&
                          program.functions[instruction.function].symbol == "getmatrix_i_ssm" &&
                          isAffineSpace(program.variables[instruction.arguments[0]]) &&
                          isAffineSpace(program.variables[instruction.arguments[1]]);
    const bool isCopy = instruction.op == Op::assign && isAffineConstant(program.variables[instruction.arguments[0]]);
    forEachWritten(program, instruction, [&](VariableId id) {
      isWritten[id] = true;
      isOther[id] = isOther[id] || (!isSpaces && !isCopy);
    });
  });
  std::vector<bool> affine(program.variables.size());
  for (VariableId id = 0; id < affine.size(); ++id)
    affine[id] = isAffineConstant(program.variables[id]) || (isWritten[id] && !isOther[id]);
  return affine;
}

}  // namespace

DerivativeBuilder::DerivativeBuilder(Program& program) : program_(program), affine_(findAffine(program)) {
  for (VariableId id = 0; id < program.variables.size(); ++id) {
    const Variable& variable = program.variables[id];
    if (variable.storage == Storage::constant) constants_.emplace(bitsKey({variable.type, variable.value}), id);
  }
  for (std::uint32_t i = 0; i < program.functions.size(); ++i) functions_.emplace(program.functions[i].symbol, i);
}

void DerivativeBuilder::begin(Code& out, std::uint32_t location) {
  out_ = &out;
  location_ = location;
  known_.clear();
}

VariableId DerivativeBuilder::addVariable(Variable variable) {
  variable.location = location_;
  program_.variables.push_back(std::move(variable));
  return static_cast<VariableId>(program_.variables.size() - 1);
}

VariableId DerivativeBuilder::temporary(const Type& type) {
  Variable variable;
  variable.type = type;
  variable.storage = Storage::temporary;
  return addVariable(std::move(variable));
}

VariableId DerivativeBuilder::constant(const Type& type, const ConstantValue& value) {
  const auto [known, isNew] = constants_.emplace(bitsKey({type, value}), zero);
  if (isNew) {
    Variable variable;
    variable.type = type;
    variable.storage = Storage::constant;
    variable.value = value;
    known->second = addVariable(std::move(variable));
  }
  return known->second;
}

VariableId DerivativeBuilder::number(float value) { return constant(types::floating, std::vector<float>{value}); }

VariableId DerivativeBuilder::integer(std::int32_t value) {
  return constant(types::integer, std::vector<std::int32_t>{value});
}

bool DerivativeBuilder::isConstant(VariableId id) const { return program_.variables[id].storage == Storage::constant; }

bool DerivativeBuilder::isAffine(VariableId matrix) const { return matrix < affine_.size() && affine_[matrix]; }

bool DerivativeBuilder::isNumber(VariableId id, float value) const {
  const auto* floats = std::get_if<std::vector<float>>(&program_.variables[id].value);
  return isConstant(id) && floats && floats->size() == 1 && (*floats)[0] == value;
}

std::uint32_t DerivativeBuilder::function(const std::string& symbol, std::uint32_t outputs) {
  const auto [known, isNew] = functions_.emplace(symbol, static_cast<std::uint32_t>(program_.functions.size()));
  if (isNew) program_.functions.push_back({symbol, true, outputs});
  return known->second;
}

std::uint32_t DerivativeBuilder::hostFunction(const std::string& symbol, std::uint32_t outputs, std::uint8_t traits) {
  const auto [known, isNew] =
      functions_.emplace("host " + symbol, static_cast<std::uint32_t>(program_.functions.size()));
  if (isNew) program_.functions.push_back({symbol, true, outputs, true, traits});
  return known->second;
}

Instruction& DerivativeBuilder::append(Op op) {
  Instruction instruction;
  instruction.op = op;
  instruction.location = location_;
  instruction.quiet = true;
  out_->push_back(std::move(instruction));
  return out_->back();
}

VariableId DerivativeBuilder::emit(Op op, const Type& type, std::vector<VariableId> arguments) {
  const std::pair key(std::string(1, static_cast<char>('A' + static_cast<int>(op))), arguments);
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  const VariableId result = temporary(type);
  Instruction& instruction = append(op);
  instruction.result = result;
  instruction.arguments = std::move(arguments);
  return known_[key] = result;
}

VariableId DerivativeBuilder::call(std::string_view base, const Type& result, std::vector<VariableId> arguments) {
  std::vector<Type> types;
  for (const VariableId argument : arguments) types.push_back(typeOf(argument));
  const std::string symbol = symbolOf(base, result, types);
  const std::pair key(symbol, arguments);
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  const VariableId target = temporary(result);
  Instruction& instruction = append(Op::call);
  instruction.function = function(symbol, 0);
  instruction.result = target;
  instruction.arguments = std::move(arguments);
  return known_[key] = target;
}

VariableId DerivativeBuilder::call(std::string_view base, VariableId x) { return call(base, types::floating, {x}); }

/// Of an operation on both: a matrix, a triple, or a float.
Type DerivativeBuilder::common(VariableId a, VariableId b) const {
  const auto rank = [](const Type& type) { return type == types::matrix ? 2 : type.isTriple() ? 1 : 0; };
  return rank(typeOf(a)) >= rank(typeOf(b)) ? typeOf(a) : typeOf(b);
}

VariableId DerivativeBuilder::add(VariableId a, VariableId b) {
  if (a == zero) return b;
  return b == zero ? a : emit(Op::add, common(a, b), {a, b});
}

VariableId DerivativeBuilder::subtract(VariableId a, VariableId b) {
  if (b == zero) return a;
  return a == zero ? negate(b) : emit(Op::subtract, common(a, b), {a, b});
}

VariableId DerivativeBuilder::multiply(VariableId a, VariableId b) {
  if (a == zero || b == zero || isNumber(a, 0) || isNumber(b, 0)) return zero;
  if (isNumber(a, 1)) return b;
  return isNumber(b, 1) ? a : emit(Op::multiply, common(a, b), {a, b});
}

VariableId DerivativeBuilder::divide(VariableId a, VariableId b) {
  if (a == zero) return zero;
  return isNumber(b, 1) ? a : emit(Op::divide, common(a, b), {a, b});
}

VariableId DerivativeBuilder::negate(VariableId a) { return a == zero ? zero : emit(Op::negate, typeOf(a), {a}); }

VariableId DerivativeBuilder::compare(Op op, VariableId a, VariableId b) { return emit(op, types::integer, {a, b}); }

VariableId DerivativeBuilder::select(VariableId condition, VariableId yes, VariableId no) {
  if (yes == no) return yes;
  const Type type = yes == zero ? typeOf(no) : no == zero ? typeOf(yes) : common(yes, no);
  return emit(Op::select, type, {condition, as(type, yes), as(type, no)});
}

VariableId DerivativeBuilder::component(VariableId triple, int index) {
  return triple == zero ? zero : emit(Op::component, types::floating, {triple, integer(index)});
}

VariableId DerivativeBuilder::triple(VariableId x, VariableId y, VariableId z) {
  if (x == zero && y == zero && z == zero) return zero;
  return emit(Op::makeTriple, types::vector, {as(types::floating, x), as(types::floating, y), as(types::floating, z)});
}

VariableId DerivativeBuilder::matrixElement(VariableId matrix, int row, int column) {
  if (matrix == zero) return zero;
  return emit(Op::matrixElement, types::floating, {matrix, integer(row), integer(column)});
}

VariableId DerivativeBuilder::as(const Type& type, VariableId value) {
  if (value == zero) return constant(type, zeroConstant(type).value);
  const Type& from = typeOf(value);
  if (from.isArray() || from.base != BaseType::floating || type.base == BaseType::floating) return value;
  return emit(type == types::matrix ? Op::toMatrix : Op::toTriple, type, {value});
}

}  // namespace aerosol::lang
