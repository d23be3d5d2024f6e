// From points of a file's space to voxels, where the voxels may stand in a frustum.
#pragma once

#include <array>
#include <optional>

#include "core/base/geometry.h"

namespace aerosol {

/// Each index coordinate is a quotient of two affine functions of the point: with x' = (x, y, z, 1)
///
///   index_r = (numerator_r · x') / (denominator_r · x'),   wherever denominator_r · x' > 0.
///
/// So the plane index_r = c of the grid is the plane of space (numerator_r - c denominator_r) · x' = 0, whatever the
/// map (Wrenninge et al. 2013; the talk: "can be directly extracted from the frustum matrix"). Three kinds have this
/// form: affine maps (all denominators 1), projective ones (all denominators the last row of the matrix), and
/// OpenVDB's NonlinearFrustumMap, where depth is linear (the denominator of z is 1).
struct VoxelMap {
  using Form = std::array<double, 4>;  ///< a x + b y + c z + d.
  using Triple = std::array<double, 3>;

  std::array<Form, 3> numerator{};
  std::array<Form, 3> denominator{};
  std::optional<Triple> eye;  ///< Where lines of constant x and y meet; nothing where they are parallel.

  static VoxelMap affine(const Matrix4& fileToIndex);
  /// The index is (x, y, z) / w of the matrix times (point, 1).
  static VoxelMap projective(const Matrix4& fileToIndex);
  /// OpenVDB's NonlinearFrustumMap: with L the sides of the box around the voxels, o its centre (of z: its least),
  /// and γ = (1 / taper - 1) / depth, the point (q_x, q_y, q_z) of the second map's space has w = γ q_z + 1 and
  ///   index_x = o_x + L_x q_x / w,   index_y = o_y + L_x q_y / w,   index_z = o_z + L_z q_z / depth.
  /// `secondInverse` goes from the file's space to q.
  static VoxelMap linearDepth(const Triple& least, const Triple& greatest, double taper, double depth,
                              const Matrix4& secondInverse);

  /// The same voxels for points of a space that `toFile` leads from.
  VoxelMap after(const Matrix4& toFile) const;

  /// Nothing behind the eye.
  std::optional<Triple> toIndex(const Triple& point) const;
  /// The point where the three planes meet; nothing where that is behind the eye, or nowhere.
  std::optional<Triple> toFile(const Triple& index) const;
  /// The plane index_axis = position: positive where the coordinate is greater.
  Form plane(std::size_t axis, double position) const;

  /// The box around the images of all points of a box, and what rounding adds; nothing where some are behind the eye.
  bool indexBox(const Triple& lower, const Triple& upper, Triple& least, Triple& greatest) const;
  /// The box around what is in front of the eye of a box of voxels.
  void fileBox(const Triple& least, const Triple& greatest, Triple& lower, Triple& upper) const;

  friend bool operator==(const VoxelMap&, const VoxelMap&) = default;
};

}  // namespace aerosol
