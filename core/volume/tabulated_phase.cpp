#include "core/volume/tabulated_phase.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace aerosol::volume {

TabulatedPhase::TabulatedPhase(std::vector<float> values) : values_(values.begin(), values.end()) {
  assert(values_.size() >= 2);
  cumulative_.push_back(0);
  for (std::size_t i = 1; i < values_.size(); ++i) {
    cumulative_.push_back(cumulative_.back() + std::numbers::pi * step() * (values_[i - 1] + values_[i]));
  }
  const double total = cumulative_.back();
  assert(total > 0);
  for (double& value : values_) value /= total;
  for (double& share : cumulative_) share /= total;
}

float TabulatedPhase::evaluate(std::span<const float>, const Deflection& deflection) const {
  const double place = std::clamp(deflection.onePlusCosine / step(), 0.0, static_cast<double>(values_.size() - 1));
  const std::size_t cell = std::min(static_cast<std::size_t>(place), values_.size() - 2);
  const double t = place - static_cast<double>(cell);
  return static_cast<float>(values_[cell] + (values_[cell + 1] - values_[cell]) * t);
}

float TabulatedPhase::pdf(std::span<const float> parameters, const Deflection& deflection) const {
  return evaluate(parameters, deflection);
}

/// Inside a cell the distribution is quadratic: of the two forms of its root the one that does not cancel.
PhaseSample TabulatedPhase::sample(std::span<const float> none, Vector<World> before, std::array<float, 2> u) const {
  const double share = static_cast<double>(u[0]);
  const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, share);
  const auto cell = static_cast<std::size_t>(above - cumulative_.begin()) - 1;
  const double a = values_[cell], b = values_[cell + 1];
  const double mass = cumulative_[cell + 1] - cumulative_[cell];
  const double v = mass > 0 ? std::clamp((share - cumulative_[cell]) / mass, 0.0, 1.0) : 0.5;
  const double root = a + std::sqrt(a * a + (b - a) * (b + a) * v);
  const double t = root > 0 ? std::min(1.0, v * (a + b) / root) : v;
  const double onePlusCosine = std::min(2.0, (static_cast<double>(cell) + t) * step());
  const Deflection deflection{2 - onePlusCosine, onePlusCosine};
  const double sine = std::sqrt(deflection.oneMinusCosine * deflection.onePlusCosine);
  const double phi = 2 * std::numbers::pi * static_cast<double>(u[1]);
  const Vector<World> after =
      Frame<World>(before).at(static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
                              static_cast<float>(deflection.cosine()));
  return {.direction = normalize(after), .pdf = pdf(none, deflection)};
}

float TabulatedPhase::meanCosine(std::span<const float>) const {
  double mean = 0;
  for (std::size_t i = 1; i < values_.size(); ++i) {
    const double c0 = static_cast<double>(i - 1) * step() - 1, c1 = c0 + step();
    // Simpson's rule is exact for the product of two lines.
    const double middle = 0.25 * (values_[i - 1] + values_[i]) * (c0 + c1);
    mean += 2 * std::numbers::pi * step() * (values_[i - 1] * c0 + 4 * middle + values_[i] * c1) / 6;
  }
  return static_cast<float>(mean);
}

}  // namespace aerosol::volume
