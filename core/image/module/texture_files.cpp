#include "core/image/module/texture_files.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/image/module/color_config.h"
#include "core/image/module/converted_input.h"

namespace aerosol::image {

namespace {

using OIIO::ustring;

/// Widens a range by all texels of one level. False when they cannot be read.
bool addLevel(OIIO::ImageCache& cache, ustring name, int subimage, int level, TextureRange& range) {
  OIIO::ImageSpec spec;
  if (!cache.get_imagespec(name, spec, subimage, level) || spec.nchannels < 1) return false;
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  if (range.least.size() < channels) {
    range.least.resize(channels, std::numeric_limits<float>::infinity());
    range.greatest.resize(channels, -std::numeric_limits<float>::infinity());
  }
  constexpr int rows = 64;
  std::vector<float> texels(channels * static_cast<std::size_t>(spec.width) * rows);
  for (int z = spec.z; z < spec.z + spec.depth; ++z) {
    for (int y = spec.y; y < spec.y + spec.height; y += rows) {
      const int end = std::min(y + rows, spec.y + spec.height);
      if (!cache.get_pixels(name, subimage, level, spec.x, spec.x + spec.width, y, end, z, z + 1, OIIO::TypeDesc::FLOAT,
                            texels.data())) {
        return false;
      }
      const std::size_t count = channels * static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(end - y);
      for (std::size_t i = 0; i < count; ++i) {
        const float value = texels[i];
        if (std::isnan(value)) {
          range.hasNan = true;
          continue;
        }
        range.least[i % channels] = std::min(range.least[i % channels], value);
        range.greatest[i % channels] = std::max(range.greatest[i % channels], value);
      }
    }
  }
  return true;
}

bool addFile(OIIO::ImageCache& cache, ustring name, TextureRange& range) {
  int subimages = 0;
  if (!cache.get_image_info(name, 0, 0, ustring("subimages"), OIIO::TypeInt, &subimages)) return false;
  for (int subimage = 0; subimage < subimages; ++subimage) {
    int levels = 0;
    if (!cache.get_image_info(name, subimage, 0, ustring("miplevels"), OIIO::TypeInt, &levels)) return false;
    for (int level = 0; level < levels; ++level) {
      if (!addLevel(cache, name, subimage, level, range)) return false;
    }
  }
  return true;
}

std::optional<TextureRange> findRange(OIIO::TextureSystem& system, const TextureFile& file) {
  if (!file.handle || !file.convertedFrom.empty()) return {};
  std::vector<ustring> names;
  if (file.isUdim) {
    int columns = 0, rows = 0;
    system.inventory_udim(system.filename_from_handle(file.handle), names, columns, rows);
    std::erase(names, ustring());
  } else {
    names.push_back(system.filename_from_handle(file.handle));
  }
  TextureRange range;
  OIIO::ImageCache& cache = *system.imagecache();
  for (const ustring& name : names) {
    if (!addFile(cache, name, range)) {
      (void)cache.geterror();
      return {};
    }
  }
  return range;
}

}  // namespace

TextureFiles::TextureFiles(const TextureSettings& settings)
    : colorSettings_(settings.colors),
      cache_(OIIO::ImageCache::create(false)),
      system_(OIIO::TextureSystem::create(false, cache_)) {
  std::string path;
  for (const std::string& folder : settings.searchPath) path += (path.empty() ? "" : ":") + folder;
  if (!path.empty()) system_->attribute("searchpath", path);
  system_->attribute("max_memory_MB", static_cast<float>(settings.memory_MB));
  // Plain image files get tiles and levels when they are read, so that they are filtered like prepared textures.
  system_->attribute("autotile", 64);
  system_->attribute("automip", 1);
}

/// A texture system that makes its own cache leaves the tiles behind when it goes.
TextureFiles::~TextureFiles() {
  OIIO::TextureSystem::destroy(system_);
  OIIO::ImageCache::destroy(cache_);
}

TextureFile& TextureFiles::open(std::string_view name, std::string_view colorSpace) {
  const std::lock_guard lock(mutex_);
  if (colorSpace.empty()) return openAsItIs(name);
  const std::string key = std::string(name) + "\n" + std::string(colorSpace);
  if (const auto known = files_.find(key); known != files_.end()) return *known->second;
  const TextureFile& plain = openAsItIs(name);
  auto& file = *(files_[key] = std::make_unique<TextureFile>());
  file.isUdim = plain.isUdim;
  file.problem = plain.problem;
  if (plain.handle) convert(file, plain, name, colorSpace);
  return file;
}

void TextureFiles::convert(TextureFile& file, const TextureFile& plain, std::string_view name,
                           std::string_view colorSpace) {
  const bool isStraight = colorSpace == straightAlpha;
  if (!isStraight && !colors_ && colorProblem_.empty()) colors_ = makeColors(colorSettings_, colorProblem_);
  std::string problem = colorProblem_;
  const ColorTransform* const transform =
      colors_ && !isStraight ? colors_->between(colorSpace, "rgb", problem) : nullptr;
  if (!transform && !isStraight) {
    file.problem = "cannot convert the texture \"" + std::string(name) + "\": " + problem;
    return;
  }
  if (plain.isUdim) {
    file.handle = plain.handle;
    file.convertedFrom = colorSpace;
    return;
  }
  const ustring converted(std::string(name) + "?colorspace=" + std::string(colorSpace));
  addConverted(*cache_, converted, system_->resolve_filename(system_->filename_from_handle(plain.handle).string()),
               transform);
  file.handle = system_->get_texture_handle(converted);
  if (file.handle && system_->good(file.handle)) return;
  file.handle = nullptr;
  file.problem = "cannot read the texture \"" + std::string(name) + "\": " + system_->geterror();
}

TextureFile& TextureFiles::openAsItIs(std::string_view name) {
  if (const auto known = files_.find(name); known != files_.end()) return *known->second;
  auto& file = *(files_[std::string(name)] = std::make_unique<TextureFile>());
  const ustring text(name);
  file.isUdim = system_->is_udim(text);
  if (name.empty()) {
    file.problem = "the name of the texture is empty";
    return file;
  }
  int exists = 0;
  const bool known = system_->get_texture_info(text, 0, ustring("exists"), OIIO::TypeInt, &exists) && exists != 0;
  const std::string message = system_->geterror();
  if (known) {
    file.handle = system_->get_texture_handle(text);
  }
  if (!file.handle || !system_->good(file.handle)) {
    file.handle = nullptr;
    std::string detail = message.empty() ? system_->geterror() : message;
    if (OIIO::ImageSpec spec; detail.empty() && !system_->get_imagespec(text, 0, spec)) detail = system_->geterror();
    file.problem = "cannot read the texture \"" + std::string(name) + "\"" + (detail.empty() ? "" : ": " + detail);
    (void)system_->geterror();
  }
  return file;
}

const std::optional<TextureRange>& TextureFiles::range(TextureFile& file) {
  std::call_once(file.rangeOnce, [&] { file.range = findRange(*system_, file); });
  return file.range;
}

}  // namespace aerosol::image
