#include "core/volume/blended_phase.h"

#include <algorithm>
#include <utility>

namespace aerosol::volume {

namespace {

float shareOf(std::span<const float> parameters) { return std::clamp(parameters[0], 0.0f, 1.0f); }
float mix(float a, float b, float share) { return a * (1 - share) + b * share; }

}  // namespace

BlendedPhase::BlendedPhase(std::shared_ptr<const PhaseFunction> first, std::shared_ptr<const PhaseFunction> second)
    : first_(std::move(first)), second_(std::move(second)) {}

float BlendedPhase::evaluate(std::span<const float> parameters, const Deflection& deflection) const {
  return mix(first_->evaluate({}, deflection), second_->evaluate({}, deflection), shareOf(parameters));
}

float BlendedPhase::pdf(std::span<const float> parameters, const Deflection& deflection) const {
  return mix(first_->pdf({}, deflection), second_->pdf({}, deflection), shareOf(parameters));
}

PhaseSample BlendedPhase::sample(std::span<const float> parameters, Vector<World> before,
                                 std::array<float, 2> u) const {
  const float share = shareOf(parameters);
  const bool isSecond = u[0] < share;
  u[0] = std::min(isSecond ? u[0] / share : (u[0] - share) / (1 - share), 0x1.fffffep-1f);
  PhaseSample sample = (isSecond ? *second_ : *first_).sample({}, before, u);
  if (sample.isDelta) return sample;
  const Deflection deflection = Deflection::between(before, sample.direction);
  sample.pdf = pdf(parameters, deflection);
  sample.weight = evaluate(parameters, deflection) / sample.pdf;
  return sample;
}

float BlendedPhase::meanCosine(std::span<const float> parameters) const {
  return mix(first_->meanCosine({}), second_->meanCosine({}), shareOf(parameters));
}

}  // namespace aerosol::volume
