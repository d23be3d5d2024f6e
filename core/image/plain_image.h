// Arrays of numbers as image files: no display transform, no colour management but what a file's kind implies.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/base/diagnostic.h"

namespace aerosol::image {

/// Rows from the top, channels interleaved: width * height * channels values.
struct PlainImage {
  int width = 0, height = 0, channels = 0;
  std::variant<std::vector<float>, std::vector<std::int32_t>> values;
};

struct PlainOptions {
  enum class Type : std::uint8_t { asIs, uint8, float16, float32 };
  Type type = Type::asIs;   ///< Integers hold [0, 1]; `asIs` is the type of the values where the format has it.
  bool encodeSrgb = false;  ///< The first three channels are linear and are stored with the sRGB curve.
};

/// Writes any format that OpenImageIO knows, told by the extension. The file is there completely or not at all.
Diagnostics writePlainImage(const std::string& path, const PlainImage& image, const PlainOptions& options);

}  // namespace aerosol::image
