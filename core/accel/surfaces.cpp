#include "core/accel/surfaces.h"

#include <algorithm>
#include <numbers>

namespace aerosol::accel {

namespace {

constexpr double pi = std::numbers::pi;

struct Corners {
  Double3 origin, edge1, edge2, normal;  ///< `normal` has twice the triangle's area as its length.
};

Corners cornersOf(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto& index = mesh.triangles[triangle];
  const Double3 p0 = toDouble(mesh.positions[index[0]]);
  const Double3 e1 = toDouble(mesh.positions[index[1]]) - p0;
  const Double3 e2 = toDouble(mesh.positions[index[2]]) - p0;
  return {p0, e1, e2, cross(e1, e2)};
}

/// Barycentric weights of corners 1 and 2 for a point of the triangle's plane, moved into the triangle where rounding
/// left it.
std::array<double, 2> barycentrics(const Corners& c, Double3 fromOrigin) {
  const double area = dot(c.normal, c.normal);
  const double b1 = std::clamp(dot(cross(fromOrigin, c.edge2), c.normal) / area, 0.0, 1.0);
  const double b2 = std::clamp(dot(cross(c.edge1, fromOrigin), c.normal) / area, 0.0, 1.0);
  const double sum = b1 + b2;
  return sum > 1 ? std::array{b1 / sum, b2 / sum} : std::array{b1, b2};
}

Double3 interpolatedNormal(const TriangleMesh& mesh, std::uint32_t triangle, double b1, double b2, Double3 geometric) {
  if (mesh.normals.empty()) return geometric;
  Double3 corner[3];
  for (std::size_t i = 0; i < 3; ++i) {
    corner[i] = toDouble(mesh.normals[mesh.triangles[triangle][i]]);
    if (!(dot(corner[i], corner[i]) > 0)) return geometric;
  }
  const Double3 sum = normalize(corner[0] * (1 - b1 - b2) + corner[1] * b1 + corner[2] * b2);
  const double agreement = dot(sum, geometric);
  if (!std::isfinite(agreement) || agreement == 0) return geometric;
  return agreement < 0 ? -sum : sum;
}

/// Texture coordinates and the derivatives of position by them. Without coordinates in the mesh, and where they are
/// degenerate, (u, v) are the barycentrics.
void setParametrisation(SurfaceHit& hit, const TriangleMesh& mesh, std::uint32_t triangle, const Corners& c, double b1,
                        double b2) {
  hit.u = static_cast<float>(b1);
  hit.v = static_cast<float>(b2);
  hit.dPdu = toFloat<Vector<World>>(c.edge1);
  hit.dPdv = toFloat<Vector<World>>(c.edge2);
  if (mesh.uvs.empty()) return;
  const auto& index = mesh.triangles[triangle];
  const TexCoord uv0 = mesh.uvs[index[0]], uv1 = mesh.uvs[index[1]], uv2 = mesh.uvs[index[2]];
  const double du1 = static_cast<double>(uv1.u) - uv0.u, dv1 = static_cast<double>(uv1.v) - uv0.v;
  const double du2 = static_cast<double>(uv2.u) - uv0.u, dv2 = static_cast<double>(uv2.v) - uv0.v;
  hit.u = static_cast<float>(uv0.u + b1 * du1 + b2 * du2);
  hit.v = static_cast<float>(uv0.v + b1 * dv1 + b2 * dv2);
  const double determinant = du1 * dv2 - dv1 * du2;
  if (determinant == 0) return;
  hit.dPdu = toFloat<Vector<World>>((c.edge1 * dv2 - c.edge2 * dv1) * (1 / determinant));
  hit.dPdv = toFloat<Vector<World>>((c.edge2 * du1 - c.edge1 * du2) * (1 / determinant));
}

Double3 toObject(const AnalyticSurface& surface, const DoubleRay& ray, double t) {
  const Matrix4& inverse = surface.toWorld.inverseMatrix();
  return mapPoint(inverse, ray.origin) + mapVector(inverse, ray.direction) * t;
}

Double3 objectNormal(const AnalyticSurface& surface, Double3 p) {
  const Double3 normal = surface.kind == AnalyticSurface::Kind::sphere ? p
                         : surface.kind == AnalyticSurface::Kind::disk ? Double3{0, 0, 1}
                                                                       : Double3{p.x, p.y, 0};
  return surface.flipNormals ? -normal : normal;
}

/// The angle of (x, y) as a fraction of a turn in [0, 1).
double turn(double x, double y) {
  const double angle = std::atan2(y, x) / (2 * pi);
  return angle < 0 ? angle + 1 : angle;
}

/// u around z, v from the pole +z to the pole -z.
void setSphereParameters(SurfaceHit& hit, const Matrix4& toWorld, Double3 p) {
  hit.u = static_cast<float>(turn(p.x, p.y));
  hit.v = static_cast<float>(std::acos(std::clamp(p.z, -1.0, 1.0)) / pi);
  const double rho = std::sqrt(p.x * p.x + p.y * p.y);
  const double cosine = rho > 0 ? p.x / rho : 1, sine = rho > 0 ? p.y / rho : 0;
  hit.dPdu = toFloat<Vector<World>>(mapVector(toWorld, {-2 * pi * p.y, 2 * pi * p.x, 0}));
  hit.dPdv = toFloat<Vector<World>>(mapVector(toWorld, {pi * p.z * cosine, pi * p.z * sine, -pi * rho}));
}

/// u is the radius, v goes around.
void setDiskParameters(SurfaceHit& hit, const Matrix4& toWorld, Double3 p) {
  const double r = std::sqrt(p.x * p.x + p.y * p.y);
  hit.u = static_cast<float>(std::fmin(r, 1));
  hit.v = static_cast<float>(turn(p.x, p.y));
  const Double3 outward = r > 0 ? Double3{p.x / r, p.y / r, 0} : Double3{1, 0, 0};
  hit.dPdu = toFloat<Vector<World>>(mapVector(toWorld, outward));
  hit.dPdv = toFloat<Vector<World>>(mapVector(toWorld, {-2 * pi * p.y, 2 * pi * p.x, 0}));
}

/// u goes around, v from one end to the other.
void setCylinderParameters(SurfaceHit& hit, const Matrix4& toWorld, Double3 p) {
  hit.u = static_cast<float>(turn(p.x, p.y));
  hit.v = static_cast<float>(p.z);
  hit.dPdu = toFloat<Vector<World>>(mapVector(toWorld, {-2 * pi * p.y, 2 * pi * p.x, 0}));
  hit.dPdv = toFloat<Vector<World>>(mapVector(toWorld, {0, 0, 1}));
}

/// From the point of closest approach to the axis, as for spheres.
Crossings intersectCylinder(Double3 o, Double3 d) {
  const double across = d.x * d.x + d.y * d.y;
  if (!(across > 0)) return {};
  const double closest = -(o.x * d.x + o.y * d.y) / across;
  const double x = o.x + d.x * closest, y = o.y + d.y * closest;
  const double inside = 1 - (x * x + y * y);
  if (!(inside > 0)) return {};
  const double half = std::sqrt(inside / across);
  Crossings crossings;
  for (const double t : {closest - half, closest + half}) {
    const double z = o.z + d.z * t;
    if (z >= 0 && z <= 1) crossings.t[crossings.count++] = t;
  }
  return crossings;
}

}  // namespace

Box<World> AnalyticSurface::worldBounds() const {
  const Matrix4& m = toWorld.matrix();
  if (kind == Kind::sphere) return unitSphereBounds(m);
  const auto extent = [&](std::size_t i) { return std::sqrt(m[i][0] * m[i][0] + m[i][1] * m[i][1]); };
  if (kind == Kind::cylinder) {
    const auto middle = [&](std::size_t i) { return m[i][3] + 0.5 * m[i][2]; };
    const auto reach = [&](std::size_t i) { return extent(i) + 0.5 * std::fabs(m[i][2]); };
    return outwardBox({middle(0), middle(1), middle(2)}, {reach(0), reach(1), reach(2)});
  }
  return outwardBox({m[0][3], m[1][3], m[2][3]}, {extent(0), extent(1), extent(2)});
}

std::optional<double> planeDistance(const TriangleMesh& mesh, std::uint32_t triangle, const DoubleRay& ray) {
  const Corners c = cornersOf(mesh, triangle);
  const double slope = dot(ray.direction, c.normal);
  if (slope == 0) return {};
  return dot(c.origin - ray.origin, c.normal) / slope;
}

bool areNeighbours(const TriangleMesh& mesh, std::uint32_t triangle, std::uint32_t other) {
  for (const std::uint32_t i : mesh.triangles[triangle]) {
    for (const std::uint32_t j : mesh.triangles[other]) {
      if (mesh.positions[i] == mesh.positions[j]) return true;
    }
  }
  return false;
}

Crossings intersect(const AnalyticSurface& surface, const DoubleRay& ray) {
  const Double3 o = mapPoint(surface.toWorld.inverseMatrix(), ray.origin);
  const Double3 d = mapVector(surface.toWorld.inverseMatrix(), ray.direction);
  if (surface.kind == AnalyticSurface::Kind::sphere) {
    const auto interval = intersectUnitSphere(o, d);
    return interval ? Crossings{{interval->t0, interval->t1}, 2} : Crossings{};
  }
  if (surface.kind == AnalyticSurface::Kind::cylinder) return intersectCylinder(o, d);
  if (d.z == 0) return {};
  const double t = -o.z / d.z;
  const Double3 p = o + d * t;
  return p.x * p.x + p.y * p.y <= 1 ? Crossings{{t, 0}, 1} : Crossings{};
}

bool entersAt(const TriangleMesh& mesh, std::uint32_t triangle, const DoubleRay& ray) {
  return dot(ray.direction, cornersOf(mesh, triangle).normal) < 0;
}

bool entersAt(const AnalyticSurface& surface, const DoubleRay& ray, double t) {
  const Double3 normal = objectNormal(surface, toObject(surface, ray, t));
  return dot(mapVector(surface.toWorld.inverseMatrix(), ray.direction), normal) < 0;
}

Double3 pointOn(const TriangleMesh& mesh, const SurfaceHit& hit) {
  const Corners c = cornersOf(mesh, hit.primitive);
  return c.origin + c.edge1 * static_cast<double>(hit.b1) + c.edge2 * static_cast<double>(hit.b2);
}

SurfaceHit describeHit(const MeshSurface& surface, std::uint32_t triangle, const DoubleRay& ray, double t) {
  const Corners c = cornersOf(surface.mesh, triangle);
  const auto [b1, b2] = barycentrics(c, ray.origin + ray.direction * t - c.origin);
  const Double3 geometric = normalize(c.normal);
  SurfaceHit hit;
  hit.t = t;
  hit.object = surface.object;
  hit.primitive = triangle;
  hit.passThrough = surface.passThrough;
  hit.entering = dot(ray.direction, c.normal) < 0;
  hit.point = toFloat<Point<World>>(c.origin + c.edge1 * b1 + c.edge2 * b2);
  hit.geometricNormal = toFloat<Normal<World>>(geometric);
  hit.shadingNormal = toFloat<Normal<World>>(interpolatedNormal(surface.mesh, triangle, b1, b2, geometric));
  hit.b1 = static_cast<float>(b1);
  hit.b2 = static_cast<float>(b2);
  setParametrisation(hit, surface.mesh, triangle, c, b1, b2);
  return hit;
}

SurfaceHit describeHit(const AnalyticSurface& surface, const DoubleRay& ray, double t) {
  const Matrix4& forward = surface.toWorld.matrix();
  Double3 p = toObject(surface, ray, t);
  if (surface.kind == AnalyticSurface::Kind::sphere) {
    p = normalize(p);
  } else if (surface.kind == AnalyticSurface::Kind::disk) {
    p.z = 0;
  } else {
    const double radius = std::hypot(p.x, p.y);
    p = {p.x / radius, p.y / radius, std::clamp(p.z, 0.0, 1.0)};
  }
  SurfaceHit hit;
  hit.t = t;
  hit.object = surface.object;
  hit.passThrough = surface.passThrough;
  hit.entering = entersAt(surface, ray, t);
  hit.point = toFloat<Point<World>>(mapPoint(forward, p));
  const Double3 normal = normalize(mapNormal(surface.toWorld.inverseMatrix(), objectNormal(surface, p)));
  hit.geometricNormal = hit.shadingNormal = toFloat<Normal<World>>(normal);
  if (surface.kind == AnalyticSurface::Kind::sphere) {
    setSphereParameters(hit, forward, p);
  } else if (surface.kind == AnalyticSurface::Kind::cylinder) {
    setCylinderParameters(hit, forward, p);
  } else {
    setDiskParameters(hit, forward, p);
  }
  return hit;
}

}  // namespace aerosol::accel
