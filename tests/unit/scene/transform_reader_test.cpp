#include "core/scene/transform_reader.h"

#include <gtest/gtest.h>

#include "tests/unit/scene/scene_test_support.h"

namespace aerosol::scene {
namespace {

Transform<World, Object> shapeTransform(const std::string& steps) {
  const SceneDescription scene =
      read("<shape type=\"cube\"><transform name=\"to_world\">" + steps + "</transform></shape>");
  return scene.shapes.empty() ? Transform<World, Object>() : Transform<World, Object>(scene.shapes[0].toWorld);
}

template <class T>
void expectNear(const T& a, float x, float y, float z) {
  EXPECT_NEAR(a.x, x, 1e-6f);
  EXPECT_NEAR(a.y, y, 1e-6f);
  EXPECT_NEAR(a.z, z, 1e-6f);
}

TEST(TransformReader, AppliesTheFirstStepFirst) {
  const auto t = shapeTransform("<translate x=\"1\"/><scale value=\"2\"/>");
  expectNear(t(Point<Object>(0, 0, 0)), 2, 0, 0);
  const auto u = shapeTransform("<scale value=\"2\"/><translate x=\"1\"/>");
  expectNear(u(Point<Object>(0, 0, 0)), 1, 0, 0);
}

TEST(TransformReader, ReadsEachStep) {
  expectNear(shapeTransform("<translate value=\"1, 2, 3\"/>")(Point<Object>(1, 1, 1)), 2, 3, 4);
  expectNear(shapeTransform("<translate y=\"2\"/>")(Point<Object>(1, 1, 1)), 1, 3, 1);
  expectNear(shapeTransform("<scale x=\"2\" z=\"3\"/>")(Point<Object>(1, 1, 1)), 2, 1, 3);
  expectNear(shapeTransform("<scale value=\"2 3 4\"/>")(Point<Object>(1, 1, 1)), 2, 3, 4);
  expectNear(shapeTransform("<rotate z=\"1\" angle=\"90\"/>")(Point<Object>(1, 0, 0)), 0, 1, 0);
  expectNear(shapeTransform("<rotate value=\"0 2 0\" angle=\"90\"/>")(Point<Object>(0, 0, 1)), 1, 0, 0);
  expectNear(shapeTransform("<rotate axis=\"1 1 1\" angle=\"120\"/>")(Point<Object>(1, 0, 0)), 0, 1, 0);
  expectNear(shapeTransform("<matrix value=\"0 0 1  1 0 0  0 1 0\"/>")(Point<Object>(1, 2, 3)), 3, 1, 2);
  expectNear(shapeTransform("<matrix value=\"1 0 0 5  0 1 0 6  0 0 1 7  0 0 0 1\"/>")(Point<Object>(1, 2, 3)), 6, 8,
             10);
}

TEST(TransformReader, QuarterTurnsAreExact) {
  const auto t = shapeTransform("<rotate x=\"1\" angle=\"-90\"/><rotate y=\"1\" angle=\"180\"/>");
  for (const auto& row : t.matrix()) {
    for (const double v : row) EXPECT_TRUE(v == 0 || v == 1 || v == -1) << v;
  }
}

TEST(TransformReader, LooksAlongZWithXToTheLeft) {
  const auto t = shapeTransform("<lookat origin=\"0, 0, -5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/>");
  expectNear(t(Point<Object>(0, 0, 0)), 0, 0, -5);
  expectNear(t(Vector<Object>(0, 0, 1)), 0, 0, 1);
  expectNear(t(Vector<Object>(1, 0, 0)), 1, 0, 0);
  const auto u = shapeTransform("<lookat origin=\"5, 0, 0\" target=\"0, 0, 0\"/>");
  expectNear(u(Vector<Object>(0, 0, 1)), -1, 0, 0);
  expectNear(u(Vector<Object>(0, 1, 0)), 0, 1, 0);
  const auto down = shapeTransform("<lookat origin=\"0, 5, 0\" target=\"0, 0, 0\"/>");
  expectNear(down(Vector<Object>(0, 0, 1)), 0, -1, 0);
}

TEST(TransformReader, TheInverseBelongsToIt) {
  const auto t = shapeTransform("<scale value=\"2 3 4\"/><rotate y=\"1\" angle=\"33\"/><translate x=\"7\"/>");
  expectNear(t.inverse()(t(Point<Object>(0.5f, -1, 2))), 0.5f, -1, 2);
}

TEST(TransformReader, AnEmptyOneIsTheIdentity) { EXPECT_EQ(shapeTransform("").matrix(), identityMatrix()); }

}  // namespace
}  // namespace aerosol::scene
