#include "core/lang/closure_text.h"

#include <algorithm>

#include "core/lang/closures.h"

namespace aerosol::lang {

namespace {

/// Parameters that a closure has besides its options.
std::size_t positional(const ClosureSite& site) {
  const auto rows = findClosures(site.closure);
  return rows.empty() ? site.parameterTypes.size() : closureParameters(*rows[0]).size();
}

}  // namespace

VariableId ClosureText::of(SiteValues values) {
  VariableId text = writer_.constant(Constant::ofString(""));
  while (const auto layering = outermost(values)) text = layered(text, *layering, values);
  for (const auto& [site, value] : values) text = plain(text, site, value);
  return text;
}

/// A layering whose base does not lie, with its tops, on something else.
std::optional<std::uint32_t> ClosureText::outermost(const SiteValues& values) const {
  std::optional<std::uint32_t> found;
  for (const auto& [site, value] : values) {
    const auto origin = layerings_.origin(site);
    if (!origin) continue;
    const bool isTop = std::ranges::any_of(values, [&](const auto& other) {
      const auto below = layerings_.origin(other.first);
      return below && below->second != origin->second && tops_.at(below->second).contains(site);
    });
    if (!isTop) return origin->second;
    found = origin->second;
  }
  return found;
}

/// What the whole was multiplied by since it was layered: of a top, its weight now over that when it was laid there.
VariableId ClosureText::weightOf(const SiteValue& top, VariableId weightInLayer) {
  if (top.linear[0] == weightInLayer) return writer_.grey(1);
  std::vector<VariableId> ratios;
  for (int i = 0; i < 3; ++i) {
    const VariableId before = writer_.component(weightInLayer, i);
    const VariableId ratio = writer_.emit(Op::divide, types::floating, {writer_.component(top.linear[0], i), before});
    const VariableId none = writer_.emit(Op::equal, types::integer, {before, writer_.number(0)});
    ratios.push_back(writer_.emit(Op::select, types::floating, {none, writer_.number(1), ratio}));
  }
  return writer_.emit(Op::makeTriple, types::color, std::move(ratios));
}

VariableId ClosureText::layered(VariableId text, std::uint32_t layering, SiteValues& values) {
  SiteValues tops, bases;
  VariableId weight = noVariable;
  for (const auto& [site, value] : values)
    if (tops_.at(layering).contains(site)) tops.emplace(site, value);
  for (auto it = values.begin(); it != values.end();) {
    const auto origin = layerings_.origin(it->first);
    if (!origin || origin->second != layering) {
      ++it;
      continue;
    }
    for (const ClosureLayer& layer : writer_.program().closureSites[it->first].layers)
      if (weight == noVariable && tops.contains(layer.top))
        weight = weightOf(tops.at(layer.top), it->second.mean[layer.weight]);
    bases.emplace(origin->first, it->second);
    it = values.erase(it);
  }
  for (const auto& [site, value] : tops) values.erase(site);
  if (weight == noVariable) weight = writer_.grey(1);
  const bool isOne = writer_.isGrey(weight, 1);
  for (auto* group : {&tops, &bases})
    for (auto& [site, value] : *group)
      if (!isOne) value.linear[0] = writer_.emit(Op::divide, types::color, {value.linear[0], weight});
  const VariableId name = writer_.constant(Constant::ofString(layerClosure));
  const VariableId above = of(std::move(tops));
  return added({text, name, weight, above, of(std::move(bases))});
}

VariableId ClosureText::plain(VariableId text, std::uint32_t site, const SiteValue& value) {
  const ClosureSite row = writer_.program().closureSites[site];
  std::vector<VariableId> arguments = {text, writer_.constant(Constant::ofString(row.closure)), value.linear[0]};
  // Behind the parameters are weights of layers. (Volumes have fewer values than parameters.)
  for (std::size_t i = 0; i < std::min(value.mean.size(), row.parameterTypes.size()); ++i) {
    if (std::ranges::any_of(row.layers, [&](const ClosureLayer& layer) { return layer.weight == i; })) continue;
    if (!writer_.program().isVolume() && i >= positional(row))
      arguments.push_back(writer_.constant(Constant::ofString(row.parameterNames[i])));
    arguments.push_back(value.mean[i]);
  }
  return added(std::move(arguments));
}

VariableId ClosureText::added(std::vector<VariableId> arguments) {
  const VariableId text = writer_.add(types::string, Storage::temporary, "");
  writer_.append(Op::call, text, std::move(arguments)).function = function();
  return text;
}

std::uint32_t ClosureText::function() {
  auto& functions = writer_.program().functions;
  for (std::uint32_t i = 0; i < functions.size(); ++i)
    if (functions[i].symbol == "addclosuretext") return i;
  functions.push_back({"addclosuretext", true, 0, true, 0});
  return static_cast<std::uint32_t>(functions.size() - 1);
}

}  // namespace aerosol::lang
