#include "core/app/output_files.h"

#include <fmt/format.h>
#include <strings.h>
#include <unistd.h>

#include <fstream>
#include <set>

#include "core/app/pixel_format.h"
#include "core/image/pending_file.h"

namespace aerosol::app {

namespace fs = std::filesystem;

namespace {

bool isExr(const std::string& name) {
  const std::string extension = fs::path(name).extension().string();
  return extension.size() == 4 && strcasecmp(extension.c_str(), ".exr") == 0;
}

image::WriteOptions optionsFor(const std::string& name, const scene::Film& film, const image::DisplayOptions& display) {
  image::WriteOptions options;
  options.display = display;
  if (isExr(name) && film.componentFormat == scene::ComponentFormat::float16) {
    options.pixelType = image::PixelType::float16;
  }
  return options;
}

}  // namespace

std::vector<std::string> outputNames(const std::vector<std::string>& asked, const fs::path& scene) {
  if (!asked.empty()) return asked;
  return {scene.stem().string() + ".png"};
}

Diagnostics checkOutputNames(const std::vector<std::string>& names) {
  Diagnostics errors;
  std::set<fs::path> seen;
  for (const std::string& name : names) {
    if (auto mistake = image::checkFileName(name)) errors.add(std::move(*mistake));
    if (!seen.insert(fs::path(name).lexically_normal()).second)
      errors.error({name, 0, 0}, "this output is given twice");
  }
  return errors;
}

Diagnostics checkOutputPlaces(const std::vector<std::string>& names) {
  Diagnostics errors;
  for (const std::string& name : names) {
    const auto place = image::PendingFile::create(name);
    if (!place) errors.append(place.errors());
  }
  return errors;
}

Diagnostics tryOutputs(const std::vector<std::string>& names, const scene::Film& film,
                       const image::DisplayOptions& display) {
  Diagnostics errors;
  image::ImageBuffer dot;
  dot.width = dot.height = 1;
  dot.channels = {"R", "G", "B"};
  dot.pixels = {0, 0, 0};
  std::set<fs::path> tried;
  // How pictures are shown is asked for: it has to be there, even if no file shows one.
  std::vector<std::string> files = names;
  const bool asksForDisplay =
      !display.config.empty() || !display.workingSpace.empty() || !display.display.empty() || !display.view.empty();
  if (asksForDisplay && !names.empty()) files.push_back(fs::path(names.front()).replace_extension(".png").string());
  for (const std::string& name : files) {
    const fs::path probe =
        fs::path(name).parent_path() / fmt::format(".aerosol-try-{}{}", getpid(), fs::path(name).extension().string());
    if (!tried.insert(probe).second) continue;
    const auto written = image::writeImage(probe.string(), dot, optionsFor(name, film, display));
    std::error_code ignored;
    fs::remove(probe, ignored);
    if (written) continue;
    for (Diagnostic error : written.errors().entries()) {
      if (error.location.file == probe.string()) error.location.file = name;
      errors.add(std::move(error));
    }
  }
  return errors;
}

Diagnostics writeOutputs(const std::vector<std::string>& names, const image::ImageBuffer& picture,
                         const scene::Film& film, const image::DisplayOptions& display) {
  Diagnostics errors;
  for (const std::string& name : names) {
    const image::WriteOptions options = optionsFor(name, film, display);
    const bool asItIs =
        !isExr(name) || film.pixelFormat == scene::PixelFormat::rgb || film.pixelFormat == scene::PixelFormat::rgba;
    const auto written = image::writeImage(name, asItIs ? picture : inFormat(picture, film.pixelFormat), options);
    if (!written) errors.append(written.errors());
  }
  return errors;
}

Diagnostics writeTextFile(const std::string& name, const std::string& text) {
  auto file = image::PendingFile::create(name);
  if (!file) return file.errors();
  std::ofstream stream(file->path(), std::ios::binary);
  stream << text;
  stream.close();
  if (stream) return file->commit();
  Diagnostics errors;
  errors.error({name, 0, 0}, "cannot write this file");
  return errors;
}

}  // namespace aerosol::app
