// Compiled shaders beside the same functions as an expert writes them in C++ with vectors: nanoseconds a point, what
// derivatives cost, and how long compiling takes.
//
//   shader_table [ROUNDS]
//
// Every number is the median over rounds of the thread's own time; the two ways of a row take turns, so that what else
// the machine does falls on both. The texture's other way is a call of the texture library for the same points; the
// group's is one function.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>
#include <stdexcept>
#include <thread>

#include <time.h>

#include "core/jit/compiler.h"
#include "core/lang/compile.h"
#include "core/render/scene_services.h"
#include "core/shading/batch.h"
#include "tests/bench/shader_table/references.h"
#include "tests/bench/shader_table/shaders.h"
#include "tests/support/scratch_folder.h"

namespace aerosol::bench {
namespace {

constexpr int pointCount = 1024;
constexpr std::size_t referenceResults = 17;
using Seconds = std::chrono::duration<double>;

/// Of this thread's own work: what else the machine does counts as little as it can.
double processorSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <class T>
T valueOf(Result<T> result) {
  if (!result) throw std::runtime_error(format(result.errors()));
  return std::move(*result);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Seconds that one call takes, of as many as fill two milliseconds.
double timeOf(const std::function<void()>& call) {
  for (int count = 1;; count *= 4) {
    const double begin = processorSeconds();
    for (int i = 0; i < count; ++i) call();
    const double seconds = processorSeconds() - begin;
    if (seconds > 2e-3) return seconds / count;
  }
}

/// Medians of the times of calls that take turns, in nanoseconds a point.
std::vector<double> compareCalls(int rounds, const std::vector<std::function<void()>>& calls) {
  std::vector<std::vector<double>> times(calls.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < calls.size(); ++i) times[i].push_back(timeOf(calls[i]) / pointCount * 1e9);
  std::vector<double> medians;
  for (auto& one : times) medians.push_back(median(one));
  return medians;
}

struct FreeMemory {
  void operator()(float* p) const { std::free(p); }
};

/// Points in a cube around the origin as arrays, with room for a reference's results.
struct Points {
  std::unique_ptr<float[], FreeMemory> memory{
      static_cast<float*>(std::aligned_alloc(64, (3 + referenceResults) * pointCount * sizeof(float)))};
  const float* axis(std::size_t i) const { return memory.get() + i * pointCount; }
  float* results() const { return memory.get() + 3 * pointCount; }

  Points() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-2.0f, 2.0f);
    for (std::size_t i = 0; i < std::size_t{3} * pointCount; ++i) memory[i] = uniform(random);
  }
};

using ProgramPointer = std::shared_ptr<const lang::Program>;

shading::ShadingOptions optionsFor(const lang::Program& program, std::optional<int> width) {
  shading::ShadingOptions options;
  options.target = valueOf(jit::chooseTarget(width));
  options.outputsAlone = !program.isSurface();
  return options;
}

/// A shader with its kernel, to be run on the points.
class Compiled {
 public:
  Compiled(const Points& points, const ProgramPointer& program, shading::Instance instance, jit::Compiler& compiler,
           std::optional<int> width, shading::Services* services)
      : host_(spaces_, 1000000, services), batch_(pointCount) {
    system_.add(program, std::move(instance));
    const Diagnostics errors = system_.compile(compiler, optionsFor(*program, width));
    if (errors.hasErrors()) throw std::runtime_error(format(errors));
    points_.bind(system_.families().front(),
                 program->isSurface() ? shading::Variant::surface : shading::Variant::outputs);
    for (std::size_t i = 0; i < pointCount; ++i) {
      shading::ShadingPoint point;
      point.set(lang::Global::P, Point<World>(points.axis(0)[i], points.axis(1)[i], points.axis(2)[i]));
      point.set(lang::Global::dPdx, Vector<World>(0.01f, 0, 0));
      point.set(lang::Global::dPdy, Vector<World>(0, 0.01f, 0));
      points_.push(point, 0);
    }
  }

  void run() {
    batch_.run(host_, points_, 0);
    host_.records().clear();
  }
  const float* output(std::size_t i) const { return batch_.output(i); }

 private:
  shading::ShadingSystem system_;
  shading::NamedSpaces spaces_;
  shading::KernelHost host_;
  shading::Batch batch_;
  shading::PointArrays points_;
};

ProgramPointer compiled(const std::string& source, const std::string& name) {
  lang::CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  return valueOf(lang::compileString(source, name + ".osl", options)).program;
}

/// A program that gives the first of its outputs alone.
ProgramPointer firstOutputOf(const ProgramPointer& program) {
  auto copy = std::make_shared<lang::Program>(*program);
  copy->outputs.resize(1);
  return copy;
}

class Table {
 public:
  explicit Table(int rounds) : rounds_(rounds), compiler_(valueOf(jit::Compiler::create({}))) {
    const int width = valueOf(jit::chooseTarget()).width;
    references_ = width == 16 ? references16() : references8();
    fmt::print("{} points a call, {} lanes, medians of {} rounds\n\n", pointCount, width, rounds);
    fmt::print("{:<13}{:>9}{:>9}{:>7}{:>10}{:>9}{:>9}{:>9}{:>10}{:>10}\n", "shader", "ns/point", "C++", "ratio",
               "one lane", "factor", "unread", "read", "cold ms", "cached ms");
  }

  void add(const TableShader& shader) {
    const ProgramPointer program = compiled(shader.source, shader.name);
    const double front = median(timesOf([&] { compiled(shader.source, shader.name); }));
    addRow(shader.name, program, shader.widthSource.empty() ? nullptr : compiled(shader.widthSource, shader.name),
           references_.at(shader.name), front);
  }

  void addGroup() {
    const lang::Group group = chainOfLayers(50, 0);
    ProgramPointer program;
    const auto merge = [&] { program = firstOfChain(valueOf(lang::merge(valueOf(lang::resolve(group))))); };
    const double front = median(timesOf(merge));
    addRow("group", program, nullptr, references_.at("group"), front);
  }

  void addTexture(const std::filesystem::path& file) {
    const TableShader shader = textureShader();
    const ProgramPointer program = compiled(shader.source, shader.name);
    const auto services = render::makeServices({});
    shading::Instance instance;
    instance.values.push_back({*shading::findParameter(*program, "file"), std::vector<std::string>{file.string()}});
    Compiled wide(points_, program, instance, *compiler_, {}, services.get());
    std::string problem;
    TextureSource* const source = services->textures(problem);
    if (!source) throw std::runtime_error(problem);
    const auto session = source->openSession();
    std::vector<float> direct(pointCount);
    const auto times = compareCalls(rounds_, {[&] { wide.run(); }, [&] { lookUp(*session, file.string(), direct); }});
    fmt::print("{:<13}{:>9.1f}{:>9.1f}{:>7.2f}\n", shader.name, times[0], times[1], times[0] / times[1]);
    check(shader.name, wide.output(0), direct.data());
  }

  /// 200 groups of five layers, each different, by all processors.
  void addParallelGroups() {
    std::vector<ProgramPointer> programs;
    for (int i = 0; i < 200; ++i)
      programs.push_back(firstOfChain(valueOf(lang::merge(valueOf(lang::resolve(chainOfLayers(5, i)))))));
    fmt::print("\n200 groups of 5 layers:");
    for (const unsigned threads : {1u, std::max(2u, std::thread::hardware_concurrency())}) {
      std::atomic<std::size_t> next{0};
      const auto begin = std::chrono::steady_clock::now();
      {
        std::vector<std::jthread> workers;
        for (unsigned t = 0; t < threads; ++t)
          workers.emplace_back([&] {
            for (std::size_t i = next++; i < programs.size(); i = next++) compileOnce(*compiler_, programs[i]);
          });
      }
      fmt::print(" {:.2f} s with {} threads", Seconds(std::chrono::steady_clock::now() - begin).count(), threads);
    }
    fmt::print("\n");
  }

 private:
  static ProgramPointer firstOfChain(const ProgramPointer& program) {
    auto copy = std::make_shared<lang::Program>(*program);
    std::erase_if(copy->outputs, [&](const lang::Output& output) {
      return output.kind != lang::OutputKind::parameter || !copy->parameters[output.index].name.ends_with("out") ||
             copy->parameters[output.index].name.ends_with("cout");
    });
    copy->outputs.erase(copy->outputs.begin(), copy->outputs.end() - 1);
    return copy;
  }

  std::vector<double> timesOf(const std::function<void()>& call) const {
    std::vector<double> times;
    for (int i = 0; i < 5; ++i) {
      const double begin = processorSeconds();
      call();
      times.push_back((processorSeconds() - begin) * 1e3);
    }
    return times;
  }

  static void compileOnce(jit::Compiler& compiler, const ProgramPointer& program) {
    shading::ShadingSystem system;
    system.add(program, {});
    const Diagnostics errors = system.compile(compiler, optionsFor(*program, {}));
    if (errors.hasErrors()) throw std::runtime_error(format(errors));
  }

  void lookUp(TextureSession& session, const std::string& file, std::vector<float>& results) const {
    std::array<TexturePoint, 16> points;
    std::array<float, 48> values{};
    std::vector<TextureFailure> failures;
    for (std::size_t i = 0; i < pointCount; i += points.size()) {
      for (std::size_t lane = 0; lane < points.size(); ++lane) {
        TexturePoint& point = points[lane];
        for (std::size_t axis = 0; axis < 2; ++axis) point.at[axis] = points_.axis(axis)[i + lane];
        point.dx[0] = point.dy[1] = 0.01f;
        point.wrap[0] = point.wrap[1] = TextureWrap::periodic;
      }
      session.lookup(TextureKind::plane, file, points, 3, values.data(), failures);
      for (std::size_t lane = 0; lane < points.size(); ++lane) results[i + lane] = values[3 * lane + 1];
    }
  }

  void addRow(const std::string& name, const ProgramPointer& program, const ProgramPointer& withWidth,
              PatternFunction reference, double frontMilliseconds) {
    Compiled wide(points_, program, {}, *compiler_, {}, nullptr);
    Compiled scalar(points_, program, {}, *compiler_, 1, nullptr);
    std::vector<std::function<void()>> calls = {
        [&] { wide.run(); },
        [&] { reference(points_.axis(0), points_.axis(1), points_.axis(2), points_.results(), pointCount); },
        [&] { scalar.run(); }};
    std::optional<Compiled> unread, read;
    if (withWidth) {
      unread.emplace(points_, firstOutputOf(withWidth), shading::Instance{}, *compiler_, std::nullopt, nullptr);
      read.emplace(points_, withWidth, shading::Instance{}, *compiler_, std::nullopt, nullptr);
      calls.emplace_back([&] { unread->run(); });
      calls.emplace_back([&] { read->run(); });
    }
    const auto times = compareCalls(rounds_, calls);
    const test::ScratchFolder folder;
    const auto caching = valueOf(jit::Compiler::create({{}, valueOf(jit::ObjectCache::open(folder.path()))}));
    compileOnce(*caching, program);
    const double cold = median(timesOf([&] { compileOnce(*compiler_, program); })) + frontMilliseconds;
    const double cached = median(timesOf([&] { compileOnce(*caching, program); }));
    const std::string derivatives =
        withWidth ? fmt::format("{:>9.2f}{:>9.2f}", times[3] / times[0], times[4] / times[0]) : std::string(18, ' ');
    fmt::print("{:<13}{:>9.1f}{:>9.1f}{:>7.2f}{:>10.1f}{:>9.1f}{}{:>10.1f}{:>10.2f}\n", name, times[0], times[1],
               times[0] / times[1], times[2], times[2] / times[0], derivatives, cold, cached);
    check(name, wide.output(0), points_.results());
  }

  /// Both ways compute the same, up to rounding; a comparison on an edge may fall on either side.
  void check(const std::string& name, const float* ours, const float* theirs) const {
    int wrong = 0;
    for (std::size_t i = 0; i < pointCount; ++i) wrong += !(std::abs(ours[i] - theirs[i]) < 1e-3f);
    if (wrong > pointCount / 100) fmt::print("  {}: {} of {} points differ\n", name, wrong, pointCount);
  }

  int rounds_;
  Points points_;
  std::shared_ptr<jit::Compiler> compiler_;
  std::map<std::string, PatternFunction> references_;
};

}  // namespace
}  // namespace aerosol::bench

int main(int count, char** words) {
  try {
    aerosol::bench::Table table(count > 1 ? std::max(1, std::atoi(words[1])) : 15);
    for (const auto& shader : aerosol::bench::tableShaders()) table.add(shader);
    table.addGroup();
    table.addTexture(AEROSOL_SOURCE_DIR "/tests/language/textures/ramp.ppm");
    table.addParallelGroups();
  } catch (const std::exception& problem) {
    fmt::print(stderr, "error: {}\n", problem.what());
    return 1;
  }
  return 0;
}
