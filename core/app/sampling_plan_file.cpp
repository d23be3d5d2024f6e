#include "core/app/sampling_plan_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/image/image.h"

namespace aerosol::app {

namespace {

Diagnostic fileError(const std::string& name, std::string message, std::vector<std::string> notes = {}) {
  return {Severity::error, {name, 0, 0}, std::move(message), {}, std::move(notes)};
}

}  // namespace

Result<render::SamplingPlan> readSamplingPlan(const std::string& name) {
  if (std::filesystem::path(name).extension() == ".exr") {
    const auto picture = image::readImage(name);
    if (!picture) return picture.errors();
    for (const image::Metadata& entry : picture->metadata) {
      const auto* text = std::get_if<std::string>(&entry.value);
      if (entry.key == "aerosol:sampling" && text) return render::parseSamplingPlan(*text, name);
    }
    return fileError(name, "this image does not say how its media were sampled",
                     {"aerosol render writes it into EXR files of scenes with media"});
  }
  std::ifstream file(name);
  if (!file) return fileError(name, "this file cannot be read");
  std::ostringstream text;
  text << file.rdbuf();
  return render::parseSamplingPlan(text.str(), name);
}

}  // namespace aerosol::app
