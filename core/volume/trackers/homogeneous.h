// Closed forms for constant coefficients: T = exp(-σt t), pdf = σt T, t = -log(1 - ξ) / σt.
#pragma once

#include <limits>

#include "core/volume/distance_sample.h"
#include "core/volume/segments.h"
#include "core/volume/trackers/channels.h"

namespace aerosol::volume {

/// Samples a distance in a segment whose media are all constant. Emission is the exact integral over the segment, for
/// any outcome. Three random numbers.
template <UniformSource R>
DistanceSample sampleHomogeneous(const Segment& segment, Color throughput, R& random) {
  CoefficientSum sum;
  for (const Medium* medium : segment.media) sum.add(*medium->constant);
  sum.sigmaT = withoutNegligible(sum.sigmaT);
  const auto length = static_cast<float>(segment.t1 - segment.t0);

  DistanceSample sample;
  const Color depth = opticalDepth(sum.sigmaT, length);
  if (!isBlack(sum.emission)) sample.emission = sum.emission * transmittedLength(sum.sigmaT, length);

  const ChannelMixture channels(throughput);
  float u = random.next();
  const float chosen = sum.sigmaT[channels.choose(u)];
  const float distance = chosen > 0 ? -std::log1p(-u) / chosen : std::numeric_limits<float>::infinity();
  if (!(distance < length)) {
    const Color transmittance = exp(depth * -1.0f);
    const float passProbability = channels.mix(transmittance);
    sample.logPdf = std::log(static_cast<double>(passProbability));
    sample.weight = passProbability > 0 ? transmittance / passProbability : Color();
    return sample;
  }
  sample.t = std::min(segment.t0 + static_cast<double>(distance), segment.t1);
  const Color transmittance = exp(sum.sigmaT * -distance);
  const float pdf = channels.mix(sum.sigmaT * transmittance);
  sample.logPdf = std::log(static_cast<double>(pdf));
  const auto forEach = [&](auto&& use) {
    for (const Medium* medium : segment.media) use(*medium, *medium->constant);
  };
  chooseLobe(forEach, transmittance / pdf, random.next(), sample);
  return sample;
}

}  // namespace aerosol::volume
