// Equiangular sampling: distances along a ray in proportion to the falloff of light from a point near it.
//
// Kulla and Fajardo 2012, "Importance Sampling Techniques for Path Tracing in Participating Media", section 5, with D
// the light's distance from the ray and a, b the ends of a stretch measured from the light's projection:
//   θb − θa = atan2(D (b − a), D² + a b),  pdf(t) = D / ((θb − θa) (D² + t²)),  t = D tan(θa + ξ (θb − θa)).
// All is written with the integral I = ∫ dt / (D² + t²) = (θb − θa) / D, which stays finite as D → 0 where the light is
// not within the stretch: I → (b − a) / (a b). With κ = tan(ξ D I) / D → ξ I the addition theorem of the tangent gives
// t = (a + D² κ) / (1 − a κ), so no case and no threshold is needed for a light on the ray.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "core/base/color.h"

namespace aerosol::volume {

/// The falloff 1 / (D² + t²) of one light over one stretch [a, b], a < b; b may be infinite. D >= 0; with D = 0 the
/// light must not lie in the stretch (a b > 0), elsewhere `integral` is infinite.
struct EquiangularStretch {
  double distance = 0;  ///< D.
  double a = 0, b = 0;
  double integral = 0;  ///< I, per unit of length.

  EquiangularStretch() = default;
  EquiangularStretch(double distance_, double a_, double b_) : distance(distance_), a(a_), b(b_) {
    if (std::isinf(b)) {
      integral = distance > 0 ? std::atan2(distance, a) / distance : a > 0 ? 1 / a : unbounded();
    } else if (distance > 0) {
      integral = std::atan2(distance * (b - a), distance * distance + a * b) / distance;
    } else {
      integral = a * b > 0 ? (b - a) / (a * b) : unbounded();
    }
    // The angle of a distance so small that the quotient has no digits.
    if (!(integral > 0)) integral = std::numeric_limits<double>::min();
  }

  /// The place for ξ in [0, 1], within [a, b].
  double sample(double xi) const {
    const double angle = xi * distance * integral;
    const double kappa = angle > 0 ? std::tan(angle) / distance : xi * integral;
    const double t = (a + distance * distance * kappa) / (1 - a * kappa);
    return std::isnan(t) ? a : std::clamp(t, a, b);
  }
  /// The density of `sample`.
  double pdf(double t) const { return 1 / (integral * (distance * distance + t * t)); }
  /// The ξ of a place in [a, b].
  double shareUpTo(double t) const {
    return t > a ? std::clamp(EquiangularStretch(distance, a, t).integral / integral, 0.0, 1.0) : 0;
  }

 private:
  static double unbounded() { return std::numeric_limits<double>::infinity(); }
};

/// Parts of a ray in order, by distances along it: [a, b], a < b.
struct RayStretch {
  double a = 0, b = 0;
};

/// What constant media do to light on a stretch, per scene unit.
struct RayExtinction {
  Color sigmaT, sigmaS;
};

/// Few stretches of a ray. Where there are more than there is room for, the last ones become one with the gaps between
/// them: a sampler may choose a gap, and finds nothing there.
class RayStretches {
 public:
  static constexpr std::size_t room = 4;

  void clear() { count_ = 0; }
  /// In the order of `a`; one that begins within the last one, or where that ends, continues it.
  void add(double a, double b) {
    if (count_ > 0 && (stretches_[count_ - 1].b >= a || count_ == room)) {
      stretches_[count_ - 1].b = std::max(stretches_[count_ - 1].b, b);
    } else {
      stretches_[count_++] = {a, b};
    }
    isKnown_ = false;
  }
  /// One on which everything is constant and known.
  void add(double a, double b, const RayExtinction& extinction) {
    const bool hasOwnPlace = count_ < room && (count_ == 0 || stretches_[count_ - 1].b <= a);
    const bool wasKnown = isKnown_ || count_ == 0;
    if (!hasOwnPlace || !std::isfinite(b)) return add(a, b);
    extinctions_[count_] = extinction;
    stretches_[count_++] = {a, b};
    isKnown_ = wasKnown;
  }
  /// Something else weakens or scatters light there.
  void forgetExtinction() { isKnown_ = false; }
  /// What of them lies in [begin, end].
  RayStretches within(double begin, double end) const {
    RayStretches part = *this;
    part.count_ = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const RayStretch inside{std::max(stretches_[i].a, begin), std::min(stretches_[i].b, end)};
      const bool isMet = inside.a < inside.b;
      // Up to the first stretch that is kept, what is left out weakens the light all the same.
      const double left = isMet ? inside.a : stretches_[i].b;
      if (isKnown_ && part.count_ == 0) part.addDepth(extinctions_[i], left - stretches_[i].a);
      if (!isMet) continue;
      part.extinctions_[part.count_] = extinctions_[i];
      part.stretches_[part.count_++] = inside;
    }
    return part;
  }
  /// Whether the extinction of all stretches is known, and nothing but these is on the way.
  bool isKnown() const { return isKnown_; }
  const RayExtinction& extinction(std::size_t stretch) const { return extinctions_[stretch]; }
  /// Optical depths in front of the first one, where extinction is known and `within` has left something out.
  const std::array<double, 3>& depthBefore() const { return depthBefore_; }
  bool isEmpty() const { return count_ == 0; }
  std::span<const RayStretch> all() const { return {stretches_.data(), count_}; }
  double begin() const { return stretches_[0].a; }
  double end() const { return stretches_[count_ - 1].b; }
  /// Of all together.
  double length() const {
    double sum = 0;
    for (const RayStretch& s : all()) sum += s.b - s.a;
    return sum;
  }

 private:
  void addDepth(const RayExtinction& extinction, double way) {
    for (std::size_t c = 0; c < 3; ++c) {
      depthBefore_[c] += static_cast<double>(extinction.sigmaT[static_cast<int>(c)]) * way;
    }
  }

  std::array<RayStretch, room> stretches_{};
  std::array<RayExtinction, room> extinctions_{};
  std::array<double, 3> depthBefore_{};
  std::size_t count_ = 0;
  bool isKnown_ = false;
};

/// Equiangular sampling over several stretches of a ray.
class EquiangularSampler {
 public:
  EquiangularSampler() = default;
  /// `projection`: where along the ray the light is nearest; `distance`: how far it is there, as in EquiangularStretch.
  EquiangularSampler(const RayStretches& stretches, double projection, double distance) : projection_(projection) {
    for (const RayStretch& s : stretches.all()) {
      parts_[count_] = {distance, s.a - projection, s.b - projection};
      integral_ += parts_[count_++].integral;
    }
  }

  /// ∫ dt / (D² + t²) over all stretches; infinite for a light in one of them with D = 0.
  double integral() const { return integral_; }

  /// A distance along the ray for ξ in [0, 1).
  double sample(double xi) const {
    double rest = xi * integral_;
    std::size_t i = 0;
    for (; i + 1 < count_ && rest >= parts_[i].integral; ++i) rest -= parts_[i].integral;
    return projection_ + parts_[i].sample(std::min(rest / parts_[i].integral, 1.0));
  }
  /// The density of `sample`: 0 outside of the stretches.
  double pdf(double t) const {
    const double x = t - projection_;
    for (std::size_t i = 0; i < count_; ++i) {
      if (x >= parts_[i].a && x <= parts_[i].b) return parts_[i].pdf(x) * (parts_[i].integral / integral_);
    }
    return 0;
  }

 private:
  std::array<EquiangularStretch, RayStretches::room> parts_{};
  std::size_t count_ = 0;
  double projection_ = 0;
  double integral_ = 0;
};

/// The same where extinction is known: in proportion to σs T / (D² + t²), the light tabulated over few cells of equal
/// angle. What a cell weighs is the mean of σs T at its ends, averaged over channels, so that nowhere the density falls
/// short of the integrand by more than a factor of 2 for that cause.
class AttenuatedEquiangularSampler {
 public:
  static constexpr std::size_t cells = 8;

  AttenuatedEquiangularSampler() = default;
  /// `stretches.isKnown()`.
  AttenuatedEquiangularSampler(const RayStretches& stretches, double projection, double distance)
      : projection_(projection) {
    std::array<double, 3> depth = stretches.depthBefore();
    for (const RayStretch& s : stretches.all()) addPart(s, stretches.extinction(count_), distance, depth);
  }

  /// ∫ σs T dt / (D² + t²), about; infinite for a light in a stretch with D = 0.
  double integral() const { return integral_; }
  /// Largest optical depth of a cell, in any channel: where it is much more than 1 another sampler does better.
  double coarseness() const { return coarseness_; }

  /// A distance along the ray for ξ in [0, 1).
  double sample(double xi) const {
    double rest = xi * integral_;
    std::size_t i = 0;
    for (; i + 1 < count_ && rest >= parts_[i].mass; ++i) rest -= parts_[i].mass;
    const Part& part = parts_[i];
    const double unit = part.stretch.integral / static_cast<double>(cells);
    std::size_t k = 0;
    for (; k + 1 < cells && rest >= part.weights[k] * unit; ++k) rest -= part.weights[k] * unit;
    const double inCell = std::clamp(rest / (part.weights[k] * unit), 0.0, 1.0);
    return projection_ + part.stretch.sample((static_cast<double>(k) + inCell) / static_cast<double>(cells));
  }
  /// The density of `sample`: 0 outside of the stretches.
  double pdf(double t) const {
    const double x = t - projection_;
    for (std::size_t i = 0; i < count_; ++i) {
      const Part& part = parts_[i];
      if (!(x >= part.stretch.a && x <= part.stretch.b)) continue;
      const double place = part.stretch.shareUpTo(x) * static_cast<double>(cells);
      const std::size_t k = std::min(static_cast<std::size_t>(place), cells - 1);
      return part.stretch.pdf(x) * part.stretch.integral * part.weights[k] / integral_;
    }
    return 0;
  }

 private:
  struct Part {
    EquiangularStretch stretch;
    std::array<double, cells> weights{};
    double mass = 0;
  };

  /// `depth`: optical depths in front of the stretch, which become those behind it.
  void addPart(const RayStretch& s, const RayExtinction& extinction, double distance, std::array<double, 3>& depth) {
    Part& part = parts_[count_++];
    part.stretch = {distance, s.a - projection_, s.b - projection_};
    const EquiangularStretch& stretch = part.stretch;
    // From the end of a cell to that of the next by the addition theorem.
    const double angle = distance * stretch.integral / static_cast<double>(cells);
    const double kappa = angle > 0 ? std::tan(angle) / distance : stretch.integral / static_cast<double>(cells);
    double x = stretch.a, before = left(extinction, depth, 0);
    double sum = 0;
    for (std::size_t k = 0; k < cells; ++k) {
      const double next = (x + distance * distance * kappa) / (1 - x * kappa);
      const double end = k + 1 == cells || !(next >= x && next <= stretch.b) ? stretch.b : next;
      const double behind = left(extinction, depth, end - stretch.a);
      part.weights[k] = 0.5 * (before + behind);
      sum += part.weights[k];
      coarseness_ = std::max(coarseness_, static_cast<double>(maximum(extinction.sigmaT)) * (end - x));
      before = behind;
      x = end;
    }
    part.mass = sum * stretch.integral / static_cast<double>(cells);
    integral_ += part.mass;
    for (std::size_t c = 0; c < 3; ++c) {
      depth[c] += static_cast<double>(extinction.sigmaT[static_cast<int>(c)]) * (stretch.b - stretch.a);
    }
  }
  /// σs T over the channels.
  static double left(const RayExtinction& extinction, const std::array<double, 3>& depth, double way) {
    double sum = 0, last = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const int channel = static_cast<int>(c);
      const bool isRepeated =
          c > 0 && depth[c] == depth[c - 1] && extinction.sigmaT[channel] == extinction.sigmaT[channel - 1];
      if (!isRepeated) last = std::exp(-depth[c] - static_cast<double>(extinction.sigmaT[channel]) * way);
      sum += static_cast<double>(std::fabs(extinction.sigmaS[channel])) * last;
    }
    return sum / 3;
  }

  std::array<Part, RayStretches::room> parts_{};
  std::size_t count_ = 0;
  double projection_ = 0;
  double integral_ = 0;
  double coarseness_ = 0;
};

}  // namespace aerosol::volume
