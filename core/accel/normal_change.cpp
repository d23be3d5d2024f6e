#include "core/accel/scene_data.h"

namespace aerosol::accel {

namespace {

/// The change of the unit vector along `v` when `v` changes by `dv`.
Double3 changeOfUnit(Double3 v, Double3 dv) {
  const double l = length(v);
  if (!(l > 0)) return {};
  const Double3 n = v * (1 / l);
  return (dv - n * dot(n, dv)) * (1 / l);
}

/// A normal that is not normalised, and its change, in the space of a surface at rest.
struct NormalAndChange {
  Double3 normal, change;
};

NormalAndChange changeOnMesh(const TriangleMesh& mesh, const SurfaceHit& hit, Double3 step) {
  if (mesh.normals.empty()) return {};
  const auto& index = mesh.triangles[hit.primitive];
  Double3 n[3], p[3];
  for (std::size_t i = 0; i < 3; ++i) {
    n[i] = toDouble(mesh.normals[index[i]]);
    p[i] = toDouble(mesh.positions[index[i]]);
    if (!(dot(n[i], n[i]) > 0)) return {};
  }
  const Double3 e1 = p[1] - p[0], e2 = p[2] - p[0], area = cross(e1, e2);
  const double squared = dot(area, area);
  if (!(squared > 0)) return {};
  const double b1 = static_cast<double>(hit.b1), b2 = static_cast<double>(hit.b2);
  const double db1 = dot(cross(step, e2), area) / squared, db2 = dot(cross(e1, step), area) / squared;
  return {n[0] * (1 - b1 - b2) + n[1] * b1 + n[2] * b2, n[0] * (-db1 - db2) + n[1] * db1 + n[2] * db2};
}

NormalAndChange changeOnQuadric(const AnalyticSurface& surface, Point<World> point, Double3 step) {
  const Matrix4& inverse = surface.toWorld.inverseMatrix();
  if (surface.kind == AnalyticSurface::Kind::disk) return {};
  Double3 p = mapPoint(inverse, toDouble(point)), dp = mapVector(inverse, step);
  if (surface.kind == AnalyticSurface::Kind::cylinder) p.z = dp.z = 0;
  return {mapNormal(inverse, p), mapNormal(inverse, dp)};
}

}  // namespace

/// Normals are a linear function of position on both kinds of surface but for their length: so is their change.
Vector<World> Scene::normalChange(const SurfaceHit& hit, Vector<World> step, float time) const {
  const Surface& surface = data_->surfaces[hit.object];
  Double3 local = toDouble(step);
  Point<World> point = hit.point;
  const std::optional<Transform<World, Object>> placement = surface.placement(time);
  if (placement) {
    local = mapVector(placement->inverseMatrix(), local);
    point = toFloat<Point<World>>(mapPoint(placement->inverseMatrix(), toDouble(point)));
  }
  NormalAndChange found;
  if (const MeshSurface* mesh = surface.restingMesh()) found = changeOnMesh(mesh->mesh, hit, local);
  if (surface.analytic) found = changeOnQuadric(*surface.analytic, point, local);
  if (placement) {
    found = {mapNormal(placement->inverseMatrix(), found.normal), mapNormal(placement->inverseMatrix(), found.change)};
  }
  const bool isTurned = dot(found.normal, toDouble(hit.shadingNormal)) < 0;
  const Double3 change = changeOfUnit(found.normal, found.change);
  return toFloat<Vector<World>>(isTurned ? -change : change);
}

}  // namespace aerosol::accel
