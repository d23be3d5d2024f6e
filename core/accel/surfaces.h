// The surfaces of a scene as the queries see them. Internal to this folder.
#pragma once

#include <optional>

#include "core/accel/hit.h"
#include "core/accel/mesh.h"
#include "core/accel/unit_sphere.h"

namespace aerosol::accel {

/// A ray in double: exactly the float ray.
struct DoubleRay {
  Double3 origin, direction;
};

/// A mesh with its flags carried out (resolveNormals).
struct MeshSurface {
  ObjectId object = 0;
  bool passThrough = false;
  TriangleMesh mesh;
};

/// The unit sphere, the unit disk in the xy plane facing +z, or the open cylinder of radius 1 about the z axis from 0
/// to 1, under an affine map.
struct AnalyticSurface {
  enum class Kind : std::uint8_t { sphere, disk, cylinder };

  Kind kind = Kind::sphere;
  ObjectId object = 0;
  bool passThrough = false;
  bool flipNormals = false;
  Transform<World, Object> toWorld;

  Box<World> worldBounds() const;
};

/// Up to two distances at which a line meets a surface, ascending.
struct Crossings {
  double t[2] = {0, 0};
  int count = 0;
};

/// Where the ray meets the triangle's plane; nothing when it is parallel or the triangle has no area. Whether it is
/// inside is Embree's (watertight) decision.
std::optional<double> planeDistance(const TriangleMesh& mesh, std::uint32_t triangle, const DoubleRay& ray);

/// Whether two triangles have a corner position in common.
bool areNeighbours(const TriangleMesh& mesh, std::uint32_t triangle, std::uint32_t other);

Crossings intersect(const AnalyticSurface& surface, const DoubleRay& ray);

/// Whether the ray comes from the outside at distance t.
bool entersAt(const TriangleMesh& mesh, std::uint32_t triangle, const DoubleRay& ray);
bool entersAt(const AnalyticSurface& surface, const DoubleRay& ray, double t);

/// Where on its plane a mesh was hit, by the hit's weights.
Double3 pointOn(const TriangleMesh& mesh, const SurfaceHit& hit);

/// Everything about the hit at distance t.
SurfaceHit describeHit(const MeshSurface& surface, std::uint32_t triangle, const DoubleRay& ray, double t);
SurfaceHit describeHit(const AnalyticSurface& surface, const DoubleRay& ray, double t);

}  // namespace aerosol::accel
