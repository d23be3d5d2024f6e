#include "core/accel/refined_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "core/accel/curved_mesh.h"
#include "core/accel/double3.h"

namespace aerosol::accel {
namespace {

/// A number that follows from both ends of an edge alone, whichever comes first.
double chanceOf(const TriangleMesh& mesh, std::uint32_t a, std::uint32_t b) {
  const Double3 p = toDouble(mesh.positions[a]) + toDouble(mesh.positions[b]);
  const double x = std::sin(p.x * 12.9898 + p.y * 78.233 + p.z * 37.719) * 43758.5453;
  return x - std::floor(x);
}

RefinedMesh refinedAtRandom(TriangleMesh mesh, RefinedMesh::Bend bend, int passes, double share) {
  resolveNormals(mesh);
  RefinedMesh refined(std::move(mesh), std::move(bend));
  for (int pass = 0; pass < passes; ++pass)
    refined.halve([&](std::uint32_t a, std::uint32_t b) { return chanceOf(refined.mesh(), a, b) < share; });
  return refined;
}

/// Edges by the places of their ends: in a closed mesh each has two triangles, one on each side.
std::size_t openEdges(const RefinedMesh& refined) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : refined.mesh().triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = refined.placeOf(t[i]), b = refined.placeOf(t[(i + 1) % 3]);
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  std::size_t open = 0;
  for (const auto& [edge, balance] : edges) open += balance != 0;
  return open;
}

double volumeOf(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles)
    volume +=
        dot(toDouble(mesh.positions[t[0]]), cross(toDouble(mesh.positions[t[1]]), toDouble(mesh.positions[t[2]]))) / 6;
  return volume;
}

TEST(RefinedMesh, StaysClosedAcrossSeams) {
  CurvedMesh sphere = makeSphereMesh();
  for (const double share : {0.2, 0.5, 0.8, 1.0}) {
    const RefinedMesh cube = refinedAtRandom(makeCube(), {}, 5, share);
    EXPECT_GT(cube.mesh().triangles.size(), 12u);
    EXPECT_EQ(openEdges(cube), 0u) << share;
    EXPECT_NEAR(volumeOf(cube.mesh()), 8, 1e-5) << share;
    const RefinedMesh ball = refinedAtRandom(sphere.mesh, sphere.bend, 4, share);
    EXPECT_EQ(openEdges(ball), 0u) << share;
  }
}

TEST(RefinedMesh, OfCurvedShapesLiesOnThem) {
  CurvedMesh sphere = makeSphereMesh();
  const TriangleMesh ball = refinedAtRandom(sphere.mesh, sphere.bend, 5, 1).take();
  EXPECT_NEAR(volumeOf(ball), 4 * std::numbers::pi / 3, 2e-3);
  for (std::size_t i = 0; i < ball.positions.size(); ++i) {
    const Double3 p = toDouble(ball.positions[i]);
    EXPECT_NEAR(length(p), 1, 1e-6);
    EXPECT_NEAR(length(toDouble(ball.normals[i]) - p), 0, 1e-6);
    EXPECT_NEAR(static_cast<double>(ball.uvs[i].v), std::acos(p.z) / std::numbers::pi, 1e-5);
    const double turn = static_cast<double>(ball.uvs[i].u) * 2 * std::numbers::pi, rho = std::hypot(p.x, p.y);
    EXPECT_NEAR(std::cos(turn) * rho, p.x, 1e-5);
    EXPECT_NEAR(std::sin(turn) * rho, p.y, 1e-5);
  }
  CurvedMesh tube = makeCylinderMesh();
  const TriangleMesh pipe = refinedAtRandom(tube.mesh, tube.bend, 4, 1).take();
  for (const Point<World>& p : pipe.positions) EXPECT_NEAR(std::hypot(p.x, p.y), 1, 1e-6);
  CurvedMesh disk = makeDiskMesh();
  const TriangleMesh flat = refinedAtRandom(disk.mesh, disk.bend, 5, 1).take();
  double area = 0;
  for (const auto& t : flat.triangles) {
    const Double3 a = toDouble(flat.positions[t[0]]);
    area += cross(toDouble(flat.positions[t[1]]) - a, toDouble(flat.positions[t[2]]) - a).z / 2;
  }
  EXPECT_NEAR(area, std::numbers::pi, 2e-3);
  for (std::size_t i = 0; i < flat.positions.size(); ++i)
    EXPECT_NEAR(std::hypot(flat.positions[i].x, flat.positions[i].y), flat.uvs[i].u, 1e-6);
}

TEST(RefinedMesh, CarriesAttributesAlong) {
  TriangleMesh mesh = makeRectangle();
  mesh.attributes.push_back({"vertex_x", 2, false, {-1, 5, 1, 5, 1, 5, -1, 5}});
  mesh.attributes.push_back({"face_number", 1, true, {10, 20}});
  const TriangleMesh fine = refinedAtRandom(mesh, {}, 5, 0.6).take();
  ASSERT_FALSE(findDefect(fine)) << *findDefect(fine);
  for (std::size_t i = 0; i < fine.positions.size(); ++i) {
    EXPECT_FLOAT_EQ(fine.attributes[0].values[2 * i], fine.positions[i].x);
    EXPECT_FLOAT_EQ(fine.attributes[0].values[2 * i + 1], 5);
    EXPECT_FLOAT_EQ(fine.uvs[i].u, 0.5f * (fine.positions[i].x + 1));
  }
  for (std::size_t t = 0; t < fine.triangles.size(); ++t) {
    float x = 0, y = 0;
    for (const std::uint32_t corner : fine.triangles[t]) {
      x += fine.positions[corner].x;
      y += fine.positions[corner].y;
    }
    EXPECT_EQ(fine.attributes[1].values[t], y < x ? 10 : 20);  // Two triangles on both sides of the diagonal.
  }
}

TEST(RefinedMesh, AsksOnlyWhereSomethingChanged) {
  RefinedMesh refined(makeRectangle());
  std::size_t asked = 0;
  const auto never = [&](std::uint32_t, std::uint32_t) {
    ++asked;
    return false;
  };
  EXPECT_EQ(refined.halve(never), 0u);
  EXPECT_GT(asked, 0u);
  asked = 0;
  EXPECT_EQ(refined.halve(never), 0u);
  EXPECT_EQ(asked, 0u);
}

TEST(JoinedNormals, AreSmoothAcrossSeamsAndSharpAcrossEdges) {
  CurvedMesh sphere = makeSphereMesh();
  RefinedMesh ball = refinedAtRandom(sphere.mesh, sphere.bend, 4, 1);
  TriangleMesh mesh = ball.mesh();
  mesh.normals.clear();
  computeJoinedNormals(mesh, ball.mesh().normals, [&](std::uint32_t i) { return ball.placeOf(i); });
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_NEAR(length(toDouble(mesh.normals[i]) - toDouble(mesh.positions[i])), 0, 6e-3);

  RefinedMesh cube = refinedAtRandom(makeCube(), {}, 3, 1);
  TriangleMesh sharp = cube.mesh();
  sharp.normals.clear();
  computeJoinedNormals(sharp, cube.mesh().normals, [&](std::uint32_t i) { return cube.placeOf(i); });
  for (std::size_t i = 0; i < sharp.positions.size(); ++i)
    EXPECT_NEAR(length(toDouble(sharp.normals[i]) - toDouble(cube.mesh().normals[i])), 0, 1e-6);
}

}  // namespace
}  // namespace aerosol::accel
