#include "core/volume/distance_sample.h"

namespace aerosol::volume {

void chooseLobe(std::span<const Medium* const> media, std::span<const Coefficients> answers, Color weight, float u,
                DistanceSample& sample) {
  float total = 0;
  std::size_t next = 0;
  for (const Medium* medium : media) {
    const Coefficients& part = coefficientsOf(*medium, answers, next);
    for (std::uint32_t k = 0; k < part.lobeCount; ++k) total += average(abs(part.lobes[k].sigmaS));
  }
  sample.event = DistanceEvent::absorbed;
  sample.weight = Color();
  if (!(total > 0)) return;
  float remaining = u * total;
  next = 0;
  for (const Medium* medium : media) {
    const Coefficients& part = coefficientsOf(*medium, answers, next);
    for (std::uint32_t k = 0; k < part.lobeCount; ++k) {
      const Lobe& lobe = part.lobes[k];
      const float share = average(abs(lobe.sigmaS));
      if (share <= 0) continue;
      // Rounding may leave a remainder after the last lobe; the last one with a share stays chosen.
      sample.event = DistanceEvent::scattered;
      sample.medium = medium;
      sample.anisotropy = lobe.anisotropy;
      sample.weight = weight * lobe.sigmaS * (total / share);
      if (remaining < share) return;
      remaining -= share;
    }
  }
}

}  // namespace aerosol::volume
