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

 private:
  static double unbounded() { return std::numeric_limits<double>::infinity(); }
};

/// Parts of a ray in order, by distances along it: [a, b], a < b.
struct RayStretch {
  double a = 0, b = 0;
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
  }
  bool isEmpty() const { return count_ == 0; }
  std::span<const RayStretch> all() const { return {stretches_.data(), count_}; }
  double begin() const { return stretches_[0].a; }
  double end() const { return stretches_[count_ - 1].b; }

 private:
  std::array<RayStretch, room> stretches_{};
  std::size_t count_ = 0;
};

/// Equiangular sampling over several stretches of a ray.
class EquiangularSampler {
 public:
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

}  // namespace aerosol::volume
