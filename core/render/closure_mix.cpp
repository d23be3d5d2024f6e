#include "core/render/closure_mix.h"

#include <algorithm>

namespace aerosol::render {

ClosureMix::ClosureMix(std::span<const WeightedClosure> terms, const ClosurePoint& point)
    : terms_(terms), point_(point) {
  for (const WeightedClosure& term : terms_) total_ += share(term);
}

float ClosureMix::share(const WeightedClosure& term) const {
  if (term.closure->kind() == ClosureKind::emission) return 0;
  return average(abs(term.weight) * term.closure->albedo(term.parameters, point_));
}

Color ClosureMix::evaluate(Vector<World> toLight) const {
  Color sum;
  for (const WeightedClosure& term : terms_) {
    if (term.closure->kind() == ClosureKind::scattering) {
      sum += term.weight * term.closure->evaluate(term.parameters, point_, toLight);
    }
  }
  return sum;
}

float ClosureMix::pdf(Vector<World> toLight) const {
  if (!(total_ > 0)) return 0;
  float sum = 0;
  for (const WeightedClosure& term : terms_) {
    const float part = share(term);
    if (part > 0) sum += part / total_ * term.closure->pdf(term.parameters, point_, toLight);
  }
  return sum;
}

std::optional<ClosureSample> ClosureMix::sample(const ClosureUniforms& u) const {
  if (!(total_ > 0)) return {};
  float rest = u.choice * total_;
  const WeightedClosure* chosen = nullptr;
  float part = 0;
  for (const WeightedClosure& term : terms_) {
    const float next = share(term);
    if (!(next > 0)) continue;
    if (chosen) rest -= part;
    chosen = &term;
    part = next;
    if (rest < part) break;
  }
  const float probability = part / total_;
  const ClosureUniforms inner{std::clamp(rest / part, 0.0f, 0x1.fffffep-1f), u.place};
  std::optional<ClosureSample> sample = chosen->closure->sample(chosen->parameters, point_, inner);
  if (!sample) return {};
  if (sample->isDelta) {
    sample->weight = chosen->weight * sample->weight / probability;
    sample->pdf *= probability;
    return sample;
  }
  sample->pdf = pdf(sample->direction);
  if (!(sample->pdf > 0)) return {};
  sample->weight = evaluate(sample->direction) / sample->pdf;
  return sample;
}

Color ClosureMix::emitted() const {
  Color sum;
  for (const WeightedClosure& term : terms_) sum += term.weight * term.closure->emitted(term.parameters, point_);
  return sum;
}

Color ClosureMix::transparency() const {
  Color sum;
  for (const WeightedClosure& term : terms_) {
    if (term.closure->kind() == ClosureKind::transparent) sum += term.weight;
  }
  return sum;
}

bool ClosureMix::isPassing() const {
  return std::all_of(terms_.begin(), terms_.end(), [](const WeightedClosure& term) {
    return term.closure->kind() != ClosureKind::scattering || isBlack(term.weight);
  });
}

}  // namespace aerosol::render
