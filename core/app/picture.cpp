#include "core/app/picture.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <string>

#include "core/app/version_command.h"
#include "core/render/aov/aov_pixels.h"
#include "core/scene/field.h"

namespace aerosol::app {

namespace {

const char* nameOf(scene::SamplerType type) { return type == scene::SamplerType::sobol ? "sobol" : "independent"; }

const char* nameOf(scene::FilterType type) {
  switch (type) {
    case scene::FilterType::box:
      return "box";
    case scene::FilterType::tent:
      return "tent";
    case scene::FilterType::mitchell:
      return "mitchell";
    case scene::FilterType::catmullrom:
      return "catmullrom";
    case scene::FilterType::lanczos:
      return "lanczos";
    case scene::FilterType::gaussian:
      break;
  }
  return "gaussian";
}

/// The word that scenes have for it.
template <class Choice>
const char* wordOf(Choice choice) {
  return scene::Words<Choice>::words[static_cast<std::size_t>(choice)];
}

std::string describeDefines(const std::map<std::string, std::string>& defines) {
  std::string text;
  for (const auto& [name, value] : defines) text += (text.empty() ? "" : " ") + name + "=" + value;
  return text;
}

/// The place of a metadata list at which entries under "aerosol:" are added.
class Entries {
 public:
  explicit Entries(std::vector<image::Metadata>& list) : list_(list) {}

  void add(const char* key, std::string text) { list_.push_back({name(key), std::move(text)}); }
  void add(const char* key, int number) { list_.push_back({name(key), static_cast<std::int32_t>(number)}); }
  void add(const char* key, double number) { list_.push_back({name(key), number}); }

 private:
  static std::string name(const char* key) { return std::string("aerosol:") + key; }

  std::vector<image::Metadata>& list_;
};

}  // namespace

render::PixelRect cropOf(const scene::Film& film) {
  return {film.cropOffsetX, film.cropOffsetY, film.cropOffsetX + film.croppedWidth(),
          film.cropOffsetY + film.croppedHeight()};
}

SampleCounts countSamples(const render::Film& film) {
  SampleCounts counts;
  counts.minimum = std::numeric_limits<std::uint32_t>::max();
  for (int y = film.area().y0; y < film.area().y1; ++y) {
    for (int x = film.area().x0; x < film.area().x1; ++x) {
      const auto count = static_cast<std::uint32_t>(film.pixel(x, y).count());
      counts.total += count;
      counts.minimum = std::min(counts.minimum, count);
      counts.maximum = std::max(counts.maximum, count);
    }
  }
  counts.mean = static_cast<double>(counts.total) / static_cast<double>(film.area().pixelCount());
  return counts;
}

std::vector<image::Metadata> describeRender(const RenderRecord& record, const SampleCounts& counts) {
  const scene::SceneDescription& description = record.description;
  std::vector<image::Metadata> metadata;
  metadata.push_back({"Software", fmt::format("Aerosol {}", programVersion())});
  metadata.push_back({"DateTime", fmt::format("{:%Y:%m:%d %H:%M:%S}", fmt::localtime(std::time(nullptr)))});

  Entries entries(metadata);
  entries.add("version", programVersion());
  entries.add("scene", record.arguments.scene.filename().string());
  if (!record.arguments.defines.empty()) entries.add("defines", describeDefines(record.arguments.defines));
  if (!record.arguments.overrides.empty()) {
    entries.add("overrides", fmt::format("{}", fmt::join(record.arguments.overrides, " ")));
  }
  if (!record.arguments.sensor.empty()) entries.add("sensor", record.arguments.sensor);
  if (!record.arguments.without.empty()) {
    entries.add("without", fmt::format("{}", fmt::join(record.arguments.without, " ")));
  }
  entries.add("spp", counts.mean);
  entries.add("sppMinimum", static_cast<int>(counts.minimum));
  entries.add("sppMaximum", static_cast<int>(counts.maximum));
  entries.add("samples", static_cast<double>(counts.total));
  entries.add("firstSample", static_cast<int>(record.range.first));
  entries.add("endSample", static_cast<int>(record.range.end));
  const render::PixelRect area = cropOf(description.film);
  entries.add("crop", fmt::format("{},{},{},{}", area.x0, area.y0, area.width(), area.height()));
  entries.add("interrupted", record.report.interrupted ? 1 : 0);
  entries.add("sampler", nameOf(description.sampler.type));
  entries.add("seed", description.sampler.seed);
  entries.add("filter", fmt::format("{} {}", nameOf(description.film.filter.type), description.film.filter.radius));
  entries.add("integrator", description.integrator.type);
  entries.add("maxDepth", description.integrator.maxDepth);
  entries.add("rrDepth", description.integrator.rrDepth);
  entries.add("roulette", wordOf(description.integrator.roulette));
  entries.add("distance", wordOf(description.integrator.distance));
  entries.add("transmittance", wordOf(description.integrator.transmittance));
  entries.add("equiangular", description.integrator.equiangular ? 1 : 0);
  entries.add("splitLights", static_cast<double>(description.integrator.splitLights));
  entries.add("jointLights", description.integrator.jointLights ? 1 : 0);
  entries.add("volumeLights", description.integrator.volumeLights ? 1 : 0);
  entries.add("lampDirections", description.integrator.lampDirections ? 1 : 0);
  if (!record.scene.samplingPlan.empty()) entries.add("sampling", render::toText(record.scene.samplingPlan));
  entries.add("stepScale", static_cast<double>(description.integrator.stepScale));
  entries.add("renderSeconds", record.secondsBefore + record.report.seconds);
  entries.add("shaderIsa", std::string(jit::name(record.target.isa)));
  entries.add("shaderWidth", record.target.width);
  return metadata;
}

image::ImageBuffer makePicture(const render::Film& film, const scene::Film& described) {
  image::ImageBuffer picture;
  picture.width = film.area().width();
  picture.height = film.area().height();
  picture.originX = film.area().x0;
  picture.originY = film.area().y0;
  picture.fullWidth = described.width;
  picture.fullHeight = described.height;
  picture.channels = {"R", "G", "B"};
  picture.pixels = film.rgba();
  if (hasAlpha(described.pixelFormat)) {
    picture.channels.push_back("A");
    return picture;
  }
  for (std::size_t i = 0; i < film.area().pixelCount(); ++i) {
    std::copy_n(picture.pixels.begin() + static_cast<std::ptrdiff_t>(4 * i), 3,
                picture.pixels.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  picture.pixels.resize(3 * film.area().pixelCount());
  return picture;
}

namespace {

/// What programs know a Cryptomatte by.
std::vector<image::Metadata> matteMetadata(const render::Film& film, const render::AovLayer& layer) {
  std::vector<image::Metadata> metadata;
  if (layer.finish != render::AovFinish::matte) return metadata;
  const render::AovMatte& matte = film.layout().mattes[layer.second];
  for (render::MatteMetadata& entry : render::matteMetadata(matte.name, matte.names))
    metadata.push_back({std::move(entry.key), std::move(entry.value)});
  return metadata;
}

}  // namespace

std::vector<image::ImageLayer> makeLayers(const render::Film& film) {
  std::vector<image::ImageLayer> layers;
  for (const render::AovLayer& layer : film.layout().layers)
    layers.push_back(
        {layer.name, layer.channels, render::layerPixels(film, layer), layer.isData, matteMetadata(film, layer)});
  return layers;
}

}  // namespace aerosol::app
