#include "core/render/closure_mix.h"

#include <algorithm>

namespace aerosol::render {

ClosureMix::ClosureMix(std::span<const WeightedClosure> terms, const ClosurePoint& point)
    : terms_(terms), point_(point), shares_(terms.size()) {
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const WeightedClosure& term = terms_[i];
    if (term.closure->kind() == ClosureKind::emission) continue;
    shares_[i] = average(abs(term.weight) * term.closure->albedo(term.parameters, point_));
    total_ += shares_[i];
    sampled_ += shares_[i] > 0;
  }
}

Color ClosureMix::evaluate(Vector<World> toLight) const {
  Color sum;
  for (const WeightedClosure& term : terms_) {
    if (term.closure->kind() == ClosureKind::scattering) {
      sum += term.weight * term.closure->evaluate(term.parameters, point_, toLight) * term.shadow(toLight);
    }
  }
  return sum;
}

Color ClosureMix::evaluateDiffuse(Vector<World> toLight) const {
  Color sum;
  for (const WeightedClosure& term : terms_) {
    if (term.closure->kind() == ClosureKind::scattering) {
      sum += term.weight * term.closure->evaluateDiffuse(term.parameters, point_, toLight) * term.shadow(toLight);
    }
  }
  return sum;
}

ClosureMix::TermShare ClosureMix::evaluateTerm(std::size_t index, Vector<World> toLight) const {
  const WeightedClosure& term = terms_[index];
  TermShare share{.label = term.label, .all = {}, .diffuse = {}};
  if (term.closure->kind() != ClosureKind::scattering) return share;
  const Color weight = term.weight * term.shadow(toLight);
  share.all = weight * term.closure->evaluate(term.parameters, point_, toLight);
  share.diffuse = weight * term.closure->evaluateDiffuse(term.parameters, point_, toLight);
  return share;
}

bool ClosureMix::hasLabels() const {
  return std::any_of(terms_.begin(), terms_.end(), [](const WeightedClosure& term) { return term.label != 0; });
}

Color ClosureMix::albedo() const {
  Color sum;
  for (const WeightedClosure& term : terms_) {
    const ClosureKind kind = term.closure->kind();
    if (kind == ClosureKind::scattering || kind == ClosureKind::subsurface)
      sum += term.weight * term.closure->albedo(term.parameters, point_);
  }
  return sum;
}

float ClosureMix::pdf(Vector<World> toLight) const {
  if (!(total_ > 0)) return 0;
  float sum = 0;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    if (shares_[i] > 0) sum += shares_[i] / total_ * terms_[i].closure->pdf(terms_[i].parameters, point_, toLight);
  }
  return sum;
}

std::optional<ClosureSample> ClosureMix::sample(const ClosureUniforms& u) const {
  if (!(total_ > 0)) return {};
  float rest = u.choice * total_;
  const WeightedClosure* chosen = nullptr;
  float part = 0;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    if (!(shares_[i] > 0)) continue;
    if (chosen) rest -= part;
    chosen = &terms_[i];
    part = shares_[i];
    if (rest < part) break;
  }
  const float probability = part / total_;
  const ClosureUniforms inner{std::clamp(rest / part, 0.0f, 0x1.fffffep-1f), u.place};
  std::optional<ClosureSample> sample = chosen->closure->sample(chosen->parameters, point_, inner);
  if (!sample) return {};
  // What only one could have returned is weighted by it alone.
  if (sample->isDelta || sampled_ == 1) {
    sample->weight = chosen->weight * sample->weight * (chosen->shadow(sample->direction) / probability);
    sample->pdf *= probability;
    sample->term = static_cast<std::uint32_t>(chosen - terms_.data());
    return sample;
  }
  sample->pdf = pdf(sample->direction);
  if (!(sample->pdf > 0)) return {};
  sample->weight = evaluate(sample->direction) / sample->pdf;
  return sample;
}

SubsurfaceBody ClosureMix::bodyOf(const ClosureSample& sample) const {
  const WeightedClosure& term = terms_[sample.term];
  return term.closure->body(term.parameters);
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

Color ClosureMix::holdout() const {
  Color sum;
  for (const WeightedClosure& term : terms_) {
    if (term.closure->kind() == ClosureKind::holdout) sum += term.weight;
  }
  return sum;
}

bool ClosureMix::isPassing() const {
  return std::all_of(terms_.begin(), terms_.end(), [](const WeightedClosure& term) {
    const ClosureKind kind = term.closure->kind();
    return (kind != ClosureKind::scattering && kind != ClosureKind::subsurface) || isBlack(term.weight);
  });
}

}  // namespace aerosol::render
