// What the module of image libraries offers the program. Both are of one build; no function throws.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/color_source.h"
#include "core/base/texture_source.h"
#include "core/image/deep_image.h"
#include "core/image/image.h"
#include "core/image/plain_image.h"

namespace aerosol::image {

/// Each function returns an error message; empty when all went well.
struct ModuleTable {
  /// Writes to `path` in the format that the extension `format` (lower case, no dot) names.
  std::string (*write)(const std::string& path, const std::string& format, const ImageBuffer& image,
                       const WriteOptions& options, WriteReport& report);
  std::string (*read)(const std::string& path, ImageBuffer& image);
  std::vector<std::string> (*versions)();
  /// Null, with a message, when the settings are refused.
  std::unique_ptr<TextureSource> (*textures)(const TextureSettings& settings, std::string& message);
  /// Null, with a message, when the settings are refused.
  std::unique_ptr<ColorSource> (*colors)(const ColorSettings& settings, std::string& message);
  /// Writes to `path` in the format that `format` (an extension) names.
  std::string (*writePlain)(const std::string& path, const std::string& format, const PlainImage& image,
                            const PlainOptions& options);
  std::string (*writeDeep)(const std::string& path, const DeepImage& image);
  std::string (*readDeep)(const std::string& path, DeepImage& image);
};

/// The name and type of the module's only exported function.
constexpr const char* moduleTableName = "aerosolImageModule";
using ModuleTableFunction = const ModuleTable*();

}  // namespace aerosol::image
