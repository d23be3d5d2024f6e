#include "core/render/light_set.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace aerosol::render {

namespace {

constexpr double equalShare = 0.1;

}  // namespace

LightSet::LightSet(std::vector<std::unique_ptr<const Light>> lights, float sceneRadius, bool samplesAll)
    : lights_(std::make_move_iterator(lights.begin()), std::make_move_iterator(lights.end())), samplesAll_(samplesAll) {
  if (gather(sceneRadius) > few) plantTree();
  findOnly();
}

LightSet::LightSet(const LightSet& all, const std::vector<bool>& chosen, float sceneRadius)
    : lights_(all.lights_), chosen_(chosen), samplesAll_(all.samplesAll_) {
  // Whether lights are chosen in parts must not differ: densities of both sets are compared.
  if (gather(sceneRadius) > 0 && !all.tree_.isEmpty()) plantTree();
  findOnly();
}

std::size_t LightSet::gather(float sceneRadius) {
  std::size_t parts = 0;
  for (std::uint32_t i = 0; i < lights_.size(); ++i) {
    if (!contains(i)) continue;
    if (lights_[i]->isInfinite() && !lights_[i]->isDelta()) infinite_.push_back(i);
    const bool isFound = !samplesAll_ && !lights_[i]->isSampled();
    hasFound_ = hasFound_ || isFound;
    if (isFound || !(maximum(abs(lights_[i]->power(sceneRadius))) > 0)) continue;
    single_.push_back(i);
    if (lights_[i]->isVolume()) volumes_.push_back(i);
    if (const auto place = lights_[i]->place()) {
      placed_.push_back({i, *place});
      parts += lights_[i]->partCount();
    }
  }
  return parts;
}

void LightSet::findOnly() {
  if (single_.size() == 1 && !hasTree()) only_ = single_[0];
}

void LightSet::plantTree() {
  std::vector<LightBounds> bounds;
  firstEntries_.resize(lights_.size());
  for (const PlacedLight& placed : placed_) {
    const Light& light = *lights_[placed.index];
    firstEntries_[placed.index] = static_cast<std::uint32_t>(entries_.size());
    for (std::uint32_t part = 0; part < light.partCount(); ++part) {
      entries_.push_back({placed.index, part});
      bounds.push_back(light.partBounds(part).value_or(LightBounds{}));
    }
  }
  tree_ = LightTree(bounds);
  std::erase_if(single_, [&](std::uint32_t i) { return placeOf(LightId{i}).has_value(); });
}

std::optional<LightPlace> LightSet::placeOf(LightId id) const {
  const auto found = std::lower_bound(placed_.begin(), placed_.end(), id.light,
                                      [](const PlacedLight& light, std::uint32_t i) { return light.index < i; });
  if (found == placed_.end() || found->index != id.light) return {};
  if (id.part == LightId::whole || lights_[id.light]->partCount() == 1) return found->place;
  const LightBounds bounds = lights_[id.light]->partBounds(id.part).value_or(LightBounds{});
  return LightPlace{.centre = bounds.centre(), .extent = bounds.halfDiagonal(), .intensity = bounds.intensity / 4};
}

LightId LightSet::idOf(std::uint32_t light, const LightHit& hit) const {
  if (!hasTree() || !placeOf(LightId{light})) return {light};
  return {light, lights_[light]->partAt(hit)};
}

double LightSet::importance(std::size_t candidate, Point<World> from) const {
  return static_cast<double>(candidate < single_.size() ? lights_[single_[candidate]]->importance(from)
                                                        : PointQuery{from}(tree_.whole()));
}

double LightSet::probabilityOf(std::size_t candidate, Point<World> from) const {
  const std::size_t count = candidateCount();
  if (count == 1) return 1;
  double total = 0;
  for (std::size_t i = 0; i < count; ++i) total += importance(i, from);
  const double equal = 1 / static_cast<double>(count);
  return total > 0 ? (1 - equalShare) * importance(candidate, from) / total + equalShare * equal : equal;
}

LightSet::Picks LightSet::pickAmongSeveral(Point<World> from, float u, float splitThreshold) const {
  Picks picks;
  const std::size_t count = candidateCount();
  if (count == 0) return picks;
  double total = 0;
  for (std::size_t i = 0; count > 1 && i < count; ++i) total += importance(i, from);
  const double equal = 1 / static_cast<double>(count);
  auto rest = static_cast<double>(u);
  std::size_t chosen = 0;
  for (; count > 1; ++chosen) {
    picks.probability = total > 0 ? (1 - equalShare) * importance(chosen, from) / total + equalShare * equal : equal;
    // Rounding may leave something behind the last light: it stays chosen.
    if (rest < picks.probability || chosen + 1 == count) break;
    rest -= picks.probability;
  }
  picks.rest = std::min(static_cast<float>(rest / picks.probability), belowOne);
  picks.isTree = hasTree() && chosen >= single_.size();
  if (picks.isTree) {
    picks.cut = tree_.cut(PointQuery{from}, splitThreshold);
    picks.count = picks.cut.count;
  } else {
    picks.single = single_[chosen];
    picks.count = 1;
  }
  return picks;
}

std::optional<LightSet::Choice> LightSet::choose(const Picks& picks, std::size_t index, Point<World> from) const {
  if (!picks.isTree) return Choice{picks.single, static_cast<float>(picks.probability)};
  // One number serves all clusters, turned by the golden ratio: each of them is sampled evenly.
  const float turned = picks.rest + 0.618034f * static_cast<float>(index);
  const auto entry =
      tree_.chooseBelow(PointQuery{from}, picks.cut.nodes[index], std::min(turned - std::floor(turned), belowOne));
  if (!entry) return {};
  const LightId id = entries_[entry->entry];
  return Choice{id.light, static_cast<float>(picks.probability) * entry->probability, id.part};
}

float LightSet::probabilityAmongSeveral(LightId id, Point<World> from, float splitThreshold) const {
  if (hasTree() && id.part != LightId::whole) {
    const PointQuery query{from};
    return static_cast<float>(probabilityOf(single_.size(), from)) *
           tree_.probability(query, entryOf(id), tree_.cut(query, splitThreshold));
  }
  const auto found = std::find(single_.begin(), single_.end(), id.light);
  if (found == single_.end()) return 0;
  return static_cast<float>(probabilityOf(static_cast<std::size_t>(found - single_.begin()), from));
}

std::optional<LightSample> LightSet::sample(LightId id, Point<World> from, const LightUniforms& uniforms) const {
  const Light& light = *lights_[id.light];
  return id.part == LightId::whole ? light.sample(from, uniforms) : light.samplePart(id.part, from, uniforms);
}

float LightSet::pdf(LightId id, Point<World> from, const LightHit& hit) const {
  const Light& light = *lights_[id.light];
  return id.part == LightId::whole ? light.pdf(from, hit) : light.pdfPart(id.part, from, hit);
}

std::optional<LightSample> LightSet::sample(Point<World> from, float u, const LightUniforms& uniforms) const {
  const std::optional<Choice> choice = choose(from, u);
  if (!choice) return {};
  std::optional<LightSample> sample = this->sample(choice->id(), from, uniforms);
  if (sample) sample->pdf *= choice->probability;
  return sample;
}

float LightSet::pdf(std::uint32_t index, Point<World> from, const LightHit& hit) const {
  const LightId id = idOf(index, hit);
  return probability(id, from) * pdf(id, from, hit);
}

float LightSet::pdfVolumes(Point<World> from, Vector<World> direction) const {
  float sum = 0;
  for (const std::uint32_t i : volumes_) sum += pdfEscaped(i, from, direction);
  return sum;
}

Light::Escaped LightSet::escapedWithPdf(std::uint32_t index, Point<World> from, Vector<World> direction) const {
  Light::Escaped found = lights_[index]->escapedWithPdf(from, direction);
  found.pdf *= probability(index, from);
  return found;
}

float LightSet::pdfEscaped(std::uint32_t index, Point<World> from, Vector<World> direction) const {
  return probability(index, from) * lights_[index]->pdfEscaped(from, direction);
}

}  // namespace aerosol::render
