#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "core/app/render_rounds.h"
#include "core/render/film_error.h"
#include "core/render/pixel_error.h"
#include "tests/render/film_checks.h"

// What a render says of its own error, against the scatter of many renders with other random numbers.

namespace aerosol::test {
namespace {

/// A ball in thin fog under an area light: light that low-discrepancy samples find better than independent ones, and
/// some for which they do little.
TestScene ballInFog(const std::string& sampler, int size) {
  return loadScene("", {.fov = 30, .width = size, .height = size, .sampler = sampler}, R"(
  <shape type="rectangle"><transform name="to_world"><scale value="1.5"/><rotate x="1" angle="90"/>
    <translate x="0.5" y="3" z="-1"/></transform><emitter type="area"><rgb name="radiance" value="9"/></emitter></shape>
  <shape type="sphere"><float name="radius" value="0.8"/><bsdf type="diffuse"/></shape>
  <volume type="box"><medium type="homogeneous"><rgb name="sigma_t" value="0.1"/><rgb name="albedo" value="0.7"/>
    </medium></volume>)");
}

/// Sums over pixels and channels.
struct Errors {
  double measured = 0, told = 0, asIfIndependent = 0;
};

/// Of renders with so many samples a pixel.
Errors errorsOf(const TestScene& scene, std::uint32_t samples, int renders) {
  Errors errors;
  std::vector<double> sums, squares;
  for (int r = 0; r < renders; ++r) {
    const auto film = scene.film();
    scene.renderInto(*film, {.threads = 1, .endSample = samples, .seed = 1000u + static_cast<unsigned>(r)});
    const render::PixelRect area = film->area();
    sums.resize(3 * area.pixelCount());
    squares.resize(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const int x = static_cast<int>(i / 3) % area.width(), y = static_cast<int>(i / 3) / area.width();
      const auto c = static_cast<int>(i % 3);
      const render::PixelEstimate estimate = film->estimate(x, y);
      const auto value = static_cast<double>(estimate.color[c]);
      sums[i] += value;
      squares[i] += value * value;
      errors.told += std::pow(static_cast<double>(estimate.standardError[c]), 2) / renders;
      const render::PixelSum& pixel = film->pixel(x, y);
      errors.asIfIndependent += squaredErrors(pixel, pixel.total(), false, 2)[i % 3] / renders;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    errors.measured += (squares[i] - sums[i] * sums[i] / renders) / (renders - 1);
  }
  return errors;
}

/// Two standard errors of the ratios or more, and far from what independent samples would have.
constexpr double band = 0.12;

TEST(ErrorEstimates, AreRightForLowDiscrepancySamples) {
  const TestScene scene = ballInFog("sobol", 8);
  ASSERT_TRUE(scene.scene());
  for (const std::uint32_t samples : {64u, 256u}) {
    const Errors errors = errorsOf(scene, samples, 100);
    std::printf("%3u samples: squared error told / measured %.3f, as if they were independent %.3f\n", samples,
                errors.told / errors.measured, errors.asIfIndependent / errors.measured);
    EXPECT_NEAR(errors.told / errors.measured, 1, band) << samples;
    EXPECT_GT(errors.asIfIndependent / errors.measured, 1 + 2 * band) << "the test tells nothing apart";
  }
}

TEST(ErrorEstimates, AreRightForIndependentSamples) {
  const TestScene scene = ballInFog("independent", 8);
  ASSERT_TRUE(scene.scene());
  const Errors errors = errorsOf(scene, 64, 100);
  EXPECT_NEAR(errors.told / errors.measured, 1, band);
}

/// Before every scramble has samples the error of a pixel is a bound, and the whole image knows better.
TEST(ErrorEstimates, AreBoundsForFewSamples) {
  const TestScene scene = ballInFog("sobol", 16);
  ASSERT_TRUE(scene.scene());
  const Errors errors = errorsOf(scene, 16, 30);
  EXPECT_GT(errors.told / errors.measured, 1 + band);
  constexpr int renders = 30;
  double told = 0, scale = 0;
  for (int r = 0; r < renders; ++r) {
    const auto film = scene.film();
    scene.renderInto(*film, {.threads = 1, .endSample = 16, .seed = 1000u + static_cast<unsigned>(r)});
    told += std::pow(render::relativeError(*film), 2) / renders;
    const std::vector<float> rgba = film->rgba();
    for (std::size_t i = 0; i < rgba.size(); ++i) {
      if (i % 4 != 3) scale += static_cast<double>(rgba[i]) / renders;
    }
  }
  // Both are means over all values of the image.
  const double values = 3.0 * 16 * 16, measured = errors.measured / values / std::pow(scale / values, 2);
  EXPECT_NEAR(told / measured, 1, band);
}

/// Renders that stop by the error that they see have that error.
TEST(ErrorEstimates, ATargetErrorIsTheErrorOfTheImage) {
  const TestScene scene = ballInFog("sobol", 8);
  ASSERT_TRUE(scene.scene());
  constexpr double target = 0.03;
  constexpr int renders = 40;
  std::vector<std::vector<float>> images;
  double told = 0, samples = 0;
  for (unsigned r = 0; r < renders; ++r) {
    const auto film = scene.film();
    const app::GoalReport report = app::renderTowards({.error = target, .maximum = 1u << 14}, *scene.scene(),
                                                      scene.integrator(), *film, {.threads = 1, .seed = 500 + r});
    EXPECT_LE(report.error, target);
    told += report.error * report.error / renders;
    samples += static_cast<double>(report.samples) / renders;
    images.push_back(film->rgba());
  }
  EXPECT_GT(samples, 1100) << "the first decision alone shows nothing";
  double squares = 0, scale = 0;
  for (std::size_t i = 0; i < images[0].size(); ++i) {
    if (i % 4 == 3) continue;
    double mean = 0;
    for (const auto& image : images) mean += static_cast<double>(image[i]) / renders;
    for (const auto& image : images) squares += std::pow(static_cast<double>(image[i]) - mean, 2) / (renders - 1);
    scale += mean;
  }
  const double values = 3.0 * 8 * 8, achieved = std::sqrt(squares / values) / (scale / values);
  std::printf("target %.2f%%: told %.3f%%, achieved %.3f%% with %.0f samples a pixel\n", 100 * target,
              100 * std::sqrt(told), 100 * achieved, samples);
  EXPECT_NEAR(achieved / std::sqrt(told), 1, band);
  EXPECT_LT(achieved, (1 + band) * target);
}

}  // namespace
}  // namespace aerosol::test
