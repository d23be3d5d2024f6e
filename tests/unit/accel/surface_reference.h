// What rays meet, by testing every triangle in long double; and what tests of surfaces share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/accel/scene.h"
#include "tests/unit/accel/random.h"

namespace aerosol::accel {

struct Vec {
  long double x = 0, y = 0, z = 0;
};
inline Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline long double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
template <class T>
Vec vec(T p) {
  return {p.x, p.y, p.z};
}

/// What a ray meets by testing every triangle and sphere in long double; `margin` is how far from an edge (in
/// barycentric or relative terms) the nearest decision was, so that undecidable rays can be left out.
struct Reference {
  long double t = std::numeric_limits<long double>::infinity();
  ObjectId object = 0;
  std::uint32_t primitive = 0;
  long double margin = 1;
};

inline void testTriangle(const TriangleMesh& mesh, ObjectId object, std::uint32_t triangle, const Ray<World>& ray,
                         Reference& best) {
  const auto& i = mesh.triangles[triangle];
  const Vec a = vec(mesh.positions[i[0]]), e1 = vec(mesh.positions[i[1]]) - a, e2 = vec(mesh.positions[i[2]]) - a;
  const Vec n = cross(e1, e2), d = vec(ray.direction), o = vec(ray.origin);
  const long double slope = dot(d, n);
  if (slope == 0) return;
  const long double t = dot(a - o, n) / slope;
  const Vec q{o.x + t * d.x - a.x, o.y + t * d.y - a.y, o.z + t * d.z - a.z};
  const long double u = dot(cross(q, e2), n) / dot(n, n), v = dot(cross(e1, q), n) / dot(n, n);
  const long double inside = std::min({u, v, 1 - u - v});
  if (t > ray.tMin && t < ray.tMax) best.margin = std::min(best.margin, std::abs(inside));
  if (inside < 0 || t <= ray.tMin || t >= ray.tMax || t >= best.t) return;
  best.t = t;
  best.object = object;
  best.primitive = triangle;
}

inline TriangleMesh randomMesh(Random& random, std::size_t triangles) {
  TriangleMesh mesh;
  for (std::size_t i = 0; i < triangles; ++i) {
    const Point<World> centre = random.point(10);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(centre + (random.point(2) - Point<World>()));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

struct Buffers {
  SpanBuffer spans;
  InterfaceBuffer interfaces;
  Counters counters;
};

inline Scene build(SceneBuilder& builder, const SceneOptions& options = {}) {
  auto scene = builder.build(options);
  EXPECT_TRUE(scene);
  return std::move(*scene);
}

}  // namespace aerosol::accel
