// Time from the layers of a shader group to code: cold, and from the cache.
#include <benchmark/benchmark.h>

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "core/jit/compiler.h"
#include "core/lang/compile.h"
#include "core/lang/group.h"

namespace aerosol::bench {

namespace {

template <class T>
T valueOf(Result<T> result) {
  if (!result) throw std::runtime_error(format(result.errors()));
  return std::move(*result);
}

/// Shaders of 20 lines each that differ, so that 50 of them have a thousand lines.
std::string layerSource(int index) {
  std::string body;
  for (int line = 0; line < 17; ++line) {
    const int kind = (index + line) % 4;
    const char* const statements[] = {"  x = x * {0}.5 + sin(y);\n", "  y += (x > {0} ? tint[1] : 0.25) * x;\n",
                                      "  tint = mix(tint, color(x, y, {0}), 0.5);\n",
                                      "  x = clamp(x + tint[0], -{0}, {0});\n"};
    body += fmt::format(fmt::runtime(statements[kind]), line % 7 + 1);
  }
  return fmt::format(
      "shader layer{}(float a = 0.5, color c = 0.25, output float out = 0, output color cout = 0) {{\n"
      "  float x = a + u, y = v; color tint = c;\n{}  out = x + y; cout = tint;\n}}\n",
      index, body);
}

/// A chain of `count` layers; `salt` makes it different from others.
lang::Group chain(int count, int salt) {
  lang::CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  lang::Group group;
  for (int i = 0; i < count; ++i) {
    const auto source = valueOf(lang::compileString(layerSource(i + salt), fmt::format("layer{}.osl", i), options));
    group.layers.push_back({fmt::format("l{}", i), source.layer, {}, {}});
    if (i == 0) continue;
    const std::string from = fmt::format("l{}", i - 1), to = fmt::format("l{}", i);
    group.connections.push_back({from, "out", to, "a", {}, {}});
    group.connections.push_back({from, "cout", to, "c", {}, {}});
  }
  return group;
}

std::filesystem::path cacheFolder() {
  return std::filesystem::temp_directory_path() / fmt::format("aerosol_bench_cache_{}", getpid());
}

jit::KernelRequest requestFor(const lang::Group& group) {
  const auto resolved = valueOf(lang::resolve(group));
  jit::KernelRequest request;
  request.program = valueOf(lang::merge(resolved));
  request.outputs = request.program->outputs;
  for (std::uint32_t i = 0; i < request.program->parameters.size(); ++i) {
    const lang::Parameter& parameter = request.program->parameters[i];
    request.folded.push_back({i, parameter.hasConstantDefault ? parameter.defaultValue : lang::ConstantValue{}});
  }
  request.target = valueOf(jit::chooseTarget());
  return request;
}

/// 50 layers of 20 lines: merging and code generation.
void groupCold(benchmark::State& state) {
  const lang::Group group = chain(50, 0);
  const auto compiler = valueOf(jit::Compiler::create({}));
  for (auto _ : state) benchmark::DoNotOptimize(valueOf(compiler->compile(requestFor(group))));
}

void groupCached(benchmark::State& state) {
  const lang::Group group = chain(50, 0);
  jit::CompilerOptions options;
  options.cache = valueOf(jit::ObjectCache::open(cacheFolder()));
  const auto compiler = valueOf(jit::Compiler::create(std::move(options)));
  valueOf(compiler->compile(requestFor(group)));
  for (auto _ : state) benchmark::DoNotOptimize(valueOf(compiler->compile(requestFor(group))));
  std::filesystem::remove_all(cacheFolder());
}

/// Merging alone; the argument is the number of layers.
void groupMerge(benchmark::State& state) {
  const lang::Group group = chain(static_cast<int>(state.range(0)), 0);
  for (auto _ : state) benchmark::DoNotOptimize(valueOf(lang::merge(valueOf(lang::resolve(group)))));
}

/// 200 groups of 5 layers, each different, on all threads.
void groupsInParallel(benchmark::State& state) {
  std::vector<lang::Group> groups;
  for (int i = 0; i < 200; ++i) groups.push_back(chain(5, i));
  const auto compiler = valueOf(jit::Compiler::create({}));
  for (auto _ : state) {
    std::atomic<std::size_t> next{0};
    std::vector<std::jthread> threads;
    for (unsigned t = 0; t < static_cast<unsigned>(state.range(0)); ++t)
      threads.emplace_back([&] {
        for (std::size_t i = next++; i < groups.size(); i = next++) valueOf(compiler->compile(requestFor(groups[i])));
      });
  }
}

BENCHMARK(groupCold)->Unit(benchmark::kMillisecond);
BENCHMARK(groupCached)->Unit(benchmark::kMillisecond);
BENCHMARK(groupMerge)->Arg(50)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(groupsInParallel)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);

}  // namespace

}  // namespace aerosol::bench
