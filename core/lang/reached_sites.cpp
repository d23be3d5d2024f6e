#include "core/lang/reached_sites.h"

#include <algorithm>
#include <map>
#include <utility>

namespace aerosol::lang {

namespace {

bool isZero(const Variable& variable) {
  const auto* floats = std::get_if<std::vector<float>>(&variable.value);
  return variable.storage == Storage::constant && floats &&
         std::ranges::all_of(*floats, [](float f) { return f == 0; });
}

/// Marks what lies on sites that are marked, where `lies(site, layer)` says that it does.
template <class Lies>
void markAbove(const Program& program, std::vector<bool>& marked, const Lies& lies) {
  std::vector<std::uint32_t> open;
  for (std::uint32_t site = 0; site < marked.size(); ++site)
    if (marked[site]) open.push_back(site);
  while (!open.empty()) {
    const std::uint32_t site = open.back();
    open.pop_back();
    for (const ClosureLayer& layer : program.closureSites[site].layers) {
      if (marked[layer.top] || !lies(site, layer)) continue;
      marked[layer.top] = true;
      open.push_back(layer.top);
    }
  }
}

}  // namespace

std::vector<bool> reachedSites(const Program& program) {
  std::vector<bool> reached(program.closureSites.size(), false);
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> isWeightless;  // By site and parameter.
  for (const Output& output : program.outputs) {
    const bool zero = isZero(program.variables[output.variable]);
    if (output.kind == OutputKind::siteWeight) reached[output.index] = !zero;
    if (output.kind == OutputKind::siteParameter) isWeightless[{output.index, output.subIndex}] = zero;
  }
  markAbove(program, reached, [&](std::uint32_t site, const ClosureLayer& layer) {
    const auto known = isWeightless.find({site, layer.weight});
    return known == isWeightless.end() || !known->second;
  });
  return reached;
}

void dropUnheldSites(Program& program) {
  std::vector<bool> held(program.closureSites.size(), false);
  for (const Output& output : program.outputs)
    if (output.kind == OutputKind::siteWeight) held[output.index] = true;
  markAbove(program, held, [](std::uint32_t, const ClosureLayer&) { return true; });
  std::vector<std::uint32_t> numbers(held.size(), 0);
  std::vector<ClosureSite> kept;
  for (std::size_t site = 0; site < held.size(); ++site) {
    if (!held[site]) continue;
    numbers[site] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(std::move(program.closureSites[site]));
  }
  for (ClosureSite& site : kept)
    for (ClosureLayer& layer : site.layers) layer.top = numbers[layer.top];
  for (Output& output : program.outputs)
    if (output.kind == OutputKind::siteWeight || output.kind == OutputKind::siteParameter)
      output.index = numbers[output.index];
  program.closureSites = std::move(kept);
}

}  // namespace aerosol::lang
