// Transmittance by residual ratio tracking (Novák et al. 2014).
#pragma once

#include "core/volume/bounds/bound_walk.h"
#include "core/volume/task.h"
#include "core/volume/trackers/tentative_flight.h"

namespace aerosol::volume {

/// Transmittance of one medium over [t0, t1] by residual ratio tracking: in each leaf the least
/// extinction is a control, taken in closed form, and collisions come at the rate of the rest of the bound. Unbiased,
/// signed where the bound is exceeded.
template <Evaluator E, UniformSource R>
Task<Color> ratioTracking(E& evaluator, Ray<World> ray, MediumSpan span, R& random) {
  const Medium& medium = *span.medium;
  BoundWalk walk(medium, ray, span.t0);
  Color transmittance(1.0f);
  if (!(span.t0 < span.t1)) co_return transmittance;
  double t = span.t0;
  auto flight = static_cast<double>(freeFlight(random.next()));
  int step = 0;
  for (;; walk.next()) {
    const double end = std::min(walk.end(), span.t1);
    if (const Coefficients* known = walk.known(); known && walk.leaf().majorant == 0) {
      // Nothing here.
    } else if (known) {
      transmittance *= exp(opticalDepth(known->sigmaT, static_cast<float>(end - t)) * -1.0f);
      if (!survivesTrackerRoulette(transmittance, maximum(abs(transmittance)), random)) co_return Color();
    } else {
      const BoundNode leaf = walk.leaf();
      if (leaf.control > 0) transmittance *= std::exp(-opticalDepth(leaf.control, static_cast<float>(end - t)));
      const float bound = medium.shadowRate(leaf) - leaf.control;
      const auto depthAt = [&](double from) {
        return bound > negligibleExtinction ? static_cast<double>(bound) * (end - from) : 0;
      };
      for (; flight < depthAt(t); flight = static_cast<double>(freeFlight(random.next()))) {
        if (step++ == maximumSteps) {
          ++evaluator.trackerStatistics().stepLimits;
          co_return transmittance;
        }
        t = std::min(t + flight / static_cast<double>(bound), end);
        evaluator.ask(medium, pointOn(ray, t), Quantity::extinction);
        const Color sigmaT = (co_await evaluator.answers())[0].sigmaT;
        countViolation(medium, leaf, sigmaT, evaluator.trackerStatistics());
        transmittance *= Color(1.0f) - (sigmaT - Color(leaf.control)) / bound;
        if (!survivesTrackerRoulette(transmittance, maximum(abs(transmittance)), random)) co_return Color();
      }
      flight -= depthAt(t);
    }
    if (end >= span.t1) co_return transmittance;
    t = end;
  }
}

}  // namespace aerosol::volume
