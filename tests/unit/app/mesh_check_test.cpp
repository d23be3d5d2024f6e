#include "core/app/doctor/mesh_check.h"

#include <gtest/gtest.h>

namespace aerosol::app {
namespace {

using accel::TriangleMesh;

TriangleMesh movedCube(float x) {
  TriangleMesh mesh = accel::makeCube();
  for (Point<World>& p : mesh.positions) p.x += x;
  return mesh;
}

TEST(MeshCheck, ACubeIsSound) {
  const MeshDefects defects = checkMesh(accel::makeCube());
  EXPECT_FALSE(defects.any());
  EXPECT_EQ(defects.degenerate, 0u);
}

TEST(MeshCheck, AMissingTriangleIsAHole) {
  TriangleMesh mesh = accel::makeCube();
  mesh.triangles.pop_back();
  const MeshDefects defects = checkMesh(mesh);
  EXPECT_EQ(defects.openEdges, 3u);
  ASSERT_TRUE(defects.openAt);
  const Point<World> p = *defects.openAt;
  EXPECT_EQ(std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}), 1);
}

TEST(MeshCheck, ATurnedTriangleDisagrees) {
  TriangleMesh mesh = accel::makeCube();
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_EQ(checkMesh(mesh).turnedEdges, 3u);
}

TEST(MeshCheck, DoublesSliversAndInnerWallsAreFound) {
  TriangleMesh mesh = accel::makeCube();
  mesh.triangles.push_back(mesh.triangles[3]);
  EXPECT_EQ(checkMesh(mesh).doubled, 1u);
  mesh = accel::makeCube();
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_EQ(checkMesh(mesh).degenerate, 1u);
  EXPECT_FALSE(checkMesh(mesh).any());
  mesh = accel::makeCube();
  mesh.positions.push_back({0, 0, 0});
  const auto centre = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  mesh.triangles.push_back({mesh.triangles[0][0], mesh.triangles[0][1], centre});
  EXPECT_EQ(checkMesh(mesh).crowdedEdges, 1u);
  EXPECT_EQ(checkMesh(mesh).openEdges, 2u);
}

TEST(CoincidentFaces, AreFoundWhereTheyOverlap) {
  const TriangleMesh cube = movedCube(0), touching = movedCube(2), apart = movedCube(2.001f), inside = movedCube(0.5f);
  EXPECT_EQ(findCoincidentFaces({&cube, &touching}).size(), 1u);
  EXPECT_EQ(findCoincidentFaces({&cube, &apart}).size(), 0u);
  EXPECT_EQ(findCoincidentFaces({&cube, &inside}).size(), 1u) << "faces in y and z";
  EXPECT_EQ(findCoincidentFaces({&cube, nullptr, &touching, &apart}).size(), 2u) << "and the two on the right";
}

TEST(CoincidentFaces, InOnePlaneSideBySideAreNone) {
  TriangleMesh a = accel::makeRectangle(), b = accel::makeRectangle();
  for (Point<World>& p : b.positions) p.x += 2;
  EXPECT_TRUE(findCoincidentFaces({&a, &b}).empty());
  for (Point<World>& p : b.positions) p.x -= 0.5f;
  EXPECT_EQ(findCoincidentFaces({&a, &b}).size(), 1u);
}

}  // namespace
}  // namespace aerosol::app
