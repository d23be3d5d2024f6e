// Blurred films against the mean of stills.
#pragma once

#include "tests/render/film_checks.h"

namespace aerosol::test {

/// Parameters of a sensor.
inline std::string shutter(double open, double close) {
  return "<float name=\"shutter_open\" value=\"" + std::to_string(open) + "\"/><float name=\"shutter_close\" value=\"" +
         std::to_string(close) + "\"/>";
}

/// Pixels that are the mean of stills.
struct MeanOfStills {
  std::vector<Color> color;
  std::vector<double> variance;  ///< Of the first channel's mean.
};

/// Of one still at a random time of each of `count` equal parts of [0, 1].
template <class Still>
MeanOfStills meanOfStills(const Still& still, int count, std::uint32_t samples) {
  MeanOfStills mean;
  Uniforms uniforms(seedOfTest(9));
  for (int i = 0; i < count; ++i) {
    const TestScene scene = still((i + static_cast<double>(uniforms.next())) / count);
    const auto film = scene.render(samples);
    const render::PixelRect area = film->area();
    mean.color.resize(area.pixelCount());
    mean.variance.resize(area.pixelCount());
    std::size_t at = 0;
    for (int y = area.y0; y < area.y1; ++y) {
      for (int x = area.x0; x < area.x1; ++x, ++at) {
        const render::PixelEstimate pixel = film->estimate(x, y);
        mean.color[at] += pixel.color / static_cast<float>(count);
        mean.variance[at] += std::pow(static_cast<double>(pixel.standardError[0]) / count, 2);
      }
    }
  }
  return mean;
}

/// Whether the blurred film is the mean of the stills: by the film's mean, and by the scores of its pixels.
inline ::testing::AssertionResult showsTheMean(const render::Film& film, const MeanOfStills& mean) {
  double found = 0, expected = 0, error = 0, squares = 0;
  std::size_t at = 0, counted = 0;
  const render::PixelRect area = film.area();
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x, ++at) {
      const render::PixelEstimate pixel = film.estimate(x, y);
      const double own = std::pow(static_cast<double>(pixel.standardError[0]), 2) + mean.variance[at];
      const double difference = static_cast<double>(pixel.color[0] - mean.color[at][0]);
      found += static_cast<double>(pixel.color[0]);
      expected += static_cast<double>(mean.color[at][0]);
      error += own;
      if (own < 1e-12) continue;
      squares += difference * difference / own;
      ++counted;
    }
  }
  const double z = (found - expected) / std::sqrt(error), n = static_cast<double>(counted);
  const auto told = [&](::testing::AssertionResult result) {
    return result << "mean " << found << " of " << expected << ", z " << z << ", chi-squared " << squares << " of "
                  << n;
  };
  if (std::sqrt(error) > meanResolution * expected) return told(::testing::AssertionFailure() << "resolves nothing: ");
  // The time within each part is one more, small, source of noise, which is the same for all pixels of a still.
  if (std::fabs(z) > maximumZ || squares > n + 6 * std::sqrt(2 * n)) return told(::testing::AssertionFailure());
  return told(::testing::AssertionSuccess());
}

}  // namespace aerosol::test
