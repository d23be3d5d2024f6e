#include "core/render/aov/deep_record.h"

namespace aerosol::render {

void DeepRecord::begin(float cosine) {
  std::fill(values_.begin(), values_.end(), 0.0f);
  std::fill(emission_.begin(), emission_.end(), 0.0f);
  given_ = Color();
  cosine_ = cosine;
}

void DeepRecord::addOpacity(std::size_t slice, Color opacity) {
  const std::uint32_t at = deep_.opacityAt(slice);
  if (deep_.isChromatic) {
    put(at, opacity);
  } else {
    values_[at] += average(opacity);
  }
}

void DeepRecord::addSurface(float distance, Color opacity) {
  const float depth = distance * cosine_, weight = average(opacity);
  const std::size_t slice = deep_.sliceOf(depth);
  addOpacity(slice, opacity);
  values_[deep_.surfaceAt(slice)] += weight;
  values_[deep_.surfaceAt(slice) + 1] += weight * depth;
}

void DeepRecord::addLight(float distance, Color light) {
  put(deep_.lightAt(deep_.sliceOf(distance * cosine_)), light);
  given_ += light;
}

void DeepRecord::addEmission(Color light) {
  float sum = 0;
  for (const float expected : emission_) sum += expected;
  given_ += light;
  if (!(sum > 0)) {
    put(deep_.lightAt(0), light);
    return;
  }
  for (std::size_t i = 0; i < emission_.size(); ++i) {
    if (emission_[i] > 0) put(deep_.lightAt(i), light * (emission_[i] / sum));
  }
}

void DeepRecord::finish(Color light, float firstDistance, float filterWeight, std::span<float> values) {
  const bool isInside = firstDistance >= 0;
  put(isInside ? deep_.lightAt(deep_.sliceOf(firstDistance * cosine_)) : deep_.backgroundAt(), light - given_);
  // The picture's filter weights light, and not what covers it.
  const auto weigh = [&](std::uint32_t at) {
    for (std::uint32_t c = 0; c < 3; ++c) values_[at + c] *= filterWeight;
  };
  if (filterWeight != 1) {
    for (std::size_t i = 0; i < deep_.slices(); ++i) weigh(deep_.lightAt(i));
    weigh(deep_.backgroundAt());
  }
  std::copy(values_.begin(), values_.end(), values.begin() + static_cast<std::ptrdiff_t>(deep_.firstSlot));
}

}  // namespace aerosol::render
