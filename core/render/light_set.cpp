#include "core/render/light_set.h"

#include <algorithm>

namespace aerosol::render {

namespace {

constexpr double equalShare = 0.1;

}  // namespace

LightSet::LightSet(std::vector<std::unique_ptr<const Light>> lights, float sceneRadius) : lights_(std::move(lights)) {
  for (std::uint32_t i = 0; i < lights_.size(); ++i) {
    if (lights_[i]->isInfinite() && !lights_[i]->isDelta()) infinite_.push_back(i);
    if (maximum(abs(lights_[i]->power(sceneRadius))) > 0) emitting_.push_back(i);
  }
}

double LightSet::totalImportance(Point<World> from) const {
  double total = 0;
  for (const std::uint32_t i : emitting_) total += static_cast<double>(lights_[i]->importance(from));
  return total;
}

double LightSet::share(std::uint32_t index, Point<World> from) const {
  return static_cast<double>(lights_[index]->importance(from));
}

std::optional<LightSet::Choice> LightSet::choose(Point<World> from, float u) const {
  if (emitting_.empty()) return {};
  if (emitting_.size() == 1) return Choice{emitting_[0], 1};
  const double total = totalImportance(from);
  const double equal = 1 / static_cast<double>(emitting_.size());
  double rest = static_cast<double>(u);
  Choice choice;
  for (const std::uint32_t i : emitting_) {
    const double probability = total > 0 ? (1 - equalShare) * share(i, from) / total + equalShare * equal : equal;
    choice = {i, static_cast<float>(probability)};
    if (rest < probability) break;
    rest -= probability;  // Rounding may leave something behind the last light: it stays chosen.
  }
  return choice;
}

float LightSet::probability(std::uint32_t index, Point<World> from) const {
  if (std::find(emitting_.begin(), emitting_.end(), index) == emitting_.end()) return 0;
  if (emitting_.size() == 1) return 1;
  const double total = totalImportance(from);
  const double equal = 1 / static_cast<double>(emitting_.size());
  return static_cast<float>(total > 0 ? (1 - equalShare) * share(index, from) / total + equalShare * equal : equal);
}

std::optional<LightSample> LightSet::sample(Point<World> from, float u, const LightUniforms& uniforms) const {
  const std::optional<Choice> choice = choose(from, u);
  if (!choice) return {};
  std::optional<LightSample> sample = lights_[choice->index]->sample(from, uniforms);
  if (sample) sample->pdf *= choice->probability;
  return sample;
}

float LightSet::pdf(std::uint32_t index, Point<World> from, const LightHit& hit) const {
  return probability(index, from) * lights_[index]->pdf(from, hit);
}

float LightSet::pdfEscaped(std::uint32_t index, Point<World> from, Vector<World> direction) const {
  return probability(index, from) * lights_[index]->pdfEscaped(from, direction);
}

}  // namespace aerosol::render
