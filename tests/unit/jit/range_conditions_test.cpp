// What is known of a number under a condition on it: bounds as tight as those of the functions that do the same.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>

#include "core/lang/compile.h"
#include "tests/unit/jit/kernel_runner.h"

namespace aerosol::jit::test {

namespace {

/// Bounds of float output f of a shader with these statements, for u in [low, high] and v in [-1, 3].
Bounds boundsOf(const std::string& statements, float low, float high) {
  const std::string text = "shader s(output float f = 0) {" + statements + "}";
  auto compiled = lang::compileString(text, "conditions.osl", {});
  EXPECT_TRUE(compiled) << format(compiled.errors());
  if (!compiled) return {};
  KernelRequest request = requestFor(compiled->program, 8);
  request.domain = Domain::range;
  const Kernel kernel = compileOrFail(request);
  Boxes boxes;
  boxes.count = 1;
  for (std::size_t i = 0; i < boxes.low.size(); ++i) {
    boxes.low[i] = {0};
    boxes.high[i] = {0};
  }
  const auto u = static_cast<std::size_t>(globalPointer(lang::Global::u));
  const auto v = static_cast<std::size_t>(globalPointer(lang::Global::v));
  boxes.low[u] = {low};
  boxes.high[u] = {high};
  boxes.low[v] = {-1};
  boxes.high[v] = {3};
  boxes.instanceData = instanceBlock(kernel.interface(), *compiled->program, {});
  return runRange(kernel, boxes)[0][0];
}

struct Case {
  const char* statements;
  double low, high;  ///< For u in [-1, 2].
};

TEST(RangeConditions, CutWhatTheyCompare) {
  constexpr std::array cases = {
      Case{"float d = u; if (d > 0) f = d;", 0, 2},
      Case{"float d = u; if (d > 0) f = d; else f = -d;", 0, 2},
      Case{"float d = u; if (0 < d) f = 3 * d + 1;", 0, 7},
      Case{"float d = u; if (!(d <= 0)) f = d;", 0, 2},
      Case{"float d = u; f = 1; if (d > 0 && d < 0.5) f = 1 + d;", 1, 1.5},
      Case{"float d = u; f = 1; if (d < 0 || d > 1) f = 1; else f = 1 + d;", 1, 2},
      Case{"float d = u; f = d > 0 ? d : 0;", 0, 2},
      Case{"float d = u; f = d < 0 ? 0 : d;", 0, 2},
      Case{"float d = u; if (d < 0) f = 0; else if (d < 1) f = d; else f = 1;", 0, 1},
      Case{"float d = u; if (d <= 0) return; f = d;", 0, 2},
      Case{"float d = u; if (d > 0) { f = 2 * d; } else { return; } f += d;", 0, 6},
      Case{"float d = u, e = 1.5 * v; if (e < d) f = e;", -1.5, 2},
      Case{"float d = u; for (int i = 0; i < 2; ++i) { if (d <= 0) continue; f += d; }", 0, 4},
      Case{"int k = int(u * 4); if (k > 0) f = k;", 0, 8},
      Case{"int k = int(u * 4); if (k == 3) f = k;", 0, 3},
      Case{"f = u; if (u > 0) f = 0; ", -1, 2},
      Case{"point p = point(u, v, 1); if (p[0] > 0) f = p[0];", 0, 2},
      Case{"point p = point(u, v, 1); if (p.y < p.x) f = p.y;", -1, 2},
      Case{"point p = point(u, v, 1); if (p[0] > 0 && p[0] < 1) f = 1 + p[0] + p[2];", 0, 3},
      Case{"point p = point(u, v, 1); float x = p[0]; if (p[0] > 0) { if (x < 1) f = p[0]; }", 0, 1},
      Case{"point p = point(u, v, 1); if (p[0] <= 0) return; f = p[0];", 0, 2},
      Case{"float d = u; int c = d > 0; if (c) f = d;", 0, 2},
      Case{"float d = u; int c = 0; c = d > 0 && d < 1; f = 3; if (c) f = 2 + d;", 2, 3},
      Case{"float d = u; int c = d > 0; if (v > 1) { if (!c) f = d; }", -1, 0},
  };
  for (const Case& each : cases) {
    const Bounds bounds = boundsOf(each.statements, -1, 2);
    EXPECT_LE(bounds.low, each.low) << each.statements;
    EXPECT_GE(bounds.high, each.high) << each.statements;
    EXPECT_NEAR(bounds.low, each.low, 1e-4) << each.statements;
    EXPECT_NEAR(bounds.high, each.high, 1e-4) << each.statements;
    EXPECT_FALSE(bounds.mayBeNan) << each.statements;
  }
}

/// What the condition has said no longer holds of what has been written since.
TEST(RangeConditions, ForgetWhatIsWritten) {
  constexpr std::array cases = {
      Case{"float d = u; if (d > 0) { d = -d; f = d; }", -2, 0},
      Case{"float d = u; int c = d > 0; d = -3; if (c) f = d;", -3, 0},
      Case{"float d = u; int c = d > 0; for (int i = 0; i < 2; ++i) { if (c) f = d; d -= 4; }", -5, 2},
      Case{"float d = u; if (d > 0) { for (int i = 0; i < 2; ++i) { f = min(f, d); d -= 4; } }", -5, 0},
      Case{"float d = u; if (d > 0) d = 1; f = d;", -1, 2},
      Case{"float d = u; int c = 1; if (v > 1) c = d > 0; if (c) f = d;", -1, 2},
      Case{"float d = u; int c = d > 0; if (v > 1) c = 1; if (c) f = d;", -1, 2},
      Case{"float d = u; int c = d > 0; c = c || v > 1; if (c) f = d;", -1, 2},
      Case{"point p = point(u, v, 1); float x = p[0]; p = -p; if (x > 0) f = p[0];", -2, 0},
      Case{"point p = point(u, v, 1); float x = p[0]; for (int i = 0; i < 2; ++i) { if (x > 0) f = p[0]; p -= 4; }", -4,
           2},
  };
  for (const Case& each : cases) {
    const Bounds bounds = boundsOf(each.statements, -1, 2);
    EXPECT_LE(bounds.low, each.low) << each.statements;
    EXPECT_GE(bounds.high, each.high) << each.statements;
  }
}

/// Where a comparison holds nothing is NaN; where it does not, everything may be.
TEST(RangeConditions, KnowWhatMayBeNan) {
  const std::string nan =
      "float d = u; if (v > 2.5) d = sqrt(-u * u - 1) / 0.0 + log(u) * 1e30 * 1e30 * 1e30 - "
      "1e30 * 1e30 * exp(v * 1000);";
  EXPECT_TRUE(boundsOf(nan + "f = d;", -1, 2).mayBeNan);
  EXPECT_FALSE(boundsOf(nan + "if (d > 0) f = d;", -1, 2).mayBeNan);
  EXPECT_TRUE(boundsOf(nan + "if (d > 0) f = 1; else f = d;", -1, 2).mayBeNan);
  EXPECT_EQ(boundsOf(nan + "if (d > 0) f = 1; else f = d;", -1, 2).high, 1);
}

}  // namespace

}  // namespace aerosol::jit::test
