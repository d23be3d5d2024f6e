// Forms of the kernels' runtime library (range_form.h): what a function computes at any point of a box lies in the
// result's range and near its line.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "core/jit/runtime/range_form_noise.h"

namespace aerosol::jit::test {

namespace {

namespace rt = aerosol::jit::runtime;
using Form = rt::Form<float>;
using Range = rt::Range<float>;

constexpr int boxes = 20000;
constexpr int pointsPerBox = 12;

/// A box of three coordinates, and its points.
class RandomBox {
 public:
  RandomBox(std::mt19937_64& random, bool isTame) : random_(random) {
    const float usual = std::exp2(-12.0f * unit());
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = 8 * unit() - 4;
      float size = usual * unit();
      if (!isTame && random_() % 8 == 0) low[i] = std::exp2(60 * unit() - 30) * (unit() - 0.5f);
      if (!isTame && random_() % 6 == 0) size = std::abs(low[i]) * unit();
      if (random_() % 8 == 0) low[i] = std::round(low[i]);
      if (random_() % 8 == 0) size = 0;
      if (random_() % 16 == 0) low[i] = 0;
      high[i] = std::max(low[i], low[i] + size);
      centre[i] = std::clamp(low[i] + 0.5f * (high[i] - low[i]), low[i], high[i]);
      half[i] = low[i] == high[i] ? 0 : std::nextafter(std::max(high[i] - centre[i], centre[i] - low[i]), INFINITY);
    }
  }
  Form form(std::size_t axis) const {
    std::array<float, 3> slope{};
    slope[axis] = half[axis];
    return {Range(low[axis], high[axis], 0), centre[axis], slope[0], slope[1], slope[2], 0};
  }
  std::array<float, 3> point() {
    std::array<float, 3> p{};
    for (std::size_t i = 0; i < 3; ++i) {
      const float t = random_() % 4 == 0 ? static_cast<float>(random_() % 2) : unit();
      p[i] = t == 0 ? low[i] : t == 1 ? high[i] : std::clamp(low[i] + t * (high[i] - low[i]), low[i], high[i]);
    }
    return p;
  }
  double coordinate(std::size_t axis, float x) const {
    if (half[axis] == 0) return 0;
    return (static_cast<double>(x) - static_cast<double>(centre[axis])) / static_cast<double>(half[axis]);
  }
  float unit() { return static_cast<float>(random_() >> 40) * 0x1p-24f; }

  std::array<float, 3> low{}, high{}, centre{}, half{};

 private:
  std::mt19937_64& random_;
};

std::string describe(const Form& form) {
  std::string text =
      "[" + std::to_string(form.lo) + ", " + std::to_string(form.hi) + "] line " + std::to_string(form.centre);
  for (const float slope : form.slope) text += " " + std::to_string(slope);
  return text + " +- " + std::to_string(form.rest);
}

/// `function` takes three numbers of either type. Gives the mean of rest over half width of the ranges.
template <class Function>
double expectHolds(const std::string& name, bool isTame, Function function) {
  std::mt19937_64 random(std::hash<std::string>{}(name));
  double shares = 0;
  int counted = 0;
  for (int i = 0; i < boxes; ++i) {
    RandomBox box(random, isTame);
    const Form result = function(box.form(0), box.form(1), box.form(2));
    EXPECT_FALSE(std::isnan(result.lo) || std::isnan(result.hi) || std::isnan(result.rest)) << name;
    if (result.hi > result.lo && std::isfinite(result.rest)) {
      shares +=
          static_cast<double>(result.rest) / (0.5 * (static_cast<double>(result.hi) - static_cast<double>(result.lo)));
      ++counted;
    }
    for (int point = 0; point < pointsPerBox; ++point) {
      const std::array<float, 3> p = box.point();
      const float value = function(p[0], p[1], p[2]);
      if (std::isnan(value)) {
        EXPECT_NE(result.nan, 0) << name << ": NaN";
        continue;
      }
      double line = static_cast<double>(result.centre), magnitude = std::abs(line);
      for (std::size_t k = 0; k < 3; ++k) {
        const double term = static_cast<double>(result.slope[k]) * box.coordinate(k, p[k]);
        line += term;
        magnitude += std::abs(term);
      }
      const bool isInRange = result.lo <= value && value <= result.hi;
      const double distance = std::abs(static_cast<double>(value) - line);
      const bool isNearLine =
          std::isinf(result.rest) || distance <= static_cast<double>(result.rest) + 1e-15 * magnitude;
      EXPECT_TRUE(isInRange) << name << ": " << value << " outside of " << describe(result);
      EXPECT_TRUE(isNearLine) << name << ": " << value << ", " << distance << " from the line of " << describe(result);
      if (isInRange && isNearLine) continue;
      for (std::size_t k = 0; k < 3; ++k)
        ADD_FAILURE() << "coordinate " << p[k] << " in [" << box.low[k] << ", " << box.high[k] << "]";
      return 0;
    }
  }
  return shares / std::max(counted, 1);
}

/// With arguments that are coordinates, and with sums that depend on all of them.
template <class Function>
void expectHoldsEverywhere(const std::string& name, Function function) {
  for (const bool isTame : {true, false}) {
    expectHolds(name + (isTame ? ", tame" : ", wild"), isTame, function);
    expectHolds(name + (isTame ? " of sums, tame" : " of sums, wild"), isTame, [&](auto x, auto y, auto z) {
      using F = decltype(x);
      return function(F(x + F(0.5f) * y), F(F(y - z) * F(3.0f)), F(F(z * x) + F(0.25f) * y));
    });
  }
}

#define HOLDS(function) expectHoldsEverywhere(#function, [](auto x, auto, auto) { return rt::function(x); })
#define HOLDS_2(function) expectHoldsEverywhere(#function, [](auto x, auto y, auto) { return rt::function(x, y); })
#define HOLDS_3(function) expectHoldsEverywhere(#function, [](auto x, auto y, auto z) { return rt::function(x, y, z); })

TEST(RuntimeForm, arithmetic) {
  expectHoldsEverywhere("+", [](auto x, auto y, auto) { return x + y; });
  expectHoldsEverywhere("-", [](auto x, auto y, auto) { return x - y; });
  expectHoldsEverywhere("*", [](auto x, auto y, auto) { return x * y; });
  expectHoldsEverywhere("cubic", [](auto x, auto y, auto z) { return x * y * z - x * x; });
  expectHoldsEverywhere("negate", [](auto x, auto, auto) { return -x; });
  HOLDS_2(safeDivide);
  HOLDS_3(fma);
  HOLDS(square);
}

TEST(RuntimeForm, functions) {
  HOLDS(abs);
  HOLDS(sqrt);
  HOLDS(sin);
  HOLDS(cos);
  HOLDS(exp);
  HOLDS(log);
  HOLDS_2(min);
  HOLDS_2(max);
  HOLDS_3(clamp);
  HOLDS_3(mix);
  HOLDS_3(smoothstep);
  HOLDS_3(linearstep);
  HOLDS_2(pow);
  HOLDS_2(hypot);
  HOLDS_2(step);
  expectHoldsEverywhere("ramp", [](auto x, auto, auto) {
    using F = decltype(x);
    return rt::smoothstep(F(-0.5f), F(1.5f), x);
  });
  expectHoldsEverywhere("choice", [](auto x, auto y, auto z) {
    using F = decltype(x);
    return rt::select(rt::less(x, y), F(x + z), F(y * z));
  });
}

TEST(RuntimeForm, geometry) {
  expectHoldsEverywhere("length", [](auto x, auto y, auto z) { return rt::length(rt::Triple<decltype(x)>{x, y, z}); });
  expectHoldsEverywhere("normalize",
                        [](auto x, auto y, auto z) { return rt::normalize(rt::Triple<decltype(x)>{x, y, z}).y; });
  expectHoldsEverywhere("cross", [](auto x, auto y, auto z) {
    return rt::cross(rt::Triple<decltype(x)>{x, y, z}, rt::Triple<decltype(x)>{z, x, x}).z;
  });
  expectHoldsEverywhere("transform", [](auto x, auto y, auto z) {
    using F = decltype(x);
    const rt::Matrix<F> m = {{F(1.0f), F(2.0f), F(0.0f), F(0.5f), F(0.5f), F(1.0f), F(3.0f), F(0.0f), F(1.0f), F(0.0f),
                              F(1.0f), F(0.0f), F(5.0f), F(6.0f), F(7.0f), F(1.0f)}};
    return rt::transformPoint(m, rt::Triple<F>{x, y, z}).y;
  });
}

TEST(RuntimeForm, noise) {
  expectHoldsEverywhere("perlin 1", [](auto x, auto, auto) { return rt::perlin(x); });
  expectHoldsEverywhere("perlin 2", [](auto x, auto y, auto) { return rt::perlin(x, y); });
  expectHoldsEverywhere("perlin 3",
                        [](auto x, auto y, auto z) { return rt::perlin(rt::Triple<decltype(x)>{x, y, z}); });
  expectHoldsEverywhere("perlin 4", [](auto x, auto y, auto z) {
    using F = decltype(x);
    return rt::perlin(rt::Triple<F>{x, y, z}, F(x * y));
  });
  expectHoldsEverywhere("perlin triple",
                        [](auto x, auto y, auto z) { return rt::perlinTriple(rt::Triple<decltype(x)>{x, y, z}).z; });
  expectHoldsEverywhere("unsigned",
                        [](auto x, auto y, auto z) { return rt::unsignedPerlin(rt::Triple<decltype(x)>{x, y, z}); });
  expectHoldsEverywhere("periodic", [](auto x, auto y, auto z) {
    using F = decltype(x);
    return rt::periodicPerlin(rt::Triple<F>{x, y, z}, rt::Triple<F>{F(3.0f), F(1.0f), F(5.5f)});
  });
  expectHoldsEverywhere("cell", [](auto x, auto y, auto z) { return rt::cellNoise(rt::Triple<decltype(x)>{x, y, z}); });
  expectHoldsEverywhere("simplex",
                        [](auto x, auto y, auto z) { return rt::simplex(rt::Triple<decltype(x)>{x, y, z}); });
}

TEST(RuntimeForm, denormalValuesStayInside) {
  const float least = 1.4e-45f;
  const Form joined = rt::join(Form(least), Form(0.0f));
  EXPECT_EQ(joined.lo, 0.0f);
  EXPECT_GE(joined.hi, least);
}

/// A sum of octaves is followed by one line, so that its range is narrower than the sum of the octaves' ranges.
TEST(RuntimeForm, sumsOfOctavesKeepTheirSlopes) {
  const auto octaves = [](auto p) {
    using F = decltype(p.x);
    F sum = F(0.0f);
    float weight = 0.5f;
    for (int octave = 0; octave < 6; ++octave, weight *= 0.5f) {
      sum = sum + F(weight) * rt::perlin(p);
      p = p * F(2.0f);
    }
    return sum;
  };
  std::mt19937_64 random(4);
  double forms = 0, ranges = 0;
  for (int i = 0; i < 200; ++i) {
    std::array<Form, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const float low = static_cast<float>(random() >> 40) * 0x1p-24f;
      std::array<float, 3> slope{};
      slope[k] = 0.5f / 64;
      p[k] = {Range(low, low + 1.0f / 64, 0), low + 0.5f / 64, slope[0], slope[1], slope[2], 1e-7f};
    }
    const Form form = octaves(rt::Triple<Form>{p[0], p[1], p[2]});
    const Range range = octaves(rt::Triple<Range>{p[0], p[1], p[2]});
    forms += static_cast<double>(form.hi - form.lo);
    ranges += static_cast<double>(range.hi - range.lo);
  }
  EXPECT_LT(forms, 0.75 * ranges);
}

}  // namespace

}  // namespace aerosol::jit::test
