// Which light, and where along a ray: light sampling that begins with the light (Kulla and Fajardo 2012; Conty and
// Kulla 2018, section 6).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/geometry.h"
#include "core/render/light_set.h"
#include "core/volume/equiangular.h"

namespace aerosol::render {

/// A light as it stands to a ray.
struct LightFromRay {
  double projection = 0;    ///< Where along the ray it is nearest.
  double distance = 0;      ///< How far away it is there, exactly.
  double keptDistance = 0;  ///< The same, but not less than its extent or radius: D of equiangular sampling.
  bool isMet = false;       ///< The ray meets a point light to rounding, so its radiance would be infinite.

  /// `length` of the way through media, on which a chosen radius depends.
  static LightFromRay of(const LightPlace& light, const Ray<World>& ray, const volume::RayStretches& stretches);
};

/// The lights beside a ray, as seen from those of its stretches where media scatter. A small value.
class LightsAlongRay {
 public:
  /// Nothing is ever chosen.
  LightsAlongRay() = default;
  /// `chooses`: whether `choose` may choose something. The lights outlive this.
  LightsAlongRay(const LightSet& lights, const Ray<World>& ray, const volume::RayStretches& stretches, bool chooses)
      : lights_(&lights), ray_(ray), stretches_(stretches), chooses_(chooses) {}

  /// Whether `choose` may give anything.
  bool chooses() const { return chooses_ && !stretches_.isEmpty(); }

  /// A light with a place along the ray.
  struct Choice {
    LightId light;
    double t = 0;
    double density = 0;  ///< Joint, of light and place; per scene unit.
    bool isMet = false;  ///< The ray meets it, a point light whose radius nobody has set.
  };

  /// `u` in [0, 1)². Often none: a light whose falloff hardly varies over the stretches is left to other techniques.
  std::optional<Choice> choose(std::array<float, 2> u) const;
  /// The density with which `choose` gives this light and place.
  double density(LightId light, double t) const;
  /// What the irradiance of a light, sampled at a point of the ray `distance` away from it, is to be multiplied by: of
  /// point lights the falloff comes from the ray's distance, rounded once, which may be a kept one. 1 for all others.
  float correction(LightId light, double t, float distance) const;

 private:
  struct Candidate {
    volume::EquiangularSampler sampler;
    double share = 0;   ///< In the choice, not normalised.
    double chance = 0;  ///< That the choice is carried out.
    bool isMet = false;
  };
  Candidate candidate(const LightPlace& light) const;
  double totalShare() const;
  /// With which the light is chosen; `seen` is the light.
  double probability(LightId light, const Candidate& seen) const;
  static std::optional<Choice> place(LightId light, const Candidate& seen, double probability, float xi);

  const LightSet* lights_ = nullptr;
  Ray<World> ray_;
  volume::RayStretches stretches_;
  bool chooses_ = false;
};

}  // namespace aerosol::render
