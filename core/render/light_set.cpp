#include "core/render/light_set.h"

#include <algorithm>

namespace aerosol::render {

namespace {

constexpr double equalShare = 0.1;

}  // namespace

LightSet::LightSet(std::vector<std::unique_ptr<const Light>> lights, float sceneRadius) : lights_(std::move(lights)) {
  std::vector<double> powers;
  double total = 0, emitting = 0;
  for (std::uint32_t i = 0; i < lights_.size(); ++i) {
    if (lights_[i]->isInfinite() && !lights_[i]->isDelta()) infinite_.push_back(i);
    const Color power = abs(lights_[i]->power(sceneRadius));
    powers.push_back((static_cast<double>(power.r) + static_cast<double>(power.g) + static_cast<double>(power.b)) / 3);
    total += powers.back();
    if (powers.back() > 0) ++emitting;
  }
  if (!(total > 0)) return;
  double sum = 0;
  for (const double power : powers) {
    if (power > 0) sum += (1 - equalShare) * power / total + equalShare / emitting;
    cumulative_.push_back(sum);
  }
  for (double& c : cumulative_) c /= sum;
}

std::optional<LightSet::Choice> LightSet::choose(float u) const {
  if (cumulative_.empty()) return {};
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), static_cast<double>(u));
  const auto index = static_cast<std::uint32_t>(std::min(found, cumulative_.end() - 1) - cumulative_.begin());
  return Choice{index, probability(index)};
}

float LightSet::probability(std::uint32_t index) const {
  if (cumulative_.empty()) return 0;
  return static_cast<float>(cumulative_[index] - (index > 0 ? cumulative_[index - 1] : 0));
}

std::optional<LightSample> LightSet::sample(Point<World> from, float u, const LightUniforms& uniforms) const {
  const std::optional<Choice> choice = choose(u);
  if (!choice) return {};
  std::optional<LightSample> sample = lights_[choice->index]->sample(from, uniforms);
  if (sample) sample->pdf *= choice->probability;
  return sample;
}

float LightSet::pdf(std::uint32_t index, Point<World> from, const LightHit& hit) const {
  return probability(index) * lights_[index]->pdf(from, hit);
}

float LightSet::pdfEscaped(std::uint32_t index, Point<World> from, Vector<World> direction) const {
  return probability(index) * lights_[index]->pdfEscaped(from, direction);
}

}  // namespace aerosol::render
