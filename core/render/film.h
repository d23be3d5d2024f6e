// The image while it is rendered: per pixel the sums of its samples, in double, whatever the order of work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/render/aov/aov_layout.h"
#include "core/render/aov/aov_sum.h"
#include "core/render/pixel_sum.h"

namespace aerosol::render {

/// Pixels x0 ≤ x < x1, y0 ≤ y < y1 of the whole film, whose upper left pixel is (0, 0).
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  std::size_t pixelCount() const { return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()); }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  bool contains(const PixelRect& o) const { return o.x0 >= x0 && o.y0 >= y0 && o.x1 <= x1 && o.y1 <= y1; }
  /// Row by row, from the upper left.
  std::size_t indexOf(int x, int y) const {
    return static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x - x0);
  }
  friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

/// The samples of one pass over one tile, as they come in. One worker's; reused from pass to pass.
class FilmTile {
 public:
  static constexpr std::uint32_t maximumSamples = 64;

  FilmTile() = default;
  /// Samples firstSample ≤ i < endSample of each pixel of `area`, at most `maximumSamples`.
  FilmTile(const PixelRect& area, std::uint32_t firstSample, std::uint32_t endSample, std::uint32_t aovWidth = 0) {
    reset(area, firstSample, endSample, aovWidth);
  }
  void reset(const PixelRect& area, std::uint32_t firstSample, std::uint32_t endSample, std::uint32_t aovWidth = 0);

  /// In any order, each sample once, with as many values as AOVs have. Pixel coordinates are those of the whole film.
  void add(int x, int y, std::uint32_t sample, Color color, float alpha, std::span<const float> aovs = {});

  const PixelRect& area() const { return area_; }
  std::uint32_t firstSample() const { return firstSample_; }
  std::uint32_t endSample() const { return endSample_; }
  /// Samples still to come.
  std::size_t missing() const { return missing_; }
  bool isComplete() const { return missing_ == 0; }

 private:
  friend class Film;

  PixelRect area_;
  std::uint32_t firstSample_ = 0, endSample_ = 0;
  std::size_t missing_ = 0;
  std::vector<PixelSample> samples_;    ///< By pixel, then by sample.
  std::vector<std::uint64_t> present_;  ///< A bit a sample.
  std::uint32_t aovWidth_ = 0;
  std::vector<float> aovs_;  ///< By pixel, by sample, then by value.
};

/// A sample that was not finite.
struct DroppedSample {
  int x = 0, y = 0;
  std::uint32_t sample = 0;
  PixelSample value;
};

template <class A>
void describe(A& archive, DroppedSample& place) {
  archive(place.x, place.y, place.sample, place.value.color.r, place.value.color.g, place.value.color.b,
          place.value.alpha);
}

/// Mean and standard error of the mean of one pixel (see pixel_error.h); all 0 without samples, the error with fewer
/// than two.
struct PixelEstimate {
  Color color;
  float alpha = 0;
  Color standardError;
  std::uint32_t count = 0;
};

/// Pixels of a rectangle of the whole film. `commit` may run in several threads at once for tiles that do not overlap;
/// everything else needs the film alone.
class Film {
 public:
  static constexpr std::size_t droppedPlaces = 8;  ///< Places of dropped samples that are kept.

  /// With a layout it also gathers what that names.
  explicit Film(const PixelRect& area, AovLayout layout = {});

  const PixelRect& area() const { return area_; }
  const AovLayout& layout() const { return layout_; }
  /// Whether samples are stratified against each other, scramble by scramble (scrambles.h).
  bool isScrambled() const { return isScrambled_; }
  void setScrambled(bool isScrambled) { isScrambled_ = isScrambled; }

  /// Adds what the tile holds, also when samples are missing. No sample may be there already.
  void commit(const FilmTile& tile);

  /// Adds another film of the same scene: other pixels or other samples. Errors, and nothing is changed, when it
  /// reaches beyond this one's area, has samples in common, or gathers something else.
  Diagnostics merge(const Film& other);

  /// Puts back what was read from a file: a pixel without samples becomes `sum`.
  void restore(int x, int y, PixelSum sum) { pixels_[area_.indexOf(x, y)] = std::move(sum); }
  void restore(int x, int y, AovSum sum) { aovs_[area_.indexOf(x, y)] = std::move(sum); }
  /// Places of dropped samples beside those that are known.
  void recordDropped(std::vector<DroppedSample> dropped);

  const PixelSum& pixel(int x, int y) const { return pixels_[area_.indexOf(x, y)]; }
  /// Of a film with a layout.
  const AovSum& aovs(int x, int y) const { return aovs_[area_.indexOf(x, y)]; }
  PixelEstimate estimate(int x, int y) const;
  /// Means as red, green, blue, alpha, row by row.
  std::vector<float> rgba() const;

  std::uint64_t sampleCount() const;   ///< Finite ones, of all pixels.
  std::uint64_t droppedCount() const;  ///< NaN or infinite ones, of all pixels.
  /// Values of AOVs that were NaN or infinite in samples that were not; they count as 0. Of this process alone.
  std::uint64_t replacedAovs() const { return replacedAovs_; }
  /// The first dropped samples by (y, x, sample).
  const std::vector<DroppedSample>& firstDropped() const { return dropped_; }
  /// A copy of them, also while tiles are committed.
  std::vector<DroppedSample> copyFirstDropped() const {
    const std::scoped_lock lock(droppedMutex_);
    return dropped_;
  }
  std::size_t bytes() const;  ///< Memory held.

 private:
  PixelRect area_;
  std::vector<PixelSum> pixels_;
  AovLayout layout_;
  std::vector<AovSum> aovs_;  ///< By pixel; empty without a layout.
  mutable std::mutex droppedMutex_;
  std::vector<DroppedSample> dropped_;
  std::uint64_t replacedAovs_ = 0;
  bool isScrambled_ = false;
};

}  // namespace aerosol::render
