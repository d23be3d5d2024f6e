// Ranges of the kernels' runtime library: what a function computes at any point of a box lies in its range over the
// box. Boxes and points are random; ends of boxes, zeros and special values are among the points.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>

#include "core/jit/runtime/range_functions.h"
#include "tests/unit/jit/runtime_lanes.h"

namespace aerosol::jit::test {

namespace {

namespace rt = aerosol::jit::runtime;
using Range = rt::Range<float>;
using IntRange = rt::IntRange<std::int32_t>;
using Triple = rt::Triple<float>;
using Box = rt::Triple<Range>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11) / 9007199254740992.0; }
  std::uint32_t bits() { return static_cast<std::uint32_t>(engine_()); }
  bool oneIn(std::uint32_t n) { return bits() % n == 0; }

  float number() {
    if (oneIn(12))
      return std::array{0.0f, -0.0f, 1.0f, -1.0f, 0.5f, 2.0f, -3.0f, INFINITY, -INFINITY, 1e-42f}[bits() % 10u];
    if (oneIn(6)) return std::bit_cast<float>(bits());
    if (oneIn(2)) return static_cast<float>(unit() * 8 - 4);
    return static_cast<float>(std::exp(unit() * 24 - 12) * (oneIn(2) ? 1 : -1));
  }

  /// A box of points without NaN; now and then a single point, now and then one that may be NaN too.
  Range range() {
    float a = number();
    while (std::isnan(a)) a = number();
    float b = number();
    if (oneIn(2)) b = a + static_cast<float>(unit() * unit()) * (oneIn(2) ? 1.0f : 0.01f);
    if (std::isnan(b) || oneIn(6)) b = a;
    return {std::min(a, b), std::max(a, b), oneIn(20) ? -1 : 0};
  }
  float in(const Range& range) {
    if (range.nan != 0 && oneIn(3)) return NAN;
    const std::uint32_t kind = bits() % 6u;
    if (kind == 0 || range.lo == range.hi) return range.lo;
    if (kind == 1) return range.hi;
    if (kind == 2 && range.lo <= 0 && range.hi >= 0) return oneIn(2) ? 0.0f : -0.0f;
    const double lo = std::max(static_cast<double>(range.lo), -3.4e38);
    const double hi = std::min(static_cast<double>(range.hi), 3.4e38);
    return std::clamp(static_cast<float>(lo + (hi - lo) * unit()), range.lo, range.hi);
  }

  std::int32_t integer() {
    if (oneIn(8)) return std::array{0, 1, -1, 2, -0x7fffffff - 1, 0x7fffffff, 31, 7}[bits() % 8u];
    return oneIn(3) ? static_cast<std::int32_t>(bits()) : static_cast<std::int32_t>(bits() % 41u) - 20;
  }
  IntRange intRange() {
    const std::int32_t a = integer();
    const std::int32_t b = oneIn(5) ? a : integer();
    return {std::min(a, b), std::max(a, b)};
  }
  std::int32_t in(const IntRange& range) {
    if (oneIn(5)) return range.lo;
    if (oneIn(5)) return range.hi;
    const auto span = static_cast<std::uint64_t>(static_cast<std::int64_t>(range.hi) - range.lo) + 1;
    return static_cast<std::int32_t>(range.lo + static_cast<std::int64_t>((engine_() >> 1) % span));
  }

  Range smallBox(double width) {
    const double low = unit() * 40 - 20;
    return {static_cast<float>(low), static_cast<float>(low + unit() * width), 0};
  }

 private:
  std::mt19937_64 engine_;
};

bool holds(const Range& range, float value) {
  if (std::isnan(value)) return range.nan != 0;
  return range.lo <= value && value <= range.hi;
}
bool holds(const IntRange& range, std::int32_t value) { return range.lo <= value && value <= range.hi; }

std::string toString(const Range& range) {
  return "[" + std::to_string(range.lo) + ", " + std::to_string(range.hi) + (range.nan != 0 ? "] or NaN" : "]");
}

constexpr int boxes = 60000;
constexpr int pointsPerBox = 8;

/// `function` takes three numbers of either type.
template <class Function>
void expectHolds(const char* name, Function function) {
  Random random(std::hash<std::string>{}(name));
  for (int box = 0; box < boxes; ++box) {
    const Range a = random.range();
    const Range b = random.range();
    const Range c = random.range();
    const Range result = function(a, b, c);
    ASSERT_FALSE(std::isnan(result.lo) || std::isnan(result.hi)) << name;
    for (int point = 0; point < pointsPerBox; ++point) {
      const float x = random.in(a);
      const float y = random.in(b);
      const float z = random.in(c);
      const float value = function(x, y, z);
      ASSERT_TRUE(holds(result, value)) << name << '(' << x << ", " << y << ", " << z << ") = " << value << " outside "
                                        << toString(result) << " over " << toString(a) << ' ' << toString(b) << ' '
                                        << toString(c);
    }
  }
}

#define HOLDS(function) expectHolds(#function, [](auto x, auto, auto) { return rt::function(x); })
#define HOLDS_2(function) expectHolds(#function, [](auto x, auto y, auto) { return rt::function(x, y); })
#define HOLDS_3(function) expectHolds(#function, [](auto x, auto y, auto z) { return rt::function(x, y, z); })

TEST(RuntimeRange, arithmetic) {
  expectHolds("+", [](auto x, auto y, auto) { return x + y; });
  expectHolds("-", [](auto x, auto y, auto) { return x - y; });
  expectHolds("*", [](auto x, auto y, auto) { return x * y; });
  expectHolds("negate", [](auto x, auto, auto) { return -x; });
  HOLDS_2(safeDivide);
  HOLDS_2(fmod);
  HOLDS_2(mod);
  HOLDS_2(min);
  HOLDS_2(max);
  HOLDS_2(step);
  HOLDS_2(hypot);
  HOLDS_3(hypot);
  HOLDS_3(clamp);
  HOLDS_3(mix);
  HOLDS_3(smoothstep);
  HOLDS_3(linearstep);
  HOLDS_3(fma);
  HOLDS(square);
  HOLDS(abs);
  HOLDS(sign);
  HOLDS(floor);
  HOLDS(ceil);
  HOLDS(round);
  HOLDS(trunc);
  HOLDS(sqrt);
  HOLDS(inversesqrt);
  HOLDS(degrees);
}

TEST(RuntimeRange, functions) {
  HOLDS(sin);
  HOLDS(cos);
  HOLDS(tan);
  HOLDS(asin);
  HOLDS(acos);
  HOLDS(atan);
  HOLDS_2(atan2);
  HOLDS(exp);
  HOLDS(exp2);
  HOLDS(expm1);
  HOLDS(log);
  HOLDS(log2);
  HOLDS(log10);
  HOLDS(logb);
  HOLDS_2(logBase);
  HOLDS(sinh);
  HOLDS(cosh);
  HOLDS(tanh);
  HOLDS(cbrt);
  HOLDS(erf);
  HOLDS(erfc);
  HOLDS_2(pow);
  expectHolds("pow whole", [](auto x, auto, auto) { return rt::pow(x, decltype(x)(3.0f)); });
  expectHolds("pow even", [](auto x, auto, auto) { return rt::pow(x, decltype(x)(2.0f)); });
  expectHolds("pow inverse", [](auto x, auto, auto) { return rt::pow(x, decltype(x)(-1.0f)); });
}

TEST(RuntimeRange, geometry) {
  expectHolds("length", [](auto x, auto y, auto z) { return rt::length(rt::Triple<decltype(x)>{x, y, z}); });
  expectHolds("normalize", [](auto x, auto y, auto z) { return rt::normalize(rt::Triple<decltype(x)>{x, y, z}).y; });
  expectHolds("cross", [](auto x, auto y, auto z) {
    return rt::cross(rt::Triple<decltype(x)>{x, y, z}, rt::Triple<decltype(x)>{z, x, x}).z;
  });
  expectHolds("determinant", [](auto x, auto y, auto z) {
    using F = decltype(x);
    const rt::Matrix<F> m = {{x, y, z, F(1.0f), y, y, x, F(0.5f), z, F(2.0f), x, y, F(3.0f), z, x, F(1.0f)}};
    return rt::determinant(m);
  });
  expectHolds("transform", [](auto x, auto y, auto z) {
    using F = decltype(x);
    const rt::Matrix<F> m = {{F(1.0f), F(2.0f), F(0.0f), F(0.5f), F(0.5f), F(1.0f), F(3.0f), F(0.0f), F(1.0f), F(0.0f),
                              F(1.0f), F(0.0f), F(5.0f), F(6.0f), F(7.0f), F(1.0f)}};
    return rt::transformPoint(m, rt::Triple<F>{x, y, z}).y;
  });
  expectHolds("refract", [](auto x, auto y, auto z) {
    using F = decltype(x);
    return rt::refract(rt::Triple<F>{x, y, F(0.5f)}, rt::Triple<F>{F(0.0f), F(1.0f), z}, F(1.5f)).x;
  });
}

TEST(RuntimeRange, integers) {
  Random random(9);
  using Binary = std::pair<IntRange (*)(IntRange, IntRange), std::int32_t (*)(std::int32_t, std::int32_t)>;
#define INTEGER(expression)                                             \
  Binary([](IntRange a, IntRange b) -> IntRange { return expression; }, \
         [](std::int32_t a, std::int32_t b) -> std::int32_t { return expression; })
  const std::array binaries = {
      Binary([](IntRange a, IntRange b) { return a + b; },
             [](std::int32_t a, std::int32_t b) { return rt::wrapAdd(a, b); }),
      Binary([](IntRange a, IntRange b) { return a - b; },
             [](std::int32_t a, std::int32_t b) { return rt::wrapSub(a, b); }),
      Binary([](IntRange a, IntRange b) { return a * b; },
             [](std::int32_t a, std::int32_t b) { return rt::wrapMul(a, b); }),
      INTEGER(rt::divide(a, b)),
      INTEGER(rt::remainder(a, b)),
      INTEGER(rt::mod(a, b)),
      INTEGER(rt::min(a, b)),
      INTEGER(rt::max(a, b)),
      Binary([](IntRange a, IntRange b) { return rt::bitAnd(a, b); },
             [](std::int32_t a, std::int32_t b) { return a & b; }),
      Binary([](IntRange a, IntRange b) { return rt::bitOr(a, b); },
             [](std::int32_t a, std::int32_t b) { return a | b; }),
      Binary([](IntRange a, IntRange b) { return rt::bitXor(a, b); },
             [](std::int32_t a, std::int32_t b) { return a ^ b; }),
      Binary([](IntRange a, IntRange b) { return rt::bitShiftLeft(a, b); },
             [](std::int32_t a, std::int32_t b) { return rt::shiftLeft(a, b & 31); }),
      Binary([](IntRange a, IntRange b) { return rt::bitShiftRight(a, b); },
             [](std::int32_t a, std::int32_t b) { return a >> (b & 31); }),
      Binary([](IntRange a, IntRange) { return rt::abs(a); }, [](std::int32_t a, std::int32_t) { return rt::abs(a); }),
      Binary([](IntRange a, IntRange) { return -a; }, [](std::int32_t a, std::int32_t) { return rt::wrapNegate(a); })};
#undef INTEGER
  for (std::size_t i = 0; i < binaries.size(); ++i) {
    for (int box = 0; box < boxes; ++box) {
      const IntRange a = random.intRange();
      const IntRange b = random.intRange();
      const IntRange result = binaries[i].first(a, b);
      for (int point = 0; point < pointsPerBox; ++point) {
        const std::int32_t x = random.in(a);
        const std::int32_t y = random.in(b);
        ASSERT_TRUE(holds(result, binaries[i].second(x, y)))
            << "operation " << i << " of " << x << " and " << y << " gives " << binaries[i].second(x, y) << " outside ["
            << result.lo << ", " << result.hi << "] over [" << a.lo << ", " << a.hi << "] [" << b.lo << ", " << b.hi
            << "]";
      }
    }
  }
}

TEST(RuntimeRange, conversions) {
  Random random(10);
  for (int box = 0; box < boxes; ++box) {
    const Range a = random.range();
    const IntRange i = random.intRange();
    const float x = random.in(a);
    const std::int32_t n = random.in(i);
    ASSERT_TRUE(holds(rt::toInt(a), rt::toInt(x))) << x;
    ASSERT_TRUE(holds(rt::toFloat(i), rt::toFloat(n))) << n;
    ASSERT_TRUE(holds(rt::isNotANumber(a), rt::isNotANumber(x)));
    ASSERT_TRUE(holds(rt::isInfinite(a), rt::isInfinite(x)));
    ASSERT_TRUE(holds(rt::isFinite(a), rt::isFinite(x)));
  }
}

TEST(RuntimeRange, comparisonsAllowWhatHappens) {
  Random random(11);
  for (int box = 0; box < boxes; ++box) {
    const Range a = random.range();
    const Range b = random.range();
    for (int point = 0; point < pointsPerBox; ++point) {
      const float x = random.in(a);
      const float y = random.in(b);
      const auto allows = [](const rt::Truth<std::int32_t>& truth, bool value) {
        return (value ? truth.mayTrue : truth.mayFalse) != 0;
      };
      ASSERT_TRUE(allows(rt::less(a, b), x < y));
      ASSERT_TRUE(allows(rt::lessEqual(a, b), x <= y));
      ASSERT_TRUE(allows(rt::greater(a, b), x > y));
      ASSERT_TRUE(allows(rt::greaterEqual(a, b), x >= y));
      ASSERT_TRUE(allows(rt::equal(a, b), x == y)) << x << ' ' << y << toString(a) << toString(b);
      ASSERT_TRUE(allows(rt::notEqual(a, b), x != y));
      ASSERT_TRUE(holds(rt::select(rt::less(a, b), a, b), x < y ? x : y));
    }
  }
}

/// Noise of (x, y, z, w) over small boxes and large ones; returns the mean width of the ranges over boxes of width
/// 0.05.
template <class Function>
double expectNoiseHolds(const char* name, Function function) {
  Random random(std::hash<std::string>{}(name));
  double widths = 0;
  int small = 0;
  for (int box = 0; box < 6000; ++box) {
    const double width = std::array{0.05, 0.3, 1.5, 20.0}[static_cast<std::size_t>(box) % 4u];
    std::array<Range, 4> b = {random.smallBox(width), random.smallBox(width), random.smallBox(width),
                              random.smallBox(width)};
    if (random.oneIn(10)) b[0].lo = std::floor(b[0].lo);
    if (random.oneIn(10)) b[1].hi = b[1].lo;
    b[0].hi = std::max(b[0].lo, b[0].hi);
    const Range result = function(b[0], b[1], b[2], b[3]);
    if (box % 4 == 0) {
      widths += static_cast<double>(result.hi - result.lo);
      ++small;
    }
    for (int point = 0; point < 60; ++point) {
      const std::array<float, 4> p = {random.in(b[0]), random.in(b[1]), random.in(b[2]), random.in(b[3])};
      const float value = function(p[0], p[1], p[2], p[3]);
      EXPECT_TRUE(holds(result, value)) << name << " at " << p[0] << ' ' << p[1] << ' ' << p[2] << ' ' << p[3] << " = "
                                        << value << " outside " << toString(result) << " over " << toString(b[0])
                                        << toString(b[1]) << toString(b[2]) << toString(b[3]);
      if (testing::Test::HasFailure()) return 0;
    }
  }
  return widths / small;
}

TEST(RuntimeRange, perlinNoise) {
  EXPECT_LT(expectNoiseHolds("perlin 1", [](auto x, auto, auto, auto) { return rt::perlin(x); }), 0.2);
  EXPECT_LT(expectNoiseHolds("perlin 2", [](auto x, auto y, auto, auto) { return rt::perlin(x, y); }), 0.3);
  EXPECT_LT(expectNoiseHolds("perlin 3",
                             [](auto x, auto y, auto z, auto) { return rt::perlin(rt::Triple<decltype(x)>{x, y, z}); }),
            0.4);
  EXPECT_LT(expectNoiseHolds("perlin 4", [](auto x, auto y, auto z,
                                            auto w) { return rt::perlin(rt::Triple<decltype(x)>{x, y, z}, w); }),
            0.6);
  expectNoiseHolds("perlin triple",
                   [](auto x, auto y, auto z, auto) { return rt::perlinTriple(rt::Triple<decltype(x)>{x, y, z}).z; });
  expectNoiseHolds("unsigned",
                   [](auto x, auto y, auto z, auto) { return rt::unsignedPerlin(rt::Triple<decltype(x)>{x, y, z}); });
  expectNoiseHolds("periodic", [](auto x, auto y, auto z, auto) {
    using F = decltype(x);
    return rt::periodicPerlin(rt::Triple<F>{x, y, z}, rt::Triple<F>{F(3.0f), F(1.0f), F(5.5f)});
  });
  expectNoiseHolds("periodic by range", [](auto x, auto y, auto, auto) { return rt::periodicPerlin(x, y); });
}

TEST(RuntimeRange, otherNoise) {
  expectNoiseHolds("cell",
                   [](auto x, auto y, auto z, auto w) { return rt::cellNoise(rt::Triple<decltype(x)>{x, y, z}, w); });
  expectNoiseHolds("cell triple", [](auto x, auto, auto, auto) { return rt::cellNoiseTriple(x).y; });
  expectNoiseHolds("hash", [](auto x, auto y, auto, auto) { return rt::hashNoise(x, y); });
  expectNoiseHolds("periodic cell", [](auto x, auto y, auto, auto) { return rt::periodicCellNoise(x, y); });
  expectNoiseHolds("simplex 1", [](auto x, auto, auto, auto) { return rt::simplex(x); });
  expectNoiseHolds("simplex 2", [](auto x, auto y, auto, auto) { return rt::simplex(x, y); });
  expectNoiseHolds("simplex 3",
                   [](auto x, auto y, auto z, auto) { return rt::simplex(rt::Triple<decltype(x)>{x, y, z}); });
  expectNoiseHolds("simplex 4", [](auto x, auto y, auto z, auto w) {
    return rt::unsignedSimplex(rt::Triple<decltype(x)>{x, y, z}, w);
  });
}

/// The greatest values of noise that ranges count on are not below what a search finds.
TEST(RuntimeRange, greatestValuesHold) {
  Random random(12);
  const auto at = [&] { return static_cast<float>(random.unit() * 2000 - 1000); };
  for (int i = 0; i < 300000; ++i) {
    const Triple p = {at(), at(), at()};
    const float w = at();
    ASSERT_LE(std::fabs(rt::perlin(p.x)), 1.001f);
    ASSERT_LE(std::fabs(rt::perlin(p.x, p.y)), 1.001f);
    ASSERT_LE(std::fabs(rt::perlin(p)), 1.0185f);
    ASSERT_LE(std::fabs(rt::perlin(p, w)), 1.29f);
    ASSERT_LE(std::fabs(rt::simplex(p)), 0.93f);
    ASSERT_LE(std::fabs(rt::simplex(p, w)), 0.93f);
  }
}

TEST(RuntimeRange, lanesAgreeWithSingleRanges) {
  Random random(13);
  using F = rt::Wide<float, 8>;
  for (int trial = 0; trial < 500; ++trial) {
    std::array<Range, 8> a;
    std::array<Range, 8> b;
    rt::Range<F> wideA(0.0f);
    rt::Range<F> wideB(0.0f);
    for (std::size_t i = 0; i < 8; ++i) {
      a[i] = random.range();
      b[i] = random.range();
      wideA.lo[i] = a[i].lo;
      wideA.hi[i] = a[i].hi;
      wideA.nan[i] = a[i].nan;
      wideB.lo[i] = b[i].lo;
      wideB.hi[i] = b[i].hi;
      wideB.nan[i] = b[i].nan;
    }
    const auto expectSame = [&](const rt::Range<F>& wide, auto single) {
      for (std::size_t i = 0; i < 8; ++i) {
        const Range one = single(a[i], b[i]);
        EXPECT_TRUE(isSame(wide.lo[i], one.lo) && isSame(wide.hi[i], one.hi) && wide.nan[i] == one.nan);
      }
    };
    expectSame(wideA * wideB, [](Range x, Range y) { return x * y; });
    expectSame(rt::safeDivide(wideA, wideB), [](Range x, Range y) { return rt::safeDivide(x, y); });
    expectSame(rt::pow(wideA, wideB), [](Range x, Range y) { return rt::pow(x, y); });
    expectSame(rt::perlin(wideA, wideB), [](Range x, Range y) { return rt::perlin(x, y); });
  }
}

}  // namespace

}  // namespace aerosol::jit::test
