#include "core/image/deep_image.h"

#include <numeric>

#include "core/image/module_access.h"
#include "core/image/pending_file.h"

namespace aerosol::image {

namespace {

Diagnostics deepError(const std::string& path, std::string message) {
  Diagnostics errors;
  errors.error({path, 0, 0}, std::move(message));
  return errors;
}

}  // namespace

std::optional<Diagnostic> checkDeepFileName(const std::string& path) {
  if (path.size() > 4 && path.ends_with(".exr")) return {};
  return Diagnostic{Severity::error, {path, 0, 0}, "deep images are written to .exr files alone", {}, {}};
}

Diagnostics writeDeepImage(const std::string& path, const DeepImage& image) {
  if (const auto mistake = checkDeepFileName(path)) {
    Diagnostics errors;
    errors.add(*mistake);
    return errors;
  }
  const std::uint64_t samples = std::accumulate(image.counts.begin(), image.counts.end(), std::uint64_t{0});
  const auto pixels =
      static_cast<std::uint64_t>(std::max(image.width, 0)) * static_cast<std::uint64_t>(std::max(image.height, 0));
  if (pixels == 0 || pixels != image.counts.size() || samples * image.channels.size() != image.values.size())
    return deepError(path, "the deep image has no pixels or not all of its samples");
  auto file = PendingFile::create(path);
  if (!file) return file.errors();
  const auto& module = table();
  if (!module) return module.errors();
  if (std::string message = (*module)->writeDeep(file->path(), image); !message.empty())
    return deepError(path, std::move(message));
  return file->commit();
}

Result<DeepImage> readDeepImage(const std::string& path) {
  const auto& module = table();
  if (!module) return module.errors();
  DeepImage image;
  if (std::string message = (*module)->readDeep(path, image); !message.empty())
    return deepError(path, std::move(message));
  return image;
}

}  // namespace aerosol::image
