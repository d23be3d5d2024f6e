#include "core/lang/voxel_density.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/lang/compile.h"

namespace aerosol::lang {
namespace {

std::optional<VoxelDensity> found(const std::string& body, const std::string& parameters = "") {
  CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  const auto result = compileString("volume s(" + parameters + ") {\n" + body + "\n}", "test.osl", options);
  EXPECT_TRUE(result) << format(result.errors());
  if (!result) return {};
  ParameterValues values;
  for (std::uint32_t i = 0; i < (*result).program->parameters.size(); ++i) values[i] = {};
  return findVoxelDensity(*(*result).program, values);
}

constexpr const char* lookUp =
    "float v = texture3d(\"a.vdb\", transform(\"object\", P), \"subimage\", \"smoke\", "
    "\"interp\", \"linear\");\n";

TEST(VoxelDensityTest, FactorsOfALookup) {
  const auto density =
      found(std::string(lookUp) +
            "Ci = 2 * anisotropic_vdf(color(0.5, 0.25, 1), color(1, 2, 3) * v, 0.3) + (4 * v) * emission();");
  ASSERT_TRUE(density);
  EXPECT_EQ(density->lookup.file, "a.vdb");
  EXPECT_EQ(density->lookup.grid, "smoke");
  EXPECT_EQ(density->lookup.interpolation, "linear");
  EXPECT_EQ(density->sigmaT, (std::array<float, 3>{2, 4, 6}));
  EXPECT_EQ(density->sigmaS, (std::array<float, 3>{1, 1, 6}));
  EXPECT_EQ(density->emission, (std::array<float, 3>{4, 4, 4}));
  ASSERT_EQ(density->lobes.size(), 1u);
  EXPECT_FLOAT_EQ(density->lobes[0].anisotropy, 0.3f);
  EXPECT_TRUE(std::isinf(density->largestValue));
}

TEST(VoxelDensityTest, ClampsHoldUpToAValue) {
  const auto density =
      found(std::string(lookUp) + "Ci = (10 * clamp(0.25 * v, 0, 1)) * anisotropic_vdf(color(1), color(1), 0);");
  ASSERT_TRUE(density);
  EXPECT_FLOAT_EQ(density->largestValue, 4);
  EXPECT_FLOAT_EQ(density->sigmaT[1], 2.5f);
  EXPECT_FALSE(found(std::string(lookUp) + "Ci = clamp(v, 0.1, 1) * anisotropic_vdf(color(1), color(1), 0);"));
}

TEST(VoxelDensityTest, ParametersAndBranchesOnThem) {
  const std::string body = std::string(lookUp) +
                           "color s = 1; if (chromatic) s = color(1, 2, 3);\n"
                           "Ci = density * anisotropic_vdf(color(0.5), s * v, g);";
  const auto density = found(body, "float density = 3, float g = 0.7, int chromatic = 1");
  ASSERT_TRUE(density);
  EXPECT_EQ(density->sigmaT, (std::array<float, 3>{3, 6, 9}));
}

TEST(VoxelDensityTest, WhatIsMoreThanAProductIsNotFound) {
  const auto isFound = [](const std::string& rest) { return found(std::string(lookUp) + rest).has_value(); };
  EXPECT_TRUE(isFound("Ci = anisotropic_vdf(color(1), color(v), 0);"));
  EXPECT_FALSE(isFound("Ci = anisotropic_vdf(color(1), color(v * v), 0);"));
  EXPECT_FALSE(isFound("Ci = anisotropic_vdf(color(1), color(v + 1), 0);"));
  EXPECT_FALSE(isFound("Ci = anisotropic_vdf(color(v), color(v), 0);"));
  EXPECT_FALSE(isFound("Ci = anisotropic_vdf(color(1), color(v), v);"));
  EXPECT_FALSE(isFound("Ci = anisotropic_vdf(color(1), color(v * noise(P)), 0);"));
  EXPECT_FALSE(isFound("Ci = anisotropic_vdf(color(1), color(sqrt(v)), 0);"));
  EXPECT_FALSE(isFound("if (v > 0.5) Ci = anisotropic_vdf(color(1), color(v), 0);"));
  EXPECT_FALSE(isFound("Ci = anisotropic_vdf(color(1), color(v), 0) + anisotropic_vdf(color(1), color(0.1), 0);"));
  EXPECT_FALSE(isFound("printf(\"%g\", v); Ci = anisotropic_vdf(color(1), color(v), 0);"));
  EXPECT_FALSE(isFound("Ci = anisotropic_vdf(color(1), color(-v), 0);"));
}

TEST(VoxelDensityTest, OneLookupAtThePointInObjectSpace) {
  const auto of = [](const std::string& call) {
    return found("float v = " + call + "; Ci = anisotropic_vdf(color(1), color(v), 0);").has_value();
  };
  EXPECT_TRUE(of("texture3d(\"a.vdb\", transform(\"object\", P))"));
  EXPECT_TRUE(of("texture3d(\"a.vdb\", transform(\"world\", \"object\", P), \"interp\", \"closest\")"));
  EXPECT_FALSE(of("texture3d(\"a.vdb\", P)"));
  EXPECT_FALSE(of("texture3d(\"a.vdb\", transform(\"shader\", P))"));
  EXPECT_FALSE(of("texture3d(\"a.vdb\", 2 * transform(\"object\", P))"));
  EXPECT_FALSE(of("texture3d(\"a.vdb\", transform(\"object\", P), \"fill\", 1.0)"));
  EXPECT_FALSE(of("texture3d(\"a.vdb\", transform(\"object\", P)) + texture3d(\"b.vdb\", transform(\"object\", P))"));
}

}  // namespace
}  // namespace aerosol::lang
