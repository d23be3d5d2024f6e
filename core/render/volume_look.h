// What an artist sets on a volume on top of its shader: factors and ramps on what the shader returns.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/color.h"
#include "core/base/result.h"
#include "core/scene/description.h"
#include "core/volume/bounds/bound_builder.h"
#include "core/volume/coefficients.h"

namespace aerosol::render {

/// Values at places, joined by straight lines, constant before the first and behind the last.
template <class T>
class Ramp {
 public:
  struct Key {
    float place = 0;
    T value{};
  };

  Ramp() = default;
  /// Ascending places.
  explicit Ramp(std::vector<Key> keys) : keys_(std::move(keys)) {}

  bool empty() const { return keys_.empty(); }
  std::span<const Key> keys() const { return keys_; }
  T at(float x) const {
    if (!(x > keys_.front().place)) return keys_.front().value;
    for (std::size_t i = 1; i < keys_.size(); ++i) {
      const Key &a = keys_[i - 1], &b = keys_[i];
      if (x < b.place) return a.value + (b.value - a.value) * ((x - a.place) / (b.place - a.place));
    }
    return keys_.back().value;
  }

 private:
  std::vector<Key> keys_;
};

/// Turns a shader's coefficients into those of the volume. With d the largest channel of the shader's extinction:
/// extinction is `density` · densityRamp(d) times the shader's, scattering `color` · colorRamp(d) times as much again,
/// emission `emission` times the shader's. Where extinction and emission were 0 they stay so.
struct VolumeLook {
  float density = 1;
  Color color{1.0f};
  float emission = 1;
  Ramp<float> densityRamp;  ///< Over extinction per scene unit.
  Ramp<Color> colorRamp;
  bool scattersAll = false;  ///< All extinction scatters, and nothing is emitted: of a holdout.

  void apply(volume::Coefficients& coefficients) const;
  /// Of the largest channel `extinction`.
  float factorAt(float extinction) const;
  /// The largest factor on extinction anywhere.
  float largestFactor() const;
  /// What is known of the volume over a box, from what is known of the shader.
  void apply(volume::BoxKnowledge& knowledge) const;
};

/// The look that a volume's parameters describe; nothing when they leave the shader as it is. An error at the volume's
/// place for a ramp that cannot be read.
Result<std::optional<VolumeLook>> lookOf(const scene::Volume& volume);

}  // namespace aerosol::render
