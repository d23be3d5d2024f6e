// Which light, and where along a ray: light sampling that begins with the light (Kulla and Fajardo 2012; Conty and
// Kulla 2018, section 6). Where all media on the ray are constant, and lights few, their extinction is part of the
// density: then it follows nearly the whole integrand, and no other way to sample the light there is needed.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/geometry.h"
#include "core/render/light_choice.h"
#include "core/render/light_set.h"
#include "core/volume/equiangular.h"
#include "core/volume/light_columns.h"

namespace aerosol::render {

/// A light as it stands to a ray.
struct LightFromRay {
  double projection = 0;    ///< Where along the ray it is nearest.
  double distance = 0;      ///< How far away it is there, exactly.
  double keptDistance = 0;  ///< The same, but not less than its extent or radius: D of equiangular sampling.
  bool isMet = false;       ///< The ray meets a point light to rounding, so its radiance would be infinite.
  /// The part of the ray in its cone.
  ConeStretch inCone{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

  /// `length` of the way through media, on which a chosen radius depends.
  static LightFromRay of(const LightPlace& light, const Ray<World>& ray, const volume::RayStretches& stretches);
};

/// The lights beside a ray, as seen from those of its stretches where media scatter.
class LightsAlongRay {
 public:
  /// Nothing is ever chosen.
  LightsAlongRay() = default;
  static const LightsAlongRay& none();
  /// The lights outlive this.
  LightsAlongRay(const LightSet& lights, const Ray<World>& ray, const volume::RayStretches& stretches,
                 LightChoice choice, float splitThreshold = neverSplit)
      : lights_(&lights), ray_(ray), stretches_(stretches), chooses_(choice == LightChoice::equiangular) {
    if (stretches.isEmpty() || lights.placed().empty()) return;
    if (choice == LightChoice::tabulated) tabulate();
    if (chooses_ && !lights.tree().isEmpty()) cut_ = lights.tree().cut(RayQuery{ray_, stretches_}, splitThreshold);
  }

  /// Whether `choose` may give anything.
  bool chooses() const { return chooses_ && !stretches_.isEmpty(); }
  /// Whether places come from tables.
  bool isTabulated() const { return columnCount_ > 0; }
  /// What tables need to know of the lights.
  volume::LightColumns columns() const;

  /// A light with a place along the ray.
  struct Choice {
    LightId light;
    double t = 0;
    double density = 0;  ///< Joint, of light and place; per scene unit.
    bool isMet = false;  ///< The ray meets it, a point light whose radius nobody has set.
  };

  /// How many choices there are: of many lights one for each cluster, where these are split.
  std::size_t count() const { return !chooses() ? 0 : lights_->tree().isEmpty() ? 1 : cut_.count; }
  /// `u` in [0, 1)², the same for all choices, of which this is number `index`. Often none: a light whose falloff
  /// hardly varies over the stretches is left to other techniques.
  std::optional<Choice> choose(std::array<float, 2> u, std::size_t index = 0) const;
  /// The light of the place that tables gave; `u` in [0, 1) serves the choice within a cluster.
  std::optional<Choice> choose(const volume::TabulatedLight& found, float u) const;
  /// What `choose` does for a light and a place.
  struct Claim {
    double density = 0;  ///< With which it gives them, in one of its choices.
    /// It does so in proportion to nearly all that they contribute: other samples of the light from there would only
    /// add noise.
    bool isEnough = false;
  };
  Claim claim(LightId light, double t) const;
  double density(LightId light, double t) const { return claim(light, t).density; }
  /// The same of tables: `scale` of the place (volume::TabulatedLight) over the mass of all.
  Claim tabulatedClaim(LightId light, double t, double scale) const;
  /// What the irradiance of a light, sampled at a point of the ray `distance` away from it, is to be multiplied by: of
  /// point lights the falloff comes from the ray's distance, rounded once, which may be a kept one. 1 for all others.
  float correction(LightId light, double t, float distance) const;

 private:
  struct Candidate {
    volume::EquiangularSampler even;
    volume::AttenuatedEquiangularSampler attenuated;
    bool isAttenuated = false;  ///< Which of the two serves.
    double share = 0;           ///< In the choice, not normalised.
    double chance = 0;          ///< That the choice is carried out.
    bool isMet = false;

    double sample(double xi) const { return isAttenuated ? attenuated.sample(xi) : even.sample(xi); }
    double pdf(double t) const { return isAttenuated ? attenuated.pdf(t) : even.pdf(t); }
    double integral() const { return isAttenuated ? attenuated.integral() : even.integral(); }
  };
  double chanceOf(const LightFromRay& seen, const volume::RayStretches& lit) const;
  Candidate candidate(const LightPlace& light) const;
  void tabulate();
  volume::LightColumn column(std::size_t index) const;
  double totalShare() const;
  /// With which the light is chosen; `seen` is the light.
  double probability(LightId light, const Candidate& seen) const;
  static std::optional<Choice> place(LightId light, const Candidate& seen, double probability, float xi);

  const LightSet* lights_ = nullptr;
  Ray<World> ray_;
  volume::RayStretches stretches_;
  bool chooses_ = false;
  std::uint8_t columnCount_ = 0;  ///< Lights, few as they are, or clusters of the hierarchy.
  LightCut cut_;
};

}  // namespace aerosol::render
