// Calls of texture functions: to the host goes one fixed list of arguments (see TextureFunction).
#include <array>

#include "core/lang/lowerer.h"
#include "core/lang/texture_options.h"

namespace aerosol::lang {

namespace {

/// Whether the lookup is one at a point, whatever its footprint is: option "width" is the constant 0.
bool isUnfiltered(const Call& called) {
  for (std::size_t i = called.builtin->parameters.size(); i + 1 < called.arguments.size(); i += 2) {
    const auto* name = std::get_if<StringLiteral>(&called.arguments[i]->node);
    if (!name || name->value != "width") continue;
    const auto& value = called.arguments[i + 1]->node;
    const auto* number = std::get_if<FloatLiteral>(&value);
    const auto* whole = std::get_if<IntLiteral>(&value);
    if ((number && number->value == 0) || (whole && whole->value == 0)) return true;
  }
  return false;
}

}  // namespace

Value Lowerer::lowerTexture(const Expression& expression, const Call& called) {
  const BuiltinOverload& overload = *called.builtin;
  const TextureFunction& function = *findTextureFunction(overload.row->name);
  const std::size_t given = overload.parameters.size();
  std::vector<VariableId> ids, options;
  std::vector<std::pair<Place, VariableId>> copiesBack;
  std::uint32_t outputs = 0;
  const auto lowered = [&](std::size_t i, const Type& type) {
    return protect(lowerTo(*called.arguments[i], type), std::span(called.arguments).subspan(i + 1)).single();
  };
  for (std::size_t i = 0; i < given; ++i) ids.push_back(lowered(i, overload.parameters[i]));
  // Derivatives that are not given are those of the coordinates.
  static constexpr std::array<const char*, 3> axes = {"dx", "dy", "dz"};
  for (std::size_t axis = 0; axis < function.derivatives && ids.size() < function.argumentCount(); ++axis) {
    for (std::size_t i = 1; i <= function.coordinates; ++i)
      ids.push_back(isUnfiltered(called) ? constant(zeroConstant(function.type))
                                         : call(axes[axis], function.type, {ids[i]}));
  }
  for (std::size_t i = given; i + 1 < called.arguments.size(); i += 2) {
    const std::string& name = std::get<StringLiteral>(called.arguments[i]->node).value;
    const TextureOption* const known = findTextureOption(name);
    const Type& type = called.arguments[i + 1]->type;
    if (!known || !known->takes(type)) {
      remark(called.arguments[i]->position, "Unknown " + std::string(overload.row->name) + " optional argument: \"" +
                                                name + "\", <" + toString(type) + ">");
      lower(*called.arguments[i + 1]);  // Nothing but its side effects.
      continue;
    }
    const TextureOption& option = *known;
    if (option.isOutput()) {
      const Place target = place(*called.arguments[i + 1]);
      VariableId variable = target.leaves[0];
      if (!target.isWhole()) {
        variable = local(target.type, "");
        copiesBack.emplace_back(target, variable);
      }
      outputs |= 1u << ids.size();
      ids.push_back(variable);
      continue;
    }
    const bool isText = type == types::string;
    options.push_back(constantString(name));
    options.push_back(lowered(i + 1, isText ? types::string : option.type));
  }
  ids.insert(ids.end(), options.begin(), options.end());
  position_ = expression.position;
  const VariableId result = callHost(overload.row->symbol, overload.result, std::move(ids), {outputs, 0, true});
  for (const auto& [target, variable] : copiesBack) store(target, {target.type, {variable}});
  return {overload.result, {result}};
}

}  // namespace aerosol::lang
