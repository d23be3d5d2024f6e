// Nanoseconds a point of compiled shaders at every width, beside the same functions in C++ for this machine; the fixed
// cost of a call; and the time that compiling takes.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/jit/compiler.h"
#include "core/lang/compile.h"
#include "tests/bench/reference.h"
#include "tests/support/scratch_folder.h"

namespace aerosol::bench {

namespace {

constexpr std::size_t pointCount = 1024;

const std::map<std::string, std::string> sources = {
    {"constant", R"(
shader constant(output color extinction = 0) { extinction = color(1, 2, 3); }
)"},
    {"sphere", R"(
shader sphere(output float density = 0) {
  float d = 1 - length(P);
  density = d > 0 ? d : 0;
}
)"},
    {"fbm", R"(
shader fbm(output float density = 0) {
  float sum = 0, weight = 0.5;
  point q = P;
  for (int octave = 0; octave < 6; octave++) {
    sum += weight * snoise(q);
    q *= 2;
    weight *= 0.5;
  }
  density = sum;
}
)"},
    // Its value, and how much that changes between shading samples; asked for both, and for the value alone.
    {"fbm_width", R"(
shader fbm_width(output float density = 0, output float width = 0) {
  float sum = 0, weight = 0.5;
  point q = P;
  for (int octave = 0; octave < 6; octave++) {
    sum += weight * snoise(q);
    q *= 2;
    weight *= 0.5;
  }
  density = sum;
  width = filterwidth(sum);
}
)"},
    {"fbm_width_unread", ""},
    {"pyroclastic", R"(
shader pyroclastic(output float density = 0) {
  float radius = length(P);
  if (radius >= 1.5) return;
  float sum = 0, weight = 0.5;
  point q = P;
  for (int octave = 0; octave < 6; octave++) {
    sum += weight * fabs(snoise(q));
    q *= 2;
    weight *= 0.5;
  }
  float d = 1 + sum - radius;
  if (d > 0) density = d;
}
)"},
};

template <class T>
T valueOf(Result<T> result) {
  if (!result) throw std::runtime_error(format(result.errors()));
  return std::move(*result);
}

const std::string& sourceOf(const std::string& name) {
  return sources.at(name == "fbm_width_unread" ? "fbm_width" : name);
}

std::shared_ptr<const lang::Program> programOf(const std::string& name) {
  static std::map<std::string, std::shared_ptr<const lang::Program>> known;
  auto& program = known[name];
  if (!program) program = valueOf(lang::compileString(sourceOf(name), name + ".osl", {})).program;
  return program;
}

jit::Compiler& compiler() {
  static const auto shared = valueOf(jit::Compiler::create({}));
  return *shared;
}

jit::KernelRequest requestFor(const std::string& name, int width, jit::Isa isa) {
  jit::KernelRequest request;
  request.program = programOf(name);
  request.outputs = request.program->outputs;
  if (name == "fbm_width_unread") request.outputs.resize(1);
  request.target = {width, isa};
  for (std::uint32_t i = 0; i < request.program->parameters.size(); ++i) {
    request.folded.push_back({i, request.program->parameters[i].defaultValue});
  }
  return request;
}

/// Points in a cube around the origin, 64-byte aligned arrays.
struct Points {
  float *x, *y, *z, *result, *unused;
  std::unique_ptr<float, decltype(&std::free)> memory;

  Points() : memory(static_cast<float*>(std::aligned_alloc(64, 6 * pointCount * sizeof(float))), &std::free) {
    x = memory.get();
    y = x + pointCount;
    z = y + pointCount;
    result = z + pointCount;
    unused = result + pointCount;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-2.0f, 2.0f);
    for (std::size_t i = 0; i < 3 * pointCount; ++i) x[i] = uniform(random);
  }
};

/// A kernel with arguments for the points.
struct Call {
  explicit Call(jit::Kernel compiled) : kernel(std::move(compiled)) {
    globals.fill(nullptr);
    globals[0] = points.x;
    globals[1] = points.y;
    globals[2] = points.z;
    // Any derivatives.
    const int dPdx = jit::globalPointer(lang::Global::dPdx);
    for (int i = 0; i < 6; ++i)
      globals[static_cast<std::size_t>(dPdx + i)] = points.x + static_cast<std::size_t>(i % 3) * pointCount;
    context.loopBudget = 1000000;
    arguments.context = &context;
    arguments.globals = globals.data();
    arguments.outputs = outputs.data();
    arguments.count = pointCount;
    for (std::size_t i = 0; i < outputs.size(); ++i) outputs[i] = points.result + i * pointCount;
  }

  jit::Kernel kernel;
  Points points;
  std::array<const float*, jit::globalPointerCount> globals;
  std::array<void*, 3> outputs;
  AerosolKernelContext context{};
  AerosolKernelArguments arguments{};
};

Function referenceFor(const Reference& reference, const std::string& name) {
  if (name == "sphere") return reference.sphere;
  return name.starts_with("fbm") ? reference.fbm : reference.pyroclastic;
}

/// Shown as time a point.
void perPoint(benchmark::State& state) {
  state.counters["point"] = benchmark::Counter(
      static_cast<double>(pointCount), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void runShader(benchmark::State& state, const std::string& name, int width, jit::Isa isa) {
  Call call(valueOf(compiler().compile(requestFor(name, width, isa))));
  for (auto _ : state) {
    call.kernel(call.arguments);
    benchmark::ClobberMemory();
  }
  perPoint(state);
  if (name == "constant") return;
  Points points;
  referenceFor(scalarReference(), name)(points.x, points.y, points.z, points.result, pointCount);
  for (std::size_t i = 0; i < pointCount; ++i) {
    if (std::abs(points.result[i] - call.points.result[i]) > 1e-4f) state.SkipWithError("not the same function");
  }
}

void runReference(benchmark::State& state, const std::string& name, const Reference& reference) {
  const Function function = referenceFor(reference, name);
  Points points;
  for (auto _ : state) {
    function(points.x, points.y, points.z, points.result, pointCount);
    benchmark::ClobberMemory();
  }
  perPoint(state);
}

/// A call for no point, and one for a single point.
void runCall(benchmark::State& state, std::int32_t count) {
  Call call(valueOf(
      compiler().compile(requestFor("constant", *jit::hostIsa() == jit::Isa::x86_64_v4 ? 16 : 8, *jit::hostIsa()))));
  call.arguments.count = count;
  for (auto _ : state) {
    call.kernel(call.arguments);
    benchmark::ClobberMemory();
  }
}

void reportTimes(benchmark::State& state, const jit::CompileTimes& sum) {
  const auto add = [&](const char* name, double seconds) {
    state.counters[name] = benchmark::Counter(seconds * 1e3, benchmark::Counter::kAvgIterations);
  };
  add("lower_ms", sum.lowering);
  add("link_ms", sum.linkRuntime);
  add("optimise_ms", sum.optimisation);
  add("codegen_ms", sum.codeGeneration);
  add("load_ms", sum.loading);
}

void runFrontEnd(benchmark::State& state, const std::string& name) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(valueOf(lang::compileString(sourceOf(name), name + ".osl", {})));
  }
}

void runCompile(benchmark::State& state, const std::string& name, int width, jit::Isa isa) {
  const jit::KernelRequest request = requestFor(name, width, isa);
  jit::CompileTimes sum;
  for (auto _ : state) {
    const jit::Kernel kernel = valueOf(compiler().compile(request));
    const jit::CompileTimes& times = kernel.times();
    sum.lowering += times.lowering;
    sum.linkRuntime += times.linkRuntime;
    sum.optimisation += times.optimisation;
    sum.codeGeneration += times.codeGeneration;
    sum.loading += times.loading;
  }
  reportTimes(state, sum);
}

void runCached(benchmark::State& state, const std::string& name, int width, jit::Isa isa) {
  const test::ScratchFolder folder;
  {
    jit::KernelRequest request = requestFor(name, width, isa);
    request.programHash = jit::hashProgram(*request.program);
    const auto cached = valueOf(jit::Compiler::create({{}, valueOf(jit::ObjectCache::open(folder.path()))}));
    valueOf(cached->compile(request));
    for (auto _ : state) {
      const auto kernel = cached->load(request);
      if (!kernel) state.SkipWithError("not in the cache");
    }
  }
}

int registerAll() {
  using benchmark::RegisterBenchmark;
  const std::optional<jit::Isa> host = jit::hostIsa();
  if (!host) return 0;
  std::vector<jit::Isa> isas = {jit::Isa::x86_64_v3};
  if (*host == jit::Isa::x86_64_v4) isas.push_back(jit::Isa::x86_64_v4);
  for (const auto& [name, source] : sources) {
    for (const jit::Isa isa : isas) {
      for (const int width : {16, 8, 4, 1}) {
        const std::string label =
            "shader/" + name + "/" + std::string(jit::name(isa)) + "/width:" + std::to_string(width);
        RegisterBenchmark(label.c_str(), runShader, name, width, isa);
      }
    }
    if (name == "constant" || name.starts_with("fbm_")) continue;
    RegisterBenchmark(("cpp/" + name + "/scalar").c_str(), runReference, name, scalarReference());
    RegisterBenchmark(("cpp/" + name + "/width:8").c_str(), runReference, name, vectorReference8());
    if (*host == jit::Isa::x86_64_v4) {
      RegisterBenchmark(("cpp/" + name + "/width:16").c_str(), runReference, name, vectorReference16());
    }
  }
  RegisterBenchmark("call/no_points", runCall, 0);
  RegisterBenchmark("call/one_point", runCall, 1);
  const int width = *host == jit::Isa::x86_64_v4 ? 16 : 8;
  for (const auto& [name, source] : sources) {
    RegisterBenchmark(("front_end/" + name).c_str(), runFrontEnd, name)->Unit(benchmark::kMillisecond);
    RegisterBenchmark(("compile/" + name).c_str(), runCompile, name, width, *host)->Unit(benchmark::kMillisecond);
    RegisterBenchmark(("cached/" + name).c_str(), runCached, name, width, *host)->Unit(benchmark::kMillisecond);
  }
  return 0;
}

const int registered = registerAll();

}  // namespace

}  // namespace aerosol::bench
