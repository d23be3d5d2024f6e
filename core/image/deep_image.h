// Deep images: pixels as lists of samples along depth, in OpenEXR files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image/image.h"

namespace aerosol::image {

/// As ImageBuffer, with any number of samples a pixel. Colours are multiplied by alpha; "Z" and "ZBack" are depths.
struct DeepImage {
  int width = 0, height = 0;
  int originX = 0, originY = 0, fullWidth = 0, fullHeight = 0;
  std::vector<std::string> channels;  ///< Such as R, G, B, A, Z, ZBack.
  std::vector<std::uint32_t> counts;  ///< Samples of each pixel, row by row from the top.
  std::vector<float> values;          ///< Sample after sample, channels interleaved.
  std::vector<Metadata> metadata;
};

/// What is wrong with the name of a deep image: only .exr files can be deep.
std::optional<Diagnostic> checkDeepFileName(const std::string& path);

/// Writes values as float32, without loss. The file is there completely or not at all. Errors name the file.
Diagnostics writeDeepImage(const std::string& path, const DeepImage& image);

/// Reads what `writeDeepImage` or another program wrote. An error when the file is not deep.
Result<DeepImage> readDeepImage(const std::string& path);

}  // namespace aerosol::image
