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

std::string signatureOf(const FunctionDeclaration& function) {
  std::string text = toString(function.type) + " " + function.name + "(";
  for (std::size_t i = 0; i < function.parameters.size(); ++i) {
    const VariableDeclaration& parameter = *function.parameters[i];
    text += (i > 0 ? "," : "") + std::string(parameter.isOutput ? "output " : "") + toString(parameter.type);
  }
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
  std::vector<VariableId> ids;
  std::uint32_t outputs = 0;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const VariableDeclaration& formal = *function.parameters[i];
    const bool isPlain = !formal.type.closure && formal.type.base != BaseType::structure;
    if (!isPlain || (formal.type.isArray() && (formal.isOutput || formal.type.arrayLength == Type::unsized))) {
      error(formal.position, "a plugin's function takes no " + std::string(formal.isOutput ? "output " : "") +
                                 "parameter of type " + toString(formal.type));
      return nothing();
    }
    if (formal.isOutput) outputs |= 1u << std::min<std::size_t>(i, 31);
    ids.push_back(arguments[i].single());
  }
  auto found = natives_->find(plugin->value, signatureOf(function), sourceMap_.location(function.position));
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
