// Calls of pointcloud_search and pointcloud_get. To the host go the fixed arguments (the search's always with the one
// that says whether to sort), then all arrays, which are written, then the names of their attributes.
#include "core/lang/lowerer.h"

namespace aerosol::lang {

Value Lowerer::lowerPointQuery(const Expression& expression, const Call& called) {
  const BuiltinOverload& overload = *called.builtin;
  const auto& arguments = called.arguments;
  std::vector<VariableId> ids, names;
  std::vector<std::pair<Place, VariableId>> copiesBack;
  std::uint32_t outputs = 0;
  const auto lowered = [&](std::size_t i, const Type& type) {
    const Value value = type == types::none || type.isArray() ? lower(*arguments[i]) : lowerTo(*arguments[i], type);
    return protect(value, std::span(arguments).subspan(i + 1)).single();
  };
  std::size_t next = 0;
  for (; next < overload.parameters.size(); ++next) ids.push_back(lowered(next, overload.parameters[next]));
  if (called.name == "pointcloud_search") {
    const bool isGiven = next < arguments.size() && arguments[next]->type == types::integer;
    ids.push_back(isGiven ? lowered(next++, types::integer) : constantInt(0));
  }
  for (; next + 1 < arguments.size(); next += 2) {
    names.push_back(lowered(next, types::string));
    const Place target = place(*arguments[next + 1]);
    VariableId variable = target.leaves[0];
    if (!target.isWhole()) {
      variable = local(target.type, "");
      assign(variable, load(target).single());
      copiesBack.emplace_back(target, variable);
    }
    outputs |= 1u << ids.size();
    ids.push_back(variable);
  }
  ids.insert(ids.end(), names.begin(), names.end());
  position_ = expression.position;
  const VariableId result = callHost(overload.row->symbol, overload.result, std::move(ids), {outputs, 0, true});
  for (const auto& [target, variable] : copiesBack) store(target, {target.type, {variable}});
  return {overload.result, {result}};
}

}  // namespace aerosol::lang
