// Phase functions: how a medium scatters.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/base/described_field.h"
#include "core/base/geometry.h"

namespace aerosol::volume {

/// The angle by which light is turned, between the direction of travel before and after a collision, as 1 - cos and
/// 1 + cos: near forward and backward scattering the cosine alone has no digits left.
struct Deflection {
  double oneMinusCosine = 0;
  double onePlusCosine = 2;

  double cosine() const { return onePlusCosine < 1 ? onePlusCosine - 1 : 1 - oneMinusCosine; }
  static Deflection fromCosine(double cosine) { return {1 - cosine, 1 + cosine}; }
  /// Between two unit directions of travel.
  static Deflection between(Vector<World> before, Vector<World> after);
};

struct PhaseSample {
  Vector<World> direction;  ///< Unit, of travel after the collision.
  float weight = 1;         ///< Phase function over pdf.
  float pdf = 0;            ///< Per steradian; 1 when `isDelta`.
  bool isDelta = false;
};

/// A phase function, normalised to 1 over the sphere, for light that travels in `before` and goes on in `after`: both
/// directions of travel, so a positive mean cosine is forward scattering. They are symmetric in time: a path traced
/// from the camera uses them as it goes. Parameters are floats as described by `fields`.
class PhaseFunction {
 public:
  virtual ~PhaseFunction() = default;

  virtual std::string_view name() const = 0;
  virtual std::string_view doc() const = 0;
  virtual std::span<const DescribedField> fields() const = 0;

  /// Per steradian. 0 where all light goes in a single direction.
  virtual float evaluate(std::span<const float> parameters, const Deflection& deflection) const = 0;
  /// The density of `sample`.
  virtual float pdf(std::span<const float> parameters, const Deflection& deflection) const = 0;
  /// `u` in [0, 1)².
  virtual PhaseSample sample(std::span<const float> parameters, Vector<World> before, std::array<float, 2> u) const = 0;
  /// Mean cosine of the deflection.
  virtual float meanCosine(std::span<const float> parameters) const = 0;

  float evaluate(std::span<const float> parameters, Vector<World> before, Vector<World> after) const {
    return evaluate(parameters, Deflection::between(before, after));
  }
  float pdf(std::span<const float> parameters, Vector<World> before, Vector<World> after) const {
    return pdf(parameters, Deflection::between(before, after));
  }
};

}  // namespace aerosol::volume
