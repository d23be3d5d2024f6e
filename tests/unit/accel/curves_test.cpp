// Fibres against closed forms and against what their own axes say.

#include "core/accel/curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/accel/scene.h"
#include "tests/unit/accel/random.h"

namespace aerosol::accel {
namespace {

std::string writeCurves(const std::string& name, const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << text;
  return path.string();
}

CurveSet load(const std::string& text, CurveBasis basis, const Transform<World, Object>& toWorld = {}) {
  auto curves = loadCurves(writeCurves("fibres.txt", text), basis, toWorld);
  EXPECT_TRUE(curves) << format(curves.errors());
  return curves ? *curves : CurveSet{};
}

std::string errorOf(const std::string& text, CurveBasis basis = CurveBasis::bSpline) {
  const auto curves = loadCurves(writeCurves("broken.txt", text), basis, {});
  return curves ? "" : format(curves.errors());
}

Scene sceneOf(CurveSet curves, bool passThrough = false) {
  SceneBuilder builder;
  EXPECT_TRUE(builder.addCurves(std::move(curves), passThrough));
  auto scene = builder.build();
  EXPECT_TRUE(scene);
  return std::move(*scene);
}

Vector<World> vector(Normal<World> n) { return {n.x, n.y, n.z}; }

TEST(Curves, FilesHoldFibresBetweenEmptyLines) {
  const CurveSet curves = load("\n0 0 0 0.1\n1 0 0 .2\r\n 2 0 0 0.3 \n\n \n0 1 0 1e-1\n1 1 0 0.1", CurveBasis::linear,
                               translateScale(0, 0, 5, 2));
  ASSERT_EQ(curves.points.size(), 5u);
  EXPECT_EQ(curves.segments, (std::vector<std::uint32_t>{0, 1, 3}));
  EXPECT_EQ(curves.along[1], (std::array<float, 2>{0.5f, 1}));
  EXPECT_EQ(curves.points[2].position.x, 4);
  EXPECT_EQ(curves.points[2].position.z, 5);
  EXPECT_EQ(curves.points[2].radius, 0.3f);
}

TEST(Curves, BrokenFilesAreErrorsWithTheirPlace) {
  EXPECT_NE(errorOf("0 0 0 1\n1 0 x 1\n").find("broken.txt:2:5"), std::string::npos);
  EXPECT_NE(errorOf("0 0 0 1\n1 0 0\n").find("broken.txt:2:6"), std::string::npos);
  EXPECT_NE(errorOf("0 0 0 1 2\n").find("broken.txt:1:9"), std::string::npos);
  EXPECT_NE(errorOf("0 0 0 -1\n").find("negative"), std::string::npos);
  EXPECT_NE(errorOf("0 0 0 1\n1 0 0 1\n2 0 0 1\n").find("4 points"), std::string::npos);
  EXPECT_NE(errorOf("0 0 0 1\n", CurveBasis::linear).find("2 points"), std::string::npos);
  EXPECT_NE(errorOf("\n\n").find("no points"), std::string::npos);
  EXPECT_NE(errorOf("0 0 0 nan\n").find("finite"), std::string::npos);
}

/// A straight fibre is a cylinder.
TEST(Curves, StraightOnesAreCylinders) {
  const std::string text = "-1 0 0 0.5\n0 0 0 0.5\n1 0 0 0.5\n2 0 0 0.5\n3 0 0 0.5\n4 0 0 0.5\n";
  for (const CurveBasis basis : {CurveBasis::linear, CurveBasis::bSpline}) {
    const Scene scene = sceneOf(load(text, basis));
    Random random("Curves.StraightOnesAreCylinders");
    SpanBuffer spans;
    Counters counters;
    int hits = 0;
    for (int i = 0; i < 3000; ++i) {
      const Point<World> from(random.uniformFloat(0.2, 2.8), random.uniformFloat(-3, 3), random.uniformFloat(2, 3));
      const Point<World> to(random.uniformFloat(0.8, 2.2), random.uniformFloat(-0.9, 0.9), 0);
      const Ray<World> ray{from, to - from};
      // Of the circle in y and z.
      const double oy = from.y, oz = from.z, dy = ray.direction.y, dz = ray.direction.z;
      const double a = dy * dy + dz * dz, b = oy * dy + oz * dz, c = oy * oy + oz * oz - 0.25;
      const double rest = b * b - a * c;
      const auto hit = scene.closestHit(ray, spans, counters);
      if (std::fabs(rest) < 1e-3) continue;
      ASSERT_EQ(hit.has_value(), rest > 0) << i;
      if (!hit) continue;
      ++hits;
      EXPECT_NEAR(hit->t, (-b - std::sqrt(rest)) / a, 1e-4);
      EXPECT_TRUE(hit->entering);
      EXPECT_NEAR(hit->geometricNormal.x, 0, 1e-4f);
      EXPECT_NEAR(hit->geometricNormal.y, 2 * hit->point.y, 1e-4f);
      EXPECT_NEAR(hit->geometricNormal.z, 2 * hit->point.z, 1e-4f);
      const float begin = basis == CurveBasis::linear ? -1 : 0, end = basis == CurveBasis::linear ? 4 : 3;
      EXPECT_NEAR(hit->v, (hit->point.x - begin) / (end - begin), 1e-4f);
      EXPECT_NEAR(dot(hit->dPdv, Vector<World>(1, 0, 0)), end - begin, 1e-3f);
      EXPECT_NEAR(length(hit->dPdu), 3.14159f, 1e-4f);
      EXPECT_GT(dot(cross(hit->dPdu, hit->dPdv), vector(hit->geometricNormal)), 0);
    }
    EXPECT_GT(hits, 1000);
  }
}

std::string bentFibres(Random& random) {
  std::string text;
  for (int fibre = 0; fibre < 40; ++fibre) {
    const Point<World> root = random.point(2);
    for (int i = 0; i < 7; ++i) {
      const Point<World> p = root + 0.35f * static_cast<float>(i) * Vector<World>(0.3f, 1, -0.2f) +
                             0.25f * (random.point(1) - Point<World>());
      text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + " " +
              std::to_string(random.uniform(0.02, 0.08)) + "\n";
    }
    text += "\n";
  }
  return text;
}

/// The parametrisation is that of the surface: neighbouring hits differ by dPdu and dPdv times the change of u and v,
/// and the normal stands on both.
TEST(Curves, BentOnesAgreeWithTheirDerivatives) {
  for (const CurveBasis basis : {CurveBasis::bSpline, CurveBasis::linear}) {
    Random random("Curves.BentOnesAgreeWithTheirDerivatives");
    const Scene scene = sceneOf(load(bentFibres(random), basis));
    SpanBuffer spans;
    Counters counters;
    int hits = 0, neighbours = 0;
    for (int i = 0; i < 20000; ++i) {
      const Point<World> from = random.point(6), to = random.point(2.5);
      const Ray<World> ray{from, normalize(to - from)};
      const auto hit = scene.closestHit(ray, spans, counters);
      InterfaceBuffer interfaces;
      ASSERT_EQ(scene.occluded(ray, spans, interfaces, counters), hit.has_value());
      if (!hit) continue;
      ++hits;
      EXPECT_NEAR(length(hit->point - ray.at(static_cast<float>(hit->t))), 0, 2e-3f);
      const Vector<World> n = vector(hit->geometricNormal);
      EXPECT_NEAR(length(n), 1, 1e-5f);
      EXPECT_NEAR(dot(n, normalize(hit->dPdu)), 0, 2e-2f);
      if (!(dot(n, ray.direction) < -0.5f)) continue;
      const auto other =
          scene.closestHit({from, normalize(ray.direction + 1e-4f * random.direction())}, spans, counters);
      if (!other || other->primitive != hit->primitive || std::fabs(other->u - hit->u) > 0.2f) continue;
      const Vector<World> step = other->point - hit->point;
      const Vector<World> told = (other->u - hit->u) * hit->dPdu + (other->v - hit->v) * hit->dPdv;
      neighbours += length(step - told) <= 0.1f * length(step) + 1e-4f;
      EXPECT_NEAR(dot(step, n), 0, 0.1f * length(step) + 2e-4f);
    }
    EXPECT_GT(hits, 1000);
    EXPECT_GT(neighbours, hits / 3);
  }
}

TEST(Curves, RaysThatLeaveAFibreDoNotMeetWhereTheyBegin) {
  Random random("Curves.RaysThatLeaveAFibreDoNotMeetWhereTheyBegin");
  const Scene scene = sceneOf(load(bentFibres(random), CurveBasis::bSpline));
  SpanBuffer spans;
  Counters counters;
  int out = 0, in = 0;
  for (int i = 0; i < 20000; ++i) {
    const Point<World> from = random.point(6), to = random.point(2.5);
    const auto hit = scene.closestHit({from, to - from}, spans, counters);
    if (!hit) continue;
    EXPECT_TRUE(hit->entering);
    const Vector<World> direction = random.direction();
    const float side = dot(direction, vector(hit->geometricNormal));
    if (std::fabs(side) < 0.3f) continue;
    // From within a fibre, too, the next thing is another one.
    const auto next = scene.closestHit({hit->originTowards(direction), direction}, spans, counters);
    ++(side > 0 ? out : in);
    EXPECT_FALSE(next && next->primitive == hit->primitive && next->t < 0.02);
    EXPECT_TRUE(!next || next->entering);
  }
  EXPECT_GT(out, 300);
  EXPECT_GT(in, 300);
}

}  // namespace
}  // namespace aerosol::accel
