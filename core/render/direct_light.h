// Next-event estimation: light that reaches a scattering vertex straight from a light, by multiple importance sampling.
#pragma once

#include <optional>

#include "core/render/closure_mix.h"
#include "core/render/lamp_directions.h"
#include "core/render/lights_along_ray.h"
#include "core/render/path_context.h"
#include "core/render/prepared_scene.h"
#include "core/volume/medium.h"
#include "core/volume/phase.h"
#include "core/volume/task.h"

namespace aerosol::render {

/// Balance heuristic (Veach 1995) for one sample of each of two techniques.
inline float balance(float pdf, float otherPdf) { return pdf > 0 ? pdf / (pdf + otherPdf) : 0; }

/// Another way to the same vertex and light.
struct Rivalry {
  double ratio = 0;       ///< Of its density to that of the way taken.
  bool isEnough = false;  ///< It serves alone: a light is not sampled besides.
};

/// Where a path scatters: in a medium, or on a surface.
class ScatteringVertex {
 public:
  virtual ~ScatteringVertex() = default;

  /// Seen from where lights are sampled.
  virtual Point<World> position() const = 0;
  /// Where a ray in this direction starts.
  virtual Point<World> originTowards(Vector<World> direction) const = 0;
  /// The surface-defined medium that such a ray starts in; null in empty space.
  virtual const volume::Medium* mediumTowards(Vector<World> direction) const = 0;
  /// All that are around where such a ray starts, where media nest.
  virtual const volume::MediumStack& mediaTowards(Vector<World> direction) const = 0;
  /// Phase function, or closures times |cos|; without delta parts.
  virtual Color evaluate(Vector<World> direction) const = 0;
  /// Per steradian, with which the path goes on in `direction`.
  virtual float pdf(Vector<World> direction) const = 0;

  /// How often the vertex is found by a choice that begins with this light, for each time that it is found as it was.
  virtual Rivalry rivalry(LightId) const { return {}; }
  /// Which lights light it; null: all.
  virtual const LinkedLights* links() const { return nullptr; }
  /// Factor on the light's irradiance; see LightsAlongRay::correction.
  virtual float correction(LightId, float) const { return 1; }
};

/// A point of a ray where it is scattered, and the densities with which it was, or could have been, chosen.
struct PlaceOnRay {
  const LightsAlongRay* lights = nullptr;  ///< Beside the ray; they outlive this.
  double t = 0;
  double choicePdf = 0;   ///< Of the distance tracker (volume::DistanceSample).
  double lightScale = 0;  ///< Where lights are tabulated: of the place, over the mass of all (volume::TabulatedLight).

  Rivalry rivalry(LightId light) const {
    const LightsAlongRay::Claim claim =
        lights->isTabulated() ? lights->tabulatedClaim(light, t, lightScale) : lights->claim(light, t);
    return {choicePdf > 0 ? claim.density / choicePdf : 0, claim.isEnough};
  }
};

class MediumVertex final : public ScatteringVertex {
 public:
  /// `ray` arrives and is scattered by `medium`; `boundaryMedium` is the surface-defined medium around the vertex, the
  /// one of `media` that rules. All outlive the vertex.
  MediumVertex(const PreparedScene& scene, const volume::Medium& medium, const Ray<World>& ray, const PlaceOnRay& place,
               float anisotropy, const volume::Medium* boundaryMedium, const volume::MediumStack& media)
      : phase_(scene.phaseOf(medium)),
        links_(scene.linksOf(medium)),
        position_(accel::pointAt(ray, place.t)),
        before_(ray.direction),
        place_(place),
        parameters_{anisotropy},
        boundaryMedium_(boundaryMedium),
        media_(media) {
    if (hasOptionalEffects && !scene.lampsInMedia.empty()) lamps_.emplace(lampsAround(scene, medium));
  }

  Point<World> position() const override { return position_; }
  Point<World> originTowards(Vector<World>) const override { return position_; }
  const volume::Medium* mediumTowards(Vector<World>) const override { return boundaryMedium_; }
  const volume::MediumStack& mediaTowards(Vector<World>) const override { return media_; }
  Color evaluate(Vector<World> direction) const override {
    return Color(phase_.evaluate(parameters_, before_, direction));
  }
  float pdf(Vector<World> direction) const override {
    const float byPhase = phase_.pdf(parameters_, before_, direction);
    if (!followsLamps()) return byPhase;
    return (1 - lamps_->share()) * byPhase + lamps_->share() * lamps_->pdf(direction);
  }
  Rivalry rivalry(LightId light) const override { return place_.rivalry(light); }
  float correction(LightId light, float distance) const override {
    return place_.lights->correction(light, place_.t, distance);
  }
  const LinkedLights* links() const override { return links_; }
  const PlaceOnRay& place() const { return place_; }
  /// Whether some directions are chosen towards lamps.
  bool followsLamps() const { return lamps_ && !lamps_->isEmpty(); }
  volume::PhaseSample sample(std::array<float, 2> u) const {
    return followsLamps() ? sampleMixture(u) : phase_.sample(parameters_, before_, u);
  }

 private:
  LampDirections lampsAround(const PreparedScene& scene, const volume::Medium& medium) const;
  volume::PhaseSample sampleMixture(std::array<float, 2> u) const;

  const volume::PhaseFunction& phase_;
  const LinkedLights* links_;
  Point<World> position_;
  Vector<World> before_;
  const PlaceOnRay& place_;
  std::array<float, 1> parameters_;
  const volume::Medium* boundaryMedium_;
  const volume::MediumStack& media_;
  std::optional<LampDirections> lamps_;  ///< Where there are lamps in media.
};

class SurfaceVertex final : public ScatteringVertex {
 public:
  /// What lies on one side.
  struct Side {
    const volume::Medium* medium = nullptr;  ///< The surface-defined one.
    const volume::MediumStack& media;        ///< All of them, where media nest.
  };

  /// All outlive the vertex. `near` is the side that the ray came from, `far` the one behind.
  /// `lightsPassed`: lights behind the surface have been sampled straight through it, from the vertex before.
  SurfaceVertex(const accel::SurfaceHit& hit, const ClosureMix& closures, const Side& near, const Side& far,
                bool lightsPassed = false, const LinkedLights* links = nullptr)
      : hit_(hit), closures_(closures), near_(near), far_(far), lightsPassed_(lightsPassed), links_(links) {}

  Point<World> position() const override { return hit_.point; }
  Point<World> originTowards(Vector<World> direction) const override { return hit_.originTowards(direction); }
  const volume::Medium* mediumTowards(Vector<World> direction) const override { return sideOf(direction).medium; }
  const volume::MediumStack& mediaTowards(Vector<World> direction) const override { return sideOf(direction).media; }
  Color evaluate(Vector<World> direction) const override {
    return lightsPassed_ && isBehind(direction) ? Color() : closures_.evaluate(direction);
  }
  float pdf(Vector<World> direction) const override { return closures_.pdf(direction); }
  const LinkedLights* links() const override { return links_; }

 private:
  const Side& sideOf(Vector<World> direction) const { return isBehind(direction) ? far_ : near_; }
  bool isBehind(Vector<World> direction) const { return (dot(direction, hit_.geometricNormal) > 0) != hit_.entering; }

  const accel::SurfaceHit& hit_;
  const ClosureMix& closures_;
  Side near_, far_;
  bool lightsPassed_;
  const LinkedLights* links_;
};

/// The light sampling of one vertex: of one light, or of several where clusters of many are split. Two slots of the
/// path's stream. Path and vertex outlive it.
class DirectLight {
 public:
  DirectLight(PathContext& path, const ScatteringVertex& vertex, float time, float splitThreshold);

  /// Goes on to the next sample, first of all to the first one; false behind the last.
  bool next() { return next_++ < picks_.count; }

  // The sample at hand:
  const ScatteringVertex& vertex() const { return vertex_; }
  const LightSet& lights() const { return lights_; }
  std::optional<LightSet::Choice> choice() const { return lights_.choose(picks_, next_ - 1, vertex_.position()); }
  /// What `choice` leaves to draw with.
  LightUniforms uniforms() const;

 private:
  const ScatteringVertex& vertex_;
  const LightSet& lights_;
  LightSet::Picks picks_;
  LightUniforms uniforms_;
  std::size_t next_ = 0;
};

/// The sample at hand: radiance · evaluate · transmittance / pdf, weighted against the direction sampling of the vertex
/// and against vertices that were chosen for the light.
volume::Task<Color> estimateDirectLight(PathContext& path, const DirectLight& lit);

/// The same for a vertex that was chosen for a light, which must be one that lights it: divided by the joint density of
/// light and place. One slot.
volume::Task<Color> estimateChosenLight(PathContext& path, const MediumVertex& vertex,
                                        const LightsAlongRay::Choice& choice, float time, float splitThreshold);

/// What the path found by its own direction sampling needs to weight light that it meets.
struct DirectionRecord {
  Point<World> from;
  float pdf = 0;        ///< Per steradian.
  bool isDelta = true;  ///< No light sample could have found the direction (or there was none): full weight.
  std::optional<PlaceOnRay> place;      ///< Of a vertex in a medium.
  const LinkedLights* links = nullptr;  ///< Which lights count; null: all.
  float splitThreshold = neverSplit;    ///< Of the light sampling there.
  bool isReplaced = false;  ///< Shadow rays have gone straight where this direction was bent: no light counts.
};

/// What the texture of a light multiplies its light by, at a point with its texture coordinates; white without one.
volume::Task<Color> lightTexture(PathContext& path, std::uint32_t light, const shading::ShadingPoint& point);

/// The weight of what media emit along a ray up to the first surface: they may be sampled as lights.
float metEmissionWeight(const PreparedScene& scene, Vector<World> direction, const DirectionRecord& record);

/// Radiance of lights at infinity along a ray that leaves the scene, weighted; AOVs get it light by light.
Color escapedLight(const PreparedScene& scene, Vector<World> direction, const DirectionRecord& record,
                   PathRecord* aovs = nullptr);

/// Radiance of an area light that a ray has met, weighted.
Color metLight(const PreparedScene& scene, std::uint32_t light, const accel::SurfaceHit& hit, const Ray<World>& ray,
               const DirectionRecord& record);

}  // namespace aerosol::render
