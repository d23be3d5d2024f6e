// Meshes with faces that are turned or missing, made closed bodies again.
#include "core/accel/closed_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/accel/double3.h"
#include "core/accel/mesh_volume.h"

namespace aerosol::accel {
namespace {

/// By the divergence theorem; positive where faces look outwards.
double volumeOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Double3 a = toDouble(mesh.positions[t[0]]), b = toDouble(mesh.positions[t[1]]),
                  c = toDouble(mesh.positions[t[2]]);
    sum += dot(a, cross(b, c)) / 6;
  }
  return sum;
}

bool isSound(const TriangleMesh& mesh) {
  const MeshTopology topology = examine(mesh);
  return topology.openEdges == 0 && topology.flippedEdges == 0 && !findDefect(mesh);
}

/// A torus with texture coordinates and numbers on faces and corners.
TriangleMesh torus() {
  constexpr std::uint32_t n = 12, m = 8;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < m; ++j) {
      const float u = 6.2831853f * static_cast<float>(i) / n, v = 6.2831853f * static_cast<float>(j) / m;
      const float r = 2 + 0.5f * std::cos(v);
      mesh.positions.push_back({r * std::cos(u), r * std::sin(u), 0.5f * std::sin(v)});
      mesh.uvs.push_back({u, v});
      const std::uint32_t right = (i + 1) % n, up = (j + 1) % m;
      mesh.triangles.push_back({i * m + j, right * m + j, right * m + up});
      mesh.triangles.push_back({i * m + j, right * m + up, i * m + up});
    }
  }
  mesh.attributes = {{"vertex_a", 2, false, std::vector<float>(2 * mesh.positions.size(), 1)},
                     {"face_b", 1, true, std::vector<float>(mesh.triangles.size(), 2)}};
  return mesh;
}

void expectNothingDone(TriangleMesh mesh) {
  const TriangleMesh before = mesh;
  const MeshRepair repair = closeBodies(mesh);
  EXPECT_EQ(repair.turned + repair.closedHoles, 0u);
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_EQ(mesh.positions.size(), before.positions.size());
}

TEST(ClosedMeshes, SoundOnesAreLeftAlone) {
  expectNothingDone(makeCube());
  expectNothingDone(torus());
  TriangleMesh inwards = torus();
  for (auto& t : inwards.triangles) std::swap(t[1], t[2]);
  expectNothingDone(inwards);
}

TEST(ClosedMeshes, TheFewerAreTurned) {
  TriangleMesh mesh = torus();
  const double volume = volumeOf(mesh);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  EXPECT_FALSE(isSound(mesh));
  const MeshRepair repair = closeBodies(mesh);
  EXPECT_EQ(repair.turned, mesh.triangles.size() / 3);
  EXPECT_TRUE(isSound(mesh));
  EXPECT_NEAR(volumeOf(mesh), volume, 1e-9);
}

/// A face of a cube is put back as it was; corners that no face shares are one.
TEST(ClosedMeshes, AFaceThatIsMissing) {
  for (std::size_t face = 0; face < 6; ++face) {
    TriangleMesh mesh = makeCube();
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(2 * face),
                         mesh.triangles.begin() + static_cast<std::ptrdiff_t>(2 * face + 2));
    const MeshRepair repair = closeBodies(mesh);
    EXPECT_EQ(repair.closedHoles, 1u);
    EXPECT_EQ(repair.leftOpen, 0u);
    EXPECT_TRUE(isSound(mesh));
    EXPECT_NEAR(volumeOf(mesh), 8, 1e-6);
  }
}

TEST(ClosedMeshes, SeveralHolesAndWhatBelongsToCorners) {
  TriangleMesh mesh = torus();
  const double volume = volumeOf(mesh);
  // One triangle here, a fan of two there.
  for (const std::size_t gone : {std::size_t{101}, std::size_t{100}, std::size_t{7}}) {
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(gone));
    mesh.attributes[1].values.pop_back();
  }
  const MeshRepair repair = closeBodies(mesh);
  EXPECT_EQ(repair.closedHoles, 2u);
  EXPECT_TRUE(isSound(mesh));
  EXPECT_NEAR(volumeOf(mesh), volume, 0.02 * volume);
  EXPECT_EQ(mesh.uvs.size(), mesh.positions.size());
  EXPECT_EQ(mesh.attributes[0].values, std::vector<float>(2 * mesh.positions.size(), 1));
  EXPECT_EQ(mesh.attributes[1].values, std::vector<float>(mesh.triangles.size(), 2));
}

/// Water, also with waves and in the form of a bowl, is meant to be open; a tube with both ends open is not.
TEST(ClosedMeshes, SheetsStayOpenAndTubesDoNot) {
  expectNothingDone(makeRectangle());
  const auto surface = [](auto height) {
    TriangleMesh mesh;
    constexpr std::uint32_t n = 20;
    for (std::uint32_t i = 0; i <= n; ++i) {
      for (std::uint32_t j = 0; j <= n; ++j) {
        const float x = static_cast<float>(i) / 10 - 1, y = static_cast<float>(j) / 10 - 1;
        mesh.positions.push_back({x, y, height(x, y)});
        if (i == n || j == n) continue;
        const std::uint32_t a = i * (n + 1) + j;
        mesh.triangles.push_back({a, a + n + 1, a + n + 2});
        mesh.triangles.push_back({a, a + n + 2, a + 1});
      }
    }
    return mesh;
  };
  expectNothingDone(surface([](float x, float y) { return 0.2f * std::sin(9 * x) * std::sin(7 * y); }));
  expectNothingDone(surface([](float x, float y) { return x * x + y * y; }));
  TriangleMesh tube;
  constexpr std::uint32_t n = 16;
  for (std::uint32_t i = 0; i < n; ++i) {
    const float u = 6.2831853f * static_cast<float>(i) / n;
    for (const float z : {-1.0f, 1.0f}) tube.positions.push_back({std::cos(u), std::sin(u), z});
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
    tube.triangles.push_back({a, b, b + 1});
    tube.triangles.push_back({a, b + 1, a + 1});
  }
  const MeshRepair repair = closeBodies(tube);
  EXPECT_EQ(repair.closedHoles, 2u);
  EXPECT_TRUE(isSound(tube));
  EXPECT_NEAR(volumeOf(tube), 2 * 0.5 * n * std::sin(6.2831853 / n), 1e-5);
}

/// A strip with one side alone.
TEST(ClosedMeshes, WhatHasNoSidesIsLeftAlone) {
  TriangleMesh strip;
  constexpr std::uint32_t n = 24;
  for (std::uint32_t i = 0; i < n; ++i) {
    const float u = 6.2831853f * static_cast<float>(i) / n;
    for (const float s : {-0.3f, 0.3f}) {
      const float r = 1 + s * std::cos(u / 2);
      strip.positions.push_back({r * std::cos(u), r * std::sin(u), s * std::sin(u / 2)});
    }
    const bool isLast = i + 1 == n;
    const std::uint32_t a = 2 * i, b = isLast ? 1 : a + 2, c = isLast ? 0 : a + 3;
    strip.triangles.push_back({a, b, c});
    strip.triangles.push_back({a, c, a + 1});
  }
  const auto before = strip.triangles;
  EXPECT_EQ(closeBodies(strip).turned, 0u);
  strip.triangles.resize(before.size());
  EXPECT_EQ(strip.triangles, before);
}

}  // namespace
}  // namespace aerosol::accel
