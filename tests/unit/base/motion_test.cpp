#include "core/base/motion.h"

#include <gtest/gtest.h>

#include <numbers>

namespace aerosol {
namespace {

Matrix4 turned(double degrees, std::array<double, 3> scale = {1, 1, 1}, std::array<double, 3> shift = {}) {
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  Matrix4 m = identityMatrix();
  m[0] = {c * scale[0], -s * scale[1], 0, shift[0]};
  m[1] = {s * scale[0], c * scale[1], 0, shift[1]};
  m[2] = {0, 0, scale[2], shift[2]};
  return m;
}

void expectNear(const Matrix4& a, const Matrix4& b, double tolerance = 1e-12) {
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(a[i][j], b[i][j], tolerance) << i << ' ' << j;
  }
}

Matrix4 at(const Motion& motion, double time) {
  Matrix4 matrix, inverse;
  motion.at(time, matrix, inverse);
  expectNear(multiply(matrix, inverse), identityMatrix());
  return matrix;
}

TEST(Motion, PassesThroughItsKeysAndRestsOutside) {
  const Motion motion({{1, turned(70, {2, 3, 0.5}, {1, 2, 3})}, {-1, turned(-20)}, {4, turned(10, {1, 1, 2})}});
  expectNear(at(motion, -1), turned(-20));
  expectNear(at(motion, 1), turned(70, {2, 3, 0.5}, {1, 2, 3}));
  expectNear(at(motion, 4), turned(10, {1, 1, 2}));
  EXPECT_EQ(at(motion, -5), motion.keys().front().matrix);
  EXPECT_EQ(at(motion, 50), motion.keys().back().matrix);
}

/// A rotation goes at an even angle, a stretch and a translation evenly, each by itself.
TEST(Motion, InterpolatesRotationStretchAndTranslationEach) {
  const Motion motion({{0, turned(0, {1, 1, 1}, {0, 0, 0})}, {2, turned(120, {3, 1, 0.5}, {4, -2, 8})}});
  for (const double u : {0.1, 0.25, 0.5, 0.9})
    expectNear(at(motion, 2 * u), turned(120 * u, {1 + 2 * u, 1, 1 - 0.5 * u}, {4 * u, -2 * u, 8 * u}));
}

TEST(Motion, TurnsTheShortWay) {
  const Motion motion({{0, turned(170)}, {1, turned(-170)}});
  expectNear(at(motion, 0.5), turned(180));
}

TEST(Motion, MirrorsStayMirrors) {
  const Motion motion({{0, turned(0, {-1, 1, 1})}, {1, turned(90, {-2, 1, 1})}});
  expectNear(at(motion, 0), turned(0, {-1, 1, 1}));
  for (const double u : {0.3, 0.7}) {
    const Matrix4 m = at(motion, u);
    EXPECT_LT(m[2][2] * (m[0][0] * m[1][1] - m[0][1] * m[1][0]), -0.5);
  }
}

TEST(Motion, NeverBecomesFlat) {
  Matrix4 sheared = turned(179, {5, 0.01, 1});
  sheared[0][2] = 7;
  const Motion motion({{0, turned(0)}, {1, sheared}});
  for (int i = 0; i <= 100; ++i) at(motion, i / 100.0);
}

TEST(Motion, KnowsWhatChanges) {
  const Motion motion({{0, turned(0)}, {1, turned(30)}, {2, turned(30)}});
  EXPECT_TRUE(motion.moves({0, 1}));
  EXPECT_TRUE(motion.moves({0.9f, 5}));
  EXPECT_FALSE(motion.moves({1, 2}));
  EXPECT_FALSE(motion.moves({3, 4}));
  EXPECT_FALSE(motion.moves({-2, -1}));
}

TEST(MotionProblems, AreFound) {
  Matrix4 flat = turned(0);
  flat[2] = {0, 0, 0, 0};
  const auto problem = [](std::vector<MotionKey> keys) { return Motion::findProblem(keys); };
  EXPECT_TRUE(problem({}));
  EXPECT_EQ(problem({{0, turned(0)}, {1, flat}})->key, 1u);
  EXPECT_EQ(problem({{0, turned(0)}, {1, turned(0)}, {0, turned(5)}})->key, 2u);
  EXPECT_EQ(problem({{0, turned(0)}, {1, turned(0, {-1, 1, 1})}})->key, 1u);
  EXPECT_TRUE(problem(std::vector<MotionKey>(65)));
  EXPECT_FALSE(problem({{1, turned(0)}, {0, turned(9, {-1, -1, 1})}}));
}

/// The fixed map comes first.
TEST(MovingTransform, AppliesTheMotionAfterTheFixedMap) {
  const auto motion = std::make_shared<const Motion>(std::vector<MotionKey>{{0, turned(0)}, {1, turned(90)}});
  const Transform<Object, Object> aside(turned(0, {1, 1, 1}, {3, 0, 0}), turned(0, {1, 1, 1}, {-3, 0, 0}));
  const MovingTransform<World, Object> moving(motion, aside);
  const Point<World> p = moving.at(1)(Point<Object>(0, 0, 0));
  EXPECT_NEAR(p.x, 0, 1e-6);
  EXPECT_NEAR(p.y, 3, 1e-6);
  const Point<Object> back = moving.at(1).inverse()(p);
  EXPECT_NEAR(back.x, 0, 1e-6);
}

}  // namespace
}  // namespace aerosol
