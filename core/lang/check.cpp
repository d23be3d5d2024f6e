#include "core/lang/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/lang/checker.h"
#include "core/lang/overload.h"
#include "core/lang/usage.h"

namespace aerosol::lang {

namespace {

struct GlobalRow {
  const char* name;
  Type type;
};
constexpr std::array<GlobalRow, namedGlobalCount> globalRows = {{
    {"P", types::point},
    {"I", types::vector},
    {"N", types::normal},
    {"Ng", types::normal},
    {"u", types::floating},
    {"v", types::floating},
    {"dPdu", types::vector},
    {"dPdv", types::vector},
    {"Ps", types::point},
    {"time", types::floating},
    {"dtime", types::floating},
    {"dPdtime", types::vector},
    {"Ci", types::closure},
}};

/// Functions may differ by what they return alone.
bool sameSignature(const FunctionDeclaration& a, const FunctionDeclaration& b) {
  return a.type == b.type &&
         std::equal(a.parameters.begin(), a.parameters.end(), b.parameters.begin(), b.parameters.end(),
                    [](const auto& x, const auto& y) { return x->type == y->type; });
}

}  // namespace

bool isDeclaredClosure(const FunctionDeclaration& function) {
  return !function.body && function.type == types::closure &&
         std::any_of(function.metadata.begin(), function.metadata.end(),
                     [](const Metadata& entry) { return entry.name == "builtin"; });
}

std::unique_ptr<CheckedSource> check(SourceFile& file, const SourceMap& sourceMap, Diagnostics& diagnostics,
                                     bool advice, bool strict) {
  auto result = Checker(sourceMap, diagnostics, advice, strict).run(file);
  if (!diagnostics.hasErrors()) warnAboutUsage(file, sourceMap, diagnostics, advice);
  return result;
}

std::unique_ptr<CheckedSource> Checker::run(SourceFile& file) {
  result_ = std::make_unique<CheckedSource>();
  scopes_.emplace_back();
  for (const auto& declaration : file.declarations)
    if (const auto* shader = std::get_if<std::unique_ptr<ShaderDeclaration>>(&declaration)) {
      if (result_->shader) {
        error((*shader)->position, "a file holds one shader, this is a second one",
              {fmt::format("the first one is '{}'; functions and structs can be shared by #include",
                           result_->shader->name)});
      } else {
        result_->shader = shader->get();
      }
    }
  shaderKind_ = result_->shader ? result_->shader->kind : "shader";
  declareGlobals();
  for (auto& declaration : file.declarations) {
    if (auto* structure = std::get_if<std::unique_ptr<StructDeclaration>>(&declaration)) checkStruct(**structure);
    if (auto* function = std::get_if<std::unique_ptr<FunctionDeclaration>>(&declaration)) checkFunction(**function);
    if (auto* shader = std::get_if<std::unique_ptr<ShaderDeclaration>>(&declaration)) checkShader(**shader);
  }
  if (!result_->shader) {
    // Where one might have expected it: at the last thing declared.
    Position last = sourceMap_.end();
    for (const auto& declaration : file.declarations) {
      const Position position = std::visit([](const auto& one) { return one->position; }, declaration);
      if (!sourceMap_.isInPrelude(position)) last = position;
    }
    error(last, "there is no shader in this file",
          {"a shader is declared like a function: 'volume name(float parameter = 1) { ... }', with one of the words "
           "surface, volume, displacement, shader"});
  }
  return std::move(result_);
}

void Checker::declareGlobals() {
  for (const GlobalRow& row : globalRows) {
    auto variable = std::make_unique<VariableDeclaration>();
    variable->name = row.name;
    variable->type = row.type;
    variable->isGlobal = true;
    scopes_.front().variables[row.name] = variable.get();
    result_->globals.push_back(std::move(variable));
  }
}

void Checker::checkStruct(StructDeclaration& declaration) {
  auto& structs = scopes_.back().structs;
  if (const auto known = structs.find(declaration.name); known != structs.end()) {
    error(declaration.position, "structure '" + declaration.name + "' is declared twice",
          {"the other one: " + where(known->second.second)});
    return;
  }
  auto structure = std::make_unique<StructType>();
  structure->name = declaration.name;
  for (const auto& field : declaration.fields) {
    field->type = resolveType(field->typeName, resolveLength(*field), nullptr);
    if (isPoisoned(field->type)) continue;
    if (field->type.arrayLength == Type::unsized) error(field->position, "a field's array needs a length");
    for (const StructField& other : structure->fields)
      if (other.name == field->name) error(field->position, "field '" + field->name + "' is declared twice");
    structure->fields.push_back({field->name, field->type});
  }
  std::size_t leaves = 0;
  for (const StructField& field : structure->fields)
    leaves += field.type.structure ? structureLeaves_[field.type.structure] : 1;
  if (leaves > maximumStructureLeaves) {
    error(declaration.position, "structure '" + declaration.name +
                                    "' is too large: with the structures inside of it, more than " +
                                    std::to_string(maximumStructureLeaves) + " fields");
    structure->fields.clear();
    leaves = 1;
  }
  structureLeaves_[structure.get()] = leaves;
  if (declaration.fields.empty()) error(declaration.position, "structure '" + declaration.name + "' has no fields");
  structs[declaration.name] = {structure.get(), declaration.position};
  result_->structs.push_back(std::move(structure));
}

void Checker::checkFunction(FunctionDeclaration& function) {
  function.type = resolveType(function.resultType, function.resultArrayLength, nullptr);
  if (function.type.isArray()) error(function.position, "functions cannot return arrays");
  for (const auto& parameter : function.parameters) {
    parameter->type = resolveType(parameter->typeName, resolveLength(*parameter), nullptr);
    parameter->isParameter = true;
    if (parameter->type == types::none) error(parameter->position, "a parameter cannot be void");
    if (parameter->initializer)
      error(parameter->initializer->position, "parameters of functions have no default values");
  }
  declareFunction(function);
  if (function.body && !sourceMap_.isInPrelude(function.position)) checkBody(function);
}

void Checker::declareFunction(FunctionDeclaration& function) {
  if (strict_ && scopes_.back().variables.contains(function.name))
    error(function.position, "'" + function.name + "' is already declared in this scope as a variable");
  auto& overloads = scopes_.back().functions[function.name];
  const bool isOwn = !sourceMap_.isInPrelude(function.position);
  for (const FunctionDeclaration* other : overloads) {
    if (!sameSignature(*other, function)) continue;
    if (!other->body && function.body) {
      result_->definitions[other] = &function;
    } else if (other->body && function.body && !(sourceMap_.isInPrelude(other->position) && isOwn)) {
      warning(function.position,
              "function '" + function.name + "' is defined twice with the same parameters and result",
              {"the other one: " + where(other->position), "calls behind this one mean this one"});
    }
  }
  // The author's functions stand before those of the standard library, and so replace them.
  overloads.insert(isOwn ? overloads.begin() : overloads.end(), &function);
}

void Checker::checkBody(FunctionDeclaration& function) {
  functionStates_[&function] = State::checking;
  const FunctionDeclaration* const outer = std::exchange(function_, &function);
  const int outerLoops = std::exchange(loopDepth_, 0);
  const bool outerReturn = std::exchange(hasReturn_, false);
  scopes_.emplace_back();
  for (const auto& parameter : function.parameters) {
    if (!scopes_.back().variables.emplace(parameter->name, parameter.get()).second && !parameter->name.empty())
      error(parameter->position, "parameter '" + parameter->name + "' is declared twice");
  }
  auto& block = std::get<Block>(function.body->node);
  for (const StatementPtr& statement : block.statements) checkStatement(*statement);
  scopes_.pop_back();
  loopDepth_ = outerLoops;
  function_ = outer;
  const bool needsReturn = !(function.type == types::none) && !isPoisoned(function.type);
  functionStates_[&function] = needsReturn && !hasReturn_ ? State::withoutReturn : State::done;
  hasReturn_ = outerReturn;
  if (needsReturn && !alwaysReturns(*function.body)) {
    advise(function.position, "function '" + function.name + "' does not return a value on every path",
           {"where it does not, the value is zero"});
  }
}

void Checker::checkShader(ShaderDeclaration& shader) {
  shaderKind_ = shader.kind;
  checkMetadata(shader.metadata);
  scopes_.emplace_back();
  for (const auto& parameter : shader.parameters) checkShaderParameter(*parameter);
  scopes_.emplace_back();
  auto& block = std::get<Block>(shader.body->node);
  for (const StatementPtr& statement : block.statements) checkStatement(*statement);
  scopes_.pop_back();
  scopes_.pop_back();
}

void Checker::checkShaderParameter(VariableDeclaration& parameter) {
  parameter.isShaderParameter = true;
  parameter.type = resolveType(parameter.typeName, resolveLength(parameter), nullptr);
  if (parameter.type == types::none) error(parameter.position, "a parameter cannot be void");
  if (!parameter.initializer) {
    error(parameter.position, "shader parameter '" + parameter.name + "' needs a default value",
          {"write '" + toString(parameter.type) + " " + parameter.name + " = ...'"});
  } else if (!isPoisoned(parameter.type)) {
    parameter.type = checkInitializer(*parameter.initializer, parameter.type, "the default of '" + parameter.name + "'",
                                      Truncation::warned);
  }
  checkMetadata(parameter.metadata);
  if (!scopes_.back().variables.emplace(parameter.name, &parameter).second)
    error(parameter.position, "parameter '" + parameter.name + "' is declared twice");
  if (!strict_) return;
  if (scopes_.front().variables.contains(parameter.name)) {
    error(parameter.position, "parameter '" + parameter.name + "' has the name of a shader global");
  } else if (scopes_.front().functions.contains(parameter.name) || !result_->builtins.find(parameter.name).empty()) {
    warning(parameter.position, "parameter '" + parameter.name + "' has the name of a function");
  }
}

void Checker::checkMetadata(std::vector<Metadata>& metadata) {
  for (Metadata& entry : metadata) {
    Type type = resolveType(entry.type, entry.arrayLength, nullptr);
    if (isPoisoned(type) || !entry.value) continue;
    if (type.closure || type.base == BaseType::structure || type.base == BaseType::none) {
      error(entry.position, "metadata cannot be of type " + toString(type));
      continue;
    }
    const int errors = diagnostics_.errorCount();
    type = checkInitializer(*entry.value, type, "metadata '" + entry.name + "'", Truncation::warned);
    if (strict_ && type == types::integer && entry.value->type == types::floating)
      error(entry.value->position, "metadata '" + entry.name + "' is an int: its value is of type float");
    if (diagnostics_.errorCount() == errors && !evaluateConstant(*entry.value))
      error(entry.value->position, "the value of metadata '" + entry.name + "' must be a constant");
  }
}

int Checker::resolveLength(const VariableDeclaration& declaration) {
  if (!declaration.lengthExpression) {
    if (declaration.arrayLength > maximumArrayLength) {
      error(declaration.position, "array '" + declaration.name +
                                      "' is too long: " + std::to_string(declaration.arrayLength) +
                                      " elements; at most " + std::to_string(maximumArrayLength) + " are allowed");
      return 1;
    }
    return declaration.arrayLength;
  }
  Expression& length = *declaration.lengthExpression;
  const Type type = check(length, types::integer);
  if (isPoisoned(type)) return 1;
  const auto value = evaluateConstant(length);
  if (!value || !(value->type == types::integer)) {
    error(length.position, "the length of array '" + declaration.name + "' must be a constant integer");
    return 1;
  }
  if (value->asInt() < 1 || value->asInt() > maximumArrayLength) {
    error(length.position, "the length of array '" + declaration.name + "' must be from 1 to " +
                               std::to_string(maximumArrayLength) + ", not " + std::to_string(value->asInt()));
    return 1;
  }
  return value->asInt();
}

Type Checker::resolveType(const TypeName& name, int arrayLength, const Expression*) {
  if (name.base == BaseType::structure) {
    const StructType* structure = findStruct(name.structName, name.position);
    if (!structure) {
      std::vector<std::string> names = {"int", "float", "string", "color", "point", "vector", "normal", "matrix"};
      for (const Scope& scope : scopes_)
        for (const auto& [known, unused] : scope.structs) names.push_back(known);
      const std::string note = didYouMean(name.structName, names);
      error(name.position, "unknown type '" + name.structName + "'",
            note.empty() ? std::vector<std::string>{} : std::vector<std::string>{note});
      return poisoned;
    }
    if (arrayLength != Type::scalar) {
      const auto holdsArrays = [](const auto& self, const StructType& type) -> bool {
        return std::any_of(type.fields.begin(), type.fields.end(), [&](const StructField& field) {
          return field.type.isArray() || (field.type.structure && self(self, *field.type.structure));
        });
      };
      if (holdsArrays(holdsArrays, *structure)) {
        error(name.position, "there are no arrays of structures that hold arrays ('" + name.structName + "' does)");
        return poisoned;
      }
    }
    return {BaseType::structure, false, arrayLength, structure};
  }
  if (name.base == BaseType::none && arrayLength != Type::scalar) {
    error(name.position, "there are no arrays of void");
    return poisoned;
  }
  return {name.base, name.closure, arrayLength, nullptr};
}

void Checker::declareVariable(VariableDeclaration& variable) {
  const auto [other, isNew] = scopes_.back().variables.emplace(variable.name, &variable);
  if (!isNew) {
    error(variable.position, "'" + variable.name + "' is declared twice in the same scope",
          {"the other one: " + where(other->second->position)});
    return;
  }
  if (!isTaken(variable)) warnWhenHiding(variable);
}

/// True after an error. The variables of a shader's body stand in the same scope as its parameters, the shader globals
/// and all functions; a function and each inner block have their own.
bool Checker::isTaken(const VariableDeclaration& variable) {
  if (!strict_ || sourceMap_.isInPrelude(variable.position)) return false;
  const auto refuse = [&](Position other) {
    std::vector<std::string> notes;
    if (other != 0) notes.push_back("the other one: " + where(other));
    notes.emplace_back("inside of a block in braces the name may be used again");
    error(variable.position, "'" + variable.name + "' is already declared in this scope", std::move(notes));
    return true;
  };
  const bool isShaderBody = !function_ && scopes_.size() == shaderBodyScopes;
  const std::size_t first = isShaderBody ? 0 : scopes_.size() - 1;
  for (std::size_t i = first; i < scopes_.size(); ++i) {
    const auto other = scopes_[i].variables.find(variable.name);
    if (other != scopes_[i].variables.end() && other->second != &variable) return refuse(other->second->position);
    const auto function = scopes_[i].functions.find(variable.name);
    if (function != scopes_[i].functions.end()) return refuse(function->second.front()->position);
  }
  return isShaderBody && !result_->builtins.find(variable.name).empty() && refuse(0);
}

void Checker::warnWhenHiding(const VariableDeclaration& variable) {
  if (sourceMap_.isInPrelude(variable.position)) return;
  for (std::size_t i = scopes_.size() - 1; i-- > 0;) {
    const auto other = scopes_[i].variables.find(variable.name);
    if (other == scopes_[i].variables.end()) continue;
    if (other->second->isGlobal) {
      if (function_) return;  // A helper's P or u is its own: it was often written for several shaders.
      advise(variable.position, "'" + variable.name + "' hides the shader global of that name");
    } else {
      advise(variable.position, "'" + variable.name + "' hides another variable of that name",
             {"the other one: " + where(other->second->position)});
    }
    return;
  }
}

VariableDeclaration* Checker::findVariable(std::string_view name) const {
  for (std::size_t i = scopes_.size(); i-- > 0;) {
    const auto found = scopes_[i].variables.find(name);
    if (found != scopes_[i].variables.end()) return found->second;
  }
  return nullptr;
}

const StructType* Checker::findStruct(std::string_view name, Position position) const {
  for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope) {
    const auto found = scope->structs.find(name);
    if (found != scope->structs.end() && found->second.second <= position) return found->second.first;
  }
  return nullptr;
}

std::vector<std::string> Checker::visibleVariables() const {
  std::vector<std::string> names;
  for (const Scope& scope : scopes_)
    for (const auto& [name, variable] : scope.variables) names.push_back(name);
  return names;
}

void Checker::error(Position position, std::string message, std::vector<std::string> notes) {
  if (sourceMap_.isInPrelude(position) && libraryCall_ != 0) {
    notes.push_back("in the standard library: " + where(position));
    position = libraryCall_;
  }
  diagnostics_.add(sourceMap_.error(position, std::move(message), std::move(notes)));
}

void Checker::warning(Position position, std::string message, std::vector<std::string> notes) {
  if (sourceMap_.warningsSuppressed(position) || sourceMap_.isInPrelude(position)) return;
  diagnostics_.add(sourceMap_.warning(position, std::move(message), std::move(notes)));
}

std::string Checker::where(Position position) const {
  const SourceLocation location = sourceMap_.location(position);
  return location.file + ":" + std::to_string(location.line) + ":" + std::to_string(location.column);
}

}  // namespace aerosol::lang
