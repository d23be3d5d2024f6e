// Bodies whose faces meet nowhere but at their edges, and meshes that are none, known by how they are made.
#include "core/accel/simple_body.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/accel/double3.h"
#include "tests/unit/accel/random.h"

namespace aerosol::accel {
namespace {

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b, float scale = 1, Vector<World> shift = {}) {
  TriangleMesh both;
  both.positions = a.positions;
  both.triangles = a.triangles;
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  for (const Point<World>& p : b.positions) {
    both.positions.push_back({scale * p.x + shift.x, scale * p.y + shift.y, scale * p.z + shift.z});
  }
  for (const auto& t : b.triangles) both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return both;
}

TriangleMesh inwards(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// Of points (radius, height) from the axis below around the outside to the axis above, or of a closed loop around it.
TriangleMesh turned(const std::vector<std::array<float, 2>>& profile, bool isLoop, std::uint32_t sides = 24) {
  TriangleMesh mesh;
  const auto rings = static_cast<std::uint32_t>(profile.size());
  for (std::uint32_t i = 0; i < sides; ++i) {
    const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(sides);
    for (const auto& [radius, height] : profile) {
      // All of the axis is one place.
      mesh.positions.push_back(
          {radius == 0 ? 0.0f : radius * std::cos(angle), radius == 0 ? 0.0f : radius * std::sin(angle), height});
    }
  }
  for (std::uint32_t i = 0; i < sides; ++i) {
    for (std::uint32_t j = 0; j + (isLoop ? 0 : 1) < rings; ++j) {
      const std::uint32_t next = (i + 1) % sides, up = (j + 1) % rings;
      const std::uint32_t a = i * rings + j, b = next * rings + j, c = next * rings + up, d = i * rings + up;
      if (profile[j][0] != 0) mesh.triangles.push_back({a, b, c});
      if (profile[up][0] != 0) mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

/// A wine glass: foot, stem, a bowl with a wall so thick.
TriangleMesh goblet(float wall) {
  return turned({{0, 0},
                 {0.8f, 0},
                 {0.8f, 0.1f},
                 {0.1f, 0.2f},
                 {0.1f, 1},
                 {0.7f, 1.5f},
                 {0.8f, 2},
                 {0.6f, 2.6f},
                 {0.6f - wall, 2.6f},
                 {0.8f - wall, 2},
                 {0.7f - wall, 1.55f},
                 {0, 1.2f}},
                false);
}

TEST(SimpleBodies, MayBeHollowAndConcave) {
  EXPECT_TRUE(isSimpleBody(makeCube()));
  EXPECT_TRUE(isSimpleBody(turned({{1, 0}, {2, -1}, {3, 0}, {2, 1}}, true)));
  EXPECT_TRUE(isSimpleBody(goblet(0.05f)));
  EXPECT_TRUE(isSimpleBody(goblet(1e-4f)));
  EXPECT_TRUE(isSimpleBody(joined(makeCube(), makeCube(), 1, {2.5f, 0, 0})));
  // A cavity, and a body within it.
  const TriangleMesh hollow = joined(makeCube(), inwards(makeCube()), 0.5f);
  EXPECT_TRUE(isSimpleBody(hollow));
  EXPECT_TRUE(isSimpleBody(joined(hollow, makeCube(), 0.25f)));
}

TEST(SimpleBodies, AreClosedAndTurnOutwards) {
  TriangleMesh open = makeCube();
  open.triangles.pop_back();
  EXPECT_FALSE(isSimpleBody(open));
  EXPECT_FALSE(isSimpleBody(makeRectangle()));
  EXPECT_FALSE(isSimpleBody({}));
  EXPECT_FALSE(isSimpleBody(inwards(makeCube())));
  EXPECT_FALSE(isSimpleBody(joined(makeCube(), inwards(makeCube()), 1, {3, 0, 0})));
  // Inside twice; and a cavity that is outside.
  EXPECT_FALSE(isSimpleBody(joined(makeCube(), makeCube(), 0.5f)));
  EXPECT_FALSE(isSimpleBody(joined(makeCube(), inwards(makeCube()), 2)));
}

TEST(SimpleBodies, DoNotCrossThemselves) {
  EXPECT_FALSE(isSimpleBody(joined(makeCube(), makeCube(), 1, {1, 0.5f, 0.25f})));
  // Faces that coincide, and that touch.
  EXPECT_FALSE(isSimpleBody(joined(makeCube(), makeCube(), 1, {2, 0, 0})));
  EXPECT_FALSE(isSimpleBody(joined(makeCube(), makeCube(), 0.5f, {1.5f, 0, 0})));
  // The inner wall of a bowl pokes through the outer one; a ring that is thicker than it is wide.
  EXPECT_FALSE(isSimpleBody(goblet(-0.05f)));
  EXPECT_FALSE(isSimpleBody(turned({{-0.5f, 0}, {1, -1}, {2, 0}, {1, 1}}, true)));
  // A dent down to near the floor, and through it.
  for (const float depth : {1.9f, 2.1f}) {
    TriangleMesh dented = makeCube();
    for (auto& t : dented.triangles) {
      const Point<World> a = dented.positions[t[0]], b = dented.positions[t[1]], c = dented.positions[t[2]];
      if (a.z < 1 || b.z < 1 || c.z < 1) continue;
      const auto middle = static_cast<std::uint32_t>(dented.positions.size());
      dented.positions.push_back({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, 1 - depth});
      const auto old = t;
      t = {old[0], old[1], middle};
      dented.triangles.push_back({old[1], old[2], middle});
      dented.triangles.push_back({old[2], old[0], middle});
      break;
    }
    EXPECT_EQ(isSimpleBody(dented), depth < 2) << depth;
  }
}

TriangleMesh tetrahedron(const std::array<Double3, 4>& corners) {
  TriangleMesh mesh;
  for (const Double3& p : corners) mesh.positions.push_back(toFloat<Point<World>>(p));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  const Double3 a = corners[1] - corners[0], b = corners[2] - corners[0], c = corners[3] - corners[0];
  return dot(cross(a, b), c) > 0 ? inwards(mesh) : mesh;
}

/// Pairs with a plane between them, however near, and pairs of which an edge of one goes through a face of the other.
TEST(SimpleBodies, OfRandomPairs) {
  Random random("simple bodies");
  const auto number = [&] { return static_cast<double>(random.uniformFloat(-1, 1)); };
  const auto point = [&] { return Double3{number(), number(), number()}; };
  int apart = 0, crossing = 0;
  for (int k = 0; k < 20'000; ++k) {
    std::array<Double3, 4> a{point(), point(), point(), point()}, b{point(), point(), point(), point()};
    // Slivers have no sure outside.
    const auto volume = [](const std::array<Double3, 4>& t) {
      return std::fabs(dot(cross(t[1] - t[0], t[2] - t[0]), t[3] - t[0]));
    };
    const Double3 normal = normalize(point());
    const double gap = std::pow(10.0, -4 + 2 * number());
    if (k % 2 == 0) {
      for (Double3& p : a) p = p - normal * (std::fmax(dot(p, normal), -gap) + gap);
      for (Double3& p : b) p = p - normal * (std::fmin(dot(p, normal), gap) - gap);
    } else {
      const double u = 0.1 + 0.2 * std::fabs(number()), v = 0.1 + 0.2 * std::fabs(number());
      const Double3 within = a[0] * (1 - u - v) + a[1] * u + a[2] * v;
      b[1] = within + (within - b[0]) * (0.5 + 0.4 * number());
    }
    if (volume(a) < 1e-2 || volume(b) < 1e-2) continue;
    ++(k % 2 == 0 ? apart : crossing);
    ASSERT_EQ(isSimpleBody(joined(tetrahedron(a), tetrahedron(b))), k % 2 == 0) << k << " " << gap;
  }
  EXPECT_GT(apart, 2'000);
  EXPECT_GT(crossing, 5'000);
}

}  // namespace
}  // namespace aerosol::accel
