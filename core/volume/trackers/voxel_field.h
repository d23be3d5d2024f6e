// A field of voxels with exact integrals along rays.
//
// With the constant kernel the field is the value of the nearest voxel, with the trilinear one that of the eight
// around. Along a ray through one cell the first is a constant, the second a cubic in the distance: coordinates within
// the cell are linear in it, and the field is a product of at most three of them. Its integral is a quartic, monotone
// because the values are not negative; a given depth is found by Newton's method, kept within a bracket that bisection
// halves.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/voxel_grid.h"

namespace aerosol::volume {

enum class VoxelKernel : std::uint8_t { constant, trilinear };

/// The field along a ray in one cell: c0 + c1 s + c2 s² + c3 s³ at the distance s from where the ray enters it.
struct CellCubic {
  std::array<double, 4> c{};

  double at(double s) const { return c[0] + s * (c[1] + s * (c[2] + s * c[3])); }
  /// ∫ from 0 to s.
  double integral(double s) const { return s * (c[0] + s * (c[1] / 2 + s * (c[2] / 3 + s * (c[3] / 4)))); }
  /// The s in [0, length] up to which the integral is `depth`, which is not more than that of the whole length. The
  /// field is not negative there.
  double inverse(double depth, double length) const;
};

/// A copy of a grid's voxels in bricks of 8 x 8 x 8 cells, each with all corners of its cells. Const after it was made.
class VoxelField {
 public:
  static constexpr std::int32_t side = 8;            ///< Cells of a brick.
  static constexpr std::int32_t corners = side + 1;  ///< Values of a brick along an axis.
  static constexpr std::size_t brickValues = 9 * 9 * 9;

  /// Nothing where values are negative, not finite, or not 0 outside of the active ones, where lookups by float points
  /// would be too coarse to tell voxels apart, and where the copy would take more than `largestBytes`.
  static std::optional<VoxelField> make(const VoxelGrid& grid, VoxelKernel kernel, std::uint64_t largestBytes);
  /// Of values at whole coordinates, x fastest; 0 outside.
  static VoxelField ofValues(const std::array<std::int32_t, 3>& first, const std::array<std::int32_t, 3>& size,
                             const std::vector<float>& values, VoxelKernel kernel);

  std::uint64_t bytes() const { return 4 * (values_.size() + uniform_.size() + bricks_.size()); }
  VoxelKernel kernel() const { return kernel_; }

 private:
  friend class VoxelWalk;
  static constexpr std::int32_t none = -1;
  /// Numbers of bricks with one value all over go down from here.
  static constexpr std::int32_t firstUniform = -2;

  /// Room for bricks from `low` to `high`, in whole bricks, both included.
  void reserve(const std::array<std::int32_t, 3>& low, const std::array<std::int32_t, 3>& high);
  std::size_t directoryIndex(const std::array<std::int32_t, 3>& brick) const {
    return static_cast<std::size_t>(brick[0] - low_[0]) +
           static_cast<std::size_t>(count_[0]) *
               (static_cast<std::size_t>(brick[1] - low_[1]) +
                static_cast<std::size_t>(count_[1]) * static_cast<std::size_t>(brick[2] - low_[2]));
  }
  /// Keeps a brick of which something is not 0.
  void put(const std::array<std::int32_t, 3>& brick, const std::array<float, brickValues>& values);

  VoxelKernel kernel_ = VoxelKernel::trilinear;
  std::array<std::int32_t, 3> low_{}, count_{};  ///< The least brick and how many there are along each axis.
  std::vector<std::int32_t> bricks_;             ///< Number of the brick's values, or of its only one; none: 0.
  std::vector<float> values_;
  std::vector<float> uniform_;
};

/// A ray in the coordinates of a field: voxels at whole numbers.
struct FieldRay {
  std::array<double, 3> origin{}, direction{};  ///< The direction is per unit of the ray's distance.
};

/// The cells along a ray in which the field is not 0, in order. A brick with one value all over counts as one cell.
class VoxelWalk {
 public:
  /// From distance t0 to t1.
  VoxelWalk(const VoxelField& field, const FieldRay& ray, double t0, double t1);

  /// Goes to the next cell. False at the end.
  bool next();
  double begin() const { return begin_; }
  double end() const { return end_; }  ///< Not less than begin().
  /// The field in the cell, by the distance from begin().
  CellCubic cubic() const;

 private:
  static std::int32_t clampCell(double x, std::int32_t first, std::int32_t last) {
    if (!(x > static_cast<double>(first))) return first;
    return x >= static_cast<double>(last) ? last : static_cast<std::int32_t>(x);
  }
  /// The distance at which the box of cells from `first`, `size` along each axis, is left, and the axis.
  double exitOf(const std::array<std::int32_t, 3>& first, std::int32_t size, std::size_t& axis) const;
  /// To the cell behind the face of a box of cells at distance t. False where the field ends.
  bool step(const std::array<std::int32_t, 3>& first, std::int32_t size, std::size_t axis, double t);
  bool isOutside() const;

  const VoxelField& field_;
  std::array<double, 3> origin_, direction_, inverse_{};
  double last_;
  std::array<std::int32_t, 3> cell_{}, firstCell_{}, lastCell_{};
  double t_ = 0, begin_ = 0, end_ = 0;
  std::size_t exitAxis_ = 0;
  std::array<std::int32_t, 3> first_{};  ///< Of the cells that are passed in one step,
  std::int32_t size_ = 1;                ///< and how many they are along an axis.
  bool isStarted_ = false, isEnded_ = false, isFlat_ = false;
  std::array<double, 8> corner_{};
};

/// Where the integral of a field from t0 on reaches a depth.
struct FieldPlace {
  bool isReached = false;
  double t = 0;
  double depth = 0;  ///< The one that was asked for, or that of the whole way.
};
FieldPlace findDepth(const VoxelField& field, const FieldRay& ray, double t0, double t1, double depth);
/// ∫ of the field from t0 to t1.
double integrate(const VoxelField& field, const FieldRay& ray, double t0, double t1);
/// The field at a place of the ray.
double valueAt(const VoxelField& field, const FieldRay& ray, double t);

}  // namespace aerosol::volume
