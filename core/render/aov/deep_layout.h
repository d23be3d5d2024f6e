// What a film gathers of each pixel for a deep image: along depth, in slices.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace aerosol::render {

/// Depths are measured from the camera along its view. What lies before the first slice or behind the last one counts
/// to it; what surrounds the scene comes behind all of them.
struct AovDeep {
  std::vector<float> depths;    ///< Where slices begin and, at last, end; ascending. Empty: nothing is gathered.
  bool isChromatic = false;     ///< Opacity is a colour.
  std::uint32_t firstSlot = 0;  ///< Of the values that are gathered.

  bool isWanted() const { return !depths.empty(); }
  std::size_t slices() const { return depths.size() - 1; }
  std::size_t sliceOf(float depth) const {
    const auto next = std::upper_bound(depths.begin() + 1, depths.end() - 1, depth);
    return static_cast<std::size_t>(next - (depths.begin() + 1));
  }

  // Values of each slice, in this order: opacity (of what reaches the camera, the part that ends here; one or three),
  // that of surfaces among it, the same times their depth, and light (three). At last the light and the coverage of
  // what is behind everything.
  std::uint32_t opacities() const { return isChromatic ? 3 : 1; }
  std::uint32_t valuesPerSlice() const { return opacities() + 5; }
  std::uint32_t width() const { return static_cast<std::uint32_t>(slices()) * valuesPerSlice() + 4; }
  std::uint32_t opacityAt(std::size_t slice) const { return static_cast<std::uint32_t>(slice) * valuesPerSlice(); }
  std::uint32_t surfaceAt(std::size_t slice) const { return opacityAt(slice) + opacities(); }
  std::uint32_t lightAt(std::size_t slice) const { return surfaceAt(slice) + 2; }
  std::uint32_t backgroundAt() const { return opacityAt(slices()); }

  bool isSound() const {
    return depths.size() != 1 && (depths.empty() || std::is_sorted(depths.begin(), depths.end()));
  }
  friend bool operator==(const AovDeep&, const AovDeep&) = default;
};

template <class A>
void describe(A& archive, AovDeep& deep) {
  archive(deep.depths, deep.isChromatic, deep.firstSlot);
}

}  // namespace aerosol::render
