#include "core/render/aov/aov_layout.h"

#include <algorithm>

namespace aerosol::render {

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
  return text;
}

bool AovLayout::isSound() const {
  constexpr std::uint32_t most = 1 << 16;
  return width <= most && std::all_of(layers.begin(), layers.end(), [&](const AovLayer& layer) {
           const std::size_t count = layer.channels.size();
           if (count == 0 || count > most || layer.first > width || layer.second > width) return false;
           switch (layer.finish) {
             case AovFinish::mean:
               return layer.first + count <= width;
             case AovFinish::share:
               return layer.first + count <= width && layer.second < width;
             case AovFinish::meanVariance:
               return layer.first + count <= width && layer.second + count <= width;
             case AovFinish::picture:
               return count == 3 || count == 4;
             case AovFinish::standardError:
             case AovFinish::pictureVariance:
               return count == 3;
             case AovFinish::sampleCount:
               return count == 1;
           }
           return false;
         });
}

}  // namespace aerosol::render
