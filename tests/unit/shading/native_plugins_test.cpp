// Functions of plugins in kernels: bitcode is inlined, its loops over lanes become vector code, and ranges hold.
#include "core/shading/native_plugins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/jit/compiler.h"
#include "core/lang/compile.h"
#include "core/shading/batch.h"
#include "core/shading/bounds.h"

namespace aerosol::shading::test {

namespace {

namespace fs = std::filesystem;

template <class T>
T valueOf(Result<T> result) {
  if (!result) throw std::runtime_error(format(result.errors()));
  return std::move(*result);
}

jit::Compiler& kernels() {
  static const auto shared =
      valueOf(jit::Compiler::create({fs::path(AEROSOL_BINARY_DIR) / "lib" / "aerosol" / "runtime", nullptr}));
  return *shared;
}

lang::CompileOptions options() {
  lang::CompileOptions result;
  result.standardLibrary = fs::path(AEROSOL_SOURCE_DIR) / "shaders" / "stdosl.h";
  result.natives = std::make_shared<NativePlugins>(
      std::vector<fs::path>{fs::path(AEROSOL_BINARY_DIR) / "lib" / "aerosol" / "plugins"},
      fs::path(AEROSOL_BINARY_DIR) / "bin" / "aerosol");
  return result;
}

constexpr const char* gearShader =
    "float gear_distance(point p, int teeth) [[ string native = \"gear\" ]];\n"
    "shader s(int teeth = 12, output float d = 0) { d = gear_distance(P, teeth) * gear_distance(2 * P, teeth); }\n";

TEST(NativePlugins, LoopsOverLanesOfBitcodeAreVectorCode) {
  const auto source = valueOf(lang::compileString(gearShader, "gear.osl", options()));
  jit::KernelRequest request;
  request.program = source.program;
  request.outputs = source.program->outputs;
  request.target = valueOf(jit::chooseTarget());
  if (request.target.width < 8) GTEST_SKIP() << "this machine has no wide vectors";
  const std::string text = valueOf(kernels().intermediateText(request));
  const std::string root = "@llvm.sqrt.v" + std::to_string(request.target.width) + "f32";
  EXPECT_NE(text.find("call <" + std::to_string(request.target.width) + " x float> " + root), std::string::npos)
      << text;
  EXPECT_EQ(text.find("@llvm.sqrt.f32("), std::string::npos) << "a lane at a time";
  EXPECT_EQ(text.find("@native."), std::string::npos) << "a call that was not inlined";
}

TEST(NativePlugins, SymbolsFindTheirFunctionAgain) {
  const lang::CompileOptions compile = options();
  const auto source = valueOf(lang::compileString(gearShader, "gear.osl", compile));
  ASSERT_EQ(source.dependencies.size() > 0, true);
  lang::Program program = *source.layer;
  for (lang::FunctionUse& use : program.functions) use.native = nullptr;
  ASSERT_TRUE(lang::attachNatives(program, compile.natives.get()));
  const auto used = std::ranges::find_if(program.functions, [](const auto& use) { return use.native != nullptr; });
  ASSERT_NE(used, program.functions.end());
  used->symbol += "x";
  EXPECT_FALSE(lang::attachNatives(program, nullptr));
}

TEST(NativePlugins, SignaturesHaveNoNames) {
  EXPECT_EQ(lang::nativeSignature("float  f( point p,output int  n , float a[3])"),
            "float f(point,output int,float[3])");
  EXPECT_EQ(lang::nativeSignature("void f()"), "void f()");
  EXPECT_FALSE(lang::nativeSignature("float f(point p"));
  EXPECT_FALSE(lang::nativeSignature("thing f(point p)"));
  EXPECT_FALSE(lang::nativeSignature("float f(point p int n)"));
}

/// Bounds of the volumes that plugins bring: no point of a box gives an extinction outside.
class PluginBounds : public testing::TestWithParam<const char*> {};

TEST_P(PluginBounds, Hold) {
  const fs::path folder = fs::path(AEROSOL_BINARY_DIR) / "lib" / "aerosol" / "plugins";
  const auto source = valueOf(compilePlugin(folder / GetParam(), options()));
  ShadingSystem system;
  system.add(source.program, Instance{});
  ShadingOptions wanted;
  wanted.target = valueOf(jit::chooseTarget());
  Diagnostics errors = system.compile(kernels(), wanted);
  errors.append(system.compileBounds(kernels(), wanted));
  ASSERT_FALSE(errors.hasErrors()) << format(errors);
  const Family& family = system.families().front();
  ASSERT_TRUE(family.bounds);
  EXPECT_TRUE(family.bounds->interface().hasDeclaredRanges);
  NamedSpaces spaces;
  KernelHost host(spaces, 1000000);
  BoundsBatch bounds(16);
  constexpr int perBox = 64;
  Batch batch(perBox);
  PointArrays points;
  points.bind(family, Variant::extinction);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-1.1f, 1.1f), unit(0, 1);
  int finite = 0;
  for (int round = 0; round < 100; ++round) {
    VolumeBox box;
    for (int i = 0; i < 3; ++i) {
      box.box.lower[i] = place(random);
      box.box.upper[i] = box.box.lower[i] + 0.5f * unit(random) * unit(random);
    }
    CoefficientBounds known;
    bounds.evaluate(host, family, 0, {&box, 1}, {&known, 1});
    const Bound extinction = known.extinction();
    finite += std::isfinite(extinction.high);
    for (int k = 0; k < perBox; ++k) {
      Point<World> p;
      for (int i = 0; i < 3; ++i) p[i] = box.box.lower[i] + (box.box.upper[i] - box.box.lower[i]) * unit(random);
      points.push(VolumePoint{p, Vector<World>(0, 0, 1), 0}, 0);
    }
    batch.run(host, points, 0);
    for (int k = 0; k < perBox; ++k) {
      EXPECT_GE(batch.output(0)[k], known.sigmaT[0].low);
      EXPECT_LE(batch.output(0)[k], known.sigmaT[0].high);
    }
    points.shrink(0);
  }
  EXPECT_EQ(finite, 100);
}

INSTANTIATE_TEST_SUITE_P(Examples, PluginBounds, testing::Values("gear.bc", "sprinkle.so"),
                         [](const auto& info) { return fs::path(info.param).stem().string(); });

}  // namespace

}  // namespace aerosol::shading::test
