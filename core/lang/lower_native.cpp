// Calls of functions of native plugins: a call of the host with the function itself beside its name.
#include <algorithm>

#include "core/lang/lowerer.h"
#include "core/lang/native.h"

namespace aerosol::lang {

namespace {

const Metadata* nativeEntry(const FunctionDeclaration& function) {
  const auto found =
      std::ranges::find_if(function.metadata, [](const Metadata& entry) { return entry.name == "native"; });
  return function.body || found == function.metadata.end() ? nullptr : &*found;
}

/// What one argument is to the plugin: the field of a structure, or the argument itself.
struct NativeArgument {
  VariableId variable = noVariable;
  Type type;
  bool isOutput = false;
};

std::string signatureOf(const FunctionDeclaration& function, const std::vector<NativeArgument>& arguments) {
  std::string text = toString(function.type) + " " + function.name + "(";
  for (std::size_t i = 0; i < arguments.size(); ++i)
    text += (i > 0 ? "," : "") + std::string(arguments[i].isOutput ? "output " : "") + toString(arguments[i].type);
  return text + ")";
}

}  // namespace

bool isNative(const FunctionDeclaration& function) { return nativeEntry(function) != nullptr; }

Value Lowerer::callNative(const FunctionDeclaration& function, const std::vector<Value>& arguments, Position position) {
  const auto nothing = [&] { return function.type == types::none ? Value{types::none, {}} : zeroValue(function.type); };
  const Metadata& entry = *nativeEntry(function);
  const auto* plugin = entry.value ? std::get_if<StringLiteral>(&entry.value->node) : nullptr;
  if (!plugin) {
    error(entry.position, "'native' names a plugin, as a string");
    return nothing();
  }
  if (!natives_) {
    error(entry.position, "plugins cannot be used here");
    return nothing();
  }
  const bool isPlainResult = !function.type.closure && !function.type.isArray();
  if (!isPlainResult || function.type.base == BaseType::structure) {
    error(function.position, "a plugin's function gives no " + toString(function.type));
    return nothing();
  }
  std::vector<NativeArgument> leaves;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const VariableDeclaration& formal = *function.parameters[i];
    std::vector<Leaf> fields;
    flatten(formal.type, fields);
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (fields[k].type.closure) {
        error(formal.position, "a plugin's function takes no parameter of type " + toString(formal.type));
        return nothing();
      }
      leaves.push_back({arguments[i].leaves[k], fields[k].type, formal.isOutput});
    }
  }
  std::vector<VariableId> ids;
  std::uint32_t outputs = 0;
  for (const NativeArgument& leaf : leaves) {
    if (leaf.isOutput && ids.size() >= 32) {
      error(position, "a plugin's function has its outputs among its first 32 arguments");
      return nothing();
    }
    if (leaf.isOutput) outputs |= 1u << ids.size();
    ids.push_back(leaf.variable);
  }
  auto found = natives_->find(plugin->value, signatureOf(function, leaves), sourceMap_.location(function.position));
  if (!found) {
    if (reported_.insert(function.position).second) diagnostics_.append(found.errors());
    failed_ = true;
    return nothing();
  }
  position_ = position;
  const VariableId result =
      callHost((*found)->symbol, function.type, std::move(ids), {.outputs = outputs, .folds = false});
  for (FunctionUse& use : program_.functions)
    if (use.symbol == (*found)->symbol) use.native = *found;
  if (function.type == types::none) return {types::none, {}};
  return {function.type, {result}};
}

}  // namespace aerosol::lang
