// Derivatives of compiled shaders against central differences of the same functions in double.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <random>

#include "core/lang/compile.h"
#include "tests/unit/jit/kernel_runner.h"

namespace aerosol::jit::test {
namespace {

using lang::Global;

/// The variables of the cases: u, v and P[0] to P[2].
using Point = std::array<double, 5>;

struct Case {
  const char* expression;  ///< Of the floats a, b, c, d, e.
  double (*function)(const Point& p);
  double low = -2, high = 2;  ///< Of all variables.
};

double fade(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}
double length(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }

#define AEROSOL_OF(...)                                                             \
  [](const Point& p) -> double {                                                    \
    [[maybe_unused]] const double a = p[0], b = p[1], c = p[2], d = p[3], e = p[4]; \
    return __VA_ARGS__;                                                             \
  }

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"a + b * c - d / e", AEROSOL_OF(a + b * c - d / e), 0.5, 2},
      {"-a * a * (2 - b)", AEROSOL_OF(-a * a * (2 - b))},
      {"sin(a * b)", AEROSOL_OF(std::sin(a * b))},
      {"cos(a) * b", AEROSOL_OF(std::cos(a) * b)},
      {"tan(0.5 * a)", AEROSOL_OF(std::tan(0.5 * a))},
      {"asin(a)", AEROSOL_OF(std::asin(a)), -0.9, 0.9},
      {"acos(a)", AEROSOL_OF(std::acos(a)), -0.9, 0.9},
      {"atan(a * 2)", AEROSOL_OF(std::atan(a * 2))},
      {"atan2(a, b)", AEROSOL_OF(std::atan2(a, b)), 0.25, 2},
      {"atan(a, b)", AEROSOL_OF(std::atan2(a, b)), 0.25, 2},
      {"sinh(a)", AEROSOL_OF(std::sinh(a))},
      {"cosh(a)", AEROSOL_OF(std::cosh(a))},
      {"tanh(a)", AEROSOL_OF(std::tanh(a))},
      {"sine(a) + 3 * cosine(b)", AEROSOL_OF(std::sin(a) + 3 * std::cos(b))},
      {"degrees(a) + radians(b)", AEROSOL_OF(a * 180 / M_PI + b * M_PI / 180)},
      {"pow(a, b)", AEROSOL_OF(std::pow(a, b)), 0.25, 3},
      {"pow(a, 3)", AEROSOL_OF(a * a * a)},
      {"pow(a, 2)", AEROSOL_OF(a * a)},
      {"pow(2.5, a)", AEROSOL_OF(std::pow(2.5, a))},
      {"exp(a)", AEROSOL_OF(std::exp(a))},
      {"exp2(a)", AEROSOL_OF(std::exp2(a))},
      {"expm1(a)", AEROSOL_OF(std::expm1(a))},
      {"log(a)", AEROSOL_OF(std::log(a)), 0.25, 4},
      {"log(a, b)", AEROSOL_OF(std::log(a) / std::log(b)), 1.5, 4},
      {"log2(a) + log10(b)", AEROSOL_OF(std::log2(a) + std::log10(b)), 0.25, 4},
      {"sqrt(a) + inversesqrt(b)", AEROSOL_OF(std::sqrt(a) + 1 / std::sqrt(b)), 0.25, 4},
      {"cbrt(a)", AEROSOL_OF(std::cbrt(a)), 0.25, 4},
      {"hypot(a, b)", AEROSOL_OF(std::hypot(a, b)), 0.25, 4},
      {"hypot(a, b, c)", AEROSOL_OF(length(a, b, c)), 0.25, 4},
      {"erf(a) - erfc(b)", AEROSOL_OF(std::erf(a) - std::erfc(b))},
      {"abs(a) * b + fabs(b)", AEROSOL_OF(std::fabs(a) * b + std::fabs(b))},
      {"sign(a) * b", AEROSOL_OF((a > 0 ? 1 : -1) * b)},
      {"floor(a) * b + ceil(b) * c", AEROSOL_OF(std::floor(a) * b + std::ceil(b) * c)},
      {"round(a) * b + trunc(b) * c", AEROSOL_OF(std::round(a) * b + std::trunc(b) * c)},
      {"fmod(a, b)", AEROSOL_OF(std::fmod(a, b)), 0.9, 4},
      {"mod(a, b)", AEROSOL_OF(a - b * std::floor(a / b)), 0.9, 4},
      {"min(a * a, b) + max(a, b * c)", AEROSOL_OF(std::min(a * a, b) + std::max(a, b * c))},
      {"clamp(a, b, c + 4)", AEROSOL_OF(std::max(std::min(a, c + 4), b))},
      {"clamp(a * 5, b, c)", AEROSOL_OF(std::max(std::min(a * 5, c), b))},
      {"mix(a, b, c)", AEROSOL_OF(a * (1 - c) + b * c)},
      {"step(a, b) * c", AEROSOL_OF((b < a ? 0 : 1) * c)},
      {"smoothstep(a - 4, b + 4, c)", AEROSOL_OF(fade(a - 4, b + 4, c))},
      {"smoothstep(0, 1, a)", AEROSOL_OF(fade(0, 1, a))},
      {"linearstep(a - 3, b + 3, c)", AEROSOL_OF(std::clamp((c - a + 3) / (b - a + 6), 0.0, 1.0))},
      {"smooth_linearstep(0, 1, a, 0.25)",
       AEROSOL_OF(a <= -0.25   ? 0
                  : a >= 1.25  ? 1
                  : a < 0.25   ? (a + 0.25) * (a + 0.25)
                  : a > 0.75   ? 1 - (1.25 - a) * (1.25 - a)
                               : a)},
      {"fma(a, b, c)", AEROSOL_OF(a * b + c)},
      {"select(a * b, c, d)", AEROSOL_OF(d != 0 ? c : a * b)},
      {"logb(a) * b", AEROSOL_OF(std::logb(a) * b), 0.3, 7},
      {"a > b ? a * c : d * e", AEROSOL_OF(a > b ? a * c : d * e)},
      // Vectors
      {"dot(vector(a, b, c), vector(d, e, a))", AEROSOL_OF(a * d + b * e + c * a)},
      {"length(vector(a, b, c))", AEROSOL_OF(length(a, b, c)), 0.25, 2},
      {"distance(point(a, b, c), point(d, e, 5))", AEROSOL_OF(length(a - d, b - e, c - 5))},
      {"distance(point(0), point(a, b, c), point(d, e, 1))",
       [](const Point& p) {
         const double t = std::clamp((p[0] * p[3] + p[1] * p[4] + p[2]) / (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]),
                                     0.0, 1.0);
         return length(p[3] - t * p[0], p[4] - t * p[1], 1 - t * p[2]);
       },
       0.25, 2},
      {"cross(vector(a, b, c), vector(d, e, a))[1]", AEROSOL_OF(c * d - a * a)},
      {"normalize(vector(a, b, c))[1] * d", AEROSOL_OF(b / length(a, b, c) * d), 0.25, 2},
      {"(vector(a, b, c) * vector(d, e, 2) / vector(4, c, 5))[1]", AEROSOL_OF(b * e / c), 0.5, 2},
      {"(vector(a, b, c) * d - e)[2]", AEROSOL_OF(c * d - e)},
      {"reflect(vector(a, b, c), vector(0, d, 1))[1]", AEROSOL_OF(b - 2 * (b * d + c) * d)},
      {"refract(vector(a, 0.1 * b, -1), vector(0, 0, 1), 0.8)[2]",
       AEROSOL_OF(-0.8 - (-0.8 + std::sqrt(1 - 0.64 * (1 - 1)))), -0.5, 0.5},
      {"faceforward(vector(a, b, c), vector(0, 0, 1), vector(d, e, 1))[0]", AEROSOL_OF(-a)},
      {"rotate(point(a, b, c), d, vector(0, 0, 2))[0]", AEROSOL_OF(a * std::cos(d) - b * std::sin(d))},
      {"luminance(color(a, b, c))", AEROSOL_OF(0.212507233 * a + 0.715349972 * b + 0.0721427202 * c)},
      {"transformc(\"hsv\", color(a + 4, b + 2, c))[2]", AEROSOL_OF(a + 4), -0.5, 0.5},
      {"transformc(\"hsl\", \"rgb\", color(0.1, a, b))[0]", AEROSOL_OF(b + a * std::min(b, 1 - b)), 0.1, 0.9},
      {"sin(color(a, b, c))[1]", AEROSOL_OF(std::sin(b))},
      // Matrices, for row vectors
      {"transform(matrix(a, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, b, 0, 0, 1), point(c, d, e))[0]", AEROSOL_OF(c * a + b)},
      {"transform(matrix(1, 0, 0, a, 0, 1, 0, 0, 0, 0, 1, 0, 0, b, 0, 3), point(c, d, e))[1]",
       AEROSOL_OF((d + b) / (c * a + 3)), 0.1, 1},
      {"transform(matrix(a, 1, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, b, 0, 0, 1), vector(c, d, e))[1]", AEROSOL_OF(c + 2 * d)},
      {"transform(matrix(a, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, b, 0, 0, 1), normal(c, d, e))[0]", AEROSOL_OF(c / a), 0.5,
       2},
      {"determinant(matrix(a, b, 0, 0, c, d, 0, 0, 0, 0, e, 0, 0, 0, 0, 2))", AEROSOL_OF((a * d - b * c) * e * 2)},
      {"(matrix(a, b, 0, 0, 0, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1) * matrix(d, 0, 0, 0, e, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, "
       "1))[0][0]",
       AEROSOL_OF(a * d + b * e)},
      {"(1 / matrix(a, b, 0, 0, 0, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1))[0][1]", AEROSOL_OF(-b / (a * c)), 0.5, 2},
      {"(matrix(d) / matrix(a, b, 0, 0, 0, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1))[0][0]", AEROSOL_OF(d / a), 0.5, 2},
      {"(transpose(matrix(a, b, 0, 0, 0, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)) * d / e)[1][0]", AEROSOL_OF(b * d / e), 0.5,
       2},
      // Where functions are constant
      {"cellnoise(a) + hashnoise(0.5) + noise(\"cell\", a, b) + hash(1) + (a < b) + (int)a", AEROSOL_OF(0 * a)},
  };
  return all;
}

/// Outputs y0, x0, y1, x1 …: the value of each case and its derivatives (x, y).
std::shared_ptr<const lang::Program> programOf(bool withValues, bool withDerivatives) {
  std::string parameters, body;
  for (std::size_t i = 0; i < cases().size(); ++i) {
    const std::string number = std::to_string(i);
    body += "  { float t = " + std::string(cases()[i].expression) + ";\n";
    if (withValues) {
      parameters += std::string(parameters.empty() ? "" : ", ") + "output float y" + number + " = 0";
      body += "    y" + number + " = t;\n";
    }
    if (withDerivatives) {
      parameters += std::string(parameters.empty() ? "" : ", ") + "output vector d" + number + " = 0";
      body += "    d" + number + " = vector(Dx(t), Dy(t), 0);\n";
    }
    body += "  }\n";
  }
  lang::CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  const std::string source =
      "float sine(float x) { float s, c; sincos(x, s, c); return s; }\n"
      "float cosine(float x) { float s = x, c; sincos(s, s, c); return c; }\n"
      "shader derivatives(" +
      parameters + ") {\n  float a = u, b = v, c = P[0], d = P[1], e = P[2];\n" + body + "}\n";
  auto compiled = lang::compileString(source, "derivatives.osl", options);
  EXPECT_TRUE(compiled) << format(compiled.errors());
  return compiled ? compiled->program : nullptr;
}

constexpr std::size_t pointCount = 97;

/// Points within a case's bounds, with directions of length about 1 in x and y.
Batch points(const Case& one) {
  Batch batch = Batch::random(pointCount, 5);
  std::mt19937_64 random(17);
  std::uniform_real_distribution<float> inside(static_cast<float>(one.low), static_cast<float>(one.high));
  for (std::vector<float>* values : {&batch.global(Global::u), &batch.global(Global::v), &batch.global(Global::P, 0),
                                     &batch.global(Global::P, 1), &batch.global(Global::P, 2)}) {
    for (float& value : *values) value = inside(random);
  }
  return batch;
}

Point at(Batch& batch, std::size_t i) {
  return {batch.global(Global::u)[i], batch.global(Global::v)[i], batch.global(Global::P, 0)[i],
          batch.global(Global::P, 1)[i], batch.global(Global::P, 2)[i]};
}
Point directionX(Batch& batch, std::size_t i) {
  return {batch.global(Global::dudx)[i], batch.global(Global::dvdx)[i], batch.global(Global::dPdx, 0)[i],
          batch.global(Global::dPdx, 1)[i], batch.global(Global::dPdx, 2)[i]};
}
Point directionY(Batch& batch, std::size_t i) {
  return {batch.global(Global::dudy)[i], batch.global(Global::dvdy)[i], batch.global(Global::dPdy, 0)[i],
          batch.global(Global::dPdy, 1)[i], batch.global(Global::dPdy, 2)[i]};
}

/// Along a direction: central difference in double, and the sum of the magnitudes of the partial derivatives' parts,
/// to which rounding is in proportion. Nothing at a jump or a corner, where the halves differ.
struct Difference {
  double value = 0, magnitude = 0;
  bool isSmooth = true;
};
Difference difference(const Case& one, const Point& point, const Point& direction) {
  constexpr double step = 1e-5;
  const auto along = [&](double t, const Point& towards) {
    Point moved = point;
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += t * towards[i];
    return one.function(moved);
  };
  Difference result;
  const double here = one.function(point);
  const double low = along(-step, direction), high = along(step, direction);
  result.value = (high - low) / (2 * step);
  for (std::size_t i = 0; i < point.size(); ++i) {
    Point axis{};
    axis[i] = direction[i];
    result.magnitude += std::fabs(along(step, axis) - along(-step, axis)) / (2 * step);
  }
  const double curvature = std::fabs(high - 2 * here + low) / step;
  result.isSmooth = curvature <= 1e-2 * (1 + result.magnitude);
  return result;
}

float floatAt(const Outcome& outcome, std::size_t output, std::size_t point) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(outcome.outputs[output][point]));
}

/// Tolerance: 1e-5 of the magnitudes that are added up, and of 1.
TEST(Derivatives, agreeWithDifferencesInDoubleAtAllWidths) {
  const auto program = programOf(true, true);
  ASSERT_TRUE(program);
  std::vector<Outcome> first;
  for (const int width : {16, 8, 4, 1}) {
    const Kernel kernel = compileOrFail(requestFor(program, width));
    for (std::size_t k = 0; k < cases().size(); ++k) {
      const Case& one = cases()[k];
      Batch batch = points(one);
      const Outcome outcome = run(kernel, batch);
      if (first.size() == k) first.push_back(outcome);
      EXPECT_EQ(outcome.outputs, first[k].outputs) << "width " << width;
      std::size_t compared = 0;
      for (std::size_t i = 0; i < pointCount; ++i) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
          const Difference expected =
              difference(one, at(batch, i), axis == 0 ? directionX(batch, i) : directionY(batch, i));
          if (!expected.isSmooth) continue;
          ++compared;
          EXPECT_NEAR(floatAt(outcome, 4 * k + 1 + axis, i), expected.value, 1e-5 * (1 + expected.magnitude))
              << one.expression << ", axis " << axis << " at " << at(batch, i)[0] << ' ' << at(batch, i)[1];
        }
      }
      EXPECT_GT(compared, pointCount) << one.expression;
    }
    if (HasFailure()) return;
  }
}

TEST(Derivatives, leaveTheBitsOfValues) {
  const auto both = programOf(true, true), alone = programOf(true, false);
  ASSERT_TRUE(both && alone);
  for (const int width : {16, 4, 1}) {
    const Kernel with = compileOrFail(requestFor(both, width)), without = compileOrFail(requestFor(alone, width));
    for (const Case& one : cases()) {
      const Batch batch = points(one);
      const Outcome a = run(with, batch), b = run(without, batch);
      for (std::size_t k = 0; k < cases().size(); ++k)
        EXPECT_EQ(a.outputs[4 * k], b.outputs[k]) << cases()[k].expression;
    }
  }
}

std::shared_ptr<const lang::Program> compiled(const std::string& source) {
  lang::CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  auto result = lang::compileString(source, "derivatives.osl", options);
  EXPECT_TRUE(result) << format(result.errors());
  return result ? result->program : nullptr;
}

/// Shaders that compute a derivative which no output needs are, but for that, the same code.
TEST(Derivatives, costNothingWhereNothingReadsThem) {
  const std::string head = "shader s(output float y = 0, output float d = 0) { y = noise(P * 3) * sin(u) + v; ";
  const auto plain = compiled(head + "}"), reading = compiled(head + "d = filterwidth(y) + Dz(y); }");
  for (const int width : {8, 1}) {
    KernelRequest a = requestFor(plain, width), b = requestFor(reading, width);
    a.outputs.resize(1);
    b.outputs.resize(1);
    const auto first = compiler().intermediateText(a), second = compiler().intermediateText(b);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(*first, *second);
    const Kernel kernel = compileOrFail(b);
    for (const Global global : {Global::dPdx, Global::dPdy, Global::dPdz, Global::dudx, Global::dvdy})
      EXPECT_FALSE(kernel.interface().reads(global));
    const Kernel whole = compileOrFail(requestFor(reading, width));
    EXPECT_TRUE(whole.interface().reads(Global::dPdz));
    EXPECT_TRUE(whole.interface().reads(Global::dudx));
    EXPECT_FALSE(whole.interface().reads(Global::dIdx));
  }
}

/// Noise: the kernel's combination of its gradient against differences of the kernel's own values, whose rounding over
/// the distance of 1/64 limits them to 1e-3 (fourth order stencil).
TEST(Derivatives, ofNoiseFollowAllItsCoordinates) {
  const std::vector<std::string> calls = {"noise(a)",
                                          "snoise(a, b)",
                                          "noise(point(a, b, c))",
                                          "snoise(point(a, b, c), d)",
                                          "noise(\"simplex\", a)",
                                          "noise(\"usimplex\", a, b)",
                                          "noise(\"simplex\", point(a, b, c))",
                                          "noise(\"usimplex\", point(a, b, c), d)",
                                          "pnoise(a, 3)",
                                          "psnoise(a, b, 3, 4)",
                                          "pnoise(point(a, b, c), point(3, 4, 5))",
                                          "psnoise(point(a, b, c), d, point(3, 4, 5), 2)",
                                          "((vector)noise(a))[1]",
                                          "((vector)snoise(a, b))[2]",
                                          "((color)noise(point(a, b, c)))[1]",
                                          "((vector)snoise(point(a, b, c), d))[0]",
                                          "((vector)noise(\"simplex\", point(a, b, c)))[2]",
                                          "((vector)noise(\"simplex\", point(a, b, c), d))[1]",
                                          "((vector)pnoise(a, 3))[2]",
                                          "((vector)psnoise(a, b, 3, 4))[1]",
                                          "((vector)pnoise(point(a, b, c), point(3, 4, 5)))[0]",
                                          "((vector)pnoise(point(a, b, c), d, point(3, 4, 5), 2))[2]"};
  std::string parameters, body;
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const std::string number = std::to_string(i);
    parameters += (i > 0 ? ", output float y" : "output float y") + number + " = 0, output float d" + number + " = 0";
    body += "y" + number + " = " + calls[i] + "; d" + number + " = Dx(" + calls[i] + ");\n";
  }
  const auto program =
      compiled("shader s(" + parameters + ") {\nfloat a = u, b = v, c = P[0], d = P[1];\n" + body + "}");
  ASSERT_TRUE(program);
  constexpr float step = 1.0f / 64;
  for (const int width : {8, 1}) {
    const Kernel kernel = compileOrFail(requestFor(program, width));
    Batch batch = Batch::random(pointCount, 3);
    for (std::vector<float>& values : batch.globals)
      for (float& value : values) value = std::floor(value * 4096) / 4096;  // so that steps are exact
    for (std::size_t i = 0; i < pointCount; ++i) {
      const int axis = static_cast<int>(i % 4);
      for (int k = 0; k < 4; ++k) {
        (k == 0   ? batch.global(Global::dudx)
         : k == 1 ? batch.global(Global::dvdx)
                  : batch.global(Global::dPdx, k - 2))[i] = k == axis ? 1.0f : 0.0f;
      }
    }
    const auto moved = [&](float by) {
      Batch there = batch;
      for (std::size_t i = 0; i < pointCount; ++i) {
        there.global(Global::u)[i] += by * batch.global(Global::dudx)[i];
        there.global(Global::v)[i] += by * batch.global(Global::dvdx)[i];
        for (int k = 0; k < 3; ++k) there.global(Global::P, k)[i] += by * batch.global(Global::dPdx, k)[i];
      }
      return run(kernel, there);
    };
    const Outcome here = run(kernel, batch);
    const Outcome far0 = moved(-2 * step), near0 = moved(-step), near1 = moved(step), far1 = moved(2 * step);
    for (std::size_t k = 0; k < calls.size(); ++k) {
      for (std::size_t i = 0; i < pointCount; ++i) {
        const auto value = [&](const Outcome& outcome) { return static_cast<double>(floatAt(outcome, 2 * k, i)); };
        const double expected =
            (8 * (value(near1) - value(near0)) - (value(far1) - value(far0))) / (12 * static_cast<double>(step));
        EXPECT_NEAR(floatAt(here, 2 * k + 1, i), expected, 2e-3) << calls[k] << " point " << i;
      }
    }
  }
}

}  // namespace
}  // namespace aerosol::jit::test
