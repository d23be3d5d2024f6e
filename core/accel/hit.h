// What a ray query returns: surface hits, volume spans, interfaces.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"

namespace aerosol::accel {

using ObjectId = std::uint32_t;  ///< Surfaces (meshes, spheres, disks), counted from 0 in the order of adding.
using VolumeId = std::uint32_t;  ///< Volume primitives, counted from 0 in the order of adding.

/// The total order of the hits along one ray: by distance; of coincident ones an opaque surface before one that lets
/// rays pass (a medium's box may stand exactly on the ground), then by object and primitive. The same ray always
/// gets the same keys, so a query can be continued behind a hit without an epsilon.
struct HitKey {
  double t = 0;
  bool passThrough = false;
  ObjectId object = 0;
  std::uint32_t primitive = 0;

  friend auto operator<=>(const HitKey&, const HitKey&) = default;
};

/// A ray's stretch in one volume primitive; t0 < t1, in units of the ray's parameter; t1 may be infinite.
struct Span {
  double t0 = 0, t1 = 0;
  VolumeId volume = 0;

  friend auto operator<=>(const Span&, const Span&) = default;
};

/// A surface with no effect of its own (null bsdf) that a shadow ray crosses.
struct Interface {
  HitKey key;
  bool entering = false;  ///< The ray comes from the side that the geometric normal points to.

  friend auto operator<=>(const Interface&, const Interface&) = default;
};

/// Grown when needed and reused from ray to ray, so that a query allocates nothing in the long run.
using SpanBuffer = std::vector<Span>;
using InterfaceBuffer = std::vector<Interface>;

/// Where a ray meets a surface.
struct SurfaceHit {
  double t = 0;  ///< In units of the ray's parameter.
  ObjectId object = 0;
  std::uint32_t primitive = 0;    ///< The triangle of a mesh; 0 for spheres and disks.
  bool passThrough = false;       ///< As the surface was added.
  bool entering = false;          ///< The ray comes from the side that `geometricNormal` points to.
  bool hasCompany = false;        ///< Another face may be as near as rounding of floats.
  Point<World> point;             ///< Within half an ulp per coordinate of the surface.
  Normal<World> geometricNormal;  ///< Unit; points outwards as the surface's winding says, not towards the ray.
  Normal<World> shadingNormal;    ///< Unit; on the geometric normal's side.
  float u = 0, v = 0;
  float b1 = 0, b2 = 0;      ///< On a mesh, weights of the triangle's second and third corner.
  Vector<World> dPdu, dPdv;  ///< Per unit of u and v; zero where the parametrisation is singular.

  HitKey key() const { return {t, passThrough, object, primitive}; }
  /// Where a ray that leaves this hit in `direction` starts; it needs no tMin.
  Point<World> originTowards(Vector<World> direction) const;
};

/// Moves a point that was rounded to float off its surface, to the side that `direction` points to, by as little as
/// rounding can have moved it: a ray from there does not meet a plane through the unrounded point again.
Point<World> offsetPoint(Point<World> p, Normal<World> geometricNormal, Vector<World> direction);

/// `origin + t * direction` in double, rounded once.
Point<World> pointAt(const Ray<World>& ray, double t);

}  // namespace aerosol::accel
