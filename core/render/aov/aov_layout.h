// What a film gathers beside the picture, and how it becomes pictures of its own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/render/aov/cryptomatte.h"
#include "core/render/aov/deep_layout.h"

namespace aerosol::render {

/// How a layer's values come from the sums over a pixel's samples.
enum class AovFinish : std::uint8_t {
  mean,             ///< Sum over number of samples.
  share,            ///< Sum over the sum of one weight; 0 where that is 0.
  meanVariance,     ///< Of the mean: from the sums of the values and of their squares.
  picture,          ///< The picture itself, with its coverage.
  standardError,    ///< Of the picture.
  pictureVariance,  ///< Of the picture's mean: the square of its standard error.
  sampleCount,
  matte  ///< Two pairs of id and coverage of a Cryptomatte.
};

/// One quantity: a part of an EXR file.
struct AovLayer {
  std::string name;
  std::string quantity;               ///< What was asked for: a name of the table, or a light path expression.
  std::vector<std::string> channels;  ///< Full names, such as "direct.R".
  AovFinish finish = AovFinish::mean;
  std::uint32_t first = 0;   ///< Of the values that are gathered: one a channel from here on.
  std::uint32_t second = 0;  ///< Of `matte`: which of the mattes, and `first` is the rank of its first pair. The weight
                             ///< of `share`; the squares of `meanVariance`, one a channel.
  bool isData = false;       ///< No colour: kept in full precision whatever the picture's is.

  friend bool operator==(const AovLayer&, const AovLayer&) = default;
};

/// Which things pixels show: the id of one thing comes with each sample, as the bits of a float.
struct AovMatte {
  std::string name;        ///< Before the numbers of its layers.
  std::uint32_t slot = 0;  ///< Of the id; 0: none is seen.
  std::uint32_t weightSlot = 0;
  std::vector<MatteName> names;

  friend bool operator==(const AovMatte&, const AovMatte&) = default;
};

struct AovLayout {
  std::vector<AovLayer> layers;
  std::vector<AovMatte> mattes;
  AovDeep deep;
  std::uint32_t width = 0;  ///< Values of each sample.

  /// "direct, first=C<RD>L".
  std::string toText() const;
  bool isEmpty() const { return layers.empty() && !deep.isWanted(); }
  /// Null when there is none of that name.
  const AovLayer* find(const std::string& name) const;
  /// Whether every layer finds its values.
  bool isSound() const;

  friend bool operator==(const AovLayout&, const AovLayout&) = default;
};

template <class A>
void describe(A& archive, AovLayer& layer) {
  archive(layer.name, layer.quantity, layer.channels, layer.finish, layer.first, layer.second, layer.isData);
}

template <class A>
void describe(A& archive, AovMatte& matte) {
  archive(matte.name, matte.slot, matte.weightSlot, matte.names);
}

template <class A>
void describe(A& archive, AovLayout& layout) {
  archive(layout.layers, layout.mattes, layout.deep, layout.width);
}

}  // namespace aerosol::render
