#include "core/volume/trackers/voxel_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace aerosol::volume {

namespace {

std::int32_t brickOf(std::int32_t cell) { return cell >> 3; }
static_assert(VoxelField::side == 8);

/// Whether the grid's matrix is all of its map: it takes the active voxels to where they are said to be.
bool isAffine(const VoxelGridInfo& info) {
  for (std::size_t r = 0; r < 3; ++r) {
    const double* const row = info.indexToFile.data() + 4 * r;
    double low = row[3], high = row[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = row[c] * (info.indexBounds[c] - 0.5), b = row[c] * (info.indexBounds[3 + c] + 0.5);
      low += std::min(a, b);
      high += std::max(a, b);
    }
    const double tolerance = 1e-6 * (std::fabs(low) + std::fabs(high)) + 0.01 * info.voxelSize[r];
    if (!(std::fabs(low - info.bounds[r]) <= tolerance && std::fabs(high - info.bounds[3 + r]) <= tolerance))
      return false;
  }
  return true;
}

/// Float coordinates have to tell voxels apart by this part of one.
constexpr double finestPart = 0.05;

}  // namespace

double CellCubic::inverse(double depth, double length) const {
  const double whole = integral(length);
  if (!(whole > 0) || depth >= whole) return depth > 0 ? length : 0;
  double low = 0, high = length, s = depth / whole * length;
  for (int i = 0; i < 100; ++i) {
    const double error = integral(s) - depth;
    (error > 0 ? high : low) = s;
    const double slope = at(s);
    double next = slope > 0 ? s - error / slope : low;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double change = std::fabs(next - s);
    s = next;
    if (change <= 1e-15 * length) break;
  }
  return s;
}

void VoxelField::reserve(const std::array<std::int32_t, 3>& low, const std::array<std::int32_t, 3>& high) {
  low_ = low;
  std::size_t all = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    count_[a] = high[a] - low[a] + 1;
    all *= static_cast<std::size_t>(count_[a]);
  }
  bricks_.assign(all, none);
}

void VoxelField::put(const std::array<std::int32_t, 3>& brick, const std::array<float, brickValues>& values) {
  if (std::ranges::all_of(values, [&](float v) { return v == values[0]; })) {
    if (values[0] == 0) return;
    bricks_[directoryIndex(brick)] = firstUniform - static_cast<std::int32_t>(uniform_.size());
    uniform_.push_back(values[0]);
    return;
  }
  bricks_[directoryIndex(brick)] = static_cast<std::int32_t>(values_.size() / brickValues);
  values_.insert(values_.end(), values.begin(), values.end());
}

VoxelField VoxelField::ofValues(const std::array<std::int32_t, 3>& first, const std::array<std::int32_t, 3>& size,
                                const std::vector<float>& values, VoxelKernel kernel) {
  VoxelField field;
  field.kernel_ = kernel;
  std::array<std::int32_t, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = brickOf(first[a] - 1);
    high[a] = brickOf(first[a] + size[a] - 1);
  }
  field.reserve(low, high);
  const auto at = [&](std::int32_t i, std::int32_t j, std::int32_t k) {
    const std::array<std::int32_t, 3> p{i - first[0], j - first[1], k - first[2]};
    for (std::size_t a = 0; a < 3; ++a) {
      if (p[a] < 0 || p[a] >= size[a]) return 0.0f;
    }
    return values[static_cast<std::size_t>(p[0] + size[0] * (p[1] + size[1] * p[2]))];
  };
  std::array<float, brickValues> brickData{};
  for (std::int32_t bz = low[2]; bz <= high[2]; ++bz) {
    for (std::int32_t by = low[1]; by <= high[1]; ++by) {
      for (std::int32_t bx = low[0]; bx <= high[0]; ++bx) {
        for (std::size_t n = 0; n < brickValues; ++n) {
          const auto m = static_cast<std::int32_t>(n);
          brickData[n] =
              at(side * bx + m % corners, side * by + m / corners % corners, side * bz + m / (corners * corners));
        }
        field.put({bx, by, bz}, brickData);
      }
    }
  }
  return field;
}

std::optional<VoxelField> VoxelField::make(const VoxelGrid& grid, VoxelKernel kernel, std::uint64_t largestBytes) {
  const VoxelGridInfo& info = grid.info();
  const bool isSound = info.problem.empty() && info.channels == 1 && !info.isEmpty && info.background[0] == 0 &&
                       info.least[0] >= 0 && info.nanValues == 0 && info.infiniteValues == 0 &&
                       info.purpose != "level set" && isAffine(info);
  if (!isSound) return {};
  for (std::size_t a = 0; a < 3; ++a) {
    const double farthest = std::max(std::fabs(info.bounds[a]), std::fabs(info.bounds[3 + a]));
    if (farthest * 0x1p-23 > finestPart * info.voxelSize[a]) return {};
    if (info.indexBounds[a] < -(1 << 24) || info.indexBounds[3 + a] > (1 << 24)) return {};
  }
  // Whole leaves: what is stored in them counts, active or not.
  VoxelField field;
  field.kernel_ = kernel;
  std::array<std::int32_t, 3> low, high;
  double all = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = brickOf(info.indexBounds[a]) - 1;
    high[a] = brickOf(info.indexBounds[3 + a]);
    all *= high[a] - low[a] + 1;
  }
  if (4 * all > static_cast<double>(largestBytes)) return {};
  field.reserve(low, high);
  std::set<std::size_t> wanted;  // By place in the directory, so that nothing depends on the order of boxes.
  const std::uint64_t mostBricks = largestBytes / (4 * brickValues);
  for (const VoxelBox& box : grid.activeBoxes()) {
    std::array<std::int32_t, 3> from, to;
    for (std::size_t a = 0; a < 3; ++a) {
      from[a] = std::max(brickOf(box.least[a]) - 1, low[a]);
      to[a] = std::min(brickOf(box.greatest[a]), high[a]);
    }
    for (std::int32_t z = from[2]; z <= to[2]; ++z) {
      for (std::int32_t y = from[1]; y <= to[1]; ++y) {
        for (std::int32_t x = from[0]; x <= to[0]; ++x) wanted.insert(field.directoryIndex({x, y, z}));
      }
    }
    if (wanted.size() > mostBricks) return {};
  }
  std::array<float, brickValues> x, y, z, values;
  for (const std::size_t index : wanted) {
    const auto i = static_cast<std::int32_t>(index);
    const std::array<std::int32_t, 3> brick{low[0] + i % field.count_[0],
                                            low[1] + i / field.count_[0] % field.count_[1],
                                            low[2] + i / (field.count_[0] * field.count_[1])};
    for (std::size_t n = 0; n < brickValues; ++n) {
      const auto m = static_cast<std::int32_t>(n);
      const std::array<double, 3> p{static_cast<double>(side * brick[0] + m % corners),
                                    static_cast<double>(side * brick[1] + m / corners % corners),
                                    static_cast<double>(side * brick[2] + m / (corners * corners))};
      const auto row = [&](std::size_t r) {
        const double* const f = info.indexToFile.data() + 4 * r;
        return static_cast<float>(f[0] * p[0] + f[1] * p[1] + f[2] * p[2] + f[3]);
      };
      x[n] = row(0);
      y[n] = row(1);
      z[n] = row(2);
    }
    grid.sample(VoxelInterpolation::nearest, brickValues, x.data(), y.data(), z.data(), values.data());
    for (const float v : values) {
      if (!(v >= 0 && std::isfinite(v))) return {};
    }
    field.put(brick, values);
  }
  return field;
}

VoxelWalk::VoxelWalk(const VoxelField& field, const FieldRay& ray, double t0, double t1)
    : field_(field), origin_(ray.origin), direction_(ray.direction), last_(t1) {
  // A voxel of the constant kernel reaches half a step to both sides.
  if (field.kernel_ == VoxelKernel::constant) {
    for (double& o : origin_) o += 0.5;
  }
  double entry = t0, exit = t1;
  for (std::size_t a = 0; a < 3; ++a) {
    firstCell_[a] = VoxelField::side * field.low_[a];
    lastCell_[a] = firstCell_[a] + VoxelField::side * field.count_[a] - 1;
    const double lower = firstCell_[a], upper = static_cast<double>(lastCell_[a]) + 1;
    if (direction_[a] == 0) {
      if (!(origin_[a] >= lower && origin_[a] <= upper)) exit = -std::numeric_limits<double>::infinity();
      continue;
    }
    inverse_[a] = 1 / direction_[a];
    const double p = (lower - origin_[a]) * inverse_[a], q = (upper - origin_[a]) * inverse_[a];
    entry = std::max(entry, std::min(p, q));
    exit = std::min(exit, std::max(p, q));
  }
  isEnded_ = !(entry < exit);
  if (isEnded_) return;
  t_ = entry;
  last_ = std::min(last_, exit);
  for (std::size_t a = 0; a < 3; ++a) {
    cell_[a] = clampCell(std::floor(origin_[a] + entry * direction_[a]), firstCell_[a], lastCell_[a]);
  }
}

double VoxelWalk::exitOf(const std::array<std::int32_t, 3>& first, std::int32_t size, std::size_t& axis) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a) {
    if (direction_[a] == 0) continue;
    const double face = direction_[a] > 0 ? first[a] + size : first[a];
    const double t = (face - origin_[a]) * inverse_[a];
    if (t < nearest) {
      nearest = t;
      axis = a;
    }
  }
  return nearest;
}

bool VoxelWalk::step(const std::array<std::int32_t, 3>& first, std::int32_t size, std::size_t axis, double t) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (a == axis) {
      cell_[a] = direction_[a] > 0 ? first[a] + size : first[a] - 1;
    } else if (size > 1) {
      cell_[a] = clampCell(std::floor(origin_[a] + t * direction_[a]), first[a], first[a] + size - 1);
    }
  }
  t_ = std::max(t_, t);
  return t_ < last_ && cell_[axis] >= firstCell_[axis] && cell_[axis] <= lastCell_[axis];
}

bool VoxelWalk::next() {
  if (isEnded_) return false;
  if (isStarted_ && !step(first_, size_, exitAxis_, end_)) isEnded_ = true;
  isStarted_ = true;
  while (!isEnded_) {
    const std::array<std::int32_t, 3> brick{brickOf(cell_[0]), brickOf(cell_[1]), brickOf(cell_[2])};
    const std::int32_t number = field_.bricks_[field_.directoryIndex(brick)];
    std::size_t axis = 0;
    if (number == VoxelField::none) {
      const std::array<std::int32_t, 3> first{8 * brick[0], 8 * brick[1], 8 * brick[2]};
      const double t = exitOf(first, VoxelField::side, axis);
      isEnded_ = !step(first, VoxelField::side, axis, t);
      continue;
    }
    if (number <= VoxelField::firstUniform) {
      first_ = {8 * brick[0], 8 * brick[1], 8 * brick[2]};
      size_ = VoxelField::side;
      isFlat_ = true;
      corner_[0] = static_cast<double>(field_.uniform_[static_cast<std::size_t>(VoxelField::firstUniform - number)]);
      begin_ = t_;
      end_ = std::max(begin_, std::min(exitOf(first_, size_, exitAxis_), last_));
      return true;
    }
    const double t = exitOf(cell_, 1, axis);
    const auto local = [&](std::size_t a) { return static_cast<std::size_t>(cell_[a] & 7); };
    const float* const v = field_.values_.data() + static_cast<std::size_t>(number) * VoxelField::brickValues +
                           local(0) + 9 * local(1) + 81 * local(2);
    double sum = static_cast<double>(v[0]);
    corner_[0] = sum;
    if (field_.kernel_ == VoxelKernel::trilinear) {
      for (std::size_t n = 1; n < 8; ++n) {
        corner_[n] = static_cast<double>(v[(n & 1) + 9 * (n >> 1 & 1) + 81 * (n >> 2)]);
        sum += corner_[n];
      }
    }
    if (sum > 0) {
      begin_ = t_;
      end_ = std::max(begin_, std::min(t, last_));
      exitAxis_ = axis;
      first_ = cell_;
      size_ = 1;
      isFlat_ = field_.kernel_ == VoxelKernel::constant;
      return true;
    }
    isEnded_ = !step(cell_, 1, axis, t);
  }
  return false;
}

CellCubic VoxelWalk::cubic() const {
  if (isFlat_) return {{corner_[0], 0, 0, 0}};
  std::array<double, 3> p;
  for (std::size_t a = 0; a < 3; ++a) {
    p[a] = std::clamp(origin_[a] + begin_ * direction_[a] - cell_[a], 0.0, 1.0);
  }
  const auto& d = direction_;
  // Interpolated along x: linear; then along y: quadratic; then along z: cubic.
  const auto line = [&](std::size_t n) {
    const double rise = corner_[n + 1] - corner_[n];
    return std::array{corner_[n] + rise * p[0], rise * d[0]};
  };
  const auto plane = [&](std::size_t n) {
    const auto low = line(n), high = line(n + 2);
    const std::array rise{high[0] - low[0], high[1] - low[1]};
    return std::array{low[0] + rise[0] * p[1], low[1] + rise[1] * p[1] + rise[0] * d[1], rise[1] * d[1]};
  };
  const auto low = plane(0), high = plane(4);
  const std::array rise{high[0] - low[0], high[1] - low[1], high[2] - low[2]};
  return {{low[0] + rise[0] * p[2], low[1] + rise[1] * p[2] + rise[0] * d[2], low[2] + rise[2] * p[2] + rise[1] * d[2],
           rise[2] * d[2]}};
}

FieldPlace findDepth(const VoxelField& field, const FieldRay& ray, double t0, double t1, double depth) {
  FieldPlace place;
  for (VoxelWalk walk(field, ray, t0, t1); walk.next();) {
    const CellCubic cubic = walk.cubic();
    const double length = walk.end() - walk.begin();
    const double part = std::max(cubic.integral(length), 0.0);
    if (place.depth + part > depth) {
      place.isReached = true;
      place.t = walk.begin() + cubic.inverse(depth - place.depth, length);
      place.depth = depth;
      return place;
    }
    place.depth += part;
  }
  return place;
}

double integrate(const VoxelField& field, const FieldRay& ray, double t0, double t1) {
  return findDepth(field, ray, t0, t1, std::numeric_limits<double>::infinity()).depth;
}

double valueAt(const VoxelField& field, const FieldRay& ray, double t) {
  VoxelWalk walk(field, ray, t, std::nextafter(t, std::numeric_limits<double>::infinity()));
  return walk.next() ? std::max(walk.cubic().at(0), 0.0) : 0.0;
}

}  // namespace aerosol::volume
