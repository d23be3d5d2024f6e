#include "core/lang/lower.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "core/lang/lowerer.h"

namespace aerosol::lang {

namespace {

bool givesTruth(Op op) {
  return op == Op::toBool || op == Op::logicalNot || op == Op::logicalAnd || op == Op::logicalOr ||
         (op >= Op::less && op <= Op::notEqual);
}

}  // namespace

std::optional<LoweredShader> lower(CheckedSource& source, const SourceMap& sourceMap, Diagnostics& diagnostics,
                                   NativeSource* natives) {
  const int errors = diagnostics.errorCount();
  Lowerer lowerer(source, sourceMap, diagnostics, natives);
  LoweredShader shader;
  shader.layer = lowerer.run();
  if (diagnostics.errorCount() == errors) {
    shader.program = complete(shader.layer, [&](std::uint32_t location, std::string message) {
      diagnostics.add(sourceMap.error(lowerer.positionOf(location), std::move(message)));
    });
  }
  if (diagnostics.errorCount() != errors) return std::nullopt;
  return shader;
}

void flatten(const Type& type, std::vector<Leaf>& leaves, const std::string& suffix) {
  if (type.base != BaseType::structure) {
    leaves.push_back({type, suffix});
    return;
  }
  for (const StructField& field : type.structure->fields) {
    const Type inner = type.isArray() ? field.type.arrayOf(type.arrayLength) : field.type;
    flatten(inner, leaves, suffix + "." + field.name);
  }
}

Program Lowerer::run() {
  const ShaderDeclaration& shader = *source_.shader;
  program_.kind = shader.kind;
  program_.name = shader.name;
  program_.metadata = lowerMetadata(shader.metadata);
  code_ = &program_.body;
  position_ = shader.position;
  locationOf(position_);
  for (std::size_t i = 0; i < source_.globals.size(); ++i) {
    const VariableDeclaration& global = *source_.globals[i];
    Variable variable;
    variable.name = global.name;
    variable.type = global.type;
    variable.storage = Storage::global;
    variable.global = static_cast<Global>(i);
    bind(global, {global.type, {addVariable(std::move(variable))}});
  }
  program_.ci = bindings_[source_.globals.back().get()].single();
  frames_.emplace_back();
  frames_.back().scopeId = scopeCount_++;
  lowerParameters();
  lowerBody();
  for (std::size_t i = 0; i < program_.parameters.size(); ++i) {
    const Parameter& parameter = program_.parameters[i];
    if (parameter.isOutput && !parameter.type.closure)
      program_.outputs.push_back({OutputKind::parameter, static_cast<std::uint32_t>(i), 0, parameter.variable});
  }
  if (program_.kind == "displacement") {
    for (const Global global : displacedGlobals) {
      const VariableDeclaration& declaration = *source_.globals[static_cast<std::size_t>(global)];
      program_.outputs.push_back(displacedOutput(global, bindings_[&declaration].single()));
    }
  }
  return std::move(program_);
}

void Lowerer::lowerBody() {
  inBody_ = true;
  const auto& block = std::get<Block>(source_.shader->body->node);
  Code body = collect([&] { lowerStatements(block.statements, 0, Tail::function); });
  if (!frames_.front().usesLeave) {
    std::move(body.begin(), body.end(), std::back_inserter(*code_));
    return;
  }
  position_ = source_.shader->position;
  Instruction& scope = append(Op::scope);
  scope.scopeId = frames_.front().scopeId;
  scope.bodies.push_back(std::move(body));
}

void Lowerer::lowerParameters() {
  for (const auto& parameter : source_.shader->parameters) lowerParameter(*parameter);
}

void Lowerer::lowerParameter(const VariableDeclaration& declaration) {
  position_ = declaration.position;
  Value initial;
  Code code = collect([&] { initial = lowerTo(*declaration.initializer, declaration.type); });
  std::vector<Leaf> leaves;
  flatten(declaration.type, leaves);
  Value value{declaration.type, {}};
  std::vector<std::pair<VariableId, VariableId>> defaults;  // isSet, value
  std::vector<VariableId> targets;
  const std::size_t firstParameter = program_.parameters.size();
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const Type& type = leaves[i].type;
    const auto index = static_cast<std::uint32_t>(program_.parameters.size());
    Variable variable;
    variable.name = declaration.name + leaves[i].suffix;
    variable.type = type;
    variable.storage = Storage::parameter;
    variable.parameter = index;
    Parameter parameter;
    parameter.name = variable.name;
    parameter.type = type;
    parameter.isOutput = declaration.isOutput;
    parameter.location = sourceMap_.location(declaration.position);
    parameter.metadata = lowerMetadata(declaration.metadata);
    parameter.variable = addVariable(variable);
    value.leaves.push_back(parameter.variable);
    if (auto known = constantOf(initial.leaves[i])) {
      parameter.defaultValue = std::move(known->value);
    } else {
      parameter.hasConstantDefault = false;
      variable.name += " is set";
      variable.type = types::integer;
      parameter.isSet = addVariable(variable);
      defaults.emplace_back(parameter.isSet, initial.leaves[i]);
      targets.push_back(parameter.variable);
    }
    program_.parameters.push_back(std::move(parameter));
  }
  bind(declaration, value);
  const bool guardsAll = defaults.size() == 1 && defaults[0].first != noVariable;
  if (!guardsAll) std::move(code.begin(), code.end(), std::back_inserter(*code_));
  for (std::size_t i = 0; i < defaults.size(); ++i) {
    const auto set = [&] {
      if (guardsAll) std::move(code.begin(), code.end(), std::back_inserter(*code_));
      assign(targets[i], defaults[i].second);
    };
    if (defaults[i].first == noVariable) {
      set();
    } else {
      branch(defaults[i].first, [] {}, set);
    }
  }
  for (std::size_t i = firstParameter; i < program_.parameters.size(); ++i) bindUserData(program_.parameters[i]);
}

std::vector<MetadataValue> Lowerer::lowerMetadata(const std::vector<Metadata>& metadata) {
  std::vector<MetadataValue> values;
  for (const Metadata& entry : metadata) {
    auto value = evaluateConstant(*entry.value);
    const Type type{entry.type.base, false, value->type.arrayLength, nullptr};
    if (!(value->type == type))
      if (auto converted = convertConstant(*value, type)) value = std::move(converted);
    values.push_back({entry.name, type, std::move(value->value)});
  }
  return values;
}

VariableId Lowerer::addVariable(Variable variable) {
  variable.location = locationOf(position_);
  frameValues_ += leafCount(variable.type);
  if (frameValues_ > maximumFrameValues) {
    stop(position_, "the variables of this shader take too much room: more than " + std::to_string(maximumFrameValues) +
                        " values, with all functions inlined");
  }
  program_.variables.push_back(std::move(variable));
  return static_cast<VariableId>(program_.variables.size() - 1);
}

VariableId Lowerer::temporary(const Type& type) {
  Variable variable;
  variable.type = type;
  variable.storage = Storage::temporary;
  return addVariable(std::move(variable));
}

VariableId Lowerer::local(const Type& type, std::string name) {
  Variable variable;
  variable.name = std::move(name);
  variable.type = type;
  variable.storage = Storage::local;
  return addVariable(std::move(variable));
}

Value Lowerer::localValue(const Type& type, const std::string& name) {
  std::vector<Leaf> leaves;
  flatten(type, leaves);
  Value value{type, {}};
  for (const Leaf& leaf : leaves) value.leaves.push_back(local(leaf.type, name + leaf.suffix));
  return value;
}

VariableId Lowerer::constant(const Constant& value) {
  const auto [known, isNew] = constants_.emplace(bitsKey(value), noVariable);
  if (isNew) {
    Variable variable;
    variable.type = value.type;
    variable.storage = Storage::constant;
    variable.value = value.value;
    known->second = addVariable(std::move(variable));
  }
  return known->second;
}

/// Gives values without a name this one: reports of indices out of range say it. Constants are shared, so that they
/// become ones of their own.
void Lowerer::nameValue(Value& value, const std::string& name) {
  std::vector<Leaf> leaves;
  flatten(value.type, leaves);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    Variable& known = program_.variables[value.leaves[i]];
    if (!known.name.empty()) continue;
    if (known.storage != Storage::constant) {
      known.name = name + leaves[i].suffix;
      continue;
    }
    Variable variable = known;
    variable.name = name + leaves[i].suffix;
    value.leaves[i] = addVariable(std::move(variable));
  }
}

Value Lowerer::zeroValue(const Type& type) {
  std::vector<Leaf> leaves;
  flatten(type, leaves);
  Value value{type, {}};
  for (const Leaf& leaf : leaves) value.leaves.push_back(constant(zeroConstant(leaf.type)));
  return value;
}

std::optional<Constant> Lowerer::constantOf(VariableId id) const {
  const Variable& variable = program_.variables[id];
  if (variable.storage != Storage::constant) return std::nullopt;
  return Constant{variable.type, variable.value};
}

bool Lowerer::isConstantValue(const Value& value) const {
  return std::all_of(value.leaves.begin(), value.leaves.end(),
                     [&](VariableId leaf) { return program_.variables[leaf].storage == Storage::constant; });
}

bool Lowerer::isMutable(VariableId variable) const {
  const Storage storage = program_.variables[variable].storage;
  return storage != Storage::constant && storage != Storage::temporary;
}

VariableId Lowerer::emit(Op op, const Type& type, std::initializer_list<VariableId> arguments) {
  return emit(op, type, std::vector<VariableId>(arguments));
}

VariableId Lowerer::emit(Op op, const Type& type, std::vector<VariableId> arguments) {
  if (!countWork(position_)) return constant(zeroConstant(type));
  if (const auto simple = simplify(op, type, arguments)) return *simple;
  const VariableId result = temporary(type);
  if (op == Op::makeTriple || op == Op::toTriple) triples_[result] = {op, arguments};
  if (givesTruth(op)) truths_.insert(result);
  Instruction& instruction = append(op);
  instruction.result = result;
  instruction.arguments = std::move(arguments);
  return result;
}

std::optional<VariableId> Lowerer::simplify(Op op, const Type& type, std::span<const VariableId> arguments) {
  if (op == Op::select) {
    if (const auto known = constantOf(arguments[0])) return known->asInt() != 0 ? arguments[1] : arguments[2];
  }
  if (op == Op::toBool && truths_.contains(arguments[0])) return arguments[0];
  if (op == Op::component) {
    const auto made = triples_.find(arguments[0]);
    const auto index = constantOf(arguments[1]);
    if (made != triples_.end() && index)
      return made->second.first == Op::toTriple ? made->second.second[0]
                                                : made->second.second[static_cast<std::size_t>(index->asInt())];
  }
  if (type.closure) return std::nullopt;
  std::vector<Constant> values;
  for (const VariableId argument : arguments) {
    auto value = constantOf(argument);
    if (!value) return std::nullopt;
    values.push_back(std::move(*value));
  }
  std::vector<const Constant*> pointers;
  for (const Constant& value : values) pointers.push_back(&value);
  if (auto folded = foldOperation(op, type, pointers)) return constant(*folded);
  return std::nullopt;
}

Instruction& Lowerer::append(Op op) {
  Instruction instruction;
  instruction.op = op;
  instruction.location = locationOf(position_);
  code_->push_back(std::move(instruction));
  return code_->back();
}

VariableId Lowerer::call(const std::string& base, const Type& result, std::vector<VariableId> arguments,
                         std::uint32_t outputs, bool pure) {
  std::vector<Type> types;
  for (const VariableId argument : arguments) types.push_back(typeOf(argument));
  const std::string symbol = symbolOf(base, result, types);
  if (!countWork(position_)) return constant(zeroConstant(result));
  const auto [known, isNew] = functions_.emplace(symbol, static_cast<std::uint32_t>(program_.functions.size()));
  if (isNew) program_.functions.push_back({symbol, pure, outputs});
  const VariableId target = result == types::none ? noVariable : temporary(result);
  Instruction& instruction = append(Op::call);
  instruction.function = known->second;
  instruction.result = target;
  instruction.arguments = std::move(arguments);
  return target;
}

void Lowerer::assign(VariableId target, VariableId value) {
  if (target == value || failed_) return;
  const Type& to = typeOf(target);
  const Type& from = typeOf(value);
  if (to.isArray() && from.isArray() && to.arrayLength != from.arrayLength) {
    copyPrefix(target, value);
    return;
  }
  // The instruction that has just made the value can write the target at once: no one else has seen the temporary.
  if (!code_->empty() && program_.variables[value].storage == Storage::temporary && !named_.contains(value)) {
    Instruction& last = code_->back();
    const bool readsTarget = std::find(last.arguments.begin(), last.arguments.end(), target) != last.arguments.end();
    const bool isSimple = last.op != Op::call || !readsTarget;
    if (last.result == value && last.bodies.empty() && isSimple && !(to.isArray() && readsTarget)) {
      last.result = target;
      return;
    }
  }
  Instruction& instruction = append(Op::assign);
  instruction.result = target;
  instruction.arguments = {value};
  countWork(position_);
}

void Lowerer::assign(const Value& target, const Value& given) {
  // `s = S(s.b, s.a)`: what is read from the target must be read before it is written.
  bool overlaps = false;
  for (std::size_t i = 0; i < given.leaves.size(); ++i)
    for (std::size_t j = 0; j < target.leaves.size(); ++j)
      overlaps = overlaps || (i != j && given.leaves[i] == target.leaves[j]);
  const Value value = overlaps ? copied(given) : given;
  // Leaf by leaf from the last one, so that the newest temporary is still at the end of the code.
  for (std::size_t i = target.leaves.size(); i-- > 0;) assign(target.leaves[i], value.leaves[i]);
}

void Lowerer::bind(const VariableDeclaration& declaration, Value value) {
  named_.insert(value.leaves.begin(), value.leaves.end());
  bindings_[&declaration] = std::move(value);
}

void Lowerer::copyPrefix(VariableId target, VariableId source) {
  const Type element = typeOf(target).element();
  const VariableId counter = local(types::integer, "");
  const VariableId length = constantInt(std::min(typeOf(target).arrayLength, typeOf(source).arrayLength));
  assign(counter, constantInt(0));
  VariableId condition = noVariable;
  std::vector<Code> bodies;
  bodies.push_back(collect([&] { condition = emit(Op::less, types::integer, {counter, length}); }));
  bodies.push_back(collect([&] {
    const VariableId value = emit(Op::element, element, {source, counter});
    Instruction& set = append(Op::setElement);
    set.result = target;
    set.arguments = {counter, value};
  }));
  bodies.push_back(collect([&] { assign(counter, emit(Op::add, types::integer, {counter, constantInt(1)})); }));
  Instruction& loop = append(Op::loop);
  loop.arguments = {condition};
  loop.bodies = std::move(bodies);
}

std::uint32_t Lowerer::locationOf(Position position) {
  const auto [known, isNew] = locations_.emplace(position, static_cast<std::uint32_t>(program_.locations.size()));
  if (isNew) program_.locations.push_back(sourceMap_.location(position));
  return known->second;
}

Position Lowerer::positionOf(std::uint32_t location) const {
  for (const auto& [position, known] : locations_)
    if (known == location) return position;
  return 0;
}

/// What an OSL renderer would say of a call that is no error here.
void Lowerer::remark(Position position, std::string message) {
  if (remarked_.insert(position).second)
    diagnostics_.add({Severity::note, sourceMap_.location(position), std::move(message), {}, {}});
}

void Lowerer::error(Position position, std::string message, std::vector<std::string> notes) {
  // What is wrong within the standard library is wrong with the call.
  for (std::size_t i = frames_.size(); i-- > 1 && sourceMap_.isInPrelude(position);) position = frames_[i].call;
  // A function that is inlined twice has its errors once.
  if (!reported_.insert(position).second) return;
  if (frames_.size() > 1 && position != frames_[1].call) {
    const SourceLocation call = sourceMap_.location(frames_[1].call);
    notes.push_back("in the call of '" + frames_[1].function->name + "' at " + call.file + ":" +
                    std::to_string(call.line) + ":" + std::to_string(call.column));
  }
  diagnostics_.add(sourceMap_.error(position, std::move(message), std::move(notes)));
}

void Lowerer::stop(Position position, std::string message) {
  if (!failed_) error(position, std::move(message));
  failed_ = true;
}

bool Lowerer::countWork(Position position) {
  if (failed_) return false;
  if (++work_ <= maximumInstructions) return true;
  stop(position, "the shader is too large: more than " + std::to_string(maximumInstructions) +
                     " instructions with all functions inlined");
  return false;
}

}  // namespace aerosol::lang
