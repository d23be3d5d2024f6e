// Mesh volumes against winding numbers computed in long double, triangle by triangle.

#include "core/accel/mesh_volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/accel/convex_volume.h"
#include "core/accel/double3.h"
#include "tests/unit/accel/random.h"

namespace aerosol::accel {
namespace {

using Real = long double;

#if defined(__has_feature) && (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer))
constexpr int rayCount = 50'000;
#else
constexpr int rayCount = 1'000'000;
#endif

/// A torus around the z axis, closed and concave; `flip` turns it inside out.
TriangleMesh torus(double major, double minor, Point<World> center, bool flip = false, int rings = 24, int sides = 16) {
  TriangleMesh mesh;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < sides; ++j) {
      const double a = 2 * M_PI * i / rings, b = 2 * M_PI * j / sides, r = major + minor * std::cos(b);
      mesh.positions.emplace_back(static_cast<float>(center.x + r * std::cos(a)),
                                  static_cast<float>(center.y + r * std::sin(a)),
                                  static_cast<float>(center.z + minor * std::sin(b)));
      const auto at = [&](int k, int l) { return static_cast<std::uint32_t>((k % rings) * sides + l % sides); };
      const std::uint32_t p = at(i, j), q = at(i + 1, j), s = at(i + 1, j + 1), t = at(i, j + 1);
      mesh.triangles.push_back(flip ? std::array{p, s, q} : std::array{p, q, s});
      mesh.triangles.push_back(flip ? std::array{p, t, s} : std::array{p, s, t});
    }
  }
  return mesh;
}

TriangleMesh join(TriangleMesh a, const TriangleMesh& b) {
  a.uvs.clear();
  a.normals.clear();
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

/// The winding number of a point: the sum of the solid angles of all triangles over 4π (van Oosterom and Strackee
/// 1983).
Real windingNumber(const TriangleMesh& mesh, const Real (&x)[3]) {
  Real sum = 0;
  for (const auto& triangle : mesh.triangles) {
    Real v[3][3], n[3];
    for (int i = 0; i < 3; ++i) {
      const Point<World>& p = mesh.positions[triangle[static_cast<std::size_t>(i)]];
      for (int k = 0; k < 3; ++k) v[i][k] = static_cast<Real>(p[k]) - x[k];
      n[i] = std::sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
    }
    const auto dot = [&](int i, int j) { return v[i][0] * v[j][0] + v[i][1] * v[j][1] + v[i][2] * v[j][2]; };
    const Real determinant = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) -
                             v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
                             v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
    sum += 2 * std::atan2(determinant, n[0] * n[1] * n[2] + dot(0, 1) * n[2] + dot(1, 2) * n[0] + dot(2, 0) * n[1]);
  }
  return sum / (4 * static_cast<Real>(M_PI));
}

bool isInside(const TriangleMesh& mesh, const Ray<World>& ray, double t) {
  Real x[3];
  for (int k = 0; k < 3; ++k) {
    x[k] = static_cast<Real>(ray.origin[k]) + static_cast<Real>(t) * static_cast<Real>(ray.direction[k]);
  }
  return std::abs(std::round(windingNumber(mesh, x))) > 0;
}

bool holds(const IntervalList& intervals, double t) {
  return std::ranges::any_of(intervals, [&](const Interval& i) { return i.t0 <= t && t <= i.t1; });
}

std::unique_ptr<const VolumeShape> make(const TriangleMesh& mesh) {
  auto made = MeshVolume::make(mesh, {});
  EXPECT_TRUE(made);
  return std::move(*made);
}

void compare(const TriangleMesh& mesh, const char* name, int rays) {
  Random random(name);
  const auto volume = make(mesh);
  int inside = 0;
  for (int k = 0; k < rays; ++k) {
    // From afar, from within, along an axis, towards a vertex.
    Ray<World> ray{random.point(k % 2 ? 5.0 : 1.5), random.direction()};
    if (k % 5 == 3) ray.direction = k % 2 ? Vector<World>(0, 0, 1) : Vector<World>(-1, 0, 0);
    if (k % 5 == 4) {
      const auto corner = static_cast<std::size_t>(random.uniform(0, static_cast<double>(mesh.positions.size())));
      ray.direction = normalize(mesh.positions[corner] - ray.origin);
    }
    IntervalList intervals;
    EXPECT_TRUE(volume->intersect(ray, intervals)) << name << " " << k;
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      EXPECT_LT(intervals[i].t0, intervals[i].t1);
      if (i > 0) EXPECT_LE(intervals[i - 1].t1, intervals[i].t0);
    }
    for (int s = 0; s < 4; ++s) {
      const double t = random.uniform(-8, 8);
      const bool isNearEnd = std::ranges::any_of(
          intervals, [&](const Interval& i) { return std::abs(i.t0 - t) < 1e-4 || std::abs(i.t1 - t) < 1e-4; });
      if (isNearEnd) continue;
      EXPECT_EQ(holds(intervals, t), isInside(mesh, ray, t)) << name << " ray " << k << " t " << t;
      inside += isInside(mesh, ray, t) ? 1 : 0;
    }
  }
  EXPECT_GT(inside, rays / 100);
}

TEST(MeshVolume, agreesWithWindingNumbers) {
  const TriangleMesh one = torus(1.5, 0.6, {0, 0, 0});
  compare(one, "concave", 400);
  compare(torus(1.5, 0.6, {0, 0, 0}, true), "inside out", 200);
  compare(join(one, torus(1.5, 0.6, {0.7f, 0, 0.2f})), "overlapping shells", 300);
  compare(join(one, torus(1.5, 0.3, {0, 0, 0}, true)), "hollow", 300);
  compare(join(one, torus(0.5, 0.3, {0, 0, 3})), "two parts", 200);
}

/// Every triangle in double (Möller and Trumbore 1997); nothing where the line comes too near to an edge to be sure.
std::optional<IntervalList> bruteForce(const TriangleMesh& mesh, const Ray<World>& ray) {
  const Double3 o = toDouble(ray.origin), d = toDouble(ray.direction);
  std::vector<std::pair<double, int>> crossings;
  for (const auto& triangle : mesh.triangles) {
    const Double3 a = toDouble(mesh.positions[triangle[0]]), e = toDouble(mesh.positions[triangle[1]]) - a,
                  f = toDouble(mesh.positions[triangle[2]]) - a;
    const Double3 p = cross(d, f), s = o - a, q = cross(s, e);
    const double determinant = dot(e, p);
    if (std::abs(determinant) < 1e-6) {
      if (std::abs(dot(s, cross(e, f))) < 1e-6) return {};
      continue;
    }
    const double u = dot(s, p) / determinant, v = dot(d, q) / determinant;
    if (u < -1e-5 || v < -1e-5 || u + v > 1 + 1e-5) continue;
    if (u < 1e-5 || v < 1e-5 || u + v > 1 - 1e-5) return {};
    crossings.emplace_back(dot(f, q) / determinant, determinant > 0 ? 1 : -1);
  }
  std::ranges::sort(crossings);
  IntervalList intervals;
  int winding = 0;
  double begin = 0;
  for (const auto& [t, step] : crossings) {
    if (winding == 0) begin = t;
    winding += step;
    if (winding == 0) intervals.add({begin, t});
  }
  return intervals;
}

TEST(MeshVolume, agreesWithBruteForceOnAMillionRays) {
  Random random("million");
  const TriangleMesh mesh =
      join(torus(1.5, 0.6, {0, 0, 0}, false, 10, 7), torus(1.2, 0.5, {0.7f, 0, 0.2f}, false, 9, 6));
  const auto volume = make(mesh);
  int compared = 0, met = 0;
  for (int k = 0; k < rayCount; ++k) {
    Ray<World> ray{random.point(k % 2 ? 4.0 : 1.5), random.direction()};
    const auto expected = bruteForce(mesh, ray);
    if (!expected) continue;
    IntervalList intervals;
    ASSERT_TRUE(volume->intersect(ray, intervals)) << k;
    ASSERT_EQ(intervals.size(), expected->size()) << k;
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      ASSERT_NEAR(intervals[i].t0, (*expected)[i].t0, 1e-8) << k;
      ASSERT_NEAR(intervals[i].t1, (*expected)[i].t1, 1e-8) << k;
    }
    ++compared;
    met += intervals.empty() ? 0 : 1;
  }
  EXPECT_GT(compared, rayCount / 10 * 9);
  EXPECT_GT(met, rayCount / 5);
}

TEST(MeshVolume, crossesTheSameFromAMillionSizesAway) {
  const auto volume = make(torus(1.5, 0.6, {0, 0, 0}));
  for (const double distance : {1e2, 1e4, 1e6}) {
    const Ray<World> ray{{static_cast<float>(-distance), 0, 0}, {1, 0, 0}};
    IntervalList intervals;
    EXPECT_TRUE(volume->intersect(ray, intervals));
    ASSERT_EQ(intervals.size(), 2u) << distance;
    EXPECT_NEAR(intervals[0].t0 - distance, -2.1, 1e-6 + 1e-12 * distance);
    EXPECT_NEAR(intervals[0].t1 - distance, -0.9, 1e-6 + 1e-12 * distance);
    EXPECT_NEAR(intervals[1].t1 - distance, 2.1, 1e-6 + 1e-12 * distance);
  }
}

TEST(MeshVolume, startsInsideAndBehind) {
  const auto volume = make(torus(1.5, 0.6, {0, 0, 0}));
  IntervalList intervals;
  EXPECT_TRUE(volume->intersect({{1.5f, 0, 0}, {1, 0, 0}}, intervals));
  ASSERT_EQ(intervals.size(), 2u);
  EXPECT_NEAR(intervals[0].t0, -3.6, 1e-6);
  EXPECT_NEAR(intervals[1].t0, -0.6, 1e-6);
  EXPECT_NEAR(intervals[1].t1, 0.6, 1e-6);
}

TEST(MeshVolume, throwsNoStreakThroughAHole) {
  TriangleMesh cube = makeCube();
  cube.triangles.erase(cube.triangles.begin(), cube.triangles.begin() + 2);
  EXPECT_EQ(examine(cube).openEdges, 4u);
  const auto volume = make(cube);
  Random random("hole");
  int open = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Ray<World> ray{random.point(4), random.direction()};
    IntervalList intervals;
    if (!volume->intersect(ray, intervals)) ++open;
    for (const Interval& i : intervals) {
      const Point<World> middle = ray.at(static_cast<float>(0.5 * (i.t0 + i.t1)));
      for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(middle[axis]), 1.0001f);
    }
  }
  EXPECT_GT(open, 500);
}

TEST(MeshVolume, pairsByParityWhereTrianglesDisagree) {
  TriangleMesh cube = makeCube();
  std::swap(cube.triangles[4][1], cube.triangles[4][2]);
  const MeshTopology topology = examine(cube);
  EXPECT_TRUE(topology.isClosed());
  EXPECT_FALSE(topology.isOriented());
  const auto volume = make(cube);
  Random random("parity");
  for (int k = 0; k < 5'000; ++k) {
    const Ray<World> ray{random.point(3), random.direction()};
    IntervalList intervals;
    EXPECT_TRUE(volume->intersect(ray, intervals));
    IntervalList box;
    BoxVolume({}).ConvexVolume::intersect(ray, box);
    ASSERT_EQ(intervals.size(), box.size()) << k;
    for (std::size_t i = 0; i < box.size(); ++i) {
      EXPECT_NEAR(intervals[i].t0, box[i].t0, 1e-6);
      EXPECT_NEAR(intervals[i].t1, box[i].t1, 1e-6);
    }
  }
}

TEST(MeshVolume, refusesWhatIsNoMesh) {
  EXPECT_FALSE(MeshVolume::make({}, {}));
  TriangleMesh broken = makeCube();
  broken.triangles[0][0] = 1000;
  EXPECT_FALSE(MeshVolume::make(broken, {}));
}

TEST(MeshVolume, sliversAndDoubledFacesAreHarmless) {
  const TriangleMesh cube = makeCube();
  TriangleMesh doubled = join(cube, cube);
  doubled.triangles.push_back({0, 1, 0});
  const auto volume = make(doubled);
  IntervalList intervals;
  EXPECT_TRUE(volume->intersect({{0.3f, 0.2f, -5}, {0, 0, 1}}, intervals));
  ASSERT_EQ(intervals.size(), 1u);
  EXPECT_NEAR(intervals[0].t0, 4, 1e-6);
  EXPECT_NEAR(intervals[0].t1, 6, 1e-6);
}

}  // namespace
}  // namespace aerosol::accel
