#include "core/shading/range_functions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/shading/texture_call.h"
#include "core/shading/voxel_functions.h"

namespace aerosol::shading {

namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
/// Filters sum weights that are 1 together, up to rounding.
constexpr float filterRounding = 1e-5f;

struct Ends {
  float low = unknown, high = unknown;
};

/// Whether both ends of the box ask for the same thing at different places.
bool asksAlike(const TexturePoint& a, const TexturePoint& b) {
  return a.interpolation == b.interpolation && a.firstChannel == b.firstChannel && a.subimage == b.subimage &&
         a.subimageName == b.subimageName && a.colorSpace == b.colorSpace && a.fill == b.fill &&
         std::ranges::equal(a.wrap, b.wrap);
}

/// Of one channel of an image: with the black around it, and what stands for channels that it does not have.
Ends boundImage(const TextureRange& range, const TexturePoint& point, std::int64_t channel) {
  if (range.hasNan || range.least.empty()) return {};
  Ends ends{0, 0};
  const auto join = [&](float low, float high) {
    ends.low = std::min(ends.low, low);
    ends.high = std::max(ends.high, high);
  };
  const auto count = static_cast<std::int64_t>(range.least.size());
  if (channel >= 0 && channel < count) {
    join(range.least[static_cast<std::size_t>(channel)], range.greatest[static_cast<std::size_t>(channel)]);
  } else {
    join(std::ranges::min(range.least), std::ranges::max(range.greatest));
    join(std::min(point.fill, 0.0f), std::max(point.fill, 1.0f));
  }
  return {ends.low - filterRounding * std::fabs(ends.low), ends.high + filterRounding * std::fabs(ends.high)};
}

Ends boundVoxels(const VoxelGrid& grid, const TexturePoint& low, const TexturePoint& high, std::int64_t channel) {
  if (channel < 0 || channel >= grid.info().channels) return {low.fill, low.fill};
  std::array<double, 3> lower{}, upper{};
  for (std::size_t i = 0; i < 3; ++i) {
    lower[i] = static_cast<double>(low.at[i]);
    upper[i] = static_cast<double>(high.at[i]);
  }
  const VoxelRange range = grid.range(voxelInterpolation(low.interpolation), lower, upper, static_cast<int>(channel));
  return range.hasNan ? Ends{} : Ends{range.least, range.greatest};
}

/// One lane's lookup.
class Lookup {
 public:
  Lookup(PointCall& call, unsigned lane, std::string_view colorSpace)
      : services_(call.host().services()), file_(call.text(0, lane)) {
    std::string problem;
    isVoxels_ = call.site().function == "texture3d" && services_.isVoxelFile(file_);
    if (isVoxels_) {
      voxels_ = services_.voxels(file_, problem);
    } else if (TextureSession* session = services_.textures(problem)) {
      image_ = session->range(file_, colorSpace);
    }
  }

  Ends bound(const TexturePoint& low, const TexturePoint& high, int c) const {
    const std::int64_t channel = std::int64_t{low.firstChannel} + c;
    if (image_) return boundImage(*image_, low, channel);
    std::string problem;
    const VoxelGrid* grid = voxels_ ? chooseVoxelGrid(*voxels_, file_, low, problem) : nullptr;
    return grid ? boundVoxels(*grid, low, high, channel) : Ends{};
  }

 private:
  ServicesOfThread& services_;
  std::string_view file_;
  bool isVoxels_ = false;
  const VoxelFile* voxels_ = nullptr;
  std::optional<TextureRange> image_;
};

}  // namespace

void boundLookup(PointCall& low, PointCall& high) {
  const lang::TextureFunction& function = *lang::findTextureFunction(low.site().function);
  TextureCall lows(low, function), highs(high, function);
  low.forEachLane([&](unsigned lane) {
    const TexturePoint from = lows.read(lane), to = highs.read(lane);
    const bool isAlike = asksAlike(from, to) && low.hash(0, lane) == high.hash(0, lane);
    const Lookup lookup(low, lane, from.colorSpace);
    std::array<float, maximumTextureChannels> least{}, greatest{};
    for (int c = 0; c < lows.channels(); ++c) {
      const Ends ends = isAlike ? lookup.bound(from, to, c) : Ends{};
      least[static_cast<std::size_t>(c)] = ends.low;
      greatest[static_cast<std::size_t>(c)] = ends.high;
    }
    lows.write(lane, least.data());
    highs.write(lane, greatest.data());
  });
}

}  // namespace aerosol::shading
