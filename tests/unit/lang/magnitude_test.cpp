#include "core/lang/magnitude.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/lang/analysis.h"
#include "core/lang/compile.h"

namespace aerosol::lang {
namespace {

/// Whether the output `o` is the same for all points, with the parameter p at its default.
bool isConstantOutput(const std::string& type, const std::string& expression, const std::string& p = "0") {
  CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  const auto compiled = compileString(
      "shader s(float p = " + p + ", output " + type + " o = 0) { o = " + expression + "; }", "t", options);
  EXPECT_TRUE(compiled) << format(compiled.errors());
  if (!compiled) return false;
  const Program program = specialise(*compiled->program, {{0, compiled->program->parameters[0].defaultValue}});
  return isConstant(program, program.outputs.at(0));
}

TEST(Magnitude, TermsOfNoWeightVanish) {
  EXPECT_TRUE(isConstantOutput("float", "0.5 + p * noise(P)"));
  EXPECT_TRUE(isConstantOutput("float", "0.5 - noise(4 * P) * p"));
  EXPECT_TRUE(isConstantOutput("float", "p * P[2] + 3"));
  EXPECT_TRUE(isConstantOutput("color", "color(1, 2, 3) + p * (color)noise(P, time)"));
  EXPECT_TRUE(isConstantOutput("float", "2 * (1 + p * (noise(P) + 0.5 * noise(2 * P)))"));
}

TEST(Magnitude, TermsThatRoundingLosesVanish) {
  EXPECT_TRUE(isConstantOutput("float", "0.5 + p * noise(P)", "1e-12"));
  EXPECT_TRUE(isConstantOutput("float", "0.5 + 1e-12 * snoise(P)"));
}

TEST(Magnitude, WhatMayMatterStays) {
  EXPECT_FALSE(isConstantOutput("float", "0.5 + p * noise(P)", "1e-7"));
  EXPECT_FALSE(isConstantOutput("float", "p + p * noise(P)"));               // -0 and 0 differ
  EXPECT_FALSE(isConstantOutput("float", "0.5 + p * exp(P[0])"));            // may be infinite
  EXPECT_FALSE(isConstantOutput("float", "0.5 + p * (1e20 * P[0])"));        // may overflow
  EXPECT_FALSE(isConstantOutput("color", "color(1, 0, 3) + p * noise(P)"));  // one component keeps the sign of the term
  EXPECT_FALSE(isConstantOutput("float", "noise(P) - (0.5 + p * P[0])"));
}

TEST(Magnitude, AbsorbsLessThanHalfOfTheNearestStep) {
  for (const float number : {1.0f, 0.5f, 3.0f, -7.25f, 1e-3f, 1e30f}) {
    const double step = std::fabs(double{number} - double{std::nextafterf(number, 0.0f)});
    EXPECT_TRUE(absorbs(number, 0.49 * step));
    EXPECT_FALSE(absorbs(number, 0.5 * step));
    EXPECT_EQ(number + static_cast<float>(0.49 * step), number);
    EXPECT_EQ(number - static_cast<float>(0.49 * step), number);
  }
  EXPECT_FALSE(absorbs(0.0f, 0));
  EXPECT_FALSE(absorbs(INFINITY, 0));
}

}  // namespace
}  // namespace aerosol::lang
