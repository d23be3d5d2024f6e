// A grid of curves as shaders look it up. Internal to this folder.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/voxel_grid.h"
#include "core/grid/temporal_file.h"
#include "core/grid/temporal_lookup.h"

namespace aerosol::grid {

class TemporalGrid final : public VoxelGrid {
 public:
  /// Null, with a message, when the map has no inverse or the blocks lie too far apart.
  static std::unique_ptr<TemporalGrid> make(TemporalCurves curves, std::string& problem);

  const VoxelGridInfo& info() const override { return info_; }
  /// At time 0.
  void sample(VoxelInterpolation interpolation, std::size_t count, const float* x, const float* y, const float* z,
              float* results) const override;
  void sampleAt(VoxelInterpolation interpolation, std::size_t count, const float* x, const float* y, const float* z,
                const float* times, float* results) const override;
  /// At all times.
  VoxelRange range(VoxelInterpolation interpolation, const std::array<double, 3>& lower,
                   const std::array<double, 3>& upper, int channel) const override;

  std::vector<VoxelBox> activeBoxes() const override;

  /// Of all times that are stored: how many knots a curve has on average that is not always 0.
  double meanKnots() const;

 private:
  struct Span {
    float least = 0, greatest = 0;
    bool hasNan = false;
  };
  explicit TemporalGrid(TemporalCurves curves) : curves_(std::move(curves)) {}
  bool index(std::string& problem);
  void describe();
  void setTables();

  TemporalCurves curves_;
  VoxelGridInfo info_;
  std::array<double, 12> fileToIndex_{};
  std::array<std::int64_t, 3> first_{}, size_{};  ///< Of the blocks, in blocks.
  std::vector<std::int32_t> blocks_;              ///< z fastest: number of the block, or -1.
  std::vector<std::int32_t> rows_;                ///< By row of curves: its first knot.
  CurveTables tables_;                            ///< What lookups see of all this.
  std::vector<Span> spans_;                       ///< By block and channel.
  std::array<Span, 3> total_{};                   ///< The background included.
};

}  // namespace aerosol::grid
