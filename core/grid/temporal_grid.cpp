#include "core/grid/temporal_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/geometry.h"

namespace aerosol::grid {

namespace {

constexpr std::size_t voxels = 512, rowLength = 8;
/// Places for blocks in the table; more than a renderer could fill.
constexpr double mostPlaces = 1 << 28;

std::int64_t voxelsAround(VoxelInterpolation interpolation) {
  return interpolation == VoxelInterpolation::tricubic ? 2 : 1;
}

/// Weights of the uniform cubic B-spline for the voxels at -1, 0, 1 and 2 around a fraction.
std::array<float, 4> splineWeights(float f) {
  const float g = 1 - f, ff = f * f;
  return {g * g * g / 6, (4 - 6 * ff + 3 * ff * f) / 6, (4 - 6 * g * g + 3 * g * g * g) / 6, ff * f / 6};
}

}  // namespace

std::unique_ptr<TemporalGrid> TemporalGrid::make(TemporalCurves curves, std::string& problem) {
  std::unique_ptr<TemporalGrid> grid(new TemporalGrid(std::move(curves)));
  Matrix4 forward, inverse;
  for (std::size_t i = 0; i < 16; ++i) forward[i / 4][i % 4] = grid->curves_.indexToFile[i];
  if (!invert(forward, inverse) || forward[3] != std::array<double, 4>{0, 0, 0, 1}) {
    problem = "the map of grid '" + grid->curves_.name + "' is not affine or has no inverse";
    return nullptr;
  }
  for (std::size_t i = 0; i < 12; ++i) grid->fileToIndex_[i] = inverse[i / 4][i % 4];
  if (!grid->index(problem)) return nullptr;
  grid->describe();
  return grid;
}

bool TemporalGrid::index(std::string& problem) {
  const auto& origins = curves_.origins;
  const std::size_t curves = voxels * static_cast<std::size_t>(curves_.channels);
  double places = origins.empty() ? 0 : 1;
  for (std::size_t i = 0; i < 3 && !origins.empty(); ++i) {
    const auto [least, greatest] = std::ranges::minmax_element(origins, {}, [i](const auto& o) { return o[i]; });
    first_[i] = (*least)[i] / 8;
    size_[i] = (*greatest)[i] / 8 - first_[i] + 1;
    places *= static_cast<double>(size_[i]);
  }
  if (places > mostPlaces) {
    problem = "the blocks of grid '" + curves_.name + "' lie too far apart";
    return false;
  }
  blocks_.assign(static_cast<std::size_t>(places), -1);
  std::uint64_t knot = 0;
  for (std::size_t b = 0; b < origins.size(); ++b) {
    const std::array<std::int64_t, 3> at{origins[b][0] / 8 - first_[0], origins[b][1] / 8 - first_[1],
                                         origins[b][2] / 8 - first_[2]};
    blocks_[static_cast<std::size_t>((at[0] * size_[1] + at[1]) * size_[2] + at[2])] = static_cast<std::int32_t>(b);
    begins_.push_back(knot);
    const std::uint64_t begin = knot;
    for (std::size_t c = 0; c < curves; ++c) {
      if (c % rowLength == 0) rows_.push_back(static_cast<std::uint32_t>(knot - begin));
      if (c % voxels == 0) spans_.push_back({});
      Span& span = spans_.back();
      const std::size_t count = curves_.counts[b * curves + c];
      for (std::size_t k = 0; k < count; ++k, ++knot) {
        const float value = curves_.values[knot];
        span.hasNan = span.hasNan || std::isnan(value);
        span.least = std::min(span.least, value);
        span.greatest = std::max(span.greatest, value);
      }
    }
  }
  for (std::size_t i = 0; i < spans_.size(); ++i) {
    Span& total = total_[i % static_cast<std::size_t>(curves_.channels)];
    total.hasNan = total.hasNan || spans_[i].hasNan;
    total.least = std::min(total.least, spans_[i].least);
    total.greatest = std::max(total.greatest, spans_[i].greatest);
  }
  return true;
}

void TemporalGrid::describe() {
  info_.name = curves_.name;
  info_.type = curves_.channels == 3 ? "curves vec3s" : "curves float";
  info_.purpose = curves_.channels == 3 ? "unknown" : "fog volume";
  info_.channels = curves_.channels;
  info_.indexToFile = curves_.indexToFile;
  const std::size_t curves = voxels * static_cast<std::size_t>(curves_.channels);
  std::array<std::int32_t, 3> least, greatest;
  least.fill(std::numeric_limits<std::int32_t>::max());
  greatest.fill(std::numeric_limits<std::int32_t>::min());
  for (std::size_t b = 0; b < curves_.origins.size(); ++b) {
    for (std::size_t v = 0; v < voxels; ++v) {
      bool isActive = false;
      for (std::size_t c = v; c < curves; c += voxels) isActive = isActive || curves_.counts[b * curves + c] > 0;
      if (!isActive) continue;
      ++info_.activeVoxels;
      const std::array<std::size_t, 3> within{v / 64, v / 8 % 8, v % 8};
      for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t at = curves_.origins[b][i] + static_cast<std::int32_t>(within[i]);
        least[i] = std::min(least[i], at);
        greatest[i] = std::max(greatest[i], at);
      }
    }
  }
  info_.isEmpty = info_.activeVoxels == 0;
  const auto& m = curves_.indexToFile;
  for (std::size_t i = 0; i < 3; ++i) {
    info_.voxelSize[i] = std::sqrt(m[i] * m[i] + m[4 + i] * m[4 + i] + m[8 + i] * m[8 + i]);
    if (info_.isEmpty) continue;
    info_.indexBounds[i] = least[i];
    info_.indexBounds[3 + i] = greatest[i];
    info_.bounds[i] = info_.bounds[3 + i] = m[4 * i + 3];
  }
  for (std::size_t r = 0; r < 3 && !info_.isEmpty; ++r) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = m[4 * r + i] * (least[i] - 0.5), b = m[4 * r + i] * (greatest[i] + 0.5);
      info_.bounds[r] += std::min(a, b);
      info_.bounds[3 + r] += std::max(a, b);
    }
  }
  for (const float value : curves_.values) {
    info_.nanValues += std::isnan(value);
    info_.infiniteValues += std::isinf(value);
  }
  for (std::size_t c = 0; c < static_cast<std::size_t>(curves_.channels); ++c) {
    info_.least[c] = total_[c].least;
    info_.greatest[c] = total_[c].greatest;
  }
  info_.memoryBytes = curves_.counts.size() + curves_.knots.size() + curves_.values.size() * sizeof(float) +
                      rows_.size() * sizeof(std::uint32_t) + begins_.size() * sizeof(std::uint64_t) +
                      blocks_.size() * sizeof(std::int32_t) + spans_.size() * sizeof(Span);
}

std::vector<VoxelBox> TemporalGrid::activeBoxes() const {
  std::vector<VoxelBox> boxes;
  const std::size_t curves = voxels * static_cast<std::size_t>(curves_.channels);
  for (std::size_t b = 0; b < curves_.origins.size(); ++b) {
    VoxelBox box;
    bool isFirst = true;
    for (std::size_t c = 0; c < curves; ++c) {
      if (curves_.counts[b * curves + c] == 0) continue;
      const std::array<std::size_t, 3> within{c % voxels / 64, c / 8 % 8, c % 8};
      for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t at = curves_.origins[b][i] + static_cast<std::int32_t>(within[i]);
        box.least[i] = isFirst ? at : std::min(box.least[i], at);
        box.greatest[i] = isFirst ? at : std::max(box.greatest[i], at);
      }
      isFirst = false;
    }
    if (!isFirst) boxes.push_back(box);
  }
  return boxes;
}

double TemporalGrid::meanKnots() const {
  const auto curves = std::ranges::count_if(curves_.counts, [](std::uint8_t count) { return count > 0; });
  return curves > 0 ? static_cast<double>(curves_.knots.size()) / static_cast<double>(curves) : 0;
}

std::int32_t TemporalGrid::blockAt(std::int64_t x, std::int64_t y, std::int64_t z) const {
  x = (x >> 3) - first_[0];
  y = (y >> 3) - first_[1];
  z = (z >> 3) - first_[2];
  if (x < 0 || y < 0 || z < 0 || x >= size_[0] || y >= size_[1] || z >= size_[2]) return -1;
  return blocks_[static_cast<std::size_t>((x * size_[1] + y) * size_[2] + z)];
}

float TemporalGrid::valueOf(std::size_t block, std::size_t curve, float time) const {
  const std::size_t curves = voxels * static_cast<std::size_t>(curves_.channels);
  const std::uint8_t* const counts = curves_.counts.data() + block * curves;
  const std::size_t count = counts[curve];
  if (count == 0) return 0;
  std::uint64_t at = begins_[block] + rows_[(block * curves + curve) / rowLength];
  for (std::size_t c = curve / rowLength * rowLength; c < curve; ++c) at += counts[c];
  const std::uint8_t* const knots = curves_.knots.data() + at;
  const float* const values = curves_.values.data() + at;
  const auto timeOf = [&](std::size_t k) { return curves_.times[knots[k]]; };
  if (!(time > timeOf(0))) return values[0];
  std::size_t k = 1;
  while (k < count && timeOf(k) <= time) ++k;
  if (k == count) return values[count - 1];
  const float u = (time - timeOf(k - 1)) / (timeOf(k) - timeOf(k - 1));
  return values[k - 1] + u * (values[k] - values[k - 1]);
}

void TemporalGrid::addVoxel(std::int64_t x, std::int64_t y, std::int64_t z, float time, float weight,
                            float* sums) const {
  const std::int32_t block = blockAt(x, y, z);
  if (block < 0) return;
  const auto voxel = static_cast<std::size_t>(((x & 7) * 8 + (y & 7)) * 8 + (z & 7));
  for (std::size_t c = 0; c < static_cast<std::size_t>(curves_.channels); ++c)
    sums[c] += weight * valueOf(static_cast<std::size_t>(block), c * voxels + voxel, time);
}

void TemporalGrid::sample(VoxelInterpolation interpolation, std::size_t count, const float* x, const float* y,
                          const float* z, float* results) const {
  const std::vector<float> times(count, 0.0f);
  sampleAt(interpolation, count, x, y, z, times.data(), results);
}

void TemporalGrid::sampleAt(VoxelInterpolation interpolation, std::size_t count, const float* x, const float* y,
                            const float* z, const float* times, float* results) const {
  for (std::size_t n = 0; n < count; ++n) {
    float sums[3] = {0, 0, 0};
    std::array<double, 3> at;
    bool isInside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const double* const row = fileToIndex_.data() + 4 * i;
      at[i] = row[0] * static_cast<double>(x[n]) + row[1] * static_cast<double>(y[n]) +
              row[2] * static_cast<double>(z[n]) + row[3];
      isInside = isInside && std::fabs(at[i]) < 1 << 30;  // Also where it is no number.
    }
    if (isInside) {
      if (interpolation == VoxelInterpolation::nearest) {
        for (double& a : at) a += 0.5;
      }
      std::array<std::int64_t, 3> low;
      std::array<float, 3> part;
      for (std::size_t i = 0; i < 3; ++i) {
        const double floor = std::floor(at[i]);
        low[i] = static_cast<std::int64_t>(floor);
        part[i] = static_cast<float>(at[i] - floor);
      }
      if (interpolation == VoxelInterpolation::nearest) {
        addVoxel(low[0], low[1], low[2], times[n], 1, sums);
      } else if (interpolation == VoxelInterpolation::trilinear) {
        for (int corner = 0; corner < 8; ++corner) {
          const int dx = corner >> 2, dy = corner >> 1 & 1, dz = corner & 1;
          const float weight =
              (dx ? part[0] : 1 - part[0]) * (dy ? part[1] : 1 - part[1]) * (dz ? part[2] : 1 - part[2]);
          if (weight != 0) addVoxel(low[0] + dx, low[1] + dy, low[2] + dz, times[n], weight, sums);
        }
      } else {
        const auto wx = splineWeights(part[0]), wy = splineWeights(part[1]), wz = splineWeights(part[2]);
        for (std::size_t corner = 0; corner < 64; ++corner) {
          const std::size_t dx = corner / 16, dy = corner / 4 % 4, dz = corner % 4;
          addVoxel(low[0] + static_cast<std::int64_t>(dx) - 1, low[1] + static_cast<std::int64_t>(dy) - 1,
                   low[2] + static_cast<std::int64_t>(dz) - 1, times[n], wx[dx] * wy[dy] * wz[dz], sums);
        }
      }
    }
    for (std::size_t c = 0; c < static_cast<std::size_t>(curves_.channels); ++c) results[c * count + n] = sums[c];
  }
}

VoxelRange TemporalGrid::range(VoxelInterpolation interpolation, const std::array<double, 3>& lower,
                               const std::array<double, 3>& upper, int channel) const {
  const auto c = static_cast<std::size_t>(channel);
  Span span;
  std::array<std::int64_t, 3> from{}, to{};
  double count = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double* const row = fileToIndex_.data() + 4 * i;
    double low = row[3], high = row[3], size = std::fabs(row[3]);
    for (std::size_t k = 0; k < 3; ++k) {
      low += std::min(row[k] * lower[k], row[k] * upper[k]);
      high += std::max(row[k] * lower[k], row[k] * upper[k]);
      size += std::max(std::fabs(row[k] * lower[k]), std::fabs(row[k] * upper[k]));
    }
    const double slack = 1e-9 * size + static_cast<double>(voxelsAround(interpolation));
    low = std::clamp(std::floor(low - slack), -1e9, 1e9);
    high = std::clamp(std::ceil(high + slack), -1e9, 1e9);
    from[i] = std::max((static_cast<std::int64_t>(low) >> 3) - first_[i], std::int64_t{0});
    to[i] = std::min((static_cast<std::int64_t>(high) >> 3) - first_[i], size_[i] - 1);
    count *= static_cast<double>(std::max<std::int64_t>(0, to[i] - from[i] + 1));
  }
  constexpr double mostLooks = 4096;
  if (count > mostLooks) {
    span = total_[c];
  } else {
    for (std::int64_t x = from[0]; x <= to[0]; ++x) {
      for (std::int64_t y = from[1]; y <= to[1]; ++y) {
        for (std::int64_t z = from[2]; z <= to[2]; ++z) {
          const std::int32_t block = blocks_[static_cast<std::size_t>((x * size_[1] + y) * size_[2] + z)];
          if (block < 0) continue;
          const Span& one = spans_[static_cast<std::size_t>(block) * static_cast<std::size_t>(curves_.channels) + c];
          span.least = std::min(span.least, one.least);
          span.greatest = std::max(span.greatest, one.greatest);
          span.hasNan = span.hasNan || one.hasNan;
        }
      }
    }
  }
  // Sums of weights are off by some roundings, and a spline's by more.
  const float slack = 1e-5f * std::max(std::fabs(span.least), std::fabs(span.greatest));
  return {span.least < 0 ? span.least - slack : 0.0f, span.greatest > 0 ? span.greatest + slack : 0.0f, span.hasNan};
}

}  // namespace aerosol::grid
