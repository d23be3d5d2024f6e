// Films against closed forms, and against each other.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "core/render/film.h"
#include "tests/statistical/statistics.h"
#include "tests/support/rendering.h"

namespace aerosol::test {

/// Radiance along a camera ray.
using ExpectedRadiance = std::function<Color(const Ray<World>&)>;

/// Where the shaders of these tests are.
inline std::filesystem::path shaderFolder() { return AEROSOL_SOURCE_DIR "/tests/render/shaders"; }

/// A scene with the shaders of these tests. Its seed comes from the test's name and that of the sensor.
inline TestScene loadScene(const std::string& integrator, TestSensor sensor, const std::string& content,
                           SceneOptions options = {}) {
  options.shaderFolder = shaderFolder();
  sensor.seed = static_cast<int>(seedOfTest(static_cast<std::uint64_t>(sensor.seed)) % 1000000);
  return TestScene(sceneXml(integrator, sensor, content), options);
}

namespace detail {

/// Sums over the pixels of a block, by channel.
struct Block {
  std::array<double, 3> found{}, expected{}, variance{};
};

inline constexpr int blockSize = 2;

/// Scores of blocks of pixels, and the mean over the film with its resolution.
class BlockScores {
 public:
  void add(const Block& block) {
    for (std::size_t c = 0; c < 3; ++c) {
      total_.found[c] += block.found[c];
      total_.expected[c] += block.expected[c];
      total_.variance[c] += block.variance[c];
      const double difference = block.found[c] - block.expected[c], rounding = 1e-4 * std::fabs(block.expected[c]);
      // Below rounding, and what four points say of a pixel, there is no noise to speak of.
      if (block.variance[c] > rounding * rounding) {
        // Channels share their random numbers: each block gives the score of one.
        if (c == blocks_ % 3) scores_.push_back(difference / std::sqrt(block.variance[c]));
      } else if (std::fabs(difference) > rounding + maximumZ * std::sqrt(block.variance[c])) {
        isExactlyWrong_ = true;
      }
    }
    ++blocks_;
  }

  ::testing::AssertionResult judge(double resolution) const {
    if (isExactlyWrong_) return ::testing::AssertionFailure() << "a pixel without noise is off: " << describe();
    for (std::size_t c = 0; c < 3; ++c) {
      const double error = std::sqrt(total_.variance[c]), difference = total_.found[c] - total_.expected[c];
      if (error > resolution * std::fabs(total_.expected[c])) {
        return ::testing::AssertionFailure() << "the test resolves nothing: " << describe();
      }
      if (std::fabs(difference) > maximumZ * error + 5e-5 * std::fabs(total_.expected[c])) {
        return ::testing::AssertionFailure() << "channel " << c << ", z " << difference / error << ": " << describe();
      }
    }
    if (scores_.size() < 40) return ::testing::AssertionSuccess();
    auto result = zScoresAreNormal(scores_);
    return result << " over " << scores_.size() << " blocks: " << describe();
  }

 private:
  std::string describe() const {
    std::string text = "mean";
    for (std::size_t c = 0; c < 3; ++c) {
      text += ' ' + std::to_string(total_.found[c]) + " ± " + std::to_string(std::sqrt(total_.variance[c])) + " of " +
              std::to_string(total_.expected[c]);
    }
    return text;
  }

  Block total_;
  std::vector<double> scores_;
  std::size_t blocks_ = 0;
  bool isExactlyWrong_ = false;
};

}  // namespace detail

/// Whether every pixel shows the expected radiance, averaged over its area: the film's mean by the rule for means, the
/// blocks of pixels by the distribution of their z.
inline ::testing::AssertionResult shows(const TestScene& scene, const render::Film& film,
                                        const ExpectedRadiance& expected, double resolution = meanResolution) {
  if (!scene.scene()) return ::testing::AssertionFailure() << "there is no scene";
  const render::PixelRect area = film.area();
  detail::BlockScores scores;
  for (int by = area.y0; by < area.y1; by += detail::blockSize) {
    for (int bx = area.x0; bx < area.x1; bx += detail::blockSize) {
      detail::Block block;
      for (int y = by; y < std::min(by + detail::blockSize, area.y1); ++y) {
        for (int x = bx; x < std::min(bx + detail::blockSize, area.x1); ++x) {
          const render::PixelEstimate pixel = film.estimate(x, y);
          for (int c = 0; c < 3; ++c) {
            const auto i = static_cast<std::size_t>(c);
            block.found[i] += static_cast<double>(pixel.color[c]);
            block.variance[i] += std::pow(static_cast<double>(pixel.standardError[c]), 2);
          }
          // Two by two Gauss points: exact for cubics over a pixel.
          for (const double dy : {0.2113248654051871, 0.7886751345948129}) {
            for (const double dx : {0.2113248654051871, 0.7886751345948129}) {
              const render::CameraSample at{.x = static_cast<float>(x + dx), .y = static_cast<float>(y + dy)};
              const Color value = expected(scene.scene()->camera->ray(at));
              for (int c = 0; c < 3; ++c)
                block.expected[static_cast<std::size_t>(c)] += static_cast<double>(value[c]) / 4;
            }
          }
        }
      }
      scores.add(block);
    }
  }
  return scores.judge(resolution);
}

/// Whether two films with independent samples are estimates of one image.
inline ::testing::AssertionResult showTheSame(const render::Film& a, const render::Film& b,
                                              double resolution = meanResolution) {
  const render::PixelRect area = a.area();
  if (!(area == b.area())) return ::testing::AssertionFailure() << "the films differ in size";
  detail::BlockScores scores;
  for (int by = area.y0; by < area.y1; by += detail::blockSize) {
    for (int bx = area.x0; bx < area.x1; bx += detail::blockSize) {
      detail::Block block;
      for (int y = by; y < std::min(by + detail::blockSize, area.y1); ++y) {
        for (int x = bx; x < std::min(bx + detail::blockSize, area.x1); ++x) {
          const render::PixelEstimate p = a.estimate(x, y), q = b.estimate(x, y);
          for (int c = 0; c < 3; ++c) {
            const auto i = static_cast<std::size_t>(c);
            block.found[i] += static_cast<double>(p.color[c]);
            block.expected[i] += static_cast<double>(q.color[c]);
            block.variance[i] += std::pow(static_cast<double>(p.standardError[c]), 2) +
                                 std::pow(static_cast<double>(q.standardError[c]), 2);
          }
        }
      }
      scores.add(block);
    }
  }
  return scores.judge(resolution);
}

/// Distances at which a ray enters and leaves the sphere of `radius` about the origin; equal when it misses.
inline std::array<double, 2> throughSphere(const Ray<World>& ray, double radius) {
  const std::array<double, 3> o{static_cast<double>(ray.origin.x), static_cast<double>(ray.origin.y),
                                static_cast<double>(ray.origin.z)};
  const std::array<double, 3> d{static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
                                static_cast<double>(ray.direction.z)};
  const double b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
  const double c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - radius * radius;
  const double root = std::sqrt(std::max(0.0, b * b - c));
  return {std::max(0.0, -b - root), std::max(0.0, -b + root)};
}

/// What a byte of an sRGB image stands for.
inline double linearFromByte(int byte) {
  const double x = byte / 255.0;
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

inline Color color(const std::function<double(int)>& channel) {
  return {static_cast<float>(channel(0)), static_cast<float>(channel(1)), static_cast<float>(channel(2))};
}

/// Squared standard errors of all pixels, in green, added up.
inline double summedVariance(const render::Film& film) {
  double sum = 0;
  for (int y = film.area().y0; y < film.area().y1; ++y) {
    for (int x = film.area().x0; x < film.area().x1; ++x) {
      sum += std::pow(static_cast<double>(film.estimate(x, y).standardError[1]), 2);
    }
  }
  return sum;
}

}  // namespace aerosol::test
