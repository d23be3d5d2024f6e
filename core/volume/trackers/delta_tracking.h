// Transmittance by delta tracking (Woodcock et al. 1965): the first real collision ends the way, so that all of the
// light arrives or none. The plainest unbiased estimator, and the yardstick of the others.
//
// Over the channels the chance to go on is the largest |σn| / μ̄; what the other channels have less of it stays in their
// weights. Where coefficients are known place by place, the chance is that of the stretch.
#pragma once

#include "core/volume/bounds/bound_walk.h"
#include "core/volume/trackers/tentative_flight.h"

namespace aerosol::volume {

/// Multiplies by a factor in full or not at all. False where nothing is left.
template <UniformSource R>
bool survivesFactor(Color& transmittance, Color factor, R& random) {
  const float chance = std::min(maximum(abs(factor)), 1.0f);
  if (!(random.next() < chance)) return false;
  transmittance *= factor / chance;
  return true;
}

/// Transmittance of one medium over a span. Signed where the bound is exceeded.
template <Evaluator E, UniformSource R>
Task<Color> deltaTracking(E& evaluator, Ray<World> ray, MediumSpan span, R& random) {
  const Medium& medium = *span.medium;
  BoundWalk walk(medium, ray, span.t0);
  Color transmittance(1.0f);
  if (!(span.t0 < span.t1)) co_return transmittance;
  double t = span.t0;
  auto flight = static_cast<double>(freeFlight(random.next()));
  int step = 0;
  for (;; walk.next()) {
    const double end = std::min(walk.end(), span.t1);
    const Coefficients* const known = walk.known();
    if (known && walk.leaf().majorant > 0) {
      const Color factor = exp(opticalDepth(known->sigmaT, static_cast<float>(end - t)) * -1.0f);
      if (!survivesFactor(transmittance, factor, random)) co_return Color();
    } else if (!known) {
      const BoundNode leaf = walk.leaf();
      const float rate = medium.collisionRate(leaf);
      const auto depthAt = [&](double from) {
        return rate > negligibleExtinction ? static_cast<double>(rate) * (end - from) : 0;
      };
      for (; flight < depthAt(t); flight = static_cast<double>(freeFlight(random.next()))) {
        if (step++ == maximumSteps) {
          ++evaluator.trackerStatistics().stepLimits;
          co_return transmittance;
        }
        t = std::min(t + flight / static_cast<double>(rate), end);
        evaluator.ask(medium, pointOn(ray, t), Quantity::extinction);
        const Color sigmaT = (co_await evaluator.answers())[0].sigmaT;
        countViolation(medium, leaf, sigmaT, evaluator.trackerStatistics());
        if (!survivesFactor(transmittance, Color(1.0f) - sigmaT / rate, random)) co_return Color();
      }
      flight -= depthAt(t);
    }
    if (end >= span.t1) co_return transmittance;
    t = end;
  }
}

}  // namespace aerosol::volume
