// Sparse voxel data as shaders and volumes ask for it: the interface between them and the library that reads files. It
// stands in the base layer because neither of the two sides sees the other.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/base/voxel_map.h"

namespace aerosol {

enum class VoxelInterpolation : std::uint8_t {
  nearest,
  trilinear,
  tricubic  ///< The cubic B-spline: smooth, within the values around, not through them.
};

/// What a grid holds. Boxes are given by their least and greatest corner.
struct VoxelGridInfo {
  std::string name;
  std::string type;     ///< As stored: "float", "half", "double", "int32", "vec3s" …
  std::string purpose;  ///< "fog volume", "level set", "staggered" or "unknown".
  std::string problem;  ///< Why its values cannot be looked up; empty for grids that can.
  int channels = 0;     ///< 1 or 3; 0 where there is a problem.
  std::uint64_t activeVoxels = 0;
  std::uint64_t memoryBytes = 0;
  bool isEmpty = true;                           ///< No active voxel: the boxes mean nothing.
  std::array<std::int32_t, 6> indexBounds = {};  ///< Active voxels, both corners included.
  std::array<double, 6> bounds = {};             ///< Of the active voxels as cells, in the space of the file.
  std::array<double, 3> voxelSize = {};
  std::array<double, 16> indexToFile = {};  ///< Row-major, for column vectors; of affine maps.
  std::optional<VoxelMap> frustum;          ///< The map of voxels that stand in a frustum.
  std::array<float, 3> background = {};
  std::array<float, 3> least = {}, greatest = {};   ///< Of the finite active values, by channel; 0 when there are none.
  std::uint64_t nanValues = 0, infiniteValues = 0;  ///< Stored values that are none or infinite, active or not.
};

/// Least and greatest value that any lookup can give.
struct VoxelRange {
  float least = 0, greatest = 0;
  bool hasNan = false;
};

/// Voxels from `least` to `greatest`, both included.
struct VoxelBox {
  std::array<std::int32_t, 3> least{}, greatest{};
};

/// Safe to use from any thread. Results depend on the arguments alone.
class VoxelGrid {
 public:
  virtual ~VoxelGrid() = default;
  virtual const VoxelGridInfo& info() const = 0;

  /// Values at points of the file's space: `results[channel * count + i]` at (x[i], y[i], z[i]). Outside of what is
  /// stored, and where a coordinate is no number, stands the background.
  virtual void sample(VoxelInterpolation interpolation, std::size_t count, const float* x, const float* y,
                      const float* z, float* results) const = 0;

  /// The same, of grids that change, at the time of each point (seconds). Others give what they always give.
  virtual void sampleAt(VoxelInterpolation interpolation, std::size_t count, const float* x, const float* y,
                        const float* z, const float* times, float* results) const {
    static_cast<void>(times);
    sample(interpolation, count, x, y, z, results);
  }

  /// What `sample` can give, at any time, in a box of the file's space.
  virtual VoxelRange range(VoxelInterpolation interpolation, const std::array<double, 3>& lower,
                           const std::array<double, 3>& upper, int channel) const = 0;

  /// Boxes that together hold all active voxels: one a leaf of the tree, as tight as it gets, and one an active tile.
  virtual std::vector<VoxelBox> activeBoxes() const = 0;
};

/// The grids of one file, in its order.
class VoxelFile {
 public:
  virtual ~VoxelFile() = default;
  virtual std::span<const std::unique_ptr<VoxelGrid>> grids() const = 0;

  /// Null when there is none of that name; the first that can be looked up for an empty name.
  const VoxelGrid* find(std::string_view name) const;
};

}  // namespace aerosol
