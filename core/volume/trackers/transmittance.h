// The table of transmittance estimators: everything that estimates the transmittance of one medium over a span.
#pragma once

#include <array>

#include "core/volume/trackers/analytic.h"
#include "core/volume/trackers/combs.h"
#include "core/volume/trackers/delta_tracking.h"
#include "core/volume/trackers/ratio_tracking.h"
#include "core/volume/trackers/ray_marching.h"

namespace aerosol::volume {

/// All of them. Tests run over this list.
inline constexpr std::array allTransmittanceMethods{
    TransmittanceMethod::closedForm,    TransmittanceMethod::analytic, TransmittanceMethod::marching,
    TransmittanceMethod::ratioTracking, TransmittanceMethod::twoCombs, TransmittanceMethod::unbiasedMarching,
    TransmittanceMethod::deltaTracking};

/// Is the mean exact, whatever the step? (With a bound that holds.)
inline constexpr bool isUnbiased(TransmittanceMethod method) {
  return method != TransmittanceMethod::marching && method != TransmittanceMethod::twoCombs;
}

/// exp(-σt length) of a constant medium.
inline Color closedTransmittance(const MediumSpan& span) {
  return exp(opticalDepth(span.medium->constant->sigmaT, static_cast<float>(span.t1 - span.t0)) * -1.0f);
}

/// The same as a task.
template <Evaluator E>
Task<Color> closedTransmittanceTask(E&, MediumSpan span) {
  co_return closedTransmittance(span);
}

/// Of `span.medium`, which has what the method needs: constant coefficients for the closed form, voxels for the
/// analytic one, a bound for ratio and delta tracking.
template <Evaluator E, UniformSource R>
Task<Color> estimateTransmittance(TransmittanceMethod method, E& evaluator, const Ray<World>& ray,
                                  const MediumSpan& span, R& random) {
  const float step = span.medium->stepSize;
  switch (method) {
    case TransmittanceMethod::marching:
      return marchedTransmittance(evaluator, ray, span, step, random);
    case TransmittanceMethod::ratioTracking:
      return ratioTracking(evaluator, ray, span, random);
    case TransmittanceMethod::twoCombs:
      return twoCombTransmittance(evaluator, ray, span, step, random);
    case TransmittanceMethod::unbiasedMarching:
      return unbiasedMarchingTransmittance(evaluator, ray, span, step, random);
    case TransmittanceMethod::deltaTracking:
      return deltaTracking(evaluator, ray, span, random);
    case TransmittanceMethod::analytic:
      return analyticTransmittance(evaluator, ray, span);
    case TransmittanceMethod::closedForm:
      break;
  }
  return closedTransmittanceTask(evaluator, span);
}

}  // namespace aerosol::volume
