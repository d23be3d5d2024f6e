// What a light is to the integrator.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/color.h"
#include "core/base/geometry.h"
#include "core/base/mesh_place.h"
#include "core/render/light_cone.h"
#include "core/render/light_tree.h"

namespace aerosol::render {

/// Random numbers for one light sample, each in [0, 1).
struct LightUniforms {
  float choice = 0;  ///< Which part of the light.
  std::array<float, 2> place{};
  float time = 0;  ///< Seconds: no random number, but when the light is to be seen.
};

/// Light that can arrive at a point, before anything in between. Its estimate is value / pdf.
struct LightSample {
  Vector<World> direction;  ///< Unit, from the point to the light.
  float distance = std::numeric_limits<float>::infinity();
  Color value;           ///< Radiance; of a delta light the irradiance on a plane that faces it.
  float pdf = 0;         ///< Per steradian; 1 for a delta light.
  bool isDelta = false;  ///< No other technique can find this direction.
  Point<World> point;    ///< On the light, where `distance` is finite.
  Normal<World> normal;  ///< Geometric, unit, towards the emitting side; zero where the light has no surface.
  float u = 0, v = 0;    ///< Where on the light's texture, where it has one.
  MeshPlace place = {};  ///< Where on its mesh, where it is one.
};

/// A point of a light's surface that a ray met.
struct LightHit {
  Point<World> point;
  Normal<World> normal;         ///< Geometric, unit, as accel::SurfaceHit has it: towards the emitting side.
  Vector<World> direction;      ///< Unit, of the ray that arrived.
  std::uint32_t primitive = 0;  ///< The triangle of a mesh.
  float time = 0;               ///< Seconds, of the ray.
};

/// Where a light is that is not at infinity, for the choice of distances along a ray.
struct LightPlace {
  Point<World> centre;
  float extent = 0;             ///< Half of its size; 0 for a point.
  float intensity = 0;          ///< About its mean radiant intensity, averaged over channels.
  float radius = 0;             ///< Of a point light: nearer than this it gets no brighter along a ray; 0: chosen.
  bool hasSingularity = false;  ///< Its irradiance grows without limit near `centre`.
  LightCone cone;               ///< Outside of it there is no light.
};

/// Of a light at one point, for the hierarchy: an edge of the cone is as bright as its axis.
LightBounds boundsOfPoint(const LightPlace& place);

/// A light. Const after preparation; directions are unit vectors in world space.
class Light {
 public:
  virtual ~Light() = default;

  /// Light arriving at `from`; none where it cannot come from the sampled part.
  virtual std::optional<LightSample> sample(Point<World> from, const LightUniforms& u) const = 0;

  /// Per steradian, with which `sample(from)` finds a hit of this light. 0 for lights without a surface.
  virtual float pdf(Point<World> from, const LightHit& hit) const;
  /// Radiance from a hit back along the ray.
  virtual Color emitted(const LightHit& hit) const;

  /// Per steradian, with which `sample(from)` finds a direction that leaves the scene.
  virtual float pdfEscaped(Point<World> from, Vector<World> direction) const;
  /// Radiance that a ray sees which leaves the scene.
  virtual Color escaped(Vector<World> direction) const;
  /// Both at once.
  struct Escaped {
    Color radiance;
    float pdf = 0;
  };
  virtual Escaped escapedWithPdf(Point<World> from, Vector<World> direction) const {
    return {escaped(direction), pdfEscaped(from, direction)};
  }

  /// Emitted power in watts (per scene unit², where lengths are scene units). `sceneRadius` bounds the scene for lights
  /// at infinity.
  virtual Color power(float sceneRadius) const = 0;
  /// About the irradiance on all sides of a point (radiance over the whole sphere), were nothing in between: what the
  /// choice among lights goes by. Positive wherever light can arrive.
  virtual float importance(Point<World> at) const = 0;
  /// None for lights at infinity.
  virtual std::optional<LightPlace> place() const { return {}; }

  // Among many lights, large meshes are sampled part by part: a part is a light of its own.
  virtual std::uint32_t partCount() const { return 1; }
  /// None for lights at infinity.
  virtual std::optional<LightBounds> partBounds(std::uint32_t) const { return {}; }
  virtual std::optional<LightSample> samplePart(std::uint32_t, Point<World> from, const LightUniforms& u) const {
    return sample(from, u);
  }
  /// With which `samplePart(part, from)` finds a hit of that part.
  virtual float pdfPart(std::uint32_t, Point<World> from, const LightHit& hit) const { return pdf(from, hit); }
  virtual std::uint32_t partAt(const LightHit&) const { return 0; }
  /// A medium that glows: samples give a direction alone, whose density is `pdfEscaped`.
  virtual bool isVolume() const { return false; }
  /// While the shutter is open.
  virtual bool moves() const { return false; }
  virtual bool isDelta() const = 0;
  /// False of a light at infinity that the directions which surfaces and media choose themselves find better than any
  /// samples of it: where all directions are alike.
  virtual bool isSampled() const { return true; }
  /// Arrives from beyond the scene.
  virtual bool isInfinite() const = 0;
};

}  // namespace aerosol::render
