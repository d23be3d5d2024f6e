#include "core/app/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "core/app/command_line.h"
#include "core/app/version_command.h"
#include "core/base/code_version.h"
#include "core/base/hash.h"
#include "core/jit/compiler.h"

namespace aerosol::app {

namespace {

constexpr std::string_view pixelFormats[] = {"rgb", "rgba", "luminance", "luminance_alpha", "xyz", "xyza"};

std::optional<scene::PixelFormat> formatNamed(const std::string* word) {
  const auto found = std::find(std::begin(pixelFormats), std::end(pixelFormats), word ? *word : "");
  if (found == std::end(pixelFormats)) return {};
  return static_cast<scene::PixelFormat>(found - std::begin(pixelFormats));
}

/// A program's hash that does not depend on where its files are.
std::string hashAnywhere(lang::Program program) {
  for (SourceLocation& location : program.locations) location.file.clear();
  return jit::hashProgram(program);
}

void addSorted(StrongHash& hash, std::vector<std::string> pieces) {
  std::sort(pieces.begin(), pieces.end());
  hash.add(pieces.size());
  for (const std::string& piece : pieces) hash.add(piece);
}

std::string identityOf(const RenderArguments& arguments, const scene::SceneDescription& description,
                       const render::PreparedScene& scene) {
  StrongHash hash;
  std::vector<std::string> texts, meshes, programs;
  for (const auto& [name, text] : description.sources->all()) texts.push_back(StrongHash().add(text->text()).hex());
  std::map<std::filesystem::path, std::string> hashes;
  for (const scene::Shape& shape : description.shapes) {
    if (shape.file.empty()) continue;
    const auto [known, isNew] = hashes.try_emplace(shape.file);
    if (isNew) known->second = hashFile(shape.file).value_or("");
    meshes.push_back(known->second);
  }
  for (const shading::Family& family : scene.shading.families()) programs.push_back(hashAnywhere(*family.program));
  addSorted(hash, std::move(texts));
  addSorted(hash, std::move(meshes));
  addSorted(hash, std::move(programs));
  hash.add(arguments.defines.size());
  for (const auto& [name, value] : arguments.defines) hash.add(name).add(value);
  hash.add(arguments.overrides.size());
  for (const std::string& change : arguments.overrides) hash.add(change);
  hash.add(arguments.sensor);
  addSorted(hash, arguments.without);
  hash.add(static_cast<std::uint64_t>(description.sampler.seed));
  hash.add(render::toText(scene.samplingPlan));
  hash.add(arguments.transmittance ? 1 + static_cast<std::uint64_t>(*arguments.transmittance) : 0);
  hash.add(static_cast<std::uint64_t>(arguments.noEquiangular));
  hash.add(arguments.distance ? 1 + static_cast<std::uint64_t>(*arguments.distance) : 0);
  hash.add(fmt::format("{}", description.integrator.stepScale));
  hash.add(static_cast<std::uint64_t>(arguments.adaptive));
  return hash.hex();
}

template <class T>
const T* findValue(const image::ImageBuffer& picture, const char* key) {
  for (const image::Metadata& entry : picture.metadata) {
    if (entry.key == key) return std::get_if<T>(&entry.value);
  }
  return nullptr;
}

}  // namespace

Job describeJob(const RenderArguments& arguments, const scene::SceneDescription& description,
                const render::PreparedScene& scene) {
  return {.identity = identityOf(arguments, description, scene),
          .embreeIsa = scene.geometry->isa(),
          .code = fmt::format("{} {}", programVersion(), codeVersion().substr(0, 16)),
          .aovs = scene.aovs ? scene.aovs->layout.toText() : "",
          .sampleCount = description.sampler.sampleCount,
          .film = description.film};
}

std::vector<image::Metadata> jobMetadata(const Job& job) {
  const scene::Film& film = job.film;
  std::vector<image::Metadata> metadata = {
      {"aerosol:job", job.identity},
      {"aerosol:embreeIsa", job.embreeIsa},
      {"aerosol:code", job.code},
      {"aerosol:sampleCount", static_cast<std::int32_t>(job.sampleCount)},
      {"aerosol:window",
       fmt::format("{},{},{},{}", film.cropOffsetX, film.cropOffsetY, film.croppedWidth(), film.croppedHeight())},
      {"aerosol:component",
       std::string(film.componentFormat == scene::ComponentFormat::float16 ? "float16" : "float32")},
      {"aerosol:pixelFormat", std::string(pixelFormats[static_cast<std::size_t>(film.pixelFormat)])}};
  if (!job.aovs.empty()) metadata.push_back({"aerosol:aovs", job.aovs});
  return metadata;
}

std::optional<Job> jobOf(const image::ImageBuffer& picture) {
  const auto* identity = findValue<std::string>(picture, "aerosol:job");
  const auto* isa = findValue<std::string>(picture, "aerosol:embreeIsa");
  const auto* code = findValue<std::string>(picture, "aerosol:code");
  const auto* samples = findValue<std::int32_t>(picture, "aerosol:sampleCount");
  const auto* window = findValue<std::string>(picture, "aerosol:window");
  const auto* component = findValue<std::string>(picture, "aerosol:component");
  const auto crop = window ? parseCrop(*window) : std::nullopt;
  const auto format = formatNamed(findValue<std::string>(picture, "aerosol:pixelFormat"));
  if (!identity || !isa || !code || !samples || !component || !crop || !format) return {};
  const auto* aovs = findValue<std::string>(picture, "aerosol:aovs");
  Job job{*identity, *isa, *code, aovs ? *aovs : "", *samples, {}};
  job.film.width = picture.fullWidth;
  job.film.height = picture.fullHeight;
  job.film.cropOffsetX = crop->x;
  job.film.cropOffsetY = crop->y;
  job.film.cropWidth = crop->width;
  job.film.cropHeight = crop->height;
  if (*component == "float16") job.film.componentFormat = scene::ComponentFormat::float16;
  job.film.pixelFormat = *format;
  return job;
}

}  // namespace aerosol::app
