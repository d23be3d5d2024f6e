#include "core/render/film.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <string>
#include <tuple>

#include "core/render/pixel_error.h"

namespace aerosol::render {

void FilmTile::reset(const PixelRect& area, std::uint32_t firstSample, std::uint32_t endSample,
                     std::uint32_t aovWidth) {
  assert(endSample >= firstSample && endSample - firstSample <= maximumSamples);
  area_ = area;
  firstSample_ = firstSample;
  endSample_ = endSample;
  missing_ = area.pixelCount() * (endSample - firstSample);
  samples_.resize(missing_);
  present_.assign(area.pixelCount(), 0);
  aovWidth_ = aovWidth;
  aovs_.resize(missing_ * aovWidth);
}

void FilmTile::add(int x, int y, std::uint32_t sample, Color color, float alpha, std::span<const float> aovs) {
  assert(area_.contains(x, y) && sample >= firstSample_ && sample < endSample_);
  const std::size_t pixel = area_.indexOf(x, y);
  const std::uint32_t offset = sample - firstSample_;
  assert((present_[pixel] >> offset & 1u) == 0);
  present_[pixel] |= std::uint64_t{1} << offset;
  const std::size_t at = pixel * (endSample_ - firstSample_) + offset;
  samples_[at] = {color, alpha};
  assert(aovs.size() == aovWidth_);
  std::copy(aovs.begin(), aovs.end(), aovs_.begin() + static_cast<std::ptrdiff_t>(at * aovWidth_));
  --missing_;
}

Film::Film(const PixelRect& area, AovLayout layout)
    : area_(area), pixels_(area.pixelCount()), layout_(std::move(layout)) {
  if (!layout_.isEmpty()) aovs_.resize(area.pixelCount());
}

namespace {

/// How many values were not finite and are 0 now.
std::uint64_t replaceNonFinite(std::vector<float>& values) {
  std::uint64_t count = 0;
  for (float& value : values) {
    if (std::isfinite(value)) continue;
    value = 0;
    ++count;
  }
  return count;
}

/// The ids of a sample's things, out of its values.
void takeMattes(const AovLayout& layout, AovSample& sample) {
  sample.mattes.clear();
  for (const AovMatte& matte : layout.mattes) {
    const float weight = sample.values[matte.weightSlot];
    const auto id = std::bit_cast<std::uint32_t>(sample.values[matte.slot]);
    sample.mattes.push_back({id, std::isfinite(weight) ? static_cast<double>(weight) : 0.0});
    sample.values[matte.slot] = 0;
  }
}

}  // namespace

void Film::commit(const FilmTile& tile) {
  assert(area_.contains(tile.area_) && tile.aovWidth_ == layout_.width);
  std::vector<DroppedSample> dropped;
  std::uint64_t replaced = 0;
  AovSample aovs;
  const std::uint32_t count = tile.endSample_ - tile.firstSample_;
  for (int y = tile.area_.y0; y < tile.area_.y1; ++y) {
    for (int x = tile.area_.x0; x < tile.area_.x1; ++x) {
      const std::size_t local = tile.area_.indexOf(x, y);
      PixelSum& pixel = pixels_[area_.indexOf(x, y)];
      for (std::uint32_t i = 0; i < count; ++i) {
        if ((tile.present_[local] >> i & 1u) == 0) continue;
        const PixelSample& sample = tile.samples_[local * count + i];
        [[maybe_unused]] const bool isNew = pixel.add(tile.firstSample_ + i, sample);
        assert(isNew);
        if (!sample.isFinite()) dropped.push_back({x, y, tile.firstSample_ + i, sample});
        if (aovs_.empty()) continue;
        const float* const values = tile.aovs_.data() + (local * count + i) * tile.aovWidth_;
        aovs.values.assign(values, values + tile.aovWidth_);
        aovs.isCounted = sample.isFinite();
        takeMattes(layout_, aovs);
        if (aovs.isCounted) replaced += replaceNonFinite(aovs.values);
        aovs_[area_.indexOf(x, y)].add(tile.firstSample_ + i, aovs);
      }
    }
  }
  if (!dropped.empty()) recordDropped(std::move(dropped));
  if (replaced == 0) return;
  const std::scoped_lock lock(droppedMutex_);
  replacedAovs_ += replaced;
}

void Film::recordDropped(std::vector<DroppedSample> dropped) {
  const std::scoped_lock lock(droppedMutex_);
  dropped_.insert(dropped_.end(), dropped.begin(), dropped.end());
  std::sort(dropped_.begin(), dropped_.end(), [](const DroppedSample& a, const DroppedSample& b) {
    return std::tie(a.y, a.x, a.sample) < std::tie(b.y, b.x, b.sample);
  });
  if (dropped_.size() > droppedPlaces) dropped_.resize(droppedPlaces);
}

Diagnostics Film::merge(const Film& other) {
  Diagnostics errors;
  if (!area_.contains(other.area_)) {
    errors.error({}, "the films to be merged show different pixels");
    return errors;
  }
  if (layout_ != other.layout_) {
    errors.error({}, "the films to be merged have different AOVs");
    return errors;
  }
  const auto reportCommon = [&](int x, int y) {
    errors.error({}, "the films to be merged have samples in common, such as in pixel (" + std::to_string(x) + ", " +
                         std::to_string(y) + ")");
  };
  for (int y = other.area_.y0; y < other.area_.y1; ++y) {
    for (int x = other.area_.x0; x < other.area_.x1; ++x) {
      if (pixel(x, y).overlaps(other.pixel(x, y))) {
        reportCommon(x, y);
        return errors;
      }
    }
  }
  for (int y = other.area_.y0; y < other.area_.y1; ++y) {
    for (int x = other.area_.x0; x < other.area_.x1; ++x) {
      pixels_[area_.indexOf(x, y)].merge(other.pixel(x, y));
      if (!aovs_.empty()) aovs_[area_.indexOf(x, y)].merge(other.aovs(x, y));
    }
  }
  isScrambled_ = isScrambled_ || other.isScrambled_;
  recordDropped(other.dropped_);
  return errors;
}

PixelEstimate Film::estimate(int x, int y) const {
  const PixelSum& sum = pixel(x, y);
  PixelEstimate estimate;
  estimate.count = sum.count();
  if (sum.count() == 0) return estimate;
  const SampleSums total = sum.total();
  const double n = sum.count();
  estimate.alpha = static_cast<float>(total.alpha / n);
  const std::array<double, 3> squares = squaredErrors(sum, total, isScrambled_, scrambleCount);
  for (int c = 0; c < 3; ++c) {
    const auto i = static_cast<std::size_t>(c);
    estimate.color[c] = static_cast<float>(total.color[i] / n);
    estimate.standardError[c] = static_cast<float>(std::sqrt(squares[i]));
  }
  return estimate;
}

std::vector<float> Film::rgba() const {
  std::vector<float> image;
  image.reserve(4 * pixels_.size());
  for (int y = area_.y0; y < area_.y1; ++y) {
    for (int x = area_.x0; x < area_.x1; ++x) {
      const PixelEstimate e = estimate(x, y);
      image.insert(image.end(), {e.color.r, e.color.g, e.color.b, e.alpha});
    }
  }
  return image;
}

std::uint64_t Film::sampleCount() const {
  std::uint64_t count = 0;
  for (const PixelSum& pixel : pixels_) count += pixel.count();
  return count;
}

std::uint64_t Film::droppedCount() const {
  std::uint64_t count = 0;
  for (const PixelSum& pixel : pixels_) count += pixel.dropped();
  return count;
}

std::size_t Film::bytes() const {
  std::size_t bytes = sizeof(Film);
  for (const PixelSum& pixel : pixels_) bytes += pixel.bytes();
  for (const AovSum& pixel : aovs_) bytes += pixel.bytes() + layout_.width * sizeof(double);
  return bytes;
}

}  // namespace aerosol::render
