#include "core/image/image.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>
#include <optional>

#include "core/image/module_access.h"
#include "core/image/pending_file.h"
#include "core/image/plain_image.h"

namespace aerosol::image {

namespace {

Diagnostic fileError(const std::string& path, std::string message, std::vector<std::string> notes = {}) {
  return {Severity::error, {path, 0, 0}, std::move(message), {}, std::move(notes)};
}

std::string extensionOf(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return extension;
}

bool canStore(const std::string& format, PixelType type) {
  if (type == PixelType::automatic) return true;
  if (format == "exr") return type == PixelType::float32 || type == PixelType::float16;
  if (format == "png") return type == PixelType::uint8 || type == PixelType::uint16;
  return type == PixelType::uint8;
}

/// What can be said without the libraries, and before a file is made.
std::optional<Diagnostic> findMistake(const std::string& path, const std::string& format, const ImageBuffer& image,
                                      const WriteOptions& options) {
  if (auto mistake = checkFileName(path)) return mistake;
  if (!canStore(format, options.pixelType)) return fileError(path, "." + format + " cannot hold this type of pixel");
  const auto count = static_cast<std::uint64_t>(std::max(image.width, 0)) *
                     static_cast<std::uint64_t>(std::max(image.height, 0)) * image.channels.size();
  if (count == 0 || count != image.pixels.size())
    return fileError(path, "the picture has no pixels or not all of them");
  for (const ImageLayer& layer : image.layers) {
    if (layer.channels.empty() || layer.pixels.size() != count / image.channels.size() * layer.channels.size())
      return fileError(path, "the layer '" + layer.name + "' has no pixels or not all of them");
  }
  if (options.jpegQuality < 1 || options.jpegQuality > 100) return fileError(path, "JPEG quality is from 1 to 100");
  return {};
}

}  // namespace

std::optional<Diagnostic> checkFileName(const std::string& path) {
  const std::string format = extensionOf(path);
  if (format == "exr" || format == "png" || format == "jpg" || format == "jpeg") return {};
  const std::string name = format.empty() ? "this name has no extension" : "cannot write ." + format + " files";
  return fileError(path, name, {"known are: .exr .png .jpg .jpeg"});
}

Result<WriteReport> writeImage(const std::string& path, const ImageBuffer& image, const WriteOptions& options) {
  const std::string format = extensionOf(path);
  if (const auto mistake = findMistake(path, format, image, options)) return *mistake;
  auto file = PendingFile::create(path);
  if (!file) return file.errors();
  const auto& module = table();
  if (!module) return module.errors();
  WriteReport report;
  std::string message = (*module)->write(file->path(), format, image, options, report);
  if (!message.empty()) return fileError(path, std::move(message));
  Diagnostics errors = file->commit();
  if (errors.hasErrors()) return errors;
  return report;
}

Result<ImageBuffer> readImage(const std::string& path) {
  const auto& module = table();
  if (!module) return module.errors();
  ImageBuffer image;
  std::string message = (*module)->read(path, image);
  if (!message.empty()) return fileError(path, std::move(message));
  return image;
}

Diagnostics writePlainImage(const std::string& path, const PlainImage& image, const PlainOptions& options) {
  Diagnostics errors;
  const std::string format = extensionOf(path);
  if (format.empty()) {
    errors.add(fileError(path, "this name has no extension that tells the format"));
    return errors;
  }
  auto file = PendingFile::create(path);
  if (!file) return file.errors();
  const auto& module = table();
  if (!module) return module.errors();
  std::string message = (*module)->writePlain(file->path(), format, image, options);
  if (!message.empty()) {
    errors.add(fileError(path, std::move(message)));
    return errors;
  }
  return file->commit();
}

Result<std::vector<std::string>> libraryVersions() {
  const auto& module = table();
  if (!module) return module.errors();
  return (*module)->versions();
}

}  // namespace aerosol::image
