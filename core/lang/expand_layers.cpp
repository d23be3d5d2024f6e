#include "core/lang/expand_layers.h"

#include <string>

namespace aerosol::lang {

namespace {

constexpr std::size_t maximumSites = 4096;

}  // namespace

std::optional<std::uint32_t> Layerings::below(std::uint32_t site, std::uint32_t layering, std::uint32_t location) {
  if (failed_) return std::nullopt;
  if (const auto known = known_.find({site, layering}); known != known_.end()) return known->second;
  for (auto above = origins_.find(site); above != origins_.end(); above = origins_.find(above->second.first)) {
    if (above->second.second != layering) continue;
    report_(location, "this layering is applied to its own result: a closure has a fixed number of layers");
    failed_ = true;
    return std::nullopt;
  }
  if (program_.closureSites.size() >= maximumSites) {
    report_(location, "more than " + std::to_string(maximumSites) + " closures with their layers");
    failed_ = true;
    return std::nullopt;
  }
  const auto made = static_cast<std::uint32_t>(program_.closureSites.size());
  ClosureSite copy = program_.closureSites[site];
  program_.closureSites.push_back(std::move(copy));
  known_[{site, layering}] = made;
  origins_[made] = {site, layering};
  return made;
}

void Layerings::finish(const std::map<std::uint32_t, Sites>& tops) {
  // In the order in which they were made: what one was made from is finished before it.
  for (const auto& [made, origin] : origins_) {
    const auto [site, layering] = origin;
    ClosureSite result = program_.closureSites[site];
    for (ClosureLayer& layer : result.layers) {
      const auto moved = known_.find({layer.top, layering});
      if (moved != known_.end()) layer.top = moved->second;
    }
    for (const std::uint32_t top : tops.at(layering)) {
      result.layers.push_back({top, static_cast<std::uint32_t>(result.parameterTypes.size())});
      result.parameterTypes.push_back(types::color);
      result.parameterNames.push_back("weight of layer " + std::to_string(top));
    }
    program_.closureSites[made] = std::move(result);
  }
}

}  // namespace aerosol::lang
