// What one path gathers for a deep image.
#pragma once

#include <span>
#include <vector>

#include "core/base/color.h"
#include "core/render/aov/deep_layout.h"

namespace aerosol::render {

/// Opacity comes from a walk along the camera's ray (deep_walk.h), light from the path: what it brings from behind its
/// first vertex counts to that one's depth. Distances are from where the camera's ray begins.
class DeepRecord {
 public:
  explicit DeepRecord(const AovDeep& deep) : deep_(deep), values_(deep.width()), emission_(deep.slices()) {}

  const AovDeep& deep() const { return deep_; }

  /// A path leaves the camera; `cosine` is that of its direction with the view.
  void begin(float cosine);
  float cosine() const { return cosine_; }

  // From the walk:
  void addOpacity(std::size_t slice, Color opacity);
  void addSurface(float distance, Color opacity);
  void addBackground(float coverage) { values_[deep_.backgroundAt() + 3] += coverage; }
  /// Where light that media emit is expected to come from.
  void expectEmission(std::size_t slice, Color light) { emission_[slice] += average(light); }

  // From the path, before its first vertex; in step with the picture:
  void addLight(float distance, Color light);
  void addEmission(Color light);

  /// The rest of the path's light comes from its first vertex, or (negative) from behind everything.
  void finish(Color light, float firstDistance, float filterWeight, std::span<float> values);

 private:
  void put(std::uint32_t at, Color light) {
    for (int c = 0; c < 3; ++c) values_[at + static_cast<std::uint32_t>(c)] += light[c];
  }

  const AovDeep& deep_;
  std::vector<float> values_;
  std::vector<float> emission_;  ///< By slice.
  Color given_;                  ///< Light that has its place.
  float cosine_ = 1;
};

}  // namespace aerosol::render
