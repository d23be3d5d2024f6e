// A mean of two phase functions whose weight varies over space.
#pragma once

#include <memory>

#include "core/volume/phase.h"

namespace aerosol::volume {

/// Its one parameter is the share of the second function; outside of [0, 1] the nearest end counts. The functions have
/// no parameters of their own.
class BlendedPhase final : public PhaseFunction {
 public:
  BlendedPhase(std::shared_ptr<const PhaseFunction> first, std::shared_ptr<const PhaseFunction> second);

  std::string_view name() const override { return "blend"; }
  std::string_view doc() const override { return "A mean of two phase functions by a weight that varies"; }
  std::span<const DescribedField> fields() const override { return {}; }

  float evaluate(std::span<const float> parameters, const Deflection& deflection) const override;
  float pdf(std::span<const float> parameters, const Deflection& deflection) const override;
  PhaseSample sample(std::span<const float> parameters, Vector<World> before, std::array<float, 2> u) const override;
  float meanCosine(std::span<const float> parameters) const override;

 private:
  std::shared_ptr<const PhaseFunction> first_, second_;
};

}  // namespace aerosol::volume
