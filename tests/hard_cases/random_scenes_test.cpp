#include <fmt/format.h>
#include <rapidcheck.h>

#include <cstdlib>

#include "tests/hard_cases/random_scene.h"
#include "tests/render/film_checks.h"

// Small random scenes of volumes, dielectrics, lights and cameras. Whatever is in them: nothing is NaN, no pixel is
// negative beyond its noise, no bit depends on threads and widths, units do not matter, and where all light comes from
// a sky of 1 nothing is brighter than that.

namespace aerosol::test {
namespace {

using rc::gen::element;

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define AEROSOL_FEW_SCENES
#endif
#endif
#ifdef AEROSOL_FEW_SCENES
constexpr const char* usualCount = "12";
#else
constexpr const char* usualCount = "150";
#endif

/// The same scenes in every run. $AEROSOL_RANDOM_SCENES asks for more of them, $AEROSOL_RANDOM_SEED for others.
const bool isConfigured = [] {
  const auto given = [](const char* variable, const char* otherwise) {
    const char* const value = std::getenv(variable);
    return std::string(value ? value : otherwise);
  };
  const std::string parameters =
      fmt::format("seed={} max_success={} verbose_progress=0", given("AEROSOL_RANDOM_SEED", "20"),
                  given("AEROSOL_RANDOM_SCENES", usualCount));
  return setenv("RC_PARAMS", parameters.c_str(), 0) == 0;
}();

/// One of them, which is told when a property does not hold.
RandomScene draw(bool skyAlone) {
  RandomScene random = RandomScene::make(skyAlone);
  RC_LOG() << random.content(1) << '\n';
  return random;
}

/// Means and their errors, all pixels and colours together.
struct Brightness {
  double mean = 0, variance = 0;

  explicit Brightness(const render::Film& film) {
    const auto count = 3 * static_cast<double>(film.area().pixelCount());
    for (int y = 0; y < film.area().y1; ++y) {
      for (int x = 0; x < film.area().x1; ++x) {
        const render::PixelEstimate e = film.estimate(x, y);
        // Colours share their paths: their errors add up as they are.
        double error = 0;
        for (int c = 0; c < 3; ++c) {
          mean += static_cast<double>(e.color[c]) / count;
          error += static_cast<double>(e.standardError[c]) / count;
        }
        variance += error * error;
      }
    }
  }
};

TEST(RandomScenes, AreFiniteAndNotNegativeAndTheSameForThreadsAndWidths) {
  ASSERT_TRUE(isConfigured);
  const bool ok = rc::check("finite, not negative, the same bits", [] {
    const RandomScene random = draw(false);
    const TestScene scene = random.load(1), narrow = random.load(1, {.width = 4, .isa = "avx2"});
    RC_ASSERT(scene.scene() && narrow.scene());
    const auto film = scene.render(32);
    RC_ASSERT(film->droppedCount() == 0u);
    for (int y = 0; y < film->area().y1; ++y) {
      for (int x = 0; x < film->area().x1; ++x) {
        const render::PixelEstimate e = film->estimate(x, y);
        for (int c = 0; c < 3; ++c) {
          RC_ASSERT(std::isfinite(e.color[c]));
          RC_ASSERT(e.color[c] >= -4 * e.standardError[c]);
        }
      }
    }
    auto other = narrow.film();
    narrow.renderInto(*other, {.threads = 2, .endSample = 32, .pathsInFlight = 37, .batchSize = 40});
    RC_ASSERT(identical(*film, *other));
  });
  EXPECT_TRUE(ok);
}

TEST(RandomScenes, UnitsDoNotMatter) {
  const bool ok = rc::check("scene times 2^k and 10^k", [] {
    const RandomScene random = draw(false);
    const double unit = *element(0.0078125, 1024.0, 1e-3, 1e4);
    const TestScene scene = random.load(1), scaled = random.load(unit);
    RC_ASSERT(scene.scene() && scaled.scene());
    // The same random numbers: most paths are the same, so errors of both together are an upper bound.
    const Brightness a(*scene.render(48)), b(*scaled.render(48));
    RC_ASSERT(std::fabs(a.mean - b.mean) <= 5 * std::sqrt(a.variance + b.variance) + 1e-4 * std::fabs(a.mean));
  });
  EXPECT_TRUE(ok);
}

TEST(RandomScenes, UnderASkyOfOneNothingIsBrighter) {
  const bool ok = rc::check("energy is bounded", [] {
    const RandomScene random = draw(true);
    const TestScene scene = random.load(1);
    RC_ASSERT(scene.scene());
    const auto film = scene.render(64);
    // A camera inside of an index n sees n² times as much.
    const double n = random.largestIndexAtCamera();
    const Brightness whole(*film);
    // Where nothing but roulette makes noise, which it does seldom, the variance is hardly known.
    RC_ASSERT(whole.mean <= n * n * (1 + 1e-4) + 5 * std::sqrt(whole.variance));
  });
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace aerosol::test
