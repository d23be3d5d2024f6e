#include "core/render/film_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace aerosol::render {
namespace {

/// Samples of value 1 with spikes of probability 1e-3: true mean `1 + 1e-3 · height`.
class Fireflies {
 public:
  Fireflies(int width, std::uint64_t seed, float height) : film({0, 0, width, width}), random_(seed), height_(height) {}

  void extendTo(std::uint32_t count) {
    while (count_ < count) {
      const std::uint32_t end = std::min({count, (count_ / 64 + 1) * 64});
      FilmTile tile(film.area(), count_, end);
      for (int y = 0; y < film.area().y1; ++y) {
        for (int x = 0; x < film.area().x1; ++x) {
          for (std::uint32_t i = count_; i < end; ++i) {
            const float value = uniform_(random_) < 1e-3 ? 1 + height_ : 1.0f;
            tile.add(x, y, i, Color(value), 1);
          }
        }
      }
      film.commit(tile);
      count_ = end;
    }
  }
  double mean() const {
    double sum = 0;
    for (int y = 0; y < film.area().y1; ++y) {
      for (int x = 0; x < film.area().x1; ++x) sum += film.pixel(x, y).total().color[0];
    }
    return sum / (static_cast<double>(film.area().pixelCount()) * count_);
  }

  Film film;

 private:
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_;
  float height_;
  std::uint32_t count_ = 0;
};

TEST(FilmError, IsTheStandardErrorOfThePixels) {
  Fireflies scene(64, 1, 10);
  scene.extendTo(256);
  // Scatter of one sample: 10 · sqrt(p (1 - p)).
  const double expected = 10 * std::sqrt(1e-3 * 0.999 / 256) / 1.01;
  EXPECT_NEAR(relativeError(scene.film), expected, 0.02 * expected);
}

TEST(FilmError, IsNothingWhereNothingIsKnown) {
  Fireflies scene(4, 1, 10);
  EXPECT_EQ(relativeError(scene.film), 0);
  scene.extendTo(1);
  EXPECT_EQ(relativeError(scene.film), 0);
}

TEST(Decisions, AreAtTheSameCountsAlways) {
  std::vector<std::uint32_t> counts;
  for (std::uint32_t count = 0; count < 300;) counts.push_back(count = nextDecision(count));
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384}));
  EXPECT_EQ(firstErrorDecision(1u << 20), 16u);
  EXPECT_GE(std::uint64_t{firstErrorDecision(100)} * 100, 65536u);
}

/// Stopping on samples that enter the mean makes it too dark: the bias over many renders of spikes with p = 1e-3, which
/// has to stay below a tenth of the target.
TEST(Decisions, ATargetErrorLeavesLittleBias) {
  for (const auto& [width, height, target] : {std::tuple{4, 30.0f, 0.05}, {16, 100.0f, 0.1}, {32, 300.0f, 0.5}}) {
    const double truth = 1 + 1e-3 * static_cast<double>(height);
    constexpr int renders = 60;
    double sum = 0, squares = 0, counts = 0;
    for (int i = 0; i < renders; ++i) {
      Fireflies scene(width, 77 + static_cast<std::uint64_t>(i), height);
      std::uint32_t count = firstErrorDecision(scene.film.area().pixelCount());
      for (;; count = nextDecision(count)) {
        scene.extendTo(count);
        if (relativeError(scene.film) <= target || count >= 1u << 14) break;
      }
      const double bias = scene.mean() / truth - 1;
      sum += bias;
      squares += bias * bias;
      counts += count;
    }
    const double bias = sum / renders, error = std::sqrt((squares / renders - bias * bias) / (renders - 1));
    std::printf("%2d x %2d pixels, spikes of %3.0f, target %.0f%%: %.0f samples a pixel, bias %+.3f%% +- %.3f%%\n",
                width, width, static_cast<double>(height), 100 * target, counts / renders, 100 * bias, 100 * error);
    EXPECT_LT(std::fabs(bias), 0.1 * target + 2 * error);
    EXPECT_LT(error, 0.05 * target) << "the test resolves nothing";
  }
}

}  // namespace
}  // namespace aerosol::render
