#include "core/app/denoise_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/app/output_files.h"
#include "core/app/quantity.h"
#include "core/image/denoise.h"

namespace aerosol::app {

namespace {

using image::ImageBuffer;
using image::ImageLayer;

const ImageLayer* find(const ImageBuffer& picture, const std::string& name) {
  const auto at = std::find_if(picture.layers.begin(), picture.layers.end(),
                               [&](const ImageLayer& each) { return each.name == name; });
  return at == picture.layers.end() ? nullptr : &*at;
}

/// Channels in the order of `letters`, which come last in the names of the file: formats sort them as they like. Values
/// that are not finite become 0.
image::Raster rasterOf(const ImageBuffer& picture, const ImageLayer& layer, std::string_view letters) {
  const std::size_t pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  image::Raster raster{static_cast<int>(letters.size()), std::vector<float>(pixels * letters.size())};
  for (std::size_t c = 0; c < letters.size(); ++c) {
    const auto at = std::find_if(layer.channels.begin(), layer.channels.end(),
                                 [&](const std::string& name) { return name.back() == letters[c]; });
    if (at == layer.channels.end()) continue;
    const auto from = static_cast<std::size_t>(at - layer.channels.begin());
    for (std::size_t i = 0; i < pixels; ++i) {
      const float value = layer.pixels[i * layer.channels.size() + from];
      raster.values[i * letters.size() + c] = std::isfinite(value) ? value : 0.0f;
    }
  }
  return raster;
}

/// What follows the edges of the picture, as far as the file has it.
void addFeatures(const ImageBuffer& picture, image::DenoiseInput& input) {
  const auto add = [&](const char* name, const char* otherwise, std::string_view letters) {
    const ImageLayer* layer = find(picture, name);
    const ImageLayer* variance = layer ? find(picture, std::string(name) + "_variance") : nullptr;
    if (!layer) layer = find(picture, otherwise);
    if (!layer) return;
    image::DenoiseFeature& feature = input.features.emplace_back();
    feature.mean = rasterOf(picture, *layer, letters);
    if (variance) feature.variance = rasterOf(picture, *variance, letters);
  };
  add("visible_albedo", "albedo", "RGB");
  add("visible_normal", "sh_normal", "XYZ");
  add("visible_depth", "depth", "T");
}

/// What this program and Cryptomatte wrote. The rest is the format's own, which writing makes anew.
void keepOurs(std::vector<image::Metadata>& metadata) {
  std::erase_if(metadata, [](const image::Metadata& entry) {
    return !entry.key.starts_with("aerosol:") && !entry.key.starts_with("cryptomatte/") && entry.key != "Software" &&
           entry.key != "DateTime";
  });
}

/// Replaces red, green and blue.
void putBack(ImageBuffer& picture, const image::Raster& result) {
  for (std::size_t c = 0; c < 3; ++c) {
    const auto at = std::find(picture.channels.begin(), picture.channels.end(), std::string(1, "RGB"[c]));
    const auto to = static_cast<std::size_t>(at - picture.channels.begin());
    for (std::size_t i = 0; i < result.values.size() / 3; ++i)
      picture.pixels[i * picture.channels.size() + to] = result.values[3 * i + c];
  }
}

}  // namespace

ExitCode denoiseCommand(const DenoiseArguments& arguments, const Console& console) {
  const auto accept = [&](const Diagnostics& diagnostics) {
    console.report(diagnostics);
    return !diagnostics.hasErrors();
  };
  if (!accept(checkOutputNames(arguments.outputs))) return ExitCode::usage;
  if (!accept(checkOutputPlaces(arguments.outputs))) return ExitCode::badInput;
  auto read = image::readImage(arguments.input);
  if (!read) {
    accept(read.errors());
    return ExitCode::badInput;
  }
  ImageBuffer& picture = *read;
  const ImageLayer *const a = find(picture, "half_a"), *const b = find(picture, "half_b"),
                          *const variance = find(picture, "variance");
  const bool hasColors = std::all_of(std::begin("RGB"), std::end("RGB") - 1, [&](char c) {
    return std::find(picture.channels.begin(), picture.channels.end(), std::string(1, c)) != picture.channels.end();
  });
  if (!a || !b || !variance || !hasColors) {
    console.report(Diagnostic{Severity::error,
                              {arguments.input, 0, 0},
                              "this image does not tell its noise",
                              {},
                              {"render it with --aov denoise"}});
    return ExitCode::badInput;
  }
  image::DenoiseInput input{
      .width = picture.width, .height = picture.height, .halfA = {}, .halfB = {}, .variance = {}, .features = {}};
  input.halfA = rasterOf(picture, *a, "RGB");
  input.halfB = rasterOf(picture, *b, "RGB");
  input.variance = rasterOf(picture, *variance, "RGB");
  addFeatures(picture, input);
  const auto start = std::chrono::steady_clock::now();
  const int threads =
      arguments.threads > 0 ? arguments.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  putBack(picture, image::denoise(input, {.threads = threads,
                                          .windowRadius = arguments.radius,
                                          .patchRadius = 3,
                                          .strength = arguments.strength}));
  picture.attachment.clear();  // These would be the sums of the noisy picture.
  keepOurs(picture.metadata);
  for (ImageLayer& each : picture.layers) keepOurs(each.metadata);
  picture.metadata.push_back(
      {"aerosol:denoised", fmt::format("radius {} strength {}", arguments.radius, arguments.strength)});
  scene::Film style;
  if (!accept(writeOutputs(arguments.outputs, picture, style, arguments.display))) return ExitCode::badInput;
  if (!arguments.quiet) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const std::string& name : arguments.outputs)
      console.note(
          fmt::format("wrote {}: {} x {} pixels, {}\n", name, picture.width, picture.height, formatDuration(seconds)));
  }
  return ExitCode::success;
}

}  // namespace aerosol::app
