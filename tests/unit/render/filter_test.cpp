#include "core/render/filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace aerosol::render {
namespace {

constexpr int columns = 4096, rows = 256;

float centre(int i, int n) { return (static_cast<float>(i) + 0.5f) / static_cast<float>(n); }

/// Mean of weight · h(dx, dy) over a grid of u, fine in x.
template <class Function>
double meanOver(const Filter& filter, Function h) {
  double sum = 0;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const FilterSample s = filter.sample({centre(i, columns), centre(j, rows)});
      sum += static_cast<double>(s.weight) * h(static_cast<double>(s.dx), static_cast<double>(s.dy));
    }
  }
  return sum / (columns * rows);
}

double square(double x, double) { return x * x; }
double one(double, double) { return 1; }
double mixed(double x, double y) { return x * y + x; }

scene::ReconstructionFilter describe(scene::FilterType type, float radius, float stddev = 0.5f) {
  scene::ReconstructionFilter filter;
  filter.type = type;
  filter.radius = radius;
  filter.stddev = stddev;
  return filter;
}

TEST(Filter, BoxIsUniform) {
  const Filter filter(describe(scene::FilterType::box, 0.5f));
  EXPECT_EQ(filter.sample({0.0f, 0.5f}).dx, -0.5f);
  EXPECT_EQ(filter.sample({0.25f, 0.5f}).dx, -0.25f);
  EXPECT_EQ(filter.sample({0.25f, 0.5f}).dy, 0.0f);
  EXPECT_EQ(filter.sample({0.75f, 0.5f}).weight, 1.0f);
  EXPECT_NEAR(filter.evaluate(0.3), 1, 1e-12);
  EXPECT_EQ(filter.evaluate(0.6), 0);
}

TEST(Filter, TentHasItsVariance) {
  const Filter filter(describe(scene::FilterType::tent, 1.5f));
  EXPECT_NEAR(meanOver(filter, square), 1.5 * 1.5 / 6, 1e-4);
  EXPECT_NEAR(meanOver(filter, mixed), 0, 1e-6);
  EXPECT_NEAR(filter.evaluate(0), 1 / 1.5, 1e-12);
  EXPECT_LE(std::fabs(filter.sample({0.0f, 0x1.fffffep-1f}).dx), 1.5f);
}

TEST(Filter, GaussianIsTheTruncatedShiftedOne) {
  const double sigma = 0.5, radius = 2;
  const Filter filter(describe(scene::FilterType::gaussian, 2, 0.5f));
  const auto f = [&](double x) {
    return std::exp(-x * x / (2 * sigma * sigma)) - std::exp(-radius * radius / (2 * sigma * sigma));
  };
  double integral = 0, second = 0;
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double x = radius * (2 * (i + 0.5) / n - 1);
    integral += f(x) * 2 * radius / n;
    second += f(x) * x * x * 2 * radius / n;
  }
  for (const double x : {-1.9, -0.7, 0.0, 0.01, 1.3}) EXPECT_NEAR(filter.evaluate(x), f(x) / integral, 3e-6);
  EXPECT_NEAR(meanOver(filter, square), second / integral, 2e-4);
  EXPECT_EQ(filter.sample({0.1f, 0.9f}).weight, 1.0f);
}

TEST(Filter, NegativeLobesCarryTheirSign) {
  // The Mitchell–Netravali cubic with B = C = 1/3.
  const auto mitchell = [](double x) {
    const double t = std::fabs(x);
    if (t < 1) return (7 * t * t * t - 12 * t * t + 16.0 / 3) / 6;
    return t < 2 ? (-7.0 / 3 * t * t * t + 12 * t * t - 20 * t + 32.0 / 3) / 6 : 0.0;
  };
  const Filter filter(mitchell, 2, 1024);
  int negative = 0;
  for (int i = 0; i < columns; ++i) {
    const FilterSample s = filter.sample({centre(i, columns), 0.5f});
    EXPECT_EQ(s.weight < 0, mitchell(static_cast<double>(s.dx)) < 0) << s.dx;
    negative += s.weight < 0 ? 1 : 0;
  }
  EXPECT_GT(negative, 0);
  EXPECT_NEAR(meanOver(filter, one), 1, 5e-3);
  double second = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x = 4 * (i + 0.5) / 100000 - 2;
    second += mitchell(x) * x * x * 4 / 100000;
  }
  EXPECT_NEAR(meanOver(filter, square), second, 5e-3);
}

TEST(Filter, CubicsAreThoseOfTheirPapers) {
  // Mitchell and Netravali at B = C = 1/3: 8/9 and 1/18 at 0 and ±1; Catmull-Rom interpolates: 1, 0 and 0, least at
  // 4/3.
  scene::ReconstructionFilter description = describe(scene::FilterType::mitchell, 2);
  const Filter mitchell(description);
  EXPECT_NEAR(mitchell.evaluate(0), 8.0 / 9, 2e-6);
  EXPECT_NEAR(mitchell.evaluate(1), 1.0 / 18, 2e-6);
  EXPECT_NEAR(mitchell.evaluate(-1.5), (-7.0 / 3 * 3.375 + 12 * 2.25 - 20 * 1.5 + 32.0 / 3) / 6, 2e-6);
  EXPECT_NEAR(meanOver(mitchell, one), 1, 5e-3);
  description.b = 1;
  description.c = 0;  // The B-spline: no negative lobe.
  EXPECT_NEAR(Filter(description).evaluate(0), 2.0 / 3, 2e-6);
  EXPECT_EQ(Filter(description).sample({0.01f, 0.5f}).weight, 1.0f);
  const Filter catmullRom(describe(scene::FilterType::catmullrom, 2));
  EXPECT_NEAR(catmullRom.evaluate(0), 1, 2e-6);
  EXPECT_NEAR(catmullRom.evaluate(1), 0, 2e-6);
  EXPECT_NEAR(catmullRom.evaluate(4.0 / 3), -2.0 / 27, 2e-6);
}

TEST(Filter, LanczosIsAWindowedSinc) {
  const Filter filter(describe(scene::FilterType::lanczos, 3));
  // ∫ sinc(x) sinc(x/3) over [-3, 3], by 10^6 midpoints.
  double integral = 0;
  const auto f = [](double x) {
    const double a = std::numbers::pi * x;
    return std::sin(a) / a * std::sin(a / 3) / (a / 3);
  };
  for (int i = 0; i < 1000000; ++i) integral += f(3 * (2 * (i + 0.5) / 1000000 - 1)) * 6e-6;
  for (const double x : {-2.5, -1.5, 0.25, 1.0, 2.75}) EXPECT_NEAR(filter.evaluate(x), f(x) / integral, 5e-6) << x;
  EXPECT_NEAR(meanOver(filter, one), 1, 5e-3);
}

TEST(Filter, IsMonotone) {
  const Filter filter(describe(scene::FilterType::gaussian, 2, 0.5f));
  float last = -3;
  for (int i = 0; i < 5000; ++i) {
    const float dx = filter.sample({static_cast<float>(i) / 5000, 0.5f}).dx;
    EXPECT_GE(dx, last);
    last = dx;
  }
}

}  // namespace
}  // namespace aerosol::render
