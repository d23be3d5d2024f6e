#include <fmt/format.h>

#include "tests/render/film_checks.h"

// The same bits for every number of threads and lanes, every batch, every crop and every split of the samples: sums in
// double, before any rounding.

namespace aerosol::test {
namespace {

struct NamedContent {
  std::string name, content;
};

constexpr const char* stage = R"(
    <emitter type="constant"><rgb name="radiance" value="0.2, 0.3, 0.5"/></emitter>
    <emitter type="directional"><vector name="direction" x="1" y="-2" z="1"/><rgb name="irradiance" value="3"/></emitter>
    <shape type="sphere"><point name="center" x="1.5" y="1" z="-1"/><float name="radius" value="0.3"/>
      <emitter type="area"><rgb name="radiance" value="8, 6, 4"/></emitter></shape>
    <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="20"/>
      <translate x="0" y="-1" z="0"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.4, 0.3"/></bsdf>
      </shape>)";

std::string scripted(const char* distance) {
  return std::string(stage) + fmt::format(R"(<volume type="sphere"><medium type="fbm">
      <string name="distance" value="{}"/><float name="density" value="6"/><float name="step_size" value="0.15"/></medium></volume>)",
                                          distance);
}

/// A hundred balls with the same shader and parameters of their own, half of them overlapping their neighbours.
std::string hundredInstances() {
  std::string text = stage;
  for (int i = 0; i < 100; ++i) {
    text += fmt::format(R"(<volume type="sphere"><transform name="to_world"><scale value="{}"/>
        <translate x="{}" y="{}" z="{}"/></transform><medium type="fbm"><string name="distance" value="{}"/>
        <float name="density" value="{}"/><float name="frequency" value="{}"/><float name="g" value="{}"/>
        <float name="step_size" value="0.1"/></medium></volume>)",
                        0.1 + 0.02 * (i % 10), 0.28 * (i % 10 - 4.5), 0.25 * (i / 10 - 3.0), 0.1 * (i % 7 - 3),
                        i % 3 == 0 ? "marching" : "null", 2 + i % 13, 1 + 0.1 * (i % 17), 0.1 * (i % 9 - 4));
  }
  return text;
}

std::vector<NamedContent> contents() {
  return {{"nullScattering", scripted("null")},
          {"marching", scripted("marching")},
          {"hundredInstances", hundredInstances()}};
}

const TestSensor sensor{.fov = 40, .width = 20, .height = 18, .sampler = "sobol"};
constexpr std::uint32_t sampleCount = 12;

class Determinism : public ::testing::TestWithParam<NamedContent> {
 protected:
  TestScene load(SceneOptions options = {}) const {
    return loadScene(R"(<integer name="max_depth" value="8"/>)", sensor, GetParam().content, std::move(options));
  }
  static std::unique_ptr<render::Film> renderWith(const TestScene& scene, const render::RenderOptions& options,
                                                  std::optional<render::PixelRect> crop = {}) {
    auto film = scene.film(crop);
    scene.renderInto(*film, options);
    EXPECT_EQ(film->droppedCount(), 0u);
    return film;
  }
};

TEST_P(Determinism, ThreadsBatchesAndPathsInFlight) {
  const TestScene scene = load();
  const auto reference = renderWith(scene, {.threads = 1, .endSample = sampleCount});
  for (const auto& [threads, paths, batch] :
       {std::tuple{2, 512, 1024}, {3, 100, 64}, {1, 1, 1024}, {1, 1000, 1}, {1, 77, 5}, {2, 2000, 33}}) {
    const auto film =
        renderWith(scene, {.threads = threads, .endSample = sampleCount, .pathsInFlight = paths, .batchSize = batch});
    EXPECT_TRUE(identical(*reference, *film)) << threads << " threads, " << paths << " paths, batches of " << batch;
  }
}

TEST_P(Determinism, Widths) {
  const bool hasAvx512 = jit::hostIsa() == jit::Isa::x86_64_v4;
  const auto reference = renderWith(load({.width = 1}), {.threads = 1, .endSample = sampleCount});
  for (const int width : {4, 8, 16}) {
    for (const char* isa : {"avx2", "avx512"}) {
      if (std::string(isa) == "avx512" && !hasAvx512) continue;
      const auto film = renderWith(load({.width = width, .isa = isa}), {.threads = 1, .endSample = sampleCount});
      EXPECT_TRUE(identical(*reference, *film)) << width << " lanes of " << isa;
    }
  }
}

TEST_P(Determinism, Crops) {
  const TestScene scene = load();
  const auto whole = renderWith(scene, {.threads = 1, .endSample = sampleCount});
  for (const render::PixelRect& crop :
       {render::PixelRect{3, 5, 4, 6}, render::PixelRect{0, 0, 20, 1}, render::PixelRect{7, 2, 19, 18}}) {
    const auto film = renderWith(scene, {.threads = 2, .endSample = sampleCount}, crop);
    for (int y = crop.y0; y < crop.y1; ++y) {
      for (int x = crop.x0; x < crop.x1; ++x) {
        ASSERT_TRUE(film->pixel(x, y) == whole->pixel(x, y)) << x << ' ' << y;
      }
    }
  }
  // Four crops are the whole.
  auto merged = scene.film();
  for (const render::PixelRect& crop : {render::PixelRect{9, 7, 20, 18}, render::PixelRect{0, 0, 9, 7},
                                        render::PixelRect{9, 0, 20, 7}, render::PixelRect{0, 7, 9, 18}}) {
    const auto part = renderWith(scene, {.threads = 1, .endSample = sampleCount}, crop);
    EXPECT_FALSE(merged->merge(*part).hasErrors());
  }
  EXPECT_TRUE(identical(*whole, *merged));
}

/// Three uneven parts of the samples, joined in any order.
TEST_P(Determinism, SplitsOfTheSamples) {
  const TestScene scene = load();
  const render::PixelRect crop{8, 8, 12, 11};
  const auto whole = renderWith(scene, {.threads = 1, .endSample = 256}, crop);
  const auto part = [&](std::uint32_t first, std::uint32_t end) {
    return renderWith(scene, {.threads = 2, .firstSample = first, .endSample = end}, crop);
  };
  std::vector<std::unique_ptr<render::Film>> parts;
  parts.push_back(part(0, 7));
  parts.push_back(part(7, 100));
  parts.push_back(part(100, 256));
  std::array<std::size_t, 3> order{0, 1, 2};
  do {
    auto merged = scene.film(crop);
    for (const std::size_t i : order) EXPECT_FALSE(merged->merge(*parts[i]).hasErrors());
    EXPECT_TRUE(identical(*whole, *merged)) << order[0] << order[1] << order[2];
  } while (std::next_permutation(order.begin(), order.end()));
}

/// The film of one part carried on by the next, as after an interruption.
TEST_P(Determinism, ARenderCarriedOn) {
  const TestScene scene = load();
  const auto whole = renderWith(scene, {.threads = 1, .endSample = sampleCount});
  auto film = scene.film();
  scene.renderInto(*film, {.threads = 2, .endSample = 5});
  scene.renderInto(*film, {.threads = 1, .firstSample = 5, .endSample = sampleCount});
  EXPECT_TRUE(identical(*whole, *film));
}

/// The test sees what it looks for: another seed is another film.
TEST_P(Determinism, AnotherSeedIsAnotherFilm) {
  TestSensor other = sensor;
  other.seed = 1;
  const TestScene reseeded = loadScene(R"(<integer name="max_depth" value="8"/>)", other, GetParam().content);
  EXPECT_FALSE(identical(*renderWith(load(), {.threads = 1, .endSample = 2}),
                         *renderWith(reseeded, {.threads = 1, .endSample = 2})));
}

/// Vectors are full: of the lanes that kernels run at least 90% hold a point, and of what they compute, weighted by
/// cost, what masks let through is counted too.
TEST_P(Determinism, LanesAreUsed) {
  const TestScene scene = load({.laneCounters = true});
  const auto film = scene.film();
  const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = 128});
  const render::WorkerStatistics& s = report.statistics;
  ASSERT_GT(s.kernelLanes, 30000u);
  EXPECT_GE(static_cast<double>(s.kernelPoints), 0.9 * static_cast<double>(s.kernelLanes));
  ASSERT_GT(s.countedLanesRun, 0u);
  EXPECT_LE(s.countedLanesUsed, s.countedLanesRun);
  EXPECT_GE(static_cast<double>(s.countedLanesUsed), 0.9 * static_cast<double>(s.countedLanesRun));
  EXPECT_EQ(s.frameHeapBlocks, 0u) << "coroutine frames that did not fit their slot";
}

INSTANTIATE_TEST_SUITE_P(All, Determinism, ::testing::ValuesIn(contents()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace aerosol::test
