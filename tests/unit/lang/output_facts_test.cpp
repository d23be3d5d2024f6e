#include "core/lang/output_facts.h"

#include <gtest/gtest.h>

#include "core/lang/compile.h"

namespace aerosol::lang {
namespace {

using Fact = bool (*)(const Program&, const ParameterValues&, OutputKind);

/// Of a volume shader with that body, all parameters at their defaults.
bool holds(Fact fact, OutputKind output, const std::string& body, const std::string& parameters) {
  CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  const auto compiled = compileString("volume s(" + parameters + ") {\n" + body + "\n}", "test.osl", options);
  EXPECT_TRUE(compiled) << format(compiled.errors());
  if (!compiled) return false;
  const Program& program = *compiled->program;
  ParameterValues values;
  for (std::uint32_t i = 0; i < program.parameters.size(); ++i) values[i] = program.parameters[i].defaultValue;
  return fact(program, values, output);
}

bool hasGreyExtinction(const std::string& body, const std::string& parameters = "") {
  return holds(isGrey, OutputKind::sigmaT, body, parameters);
}

TEST(Grey, ExtinctionFromOneNumber) {
  EXPECT_TRUE(hasGreyExtinction("Ci = anisotropic_vdf(color(0.9, 0.5, 0.1), color((float)noise(P)), 0);"));
  EXPECT_TRUE(hasGreyExtinction("Ci = (float)noise(P) * anisotropic_vdf(color(0.9, 0.5, 0.1), color(2), 0);"));
  EXPECT_TRUE(hasGreyExtinction("float d = noise(P); Ci = anisotropic_vdf(color(1), color(d, d, d), 0);"));
  EXPECT_TRUE(hasGreyExtinction("Ci = noise(P) * emission();"));  // There is none.
}

TEST(Grey, ExtinctionWithAColour) {
  EXPECT_FALSE(hasGreyExtinction("Ci = anisotropic_vdf(color(1), (color)noise(P), 0);"));
  EXPECT_FALSE(hasGreyExtinction("Ci = noise(P) * anisotropic_vdf(color(1), color(1, 2, 2), 0);"));
  EXPECT_FALSE(hasGreyExtinction("Ci = anisotropic_vdf(color(1), color(P), 0);"));
  EXPECT_FALSE(hasGreyExtinction("float d = noise(P); Ci = anisotropic_vdf(color(1), color(d, d, 2 * d), 0);"));
  EXPECT_FALSE(hasGreyExtinction("color c = (float)noise(P); c[1] = 3; Ci = anisotropic_vdf(color(1), c, 0);"));
}

TEST(Grey, ParametersDecide) {
  const std::string body = "Ci = (float)noise(P) * anisotropic_vdf(color(1), c, 0);";
  EXPECT_TRUE(hasGreyExtinction(body, "color c = 3"));
  EXPECT_FALSE(hasGreyExtinction(body, "color c = color(3, 3, 3.5)"));
  const std::string branch =
      "color c = (float)noise(P); if (tint) c *= color(1, 2, 3); Ci = anisotropic_vdf(color(1), c, 0);";
  EXPECT_TRUE(hasGreyExtinction(branch, "int tint = 0"));
  EXPECT_FALSE(hasGreyExtinction(branch, "int tint = 1"));
}

TEST(Grey, FunctionsOfComponents) {
  const auto of = [](const std::string& c) {
    return hasGreyExtinction("color d = (float)noise(P); Ci = anisotropic_vdf(color(1), " + c + ", 0);");
  };
  EXPECT_TRUE(of("exp(-d)"));
  EXPECT_TRUE(of("clamp(2 * d, color(0), color(1))"));
  EXPECT_TRUE(of("mix(color(0.5), d, time)"));
  EXPECT_FALSE(of("mix(color(0.5, 0.4, 0.4), d, time)"));
  EXPECT_FALSE(of("color(P) * exp(-d)"));
}

TEST(Grey, LoopsAndBranchesOnWhatVaries) {
  EXPECT_TRUE(hasGreyExtinction(
      R"(color c = 0; for (int i = 0; i < 5; ++i) { if (P[0] > i) c += (float)noise(i * P); else c *= 2; }
      Ci = anisotropic_vdf(color(1), c, 0);)"));
  EXPECT_FALSE(hasGreyExtinction(
      R"(color c = 0, k = 1; for (int i = 0; i < 5; ++i) { c += k * (float)noise(i * P); k = color(P); }
      Ci = anisotropic_vdf(color(1), c, 0);)"));
  // In the other part of a branch the number is another one.
  EXPECT_FALSE(hasGreyExtinction(R"(float a = noise(P), b = noise(2 * P); color c = 1;
      if (P[0] > 0) b = a; else c = color(b, a, a);
      Ci = anisotropic_vdf(color(1), c, 0);)"));
  EXPECT_FALSE(hasGreyExtinction(R"(float a = noise(P), b = a; color c = 1;
      for (int i = 0; i < 3; ++i) { c = color(a, b, b); b = noise(i * P); }
      Ci = anisotropic_vdf(color(1), c, 0);)"));
}

TEST(Zero, WhatIsNeverThere) {
  const auto isNothing = [](OutputKind output, const std::string& body, const std::string& parameters = "") {
    return holds(isZero, output, body, parameters);
  };
  const std::string fire = "Ci = noise(P) * emission();";
  EXPECT_TRUE(isNothing(OutputKind::sigmaT, fire));
  EXPECT_TRUE(isNothing(OutputKind::sigmaS, fire));
  EXPECT_FALSE(isNothing(OutputKind::emission, fire));
  const std::string smoke = "Ci = noise(P) * anisotropic_vdf(albedo, color(1), 0);";
  EXPECT_TRUE(isNothing(OutputKind::emission, smoke, "color albedo = 1"));
  EXPECT_TRUE(isNothing(OutputKind::sigmaS, smoke, "color albedo = 0"));
  EXPECT_FALSE(isNothing(OutputKind::sigmaS, smoke, "color albedo = color(0, 0, 0.1)"));
  EXPECT_FALSE(isNothing(OutputKind::sigmaT, smoke, "color albedo = 0"));
}

}  // namespace
}  // namespace aerosol::lang
