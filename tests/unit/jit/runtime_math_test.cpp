// The elementary functions of the kernels' runtime library: accuracy against the host's double functions, the
// language's special values, and the same bits at every number of lanes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "core/jit/runtime/geometry.h"
#include "core/jit/runtime/math_basic.h"
#include "core/jit/runtime/math_exponential.h"
#include "core/jit/runtime/math_special.h"
#include "core/jit/runtime/math_trigonometric.h"
#include "tests/unit/jit/runtime_lanes.h"

namespace aerosol::jit::test {

namespace {

namespace rt = aerosol::jit::runtime;

constexpr std::size_t inputCount = 1u << 16;

// --- accuracy
// ----------------------------------------------------------------------------------------------------------

struct Accuracy {
  const char* name;
  float (*function)(float);
  double (*reference)(double);
  double low, high;  ///< Inputs between, evenly spread, or evenly in the exponent when low is positive.
  double allowed;    ///< Units in the last place.
};

std::vector<float> spread(double low, double high, std::size_t count) {
  std::vector<float> values;
  std::mt19937_64 random(7);
  for (std::size_t i = 0; i < count; ++i) {
    const double unit = static_cast<double>(random() >> 11) / 9007199254740992.0;
    values.push_back(static_cast<float>(low > 0 ? low * std::pow(high / low, unit) : low + (high - low) * unit));
  }
  return values;
}

class RuntimeAccuracy : public testing::TestWithParam<Accuracy> {};

TEST_P(RuntimeAccuracy, staysWithinItsBound) {
  const Accuracy& test = GetParam();
  double worst = 0;
  float worstInput = 0;
  for (const float x : spread(test.low, test.high, 400000)) {
    const double expected = test.reference(static_cast<double>(x));
    const float got = test.function(x);
    if (std::isinf(static_cast<float>(expected)) && got == static_cast<float>(expected)) continue;
    ASSERT_FALSE(std::isnan(got)) << test.name << '(' << x << ')';
    const double error = errorInUlps(got, expected);
    if (error > worst) {
      worst = error;
      worstInput = x;
    }
  }
  EXPECT_LE(worst, test.allowed) << test.name << " at " << worstInput;
  RecordProperty("ulps", std::to_string(worst));
}

#define ACCURACY(function, low, high, allowed)                                                                        \
  Accuracy {                                                                                                          \
    #function, [](float x) { return rt::function(x); }, [](double x) { return std::function(x); }, low, high, allowed \
  }

INSTANTIATE_TEST_SUITE_P(
    Functions, RuntimeAccuracy,
    testing::Values(ACCURACY(sin, -10, 10, 2), ACCURACY(sin, -131072, 131072, 2), ACCURACY(sin, 1e-30, 3.4e38, 2.5),
                    ACCURACY(cos, -10, 10, 2), ACCURACY(cos, 1e5, 3.4e38, 2.5), ACCURACY(tan, -10, 10, 4),
                    ACCURACY(tan, 1e-30, 3.4e38, 4.5), ACCURACY(asin, -1, 1, 2.5), ACCURACY(asin, 1e-30, 1, 2.5),
                    ACCURACY(acos, -1, 1, 2), ACCURACY(atan, -3, 3, 2), ACCURACY(atan, 1e-30, 3.4e38, 2),
                    ACCURACY(exp, -104, 89, 1.5), ACCURACY(exp2, -150, 128, 1.5), ACCURACY(expm1, -40, 88.7, 2),
                    ACCURACY(expm1, 1e-30, 1, 2), ACCURACY(log, 1.2e-38, 3.4e38, 1.5), ACCURACY(log, 0, 2, 1.5),
                    ACCURACY(log2, 1.2e-38, 3.4e38, 1.5), ACCURACY(log2, 0.5, 2, 1.5),
                    ACCURACY(log10, 1.2e-38, 3.4e38, 1.5), ACCURACY(log10, 0.5, 2, 1.5), ACCURACY(sinh, -89.4, 89.4, 2),
                    ACCURACY(sinh, 1e-30, 1, 1.5), ACCURACY(cosh, -89.4, 89.4, 2), ACCURACY(tanh, -10, 10, 2),
                    ACCURACY(tanh, 1e-30, 1, 2), ACCURACY(cbrt, 1e-44, 3.4e38, 1), ACCURACY(erf, -4, 4, 2.5),
                    ACCURACY(erf, 1e-30, 1, 2.5), ACCURACY(erfc, -4, 9.1, 4.6), ACCURACY(logb, 1.2e-38, 3.4e38, 0),
                    ACCURACY(round, -10, 10, 0), ACCURACY(trunc, -10, 10, 0)));

TEST(RuntimeMath, powersAreAccurate) {
  std::mt19937_64 random(3);
  double worst = 0;
  const auto unit = [&] { return static_cast<double>(random() >> 11) / 9007199254740992.0; };
  for (int i = 0; i < 400000; ++i) {
    const bool wide = (i & 1) != 0;
    const float x = static_cast<float>(wide ? std::exp(unit() * 170 - 85) : unit() * 4);
    const float y = static_cast<float>(wide ? unit() * 6 - 3 : unit() * 200 - 100);
    const double expected = std::pow(static_cast<double>(x), static_cast<double>(y));
    if (x == 0 || expected > 3.4e38 || expected < 1.2e-38) continue;
    worst = std::max(worst, errorInUlps(rt::pow(x, y), expected));
  }
  EXPECT_LE(worst, 2.5);
}

TEST(RuntimeMath, anglesAreAccurateInAllQuadrants) {
  std::mt19937_64 random(4);
  double worst = 0;
  for (int i = 0; i < 400000; ++i) {
    const auto draw = [&] {
      const auto bits = static_cast<std::uint32_t>(random());
      return (i & 1) != 0 ? std::bit_cast<float>(bits) : static_cast<float>(static_cast<int>(bits)) * 1e-9f;
    };
    const float y = draw();
    const float x = draw();
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    const double expected = std::atan2(static_cast<double>(y), static_cast<double>(x));
    if (std::fabs(expected) > 1.2e-38) worst = std::max(worst, errorInUlps(rt::atan2(y, x), expected));
  }
  EXPECT_LE(worst, 2.5);
}

TEST(RuntimeMath, remaindersAreTheLanguagesFormulas) {
  EXPECT_EQ(rt::mod(0.5f, 0.1f), 0.0f);  // The exact one is 0.0999999925.
  EXPECT_EQ(rt::fmod(10.5f, 0.3f), 0.0f);
  EXPECT_EQ(rt::mod(100.1f, 1.0000001f), 100.1f - 1.0000001f * 100.0f);
  EXPECT_EQ(rt::mod(1e30f, 1e-30f), 1e30f);
  EXPECT_EQ(rt::fmod(1e30f, 1e-30f), 0.0f);
  std::mt19937_64 random(5);
  for (int i = 0; i < 200000; ++i) {
    const auto a = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    const auto b = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    const float quotient = a / b;
    if (!(std::fabs(quotient) < INFINITY)) continue;
    const float back = b * std::trunc(quotient);
    const float below = b * std::floor(quotient);
    ASSERT_TRUE(isSame(rt::fmod(a, b), a - back)) << a << ' ' << b;
    ASSERT_TRUE(isSame(rt::mod(a, b), a - below)) << a << ' ' << b;
  }
}

// --- special values
// ----------------------------------------------------------------------------------------------------

TEST(RuntimeMath, domainErrorsFollowTheLanguage) {
  EXPECT_EQ(rt::sqrt(-1.0f), 0.0f);
  EXPECT_EQ(rt::inversesqrt(0.0f), 0.0f);
  EXPECT_EQ(rt::inversesqrt(-4.0f), 0.0f);
  EXPECT_EQ(rt::inversesqrt(4.0f), 0.5f);
  EXPECT_EQ(rt::log(0.0f), rt::log(-3.0f));
  EXPECT_NEAR(rt::log(0.0f), -87.33655f, 1e-4f);
  EXPECT_NEAR(rt::log2(0.0f), -126.0f, 1e-4f);
  EXPECT_NEAR(rt::log(INFINITY), 88.72284f, 1e-4f);
  EXPECT_EQ(rt::logb(0.0f), -126.0f);
  EXPECT_EQ(rt::logb(1e-40f), -126.0f);
  EXPECT_EQ(rt::logb(-INFINITY), 127.0f);
  EXPECT_EQ(rt::logb(8.0f), 3.0f);
  EXPECT_EQ(rt::asin(2.0f), rt::asin(1.0f));
  EXPECT_EQ(rt::acos(-2.0f), rt::acos(-1.0f));
  EXPECT_NEAR(rt::acos(-2.0f), std::numbers::pi_v<float>, 1e-6f);
  EXPECT_EQ(rt::acos(1.5f), 0.0f);
  EXPECT_EQ(rt::safeDivide(3.0f, 0.0f), 0.0f);
  EXPECT_EQ(rt::fmod(3.0f, 0.0f), 0.0f);
  EXPECT_EQ(rt::mod(3.0f, 0.0f), 3.0f);
  EXPECT_EQ(rt::fmod(-0.25f, 1.0f), -0.25f);
  EXPECT_EQ(rt::mod(-0.25f, 1.0f), 0.75f);
  EXPECT_EQ(rt::mod(0.25f, -1.0f), -0.75f);
  EXPECT_EQ(rt::mod(-7, 3), 2);
  EXPECT_EQ(rt::mod(7, 0), 0);
}

TEST(RuntimeMath, powersFollowTheLanguage) {
  EXPECT_EQ(rt::pow(0.0f, 0.0f), 1.0f);
  EXPECT_EQ(rt::pow(NAN, 0.0f), 1.0f);
  EXPECT_EQ(rt::pow(0.0f, 2.0f), 0.0f);
  EXPECT_EQ(rt::pow(0.0f, -2.0f), 0.0f);
  EXPECT_EQ(rt::pow(-1.0f, 0.5f), 0.0f);
  EXPECT_EQ(rt::pow(-2.0f, 3.0f), -8.0f);
  EXPECT_EQ(rt::pow(-2.0f, 2.0f), 4.0f);
  EXPECT_EQ(rt::pow(-2.0f, -1.0f), -0.5f);
  EXPECT_EQ(rt::pow(10.0f, 100.0f), 3.4028235e38f);
  EXPECT_EQ(rt::pow(10.0f, -100.0f), 0.0f);
  EXPECT_EQ(rt::pow(1.0f, 3.4e38f), 1.0f);
  EXPECT_EQ(rt::pow(INFINITY, -1.0f), 0.0f);
  EXPECT_EQ(rt::pow(3.0f, 1.0f), 3.0f);
  EXPECT_TRUE(std::isnan(rt::pow(NAN, 1.0f)));
}

TEST(RuntimeMath, stepsAndMixes) {
  EXPECT_EQ(rt::smoothstep(1.0f, 3.0f, 2.0f), 0.5f);
  EXPECT_EQ(rt::smoothstep(1.0f, 3.0f, 0.5f), 0.0f);
  EXPECT_EQ(rt::smoothstep(1.0f, 3.0f, 4.0f), 1.0f);
  EXPECT_EQ(rt::smoothstep(3.0f, 1.0f, 0.5f), 0.0f);
  EXPECT_EQ(rt::smoothstep(3.0f, 1.0f, 2.0f), 0.0f);
  EXPECT_EQ(rt::smoothstep(3.0f, 1.0f, 3.0f), 1.0f);
  EXPECT_EQ(rt::linearstep(1.0f, 3.0f, 1.5f), 0.25f);
  EXPECT_EQ(rt::linearstep(2.0f, 2.0f, 1.9f), 0.0f);
  EXPECT_EQ(rt::linearstep(2.0f, 2.0f, 2.0f), 1.0f);
  EXPECT_EQ(rt::step(2.0f, 2.0f), 1.0f);
  EXPECT_EQ(rt::step(2.0f, 1.9f), 0.0f);
  EXPECT_EQ(rt::mix(2.0f, 6.0f, 0.25f), 3.0f);
  EXPECT_EQ(rt::clamp(5.0f, 1.0f, 3.0f), 3.0f);
  EXPECT_EQ(rt::round(2.5f), 3.0f);
  EXPECT_EQ(rt::round(-2.5f), -3.0f);
  EXPECT_EQ(rt::round(0.49999997f), 0.0f);
  EXPECT_EQ(rt::sign(-0.1f), -1.0f);
  EXPECT_EQ(rt::sign(0.0f), 0.0f);
}

TEST(RuntimeMath, conversionsSaturate) {
  EXPECT_EQ(rt::toInt(NAN), 0);
  EXPECT_EQ(rt::toInt(1e20f), 0x7fffffff);
  EXPECT_EQ(rt::toInt(-1e20f), -0x7fffffff - 1);
  EXPECT_EQ(rt::toInt(-1.9f), -1);
  EXPECT_EQ(rt::toInt(INFINITY), 0x7fffffff);
  EXPECT_EQ(rt::divide(-0x7fffffff - 1, -1), -0x7fffffff - 1);
  EXPECT_EQ(rt::divide(5, 0), 0);
  EXPECT_EQ(rt::remainder(-0x7fffffff - 1, -1), 0);
  EXPECT_EQ(rt::remainder(-7, 3), -1);
}

// --- vectors and matrices
// ----------------------------------------------------------------------------------------------

using Triple = rt::Triple<float>;
using Matrix = rt::Matrix<float>;

TEST(RuntimeGeometry, lengthsHoldBeyondTheRangeOfSquares) {
  for (const float scale : {1.0f, 1e-25f, 1e25f, 1e-44f}) {
    const Triple v = {3 * scale, 0, 4 * scale};
    EXPECT_NEAR(rt::length(v) / (5 * scale), 1.0f, scale > 1e-40f ? 1e-6f : 0.1f) << scale;
    EXPECT_NEAR(rt::length(rt::normalize(v)), 1.0f, scale > 1e-40f ? 1e-6f : 0.1f) << scale;
  }
  const Triple zero = rt::normalize(Triple{0, 0, 0});
  EXPECT_EQ(zero.x, 0.0f);
  EXPECT_EQ(rt::length(zero), 0.0f);
}

TEST(RuntimeGeometry, inverseTimesMatrixIsUnit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> draw(-1, 1);
  for (int trial = 0; trial < 100; ++trial) {
    Matrix a;
    for (float& element : a.m) element = draw(random);
    if (std::fabs(rt::determinant(a)) < 0.05f) continue;
    const Matrix unit = rt::multiply(a, rt::inverse(a));
    for (int i = 0; i < 16; ++i) EXPECT_NEAR(unit.m[i], i % 5 == 0 ? 1.0f : 0.0f, 2e-4f);
  }
  Matrix singular = {};
  EXPECT_EQ(rt::inverse(singular).m[0], 1.0f);
  EXPECT_EQ(rt::inverse(singular).m[1], 0.0f);
}

TEST(RuntimeGeometry, transformsTreatRowsAsOslDoes) {
  const Matrix shift = {{2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, 10, 20, 30, 1}};
  const Triple p = rt::transformPoint(shift, {1, 1, 1});
  EXPECT_EQ(p.x, 12.0f);
  EXPECT_EQ(p.y, 23.0f);
  EXPECT_EQ(p.z, 34.0f);
  const Triple v = rt::transformVector(shift, {1, 1, 1});
  EXPECT_EQ(v.y, 3.0f);
  const Triple n = rt::transformNormal(shift, {1, 1, 1});
  EXPECT_FLOAT_EQ(n.z, 0.25f);
  EXPECT_EQ(rt::determinant(shift), 24.0f);
  EXPECT_EQ(rt::transpose(shift).m[3], 10.0f);
  const Triple c = rt::cross(Triple{1, 0, 0}, Triple{0, 1, 0});
  EXPECT_EQ(c.z, 1.0f);
}

// --- the same bits at every width
// --------------------------------------------------------------------------------------

/// Calls F of one, two or three lanes' arguments at width W.
template <int W, class Function>
std::vector<float> evaluate(Function function, const std::vector<float>& a, const std::vector<float>& b,
                            const std::vector<float>& c) {
  std::vector<float> results(a.size());
  for (std::size_t i = 0; i < a.size(); i += W) {
    store(results, i, function(lanesAt<W>(a, i), lanesAt<W>(b, i), lanesAt<W>(c, i)));
  }
  return results;
}

template <class Function>
void expectSameBits(const char* name, Function function) {
  const std::vector<float> a = anyFloats(inputCount, 11);
  std::vector<float> b = anyFloats(inputCount, 12);
  std::vector<float> c = anyFloats(inputCount, 13);
  std::shuffle(b.begin(), b.end(), std::mt19937(1));
  std::shuffle(c.begin(), c.end(), std::mt19937(2));
  const std::vector<float> one = evaluate<1>(function, a, b, c);
  const std::array<std::vector<float>, 3> others = {evaluate<4>(function, a, b, c), evaluate<8>(function, a, b, c),
                                                    evaluate<16>(function, a, b, c)};
  for (const auto& other : others) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_TRUE(isSame(one[i], other[i]))
          << name << '(' << a[i] << ", " << b[i] << ", " << c[i] << ") gives " << one[i] << " and " << other[i];
    }
  }
}

#define SAME_BITS(function) expectSameBits(#function, [](auto x, auto, auto) { return rt::function(x); })
#define SAME_BITS_2(function) expectSameBits(#function, [](auto x, auto y, auto) { return rt::function(x, y); })
#define SAME_BITS_3(function) expectSameBits(#function, [](auto x, auto y, auto z) { return rt::function(x, y, z); })

TEST(RuntimeBits, trigonometry) {
  SAME_BITS(sin);
  SAME_BITS(cos);
  SAME_BITS(tan);
  SAME_BITS(asin);
  SAME_BITS(acos);
  SAME_BITS(atan);
  SAME_BITS_2(atan2);
}
TEST(RuntimeBits, exponentials) {
  SAME_BITS(exp);
  SAME_BITS(exp2);
  SAME_BITS(expm1);
  SAME_BITS(log);
  SAME_BITS(log2);
  SAME_BITS(log10);
  SAME_BITS(logb);
  SAME_BITS(sinh);
  SAME_BITS(cosh);
  SAME_BITS(tanh);
  SAME_BITS_2(pow);
  SAME_BITS_2(logBase);
}
TEST(RuntimeBits, others) {
  SAME_BITS(sqrt);
  SAME_BITS(inversesqrt);
  SAME_BITS(cbrt);
  SAME_BITS(erf);
  SAME_BITS(erfc);
  SAME_BITS(sign);
  SAME_BITS(round);
  SAME_BITS(floor);
  SAME_BITS(degrees);
  SAME_BITS(radians);
  SAME_BITS_2(fmod);
  SAME_BITS_2(mod);
  SAME_BITS_2(min);
  SAME_BITS_2(max);
  SAME_BITS_2(safeDivide);
  SAME_BITS_2(step);
  SAME_BITS_2(hypot);
  SAME_BITS_3(hypot);
  SAME_BITS_3(mix);
  SAME_BITS_3(clamp);
  SAME_BITS_3(smoothstep);
  SAME_BITS_3(linearstep);
  SAME_BITS_3(fma);
  expectSameBits("toInt", [](auto x, auto, auto) { return rt::toFloat(rt::toInt(x)); });
}
TEST(RuntimeBits, geometry) {
  expectSameBits("length", [](auto x, auto y, auto z) { return rt::length(rt::Triple<decltype(x)>{x, y, z}); });
  expectSameBits("normalize", [](auto x, auto y, auto z) { return rt::normalize(rt::Triple<decltype(x)>{x, y, z}).y; });
  expectSameBits("inverse", [](auto x, auto y, auto z) {
    using F = decltype(x);
    const rt::Matrix<F> m = {{x, y, z, F(1.0f), y, y, x, F(0.5f), z, F(2.0f), x, y, F(3.0f), z, x, F(1.0f)}};
    return rt::inverse(m).m[6];
  });
}

}  // namespace

}  // namespace aerosol::jit::test
