// Closed forms for voxels: with coefficients that are a field times constants, the field's integral D(t) along the ray
// takes the place of the distance in the closed forms of constant media: T = exp(-σ D), pdf = σ T in D and σ T f(t) in
// t, D = -log(1 - ξ) / σ. Both directions, D of t and t of D, are exact (voxel_field.h). No shader is asked.
#pragma once

#include <limits>

#include "core/volume/distance_sample.h"
#include "core/volume/segments.h"
#include "core/volume/task.h"
#include "core/volume/trackers/channels.h"
#include "core/volume/trackers/ray_marching.h"
#include "core/volume/trackers/voxel_medium.h"

namespace aerosol::volume {

/// A segment of one medium that has voxels.
class AnalyticSegment {
 public:
  AnalyticSegment(const Segment& segment, const Ray<World>& ray, Color throughput)
      : segment_(segment),
        medium_(*segment.media.front()),
        voxels_(*medium_.voxels),
        ray_(voxels_.seenFrom(medium_, ray)),
        channels_(throughput),
        sigmaT_(withoutNegligible(voxels_.unit.sigmaT)) {}

  /// Samples a distance. Emission is the exact integral over the segment, for any outcome. Two random numbers, or one.
  template <UniformSource R>
  DistanceSample sample(R& random) const {
    DistanceSample sample;
    if (!isBlack(voxels_.unit.emission)) {
      sample.emission = voxels_.unit.emission * transmittedLength(sigmaT_, static_cast<float>(wholeDepth()));
    }
    float u = random.next();
    const auto chosen = static_cast<double>(sigmaT_[channels_.choose(u)]);
    const double depth =
        chosen > 0 ? -std::log1p(-static_cast<double>(u)) / chosen : std::numeric_limits<double>::infinity();
    const FieldPlace place = findDepth(*voxels_.field, ray_, segment_.t0, segment_.t1, depth);
    const Color transmittance = through(place.depth);
    if (!place.isReached) {
      sample.choicePdf = static_cast<double>(channels_.mix(transmittance));
      sample.logPdf = std::log(sample.choicePdf);
      sample.weight = sample.choicePdf > 0 ? transmittance / static_cast<float>(sample.choicePdf) : Color();
      return sample;
    }
    sample.t = place.t;
    const float density = channels_.mix(sigmaT_ * transmittance);
    sample.choicePdf = static_cast<double>(density) * valueAt(*voxels_.field, ray_, place.t);
    sample.logPdf = std::log(sample.choicePdf);
    chooseLobe(transmittance / density, random.next(), sample);
    return sample;
  }

  /// What is found at a given distance, or on the way past it.
  template <UniformSource R>
  void find(GivenDistance& given, R& random) const {
    if (!given.isIn(segment_)) {
      const Color transmittance = through(wholeDepth());
      return given.pass(transmittance, static_cast<double>(channels_.mix(transmittance)));
    }
    const Color transmittance = through(integrate(*voxels_.field, ray_, segment_.t0, given.t));
    const double value = valueAt(*voxels_.field, ray_, given.t);
    given.sample.t = given.t;
    given.sample.choicePdf *= value * static_cast<double>(channels_.mix(sigmaT_ * transmittance));
    chooseLobe(given.sample.weight * transmittance * static_cast<float>(value), random.next(), given.sample);
  }

 private:
  double wholeDepth() const { return integrate(*voxels_.field, ray_, segment_.t0, segment_.t1); }
  Color through(double depth) const {
    Color result;
    for (int c = 0; c < 3; ++c) {
      result[c] = sigmaT_[c] > 0 ? static_cast<float>(std::exp(-static_cast<double>(sigmaT_[c]) * depth)) : 1.0f;
    }
    return result;
  }
  void chooseLobe(Color weight, float u, DistanceSample& sample) const {
    const auto forEach = [&](auto&& use) {
      if (weight.r != 0 || weight.g != 0 || weight.b != 0) use(medium_, voxels_.unit);
    };
    volume::chooseLobe(forEach, weight, u, sample);
  }

  const Segment& segment_;
  const Medium& medium_;
  const VoxelMedium& voxels_;
  FieldRay ray_;
  ChannelMixture channels_;
  Color sigmaT_;
};

/// exp(-σ D) of a medium that has voxels; 0 where no channel lets 1e-7 through.
template <Evaluator E>
Task<Color> analyticTransmittance(E&, Ray<World> ray, MediumSpan span) {
  const VoxelMedium& voxels = *span.medium->voxels;
  const Color sigmaT = withoutNegligible(voxels.unit.sigmaT);
  const auto least = static_cast<double>(minimum(sigmaT));
  const double opaque = least > 0 ? opaqueDepth / least : std::numeric_limits<double>::infinity();
  const FieldPlace place = findDepth(*voxels.field, voxels.seenFrom(*span.medium, ray), span.t0, span.t1, opaque);
  if (place.isReached) co_return Color();
  Color result;
  for (int c = 0; c < 3; ++c) {
    result[c] = static_cast<float>(std::exp(-static_cast<double>(sigmaT[c]) * place.depth));
  }
  co_return result;
}

}  // namespace aerosol::volume
