// Reading and writing through OpenImageIO. Internal to the module.
#pragma once

#include <cstddef>
#include <string>

#include "core/image/deep_image.h"
#include "core/image/image.h"
#include "core/image/plain_image.h"

namespace aerosol::image {

/// The part of an EXR that holds an attachment, and its largest width.
inline constexpr const char* attachmentName = "aerosol.attachment";
inline constexpr std::size_t attachmentWidth = 4096;

/// See ModuleTable.
std::string writeFile(const std::string& path, const std::string& format, const ImageBuffer& image,
                      const WriteOptions& options, WriteReport& report);
std::string readFile(const std::string& path, ImageBuffer& image);
std::string writePlainFile(const std::string& path, const std::string& format, const PlainImage& image,
                           const PlainOptions& options);
std::string writeDeepFile(const std::string& path, const DeepImage& image);
std::string readDeepFile(const std::string& path, DeepImage& image);

}  // namespace aerosol::image
