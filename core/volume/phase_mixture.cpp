#include "core/volume/phase_mixture.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace aerosol::volume {

PhaseMixture::PhaseMixture(std::vector<Part> parts) : parts_(std::move(parts)) {
  float total = 0;
  for (const Part& part : parts_) total += part.share;
  assert(total > 0);
  for (Part& part : parts_) part.share /= total;
}

float PhaseMixture::evaluate(std::span<const float>, const Deflection& deflection) const {
  float sum = 0;
  for (const Part& part : parts_) sum += part.share * part.function->evaluate(part.parameters, deflection);
  return sum;
}

float PhaseMixture::pdf(std::span<const float>, const Deflection& deflection) const {
  float sum = 0;
  for (const Part& part : parts_) sum += part.share * part.function->pdf(part.parameters, deflection);
  return sum;
}

PhaseSample PhaseMixture::sample(std::span<const float> none, Vector<World> before, std::array<float, 2> u) const {
  std::size_t chosen = 0;
  while (chosen + 1 < parts_.size() && u[0] >= parts_[chosen].share) u[0] -= parts_[chosen++].share;
  const Part& part = parts_[chosen];
  u[0] = std::min(u[0] / part.share, 0x1.fffffep-1f);
  PhaseSample sample = part.function->sample(part.parameters, before, u);
  if (sample.isDelta) return sample;
  const Deflection deflection = Deflection::between(before, sample.direction);
  sample.pdf = pdf(none, deflection);
  sample.weight = evaluate(none, deflection) / sample.pdf;
  return sample;
}

float PhaseMixture::meanCosine(std::span<const float>) const {
  float sum = 0;
  for (const Part& part : parts_) sum += part.share * part.function->meanCosine(part.parameters);
  return sum;
}

}  // namespace aerosol::volume
