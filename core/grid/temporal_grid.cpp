#include "core/grid/temporal_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/geometry.h"

namespace aerosol::grid {

namespace {

constexpr std::size_t voxels = curvesInBlock;
/// Numbers of curves and of knots are counted in 31 bits.
constexpr std::size_t mostNumbers = std::numeric_limits<std::int32_t>::max();
/// Places for blocks in the table; more than a renderer could fill.
constexpr double mostPlaces = 1 << 28;

std::int64_t voxelsAround(VoxelInterpolation interpolation) {
  return interpolation == VoxelInterpolation::tricubic ? 2 : 1;
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
  if (origins.size() * curves > mostNumbers || curves_.values.size() > mostNumbers) {
    problem = "grid '" + curves_.name + "' has more than 2^31 curves or values";
    return false;
  }
  blocks_.assign(std::max<std::size_t>(1, static_cast<std::size_t>(places)), -1);
  std::size_t knot = 0;
  for (std::size_t b = 0; b < origins.size(); ++b) {
    const std::array<std::int64_t, 3> at{origins[b][0] / 8 - first_[0], origins[b][1] / 8 - first_[1],
                                         origins[b][2] / 8 - first_[2]};
    blocks_[static_cast<std::size_t>((at[0] * size_[1] + at[1]) * size_[2] + at[2])] = static_cast<std::int32_t>(b);
    for (std::size_t c = 0; c < curves; ++c) {
      if (c % curvesInRow == 0) rows_.push_back(static_cast<std::int32_t>(knot));
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
  setTables();
  return true;
}

void TemporalGrid::setTables() {
  curves_.knots.resize(curves_.values.size() + 4);
  tables_.channels = curves_.channels;
  tables_.timeCount = static_cast<std::int32_t>(curves_.times.size());
  for (std::size_t i = 0; i < 3; ++i) {
    tables_.first[i] = static_cast<std::int32_t>(first_[i]);
    tables_.size[i] = static_cast<std::int32_t>(size_[i]);
  }
  tables_.blocks = blocks_.data();
  tables_.counts = curves_.counts.data();
  tables_.rows = rows_.data();
  tables_.knots = curves_.knots.data();
  tables_.values = curves_.values.data();
  tables_.times = curves_.times.data();
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
                      rows_.size() * sizeof(std::int32_t) + blocks_.size() * sizeof(std::int32_t) +
                      spans_.size() * sizeof(Span);
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
  return curves > 0 ? static_cast<double>(curves_.values.size()) / static_cast<double>(curves) : 0;
}

void TemporalGrid::sample(VoxelInterpolation interpolation, std::size_t count, const float* x, const float* y,
                          const float* z, float* results) const {
  const std::vector<float> times(count, 0.0f);
  sampleAt(interpolation, count, x, y, z, times.data(), results);
}

void TemporalGrid::sampleAt(VoxelInterpolation interpolation, std::size_t count, const float* x, const float* y,
                            const float* z, const float* times, float* results) const {
  lookUp(
      interpolation, tables_,
      {.fileToIndex = fileToIndex_.data(), .count = count, .x = x, .y = y, .z = z, .results = results, .times = times});
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
