// The texture files in use, each opened once for all threads. Internal to the module.
#pragma once

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/texture_source.h"

namespace aerosol::image {

/// In the place of a colour space: colours as the file has them, not multiplied by its alpha.
inline constexpr std::string_view straightAlpha = "straight alpha";

/// A file, or a pattern that stands for the tiles of a UDIM set.
struct TextureFile {
  OIIO::TextureSystem::TextureHandle* handle = nullptr;  ///< Null when the name is no readable file.
  bool isUdim = false;
  std::string convertedFrom;  ///< The colour space, of a UDIM set whose tiles are converted; empty: none is.
  std::string problem;        ///< Why it cannot be read: the same text whoever asks first.

  std::once_flag rangeOnce;
  std::optional<TextureRange> range;
};

class TextureFiles {
 public:
  /// Owns an OpenImageIO texture system with a cache of its own.
  explicit TextureFiles(const TextureSettings& settings);
  ~TextureFiles();
  TextureFiles(const TextureFiles&) = delete;
  TextureFiles& operator=(const TextureFiles&) = delete;

  OIIO::TextureSystem& system() { return *system_; }

  /// Opens the file when nobody has yet. The result stays valid. `colorSpace` as in TexturePoint: of a UDIM set each
  /// tile is a file of its own.
  TextureFile& open(std::string_view name, std::string_view colorSpace);
  const std::optional<TextureRange>& range(TextureFile& file);

 private:
  TextureFile& openAsItIs(std::string_view name);
  void convert(TextureFile& file, const TextureFile& plain, std::string_view name, std::string_view colorSpace);

  ColorSettings colorSettings_;
  std::unique_ptr<ColorSource> colors_;
  std::string colorProblem_;
  OIIO::ImageCache* cache_ = nullptr;
  OIIO::TextureSystem* system_ = nullptr;
  std::mutex mutex_;
  std::map<std::string, std::unique_ptr<TextureFile>, std::less<>> files_;
};

}  // namespace aerosol::image
