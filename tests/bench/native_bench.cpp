// A plugin's function in kernels: inlined bitcode, whose loop over lanes is vector code, beside the same function in
// the shading language, beside a call for each batch of lanes of a shared object, and beside one lane at a time.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/jit/compiler.h"
#include "core/lang/compile.h"
#include "core/shading/batch.h"
#include "core/shading/native_plugins.h"

namespace aerosol::bench {

namespace {

namespace fs = std::filesystem;
constexpr int pointCount = 1024;

template <class T>
T valueOf(Result<T> result) {
  if (!result) throw std::runtime_error(format(result.errors()));
  return std::move(*result);
}

fs::path buildFolder() { return fs::read_symlink("/proc/self/exe").parent_path().parent_path(); }

constexpr const char* inlined =
    "float gear_distance(point p, int teeth) [[ string native = \"gear\" ]];\n"
    "shader s(output float d = 0) { d = gear_distance(P, 12) + gear_distance(1.1 * P, 9); }\n";

/// What plugins/sdk/examples/gear.cpp computes.
constexpr const char* written =
    "float diamond(float x, float y) {\n"
    "  float sum = abs(x) + abs(y), share = sum > 0 ? y / sum : 0.0;\n"
    "  return x >= 0 ? (y >= 0 ? share : 4 + share) : 2 - share;\n}\n"
    "float gear_distance(point p, int teeth) {\n"
    "  float wave = diamond(p[0], p[1]) * 0.25 * teeth, phase = wave - floor(wave);\n"
    "  float r = sqrt(p[0] * p[0] + p[1] * p[1]);\n"
    "  float rim = r - (0.85 + 0.15 * (1 - abs(2 * phase - 1))), side = abs(p[2]) - 0.2;\n"
    "  return max(max(0.6 * rim, side), 0.3 - r);\n}\n"
    "shader s(output float d = 0) { d = gear_distance(P, 12) + gear_distance(1.1 * P, 9); }\n";

constexpr const char* called =
    "float sprinkle(point p, float radius) [[ string native = \"sprinkle\" ]];\n"
    "shader s(output float d = 0) { d = sprinkle(P, 0.6); }\n";

/// Nanoseconds a point at a width.
void run(benchmark::State& state, const char* source, int width) {
  lang::CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  options.natives = std::make_shared<shading::NativePlugins>(
      std::vector<fs::path>{buildFolder() / "lib" / "aerosol" / "plugins"}, buildFolder() / "bin" / "aerosol");
  const auto program = valueOf(lang::compileString(source, "bench.osl", options)).program;
  const auto compiler = valueOf(jit::Compiler::create({}));
  shading::ShadingSystem system;
  system.add(program, shading::Instance{});
  shading::ShadingOptions wanted;
  wanted.target = valueOf(jit::chooseTarget(width > 0 ? std::optional(width) : std::nullopt));
  wanted.outputsAlone = true;
  const Diagnostics errors = system.compile(*compiler, wanted);
  if (errors.hasErrors()) throw std::runtime_error(format(errors));
  const shading::Family& family = system.families().front();
  shading::NamedSpaces spaces;
  shading::KernelHost host(spaces, 1000000);
  shading::Batch batch(pointCount);
  shading::PointArrays points;
  points.bind(family, shading::Variant::outputs);
  for (int i = 0; i < pointCount; ++i) {
    const auto x = static_cast<float>(i);
    shading::ShadingPoint point;
    point.set(lang::Global::P, Point<World>(std::sin(x), std::cos(2 * x), 0.1f * std::sin(3 * x)));
    points.push(point, 0);
  }
  for (auto _ : state) {
    batch.run(host, points, 0);
    benchmark::DoNotOptimize(batch.output(0)[0]);
  }
  state.counters["ns/point"] = benchmark::Counter(static_cast<double>(state.iterations()) * pointCount * 1e-9,
                                                  benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void nativeInlined(benchmark::State& state) { run(state, inlined, 0); }
void nativeInlinedOneLane(benchmark::State& state) { run(state, inlined, 1); }
void nativeWrittenInOsl(benchmark::State& state) { run(state, written, 0); }
void nativeSharedObject(benchmark::State& state) { run(state, called, 0); }

BENCHMARK(nativeInlined);
BENCHMARK(nativeInlinedOneLane);
BENCHMARK(nativeWrittenInOsl);
BENCHMARK(nativeSharedObject);

}  // namespace

}  // namespace aerosol::bench
