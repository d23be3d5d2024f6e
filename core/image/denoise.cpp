#include "core/image/denoise.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>

namespace aerosol::image {

namespace {

constexpr int tileSize = 32;

/// Pixels x0 ≤ x < x1, y0 ≤ y < y1.
struct Area {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  std::size_t count() const { return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()); }
};

/// Calls work(area) for all tiles of a picture, on several threads.
void forTiles(int width, int height, int threads, const std::function<void(const Area&)>& work) {
  const int across = (width + tileSize - 1) / tileSize, down = (height + tileSize - 1) / tileSize;
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int i = next++; i < across * down; i = next++) {
      const int x = i % across * tileSize, y = i / across * tileSize;
      work({x, y, std::min(x + tileSize, width), std::min(y + tileSize, height)});
    }
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < threads; ++i) helpers.emplace_back(run);
  run();
}

/// The weights with which a pixel's neighbours at one offset are like it.
///
/// Non-local means for known noise: Rousselle, Knaus and Zwicker 2012, "Adaptive Rendering with Non-Local Means
/// Filtering". Two pixels p, q differ by ((u_p - u_q)² - (v_p + min(v_p, v_q))) / (ε + k² (v_p + v_q)), where v is the
/// variance of u: what noise alone explains is taken off, and the rest counted in its units. The mean over channels and
/// over a patch, d², gives the weight exp(-max(0, d²)).
class Likeness {
 public:
  Likeness(int width, int height, const Raster& values, const Raster& variance, float varianceScale, int patchRadius,
           float strength)
      : width_(width),
        height_(height),
        values_(values),
        variance_(variance),
        varianceScale_(varianceScale),
        patchRadius_(patchRadius),
        strength_(strength * strength) {}

  /// Of the pixels of an area, row by row, to those dx to the right and dy below; 0 outside of the picture.
  void weigh(const Area& area, int dx, int dy, std::vector<float>& weights) {
    const Area wide = widened(area);
    rows_.resize(area.count() / static_cast<std::size_t>(area.height()) * static_cast<std::size_t>(wide.height()));
    row_.resize(static_cast<std::size_t>(wide.width()));
    weights.assign(area.count(), 0.0f);
    // The mean over a patch, one direction after the other.
    for (int y = wide.y0; y < wide.y1; ++y) {
      for (int x = wide.x0; x < wide.x1; ++x) row_[static_cast<std::size_t>(x - wide.x0)] = difference(x, y, dx, dy);
      for (int x = area.x0; x < area.x1; ++x) {
        float sum = 0;
        int count = 0;
        for (int at = std::max(x - patchRadius_, wide.x0); at <= std::min(x + patchRadius_, wide.x1 - 1); ++at) {
          sum += row_[static_cast<std::size_t>(at - wide.x0)];
          ++count;
        }
        rows_[indexIn(area, x, y - wide.y0)] = sum / static_cast<float>(count);
      }
    }
    for (int y = area.y0; y < area.y1; ++y) {
      for (int x = area.x0; x < area.x1; ++x) {
        if (!isInside(x + dx, y + dy)) continue;
        float sum = 0;
        int count = 0;
        for (int at = std::max(y - patchRadius_, wide.y0); at <= std::min(y + patchRadius_, wide.y1 - 1); ++at) {
          sum += rows_[indexIn(area, x, at - wide.y0)];
          ++count;
        }
        const std::size_t i = indexIn(area, x, y - area.y0);
        weights[i] = std::exp(-std::max(0.0f, sum / static_cast<float>(count)));
      }
    }
  }

 private:
  static std::size_t indexIn(const Area& area, int x, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(area.width()) +
           static_cast<std::size_t>(x - area.x0);
  }
  Area widened(const Area& area) const {
    return {std::max(area.x0 - patchRadius_, 0), std::max(area.y0 - patchRadius_, 0),
            std::min(area.x1 + patchRadius_, width_), std::min(area.y1 + patchRadius_, height_)};
  }
  bool isInside(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

  /// Behind the edge the picture goes on as its outermost pixel.
  float difference(int x, int y, int dx, int dy) const {
    const int qx = std::clamp(x + dx, 0, width_ - 1), qy = std::clamp(y + dy, 0, height_ - 1);
    const auto channels = static_cast<std::size_t>(values_.channels);
    const std::size_t p = static_cast<std::size_t>(y * width_ + x) * channels;
    const std::size_t q = static_cast<std::size_t>(qy * width_ + qx) * channels;
    float sum = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      const float step = values_.values[p + c] - values_.values[q + c];
      const float vp = varianceScale_ * variance_.values[p + c], vq = varianceScale_ * variance_.values[q + c];
      sum += (step * step - (vp + std::min(vp, vq))) / (1e-10f + strength_ * (vp + vq));
    }
    return sum / static_cast<float>(channels);
  }

  int width_, height_;
  const Raster& values_;
  const Raster& variance_;
  float varianceScale_;
  int patchRadius_;
  float strength_;
  std::vector<float> row_, rows_;
};

/// A feature without its own noise, by non-local means; `variance` is that of its means.
Raster smoothed(const DenoiseFeature& feature, int width, int height, int threads) {
  constexpr int radius = 5;
  if (feature.variance.values.empty()) return feature.mean;
  Raster result = feature.mean;
  const auto channels = static_cast<std::size_t>(feature.mean.channels);
  forTiles(width, height, threads, [&](const Area& area) {
    Likeness likeness(width, height, feature.mean, feature.variance, 1, 3, 1);
    std::vector<float> weights;
    std::vector<double> sums(area.count() * channels), totals(area.count());
    for (int dy = -radius; dy <= radius; ++dy) {
      for (int dx = -radius; dx <= radius; ++dx) {
        likeness.weigh(area, dx, dy, weights);
        for (std::size_t i = 0; i < weights.size(); ++i) {
          if (weights[i] == 0) continue;
          const int x = area.x0 + static_cast<int>(i) % area.width() + dx;
          const int y = area.y0 + static_cast<int>(i) / area.width() + dy;
          const std::size_t q = static_cast<std::size_t>(y * width + x) * channels;
          for (std::size_t c = 0; c < channels; ++c)
            sums[i * channels + c] += static_cast<double>(weights[i] * feature.mean.values[q + c]);
          totals[i] += static_cast<double>(weights[i]);
        }
      }
    }
    for (std::size_t i = 0; i < area.count(); ++i) {
      const int x = area.x0 + static_cast<int>(i) % area.width(), y = area.y0 + static_cast<int>(i) / area.width();
      const std::size_t p = static_cast<std::size_t>(y * width + x) * channels;
      for (std::size_t c = 0; c < channels; ++c)
        result.values[p + c] = static_cast<float>(sums[i * channels + c] / totals[i]);
    }
  });
  return result;
}

constexpr std::size_t mostTerms = 12;

/// Weighted least squares with a little ridge: the value at the pixel itself of the plane through its neighbours.
class LocalPlane {
 public:
  void add(double weight, const std::array<double, mostTerms>& terms, std::size_t count, const float* color) {
    for (std::size_t i = 0; i < count; ++i) {
      const double scaled = weight * terms[i];
      for (std::size_t j = 0; j <= i; ++j) gram_[i * mostTerms + j] += scaled * terms[j];
      for (std::size_t c = 0; c < 3; ++c) right_[i * 3 + c] += scaled * static_cast<double>(color[c]);
    }
  }
  /// By Cholesky's method. Features without a spread add nothing.
  std::array<double, 3> atPixel(std::size_t count) {
    double trace = 0;
    for (std::size_t i = 1; i < count; ++i) trace += gram_[i * mostTerms + i];
    for (std::size_t i = 1; i < count; ++i)
      gram_[i * mostTerms + i] += 1e-3 * (trace / static_cast<double>(count)) + 1e-9;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = gram_[i * mostTerms + j];
        for (std::size_t k = 0; k < j; ++k) sum -= gram_[i * mostTerms + k] * gram_[j * mostTerms + k];
        gram_[i * mostTerms + j] = i == j ? std::sqrt(std::max(sum, 1e-12)) : sum / gram_[j * mostTerms + j];
      }
    }
    std::array<double, 3> constant{};
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<double, mostTerms> y{};
      for (std::size_t i = 0; i < count; ++i) {
        double sum = right_[i * 3 + c];
        for (std::size_t k = 0; k < i; ++k) sum -= gram_[i * mostTerms + k] * y[k];
        y[i] = sum / gram_[i * mostTerms + i];
      }
      for (std::size_t i = count; i-- > 0;) {
        for (std::size_t k = i + 1; k < count; ++k) y[i] -= gram_[k * mostTerms + i] * y[k];
        y[i] /= gram_[i * mostTerms + i];
      }
      constant[c] = y[0];
    }
    return constant;
  }

 private:
  std::array<double, mostTerms * mostTerms> gram_{};
  std::array<double, 3 * mostTerms> right_{};
};

/// All features, each channel scaled to about one over the picture, that terms of regressions are made of.
Raster joinedFeatures(const DenoiseInput& input, int threads) {
  const std::size_t pixels = static_cast<std::size_t>(input.width) * static_cast<std::size_t>(input.height);
  Raster joined;
  std::vector<Raster> parts;
  for (const DenoiseFeature& feature : input.features) {
    if (static_cast<std::size_t>(joined.channels + feature.mean.channels) >= mostTerms) break;
    parts.push_back(smoothed(feature, input.width, input.height, threads));
    joined.channels += feature.mean.channels;
  }
  joined.values.resize(pixels * static_cast<std::size_t>(joined.channels));
  std::size_t first = 0;
  for (const Raster& part : parts) {
    const auto channels = static_cast<std::size_t>(part.channels);
    float largest = 0;
    for (const float value : part.values) largest = std::max(largest, std::fabs(value));
    for (std::size_t i = 0; i < pixels; ++i) {
      for (std::size_t c = 0; c < channels; ++c) {
        joined.values[i * static_cast<std::size_t>(joined.channels) + first + c] =
            largest > 0 ? part.values[i * channels + c] / largest : 0.0f;
      }
    }
    first += channels;
  }
  return joined;
}

/// One half filtered with weights that come from the other: so their noise cannot choose what it is averaged with.
void regress(const DenoiseInput& input, const DenoiseOptions& options, const Raster& features, const Raster& filtered,
             const Raster& guide, const Area& area, std::vector<double>& sum) {
  const auto terms = static_cast<std::size_t>(features.channels) + 1;
  // Half of the samples: twice the variance of their mean.
  Likeness likeness(input.width, input.height, guide, input.variance, 2, options.patchRadius, options.strength);
  std::vector<LocalPlane> planes(area.count());
  std::vector<float> weights;
  for (int dy = -options.windowRadius; dy <= options.windowRadius; ++dy) {
    for (int dx = -options.windowRadius; dx <= options.windowRadius; ++dx) {
      likeness.weigh(area, dx, dy, weights);
      for (std::size_t i = 0; i < weights.size(); ++i) {
        if (weights[i] < 1e-6f) continue;
        const int x = area.x0 + static_cast<int>(i) % area.width(), y = area.y0 + static_cast<int>(i) / area.width();
        const auto p = static_cast<std::size_t>(y * input.width + x);
        const auto q = static_cast<std::size_t>((y + dy) * input.width + x + dx);
        std::array<double, mostTerms> step{1};
        for (std::size_t t = 1; t < terms; ++t) {
          const std::size_t channels = terms - 1;
          step[t] = static_cast<double>(features.values[q * channels + t - 1] - features.values[p * channels + t - 1]);
        }
        planes[i].add(static_cast<double>(weights[i]), step, terms, filtered.values.data() + 3 * q);
      }
    }
  }
  for (std::size_t i = 0; i < area.count(); ++i) {
    const std::array<double, 3> value = planes[i].atPixel(terms);
    for (std::size_t c = 0; c < 3; ++c) sum[3 * i + c] += 0.5 * value[c];
  }
}

}  // namespace

// Bitterli, Rousselle, Moon, Iglesias-Guitián, Adler, Mitchell, Jarosz and Novák 2016, "Nonlinearly Weighted
// First-order Regression for Denoising Monte Carlo Renderings": around each pixel the colour is a plane over features
// that hardly have noise, fitted with weights by non-local means of the colour; the two halves guide each other. Here
// in one pass, with one strength.
Raster denoise(const DenoiseInput& input, const DenoiseOptions& options) {
  const Raster features = joinedFeatures(input, options.threads);
  Raster result{3,
                std::vector<float>(3 * static_cast<std::size_t>(input.width) * static_cast<std::size_t>(input.height))};
  forTiles(input.width, input.height, options.threads, [&](const Area& area) {
    std::vector<double> sum(3 * area.count());
    regress(input, options, features, input.halfA, input.halfB, area, sum);
    regress(input, options, features, input.halfB, input.halfA, area, sum);
    for (std::size_t i = 0; i < area.count(); ++i) {
      const int x = area.x0 + static_cast<int>(i) % area.width(), y = area.y0 + static_cast<int>(i) / area.width();
      for (std::size_t c = 0; c < 3; ++c) {
        // Light is not negative where none of the samples was.
        const std::size_t at = 3 * static_cast<std::size_t>(y * input.width + x) + c;
        const bool isSigned = input.halfA.values[at] < 0 || input.halfB.values[at] < 0;
        result.values[at] = static_cast<float>(isSigned ? sum[3 * i + c] : std::max(0.0, sum[3 * i + c]));
      }
    }
  });
  return result;
}

}  // namespace aerosol::image
