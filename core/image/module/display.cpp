#include "core/image/module/display.h"

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/image/module/color_config.h"

namespace aerosol::image {

namespace {

namespace ocio = OCIO_NAMESPACE;

struct DisplayView {
  std::string source, display, view;
};

/// Fills in what is empty and checks the names; returns an error message.
std::string resolve(const ocio::Config& config, const DisplayOptions& options, DisplayView& names) {
  names.source = options.workingSpace.empty() ? ocio::ROLE_SCENE_LINEAR : options.workingSpace;
  if (!config.getColorSpace(names.source.c_str())) {
    return "the OCIO config has no colour space '" + names.source + "'; it has " +
           joinNames(config.getNumColorSpaces(), [&](int i) { return config.getColorSpaceNameByIndex(i); });
  }
  names.display = options.display.empty() ? config.getDefaultDisplay() : options.display;
  const int views = config.getNumViews(names.display.c_str());
  if (views == 0) {
    return "the OCIO config has no display '" + names.display + "'; it has " +
           joinNames(config.getNumDisplays(), [&](int i) { return config.getDisplay(i); });
  }
  names.view = options.view.empty() ? config.getDefaultView(names.display.c_str()) : options.view;
  for (int i = 0; i < views; ++i) {
    if (names.view == config.getView(names.display.c_str(), i)) return {};
  }
  return "the display '" + names.display + "' has no view '" + names.view + "'; it has " +
         joinNames(views, [&](int i) { return config.getView(names.display.c_str(), i); });
}

/// The index of each channel of the picture, or -1.
struct Layout {
  int red = -1, green = -1, blue = -1, alpha = -1;
  bool isGrey = false;
};

Layout findChannels(const ImageBuffer& image) {
  const auto find = [&](const char* name) {
    const auto at = std::ranges::find(image.channels, name);
    return at == image.channels.end() ? -1 : static_cast<int>(at - image.channels.begin());
  };
  Layout layout{find("R"), find("G"), find("B"), find("A"), false};
  if (layout.red < 0 && layout.green < 0 && layout.blue < 0 && find("Y") >= 0) {
    layout.red = layout.green = layout.blue = find("Y");
    layout.isGrey = true;
  }
  return layout;
}

/// A finite stand-in: nothing for NaN, the brightest (or darkest) for an infinity.
float showable(float value, WriteReport& report) {
  constexpr float brightest = 65504;  // the largest half: far beyond any display, and no transform overflows on it
  if (std::isfinite(value)) return std::clamp(value, -brightest, brightest);
  ++report.nonFinite;
  if (std::isnan(value)) return 0;
  return value > 0 ? brightest : 0;
}

/// One pixel's colours divided by alpha and exposed, four floats; colour without coverage is light that was added and
/// stays as it is.
void copyPixel(const float* from, const Layout& layout, float gain, bool withAlpha, float* to, WriteReport& report) {
  const float alpha = layout.alpha >= 0 ? std::clamp(showable(from[layout.alpha], report), 0.0f, 1.0f) : 1.0f;
  const float scale = withAlpha && alpha > 0 ? gain / alpha : gain;
  to[0] = showable(showable(from[layout.red], report) * scale, report);
  to[1] = layout.isGrey ? to[0] : showable(showable(from[layout.green], report) * scale, report);
  to[2] = layout.isGrey ? to[0] : showable(showable(from[layout.blue], report) * scale, report);
  to[3] = alpha;
}

}  // namespace

std::string toDisplay(const ImageBuffer& image, const DisplayOptions& options, bool withAlpha, DisplayPicture& picture,
                      WriteReport& report) {
  const Layout layout = findChannels(image);
  if (layout.red < 0 || layout.green < 0 || layout.blue < 0) {
    return "the picture has no channels R, G and B to show";
  }
  if (!std::isfinite(options.exposure)) return "the exposure is not a finite number";
  ocio::SetLoggingLevel(ocio::LOGGING_LEVEL_NONE);
  const auto config = openColorConfig(options.config);
  DisplayView names;
  if (std::string message = resolve(*config, options, names); !message.empty()) return message;
  auto transform = ocio::DisplayViewTransform::Create();
  transform->setSrc(names.source.c_str());
  transform->setDisplay(names.display.c_str());
  transform->setView(names.view.c_str());
  const auto processor = config->getProcessor(transform)->getOptimizedCPUProcessor(ocio::OPTIMIZATION_LOSSLESS);

  const bool hasAlpha = withAlpha && layout.alpha >= 0;
  picture.channels = hasAlpha ? 4 : layout.isGrey ? 1 : 3;
  picture.isSrgb = names.display.find("sRGB") != std::string::npos;
  const auto stride = static_cast<std::ptrdiff_t>(image.channels.size());
  const auto channels = static_cast<std::size_t>(picture.channels);
  const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
  const float gain = std::exp2(options.exposure);
  std::vector<float> row(4 * width);
  picture.pixels.resize(width * height * channels);
  float* to = picture.pixels.data();
  const float* from = image.pixels.data();
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x, from += stride) {
      copyPixel(from, layout, gain, hasAlpha, row.data() + 4 * x, report);
    }
    ocio::PackedImageDesc description(row.data(), static_cast<long>(width), 1, 4);
    processor->apply(description);
    for (std::size_t x = 0; x < width; ++x, to += channels) std::copy_n(row.data() + 4 * x, channels, to);
  }
  return {};
}

}  // namespace aerosol::image
