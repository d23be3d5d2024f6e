#include "core/volume/distance_sample.h"

namespace aerosol::volume {

void LobeChoice::choose(Color weight, float u, DistanceSample& sample) const {
  float total = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Coefficients& part = *parts_[i].coefficients;
    for (std::uint32_t k = 0; k < part.lobeCount; ++k) total += average(abs(part.lobes[k].sigmaS));
  }
  sample.event = DistanceEvent::absorbed;
  sample.weight = Color();
  if (!(total > 0)) return;
  float remaining = u * total;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Coefficients& part = *parts_[i].coefficients;
    for (std::uint32_t k = 0; k < part.lobeCount; ++k) {
      const Lobe& lobe = part.lobes[k];
      const float share = average(abs(lobe.sigmaS));
      if (share <= 0) continue;
      // Rounding may leave a remainder after the last lobe; the last one with a share stays chosen.
      sample.event = DistanceEvent::scattered;
      sample.medium = parts_[i].medium;
      sample.anisotropy = lobe.anisotropy;
      sample.weight = weight * lobe.sigmaS * (total / share);
      if (remaining < share) return;
      remaining -= share;
    }
  }
}

}  // namespace aerosol::volume
