// Closed forms for constant coefficients: T = exp(-σt t), pdf = σt T, t = -log(1 - ξ) / σt.
#pragma once

#include <limits>

#include "core/volume/distance_sample.h"
#include "core/volume/segments.h"
#include "core/volume/trackers/channels.h"

namespace aerosol::volume {

/// A segment whose media are all constant.
class HomogeneousSegment {
 public:
  HomogeneousSegment(const Segment& segment, Color throughput)
      : segment_(segment), length_(static_cast<float>(segment.t1 - segment.t0)), channels_(throughput) {
    for (const Medium* medium : segment.media) sum_.add(*medium->constant);
    sum_.sigmaT = withoutNegligible(sum_.sigmaT);
  }

  /// Samples a distance. Emission is the exact integral over the segment, for any outcome. Two random numbers,
  /// or one.
  template <UniformSource R>
  DistanceSample sample(R& random) const {
    DistanceSample sample;
    if (!isBlack(sum_.emission)) sample.emission = sum_.emission * transmittedLength(sum_.sigmaT, length_);
    float u = random.next();
    const float chosen = sum_.sigmaT[channels_.choose(u)];
    const float distance = chosen > 0 ? -std::log1p(-u) / chosen : std::numeric_limits<float>::infinity();
    if (!(distance < length_)) {
      const Color transmittance = exp(opticalDepth(sum_.sigmaT, length_) * -1.0f);
      sample.choicePdf = static_cast<double>(channels_.mix(transmittance));
      sample.logPdf = std::log(sample.choicePdf);
      sample.weight = sample.choicePdf > 0 ? transmittance / static_cast<float>(sample.choicePdf) : Color();
      return sample;
    }
    sample.t = std::min(segment_.t0 + static_cast<double>(distance), segment_.t1);
    const Color transmittance = exp(sum_.sigmaT * -distance);
    const float pdf = channels_.mix(sum_.sigmaT * transmittance);
    sample.choicePdf = static_cast<double>(pdf);
    sample.logPdf = std::log(sample.choicePdf);
    chooseLobe(transmittance / pdf, random.next(), sample);
    return sample;
  }

  /// What is found at a given distance, or on the way past it.
  template <UniformSource R>
  void find(GivenDistance& given, R& random) const {
    if (!given.isIn(segment_)) {
      const Color transmittance = exp(opticalDepth(sum_.sigmaT, length_) * -1.0f);
      return given.pass(transmittance, static_cast<double>(channels_.mix(transmittance)));
    }
    const Color transmittance = exp(opticalDepth(sum_.sigmaT, static_cast<float>(given.t - segment_.t0)) * -1.0f);
    given.sample.t = given.t;
    given.sample.choicePdf *= static_cast<double>(channels_.mix(sum_.sigmaT * transmittance));
    chooseLobe(given.sample.weight * transmittance, random.next(), given.sample);
  }

 private:
  void chooseLobe(Color weight, float u, DistanceSample& sample) const {
    const auto forEach = [&](auto&& use) {
      for (const Medium* medium : segment_.media) use(*medium, *medium->constant);
    };
    volume::chooseLobe(forEach, weight, u, sample);
  }

  const Segment& segment_;
  float length_;
  ChannelMixture channels_;
  CoefficientSum sum_;
};

/// Samples a distance in a segment whose media are all constant.
template <UniformSource R>
DistanceSample sampleHomogeneous(const Segment& segment, Color throughput, R& random) {
  return HomogeneousSegment(segment, throughput).sample(random);
}

}  // namespace aerosol::volume
