#include "core/render/aov/aov_layout.h"

#include <algorithm>

namespace aerosol::render {

namespace {

/// Whether a layer finds its values.
bool isSound(const AovLayout& layout, const AovLayer& layer) {
  const std::size_t count = layer.channels.size(), width = layout.width;
  const bool hasValues = layer.first + count <= width;
  switch (layer.finish) {
    case AovFinish::mean:
      return hasValues;
    case AovFinish::share:
      return hasValues && layer.second < width;
    case AovFinish::meanVariance:
      return hasValues && layer.second + count <= width;
    case AovFinish::picture:
      return count == 3 || count == 4;
    case AovFinish::standardError:
    case AovFinish::pictureVariance:
      return count == 3;
    case AovFinish::sampleCount:
      return count == 1;
    case AovFinish::matte:
      return count == 4 && layer.second < layout.mattes.size();
  }
  return false;
}

}  // namespace

const AovLayer* AovLayout::find(const std::string& name) const {
  const auto at = std::find_if(layers.begin(), layers.end(), [&](const AovLayer& each) { return each.name == name; });
  return at == layers.end() ? nullptr : &*at;
}

std::string AovLayout::toText() const {
  std::string text;
  for (const AovLayer& layer : layers) {
    if (!text.empty()) text += ", ";
    text += layer.name;
    if (layer.quantity != layer.name) text += "=" + layer.quantity;
  }
  if (deep.isWanted()) text += (text.empty() ? "" : ", ") + ("deep, " + std::to_string(deep.slices()) + " slices");
  return text;
}

bool AovLayout::isSound() const {
  constexpr std::uint32_t most = 1 << 16;
  const bool hasMattes = std::all_of(mattes.begin(), mattes.end(), [&](const AovMatte& matte) {
    return matte.slot < width && matte.weightSlot < width;
  });
  const bool hasDeep = !deep.isWanted() || (deep.depths.size() <= most && deep.firstSlot + deep.width() <= width);
  return width <= most && hasMattes && deep.isSound() && hasDeep &&
         std::all_of(layers.begin(), layers.end(), [&](const AovLayer& layer) {
           return !layer.channels.empty() && layer.channels.size() <= most && layer.first <= most &&
                  layer.second <= most && render::isSound(*this, layer);
         });
}

}  // namespace aerosol::render
