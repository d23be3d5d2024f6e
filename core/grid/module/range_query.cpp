#include "core/grid/module/range_query.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aerosol::grid {

namespace {

/// Voxels from `least` to `greatest`, both included.
struct VoxelBox {
  std::int32_t least[3], greatest[3];
};

/// The voxels that lookups between two places of an axis read.
void readAround(double least, double greatest, VoxelInterpolation interpolation, int axis, VoxelBox& box) {
  const double offset = interpolation == VoxelInterpolation::nearest ? 0.5 : 0.0;
  constexpr double far = 1073741824.0;
  const auto voxel = [&](double p) {
    return static_cast<std::int32_t>(std::floor(std::clamp(std::isnan(p) ? far : p, -far, far)));
  };
  const int before = interpolation == VoxelInterpolation::tricubic ? 1 : 0;
  const int behind = interpolation == VoxelInterpolation::nearest ? 0 : before + 1;
  box.least[axis] = voxel(least + offset) - before;
  box.greatest[axis] = voxel(greatest + offset) + behind;
}

/// The voxels that lookups in the box of the file's space read.
VoxelBox voxelsOf(const double* fileToIndex, VoxelInterpolation interpolation, const std::array<double, 3>& lower,
                  const std::array<double, 3>& upper) {
  VoxelBox box;
  for (int r = 0; r < 3; ++r) {
    const double* m = fileToIndex + 4 * r;
    double least = m[3], greatest = m[3], size = std::abs(m[3]);
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = m[c] * lower[c], b = m[c] * upper[c];
      least += std::min(a, b);
      greatest += std::max(a, b);
      size += std::max(std::abs(a), std::abs(b));
    }
    const double slack = 1e-14 * size;  // the sum's own rounding
    readAround(least - slack, greatest + slack, interpolation, r, box);
  }
  return box;
}

class Query {
 public:
  Query(const Directory& directory, const VoxelBox& box, int channel)
      : d_(directory), box_(box), channel_(static_cast<std::size_t>(channel)) {}

  ValueRange run() {
    std::int32_t first[3], last[3];
    for (int r = 0; r < 3; ++r) {
      const auto blockOf = [&](std::int32_t voxel) {
        return std::clamp((voxel >> blockBits) - (d_.origin[r] >> blockBits), 0, d_.size[r] - 1);
      };
      first[r] = blockOf(box_.least[r]);
      last[r] = blockOf(box_.greatest[r]);
    }
    const double blocks = double(last[0] - first[0] + 1) * (last[1] - first[1] + 1) * (last[2] - first[2] + 1);
    if (blocks > 32768) return d_.total[channel_];
    for (std::int32_t z = first[2]; z <= last[2]; ++z)
      for (std::int32_t y = first[1]; y <= last[1]; ++y)
        for (std::int32_t x = first[0]; x <= last[0]; ++x) addBlock(x, y, z);
    return range_;
  }

 private:
  void addConstant(std::int32_t entry) { range_.add(d_.constant(entry)[channel_]); }

  void addBlock(std::int32_t x, std::int32_t y, std::int32_t z) {
    const std::int32_t table = d_.blocks[static_cast<std::size_t>(x + d_.size[0] * (y + d_.size[1] * z))];
    const std::int32_t at[3] = {x, y, z};
    std::int32_t least[3], greatest[3];  // within the block
    bool isWhole = true;
    for (int r = 0; r < 3; ++r) {
      const std::int32_t begin = d_.origin[r] + (at[r] << blockBits);
      // The outermost layer stands for all that is outside.
      least[r] = std::clamp(box_.least[r] - begin, 0, 127);
      greatest[r] = std::clamp(box_.greatest[r] - begin, 0, 127);
      isWhole = isWhole && least[r] == 0 && greatest[r] == 127;
    }
    if (isWhole || table == 0) return range_.add(d_.tableRanges[static_cast<std::size_t>(table)][channel_]);
    const std::int32_t* entries = d_.entries.data() + std::ptrdiff_t{table} * tableSize;
    for (int i = least[0] >> 3; i <= greatest[0] >> 3; ++i)
      for (int j = least[1] >> 3; j <= greatest[1] >> 3; ++j)
        for (int k = least[2] >> 3; k <= greatest[2] >> 3; ++k)
          addEntry(entries[i << 8 | j << 4 | k], {i << 3, j << 3, k << 3}, least, greatest);
  }

  void addEntry(std::int32_t entry, const std::array<std::int32_t, 3>& begin, const std::int32_t* least,
                const std::int32_t* greatest) {
    if (entry < 0) return addConstant(entry);
    std::int32_t from[3], to[3];
    bool isWhole = true;
    for (std::size_t r = 0; r < 3; ++r) {
      from[r] = std::clamp(least[r] - begin[r], 0, 7);
      to[r] = std::clamp(greatest[r] - begin[r], 0, 7);
      isWhole = isWhole && from[r] == 0 && to[r] == 7;
    }
    if (isWhole) return range_.add(d_.leafRanges[static_cast<std::size_t>(entry / d_.leafStride)][channel_]);
    for (int x = from[0]; x <= to[0]; ++x)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int z = from[2]; z <= to[2]; ++z)
          range_.add(d_.values[entry + (x << 6 | y << 3 | z) * d_.channels + static_cast<int>(channel_)]);
  }

  const Directory& d_;
  const VoxelBox& box_;
  std::size_t channel_;
  ValueRange range_;
};

}  // namespace

/// a + (b - a) t and sums of products of weights stay within the values but for rounding, which no value of 0 knows and
/// which does not cross 0 from where all values are on one side. With values near the largest float (or infinite) a
/// difference overflows, and infinity times 0 is no number.
VoxelRange widened(const ValueRange& range, VoxelInterpolation interpolation) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  if (range.least > range.greatest) return {-infinity, infinity, true};  // nothing but NaN
  VoxelRange result{range.least, range.greatest, range.hasNan};
  if (interpolation == VoxelInterpolation::nearest) return result;
  const float magnitude = std::max(std::abs(range.least), std::abs(range.greatest));
  if (!(magnitude < 0.25f * std::numeric_limits<float>::max())) return {-infinity, infinity, true};
  if (interpolation == VoxelInterpolation::trilinear && range.least == range.greatest) return result;
  const float slack = (interpolation == VoxelInterpolation::trilinear ? 1e-6f : 1e-5f) * magnitude;
  result.least = range.least >= 0 ? std::max(range.least - slack, 0.0f) : range.least - slack;
  result.greatest = range.greatest <= 0 ? std::min(range.greatest + slack, 0.0f) : range.greatest + slack;
  return result;
}

VoxelRange findRange(const Directory& directory, const double* fileToIndex, VoxelInterpolation interpolation,
                     const std::array<double, 3>& lower, const std::array<double, 3>& upper, int channel) {
  const VoxelBox box = voxelsOf(fileToIndex, interpolation, lower, upper);
  ValueRange values = Query(directory, box, channel).run();
  // A point that is no number, or infinite, reads background.
  for (std::size_t r = 0; r < 3; ++r) {
    if (!std::isfinite(lower[r]) || !std::isfinite(upper[r]))
      values = directory.total[static_cast<std::size_t>(channel)];
  }
  return widened(values, interpolation);
}

VoxelRange findRange(const Directory& directory, const VoxelMap& map, VoxelInterpolation interpolation,
                     const std::array<double, 3>& lower, const std::array<double, 3>& upper, int channel) {
  std::array<double, 3> least, greatest;
  // Boxes that reach behind the eye, or are no boxes, may read anything.
  if (!map.indexBox(lower, upper, least, greatest))
    return widened(directory.total[static_cast<std::size_t>(channel)], interpolation);
  VoxelBox box;
  for (int r = 0; r < 3; ++r)
    readAround(least[static_cast<std::size_t>(r)], greatest[static_cast<std::size_t>(r)], interpolation, r, box);
  ValueRange values = Query(directory, box, channel).run();
  for (std::size_t r = 0; r < 3; ++r) {
    if (!std::isfinite(least[r]) || !std::isfinite(greatest[r]))
      values = directory.total[static_cast<std::size_t>(channel)];
  }
  return widened(values, interpolation);
}

}  // namespace aerosol::grid
