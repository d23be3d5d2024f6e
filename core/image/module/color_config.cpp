#include "core/image/module/color_config.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

namespace aerosol::image {

namespace ocio = OCIO_NAMESPACE;

ocio::TransformRcPtr linearToSrgb() {
  auto transform = ocio::ExponentWithLinearTransform::Create();
  transform->setGamma({2.4, 2.4, 2.4, 1});
  transform->setOffset({0.055, 0.055, 0.055, 0});
  transform->setDirection(ocio::TRANSFORM_DIR_INVERSE);
  return transform;
}

namespace {

constexpr const char* acesView = "ACES 1.0 SDR";

/// Linear Rec.709 to ACEScg (AP1), with the Bradford adaptation between their white points.
ocio::TransformRcPtr rec709ToAcesCg() {
  auto transform = ocio::BuiltinTransform::Create();
  transform->setStyle("UTILITY - ACES-AP1_to_LINEAR-REC709_BFD");
  transform->setDirection(ocio::TRANSFORM_DIR_INVERSE);
  return transform;
}

ocio::TransformRcPtr builtin(const char* style) {
  auto transform = ocio::BuiltinTransform::Create();
  transform->setStyle(style);
  return transform;
}

ocio::TransformRcPtr invertedBuiltin(const char* style) {
  auto transform = ocio::BuiltinTransform::Create();
  transform->setStyle(style);
  transform->setDirection(ocio::TRANSFORM_DIR_INVERSE);
  return transform;
}

/// Linear Rec.709 through ACES' reference rendering and SDR output transform to sRGB.
ocio::TransformRcPtr rec709ToAcesSdr() {
  auto group = ocio::GroupTransform::Create();
  group->appendTransform(rec709ToAcesCg());
  group->appendTransform(builtin("UTILITY - ACES-AP1_to_CIE-XYZ-D65_BFD"));
  group->appendTransform(invertedBuiltin("UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD"));
  group->appendTransform(builtin("ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0"));
  group->appendTransform(builtin("DISPLAY - CIE-XYZ-D65_to_sRGB"));
  return group;
}

void addColorSpace(ocio::Config& config, const char* name, const ocio::ConstTransformRcPtr& fromReference,
                   bool isData = false) {
  auto space = ocio::ColorSpace::Create();
  space->setName(name);
  space->setIsData(isData);
  if (fromReference) space->setTransform(fromReference, ocio::COLORSPACE_DIR_FROM_REFERENCE);
  config.addColorSpace(space);
}

/// The reference space is linear Rec.709.
ocio::ConstConfigRcPtr builtinConfig() {
  const auto config = ocio::Config::Create();
  config->setMajorVersion(2);
  addColorSpace(*config, "lin_rec709", nullptr);
  addColorSpace(*config, "ACEScg", rec709ToAcesCg());
  addColorSpace(*config, "sRGB", linearToSrgb());
  addColorSpace(*config, acesView, rec709ToAcesSdr());
  addColorSpace(*config, "Raw", nullptr, true);
  config->setRole(ocio::ROLE_SCENE_LINEAR, "lin_rec709");
  config->setRole(ocio::ROLE_DEFAULT, "Raw");
  for (const char* view : {"sRGB", acesView, "Raw"}) config->addDisplayView("sRGB", view, view, "");
  return config;
}

class Transform final : public ColorTransform {
 public:
  /// Null: the colours stay as they are.
  explicit Transform(ocio::ConstCPUProcessorRcPtr processor) : processor_(std::move(processor)) {}

  void apply(float* colors, std::size_t count) const override {
    if (!processor_ || count == 0) return;
    ocio::PackedImageDesc description(colors, static_cast<long>(count), 1, 3);
    processor_->apply(description);
  }

 private:
  ocio::ConstCPUProcessorRcPtr processor_;
};

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return lower;
}

class Colors final : public ColorSource {
 public:
  Colors(ocio::ConstConfigRcPtr config, std::string working)
      : config_(std::move(config)), working_(std::move(working)) {}

  const ColorTransform* between(std::string_view from, std::string_view to, std::string& problem) override {
    const std::lock_guard lock(mutex_);
    auto& known = known_[{std::string(from), std::string(to)}];
    if (!known.transform && known.problem.empty()) {
      try {
        known.transform = make(from, to, known.problem);
      } catch (const std::exception& error) {
        known.problem = error.what();
      }
    }
    problem = known.problem;
    return known.transform.get();
  }

 private:
  struct Known {
    std::unique_ptr<const Transform> transform;
    std::string problem;
  };

  /// A space of the config, or one that any program knows.
  struct Space {
    std::string name;
    bool isSrgb = false;  ///< The working space by the curve of sRGB.
  };

  std::optional<Space> find(std::string_view name, std::string& problem) const {
    if (name == "rgb") return Space{working_};
    const std::string text(name);
    if (config_->getColorSpace(text.c_str())) return Space{text};
    const std::string lower = lowerCase(name);
    constexpr std::array<std::string_view, 5> linear{"linear", "rec709", "hdtv", "lin_srgb", "lin_rec709"};
    if (std::ranges::find(linear, lower) != linear.end()) return Space{working_};
    if (lower == "srgb" || lower == "srgb_texture") return Space{working_, true};
    problem = "unknown colour space \"" + text + "\"; the OpenColorIO config has " +
              joinNames(config_->getNumColorSpaces(), [&](int i) { return config_->getColorSpaceNameByIndex(i); });
    return {};
  }

  std::unique_ptr<const Transform> make(std::string_view from, std::string_view to, std::string& problem) const {
    const auto source = find(from, problem), target = source ? find(to, problem) : std::nullopt;
    if (!target) return nullptr;
    const auto group = ocio::GroupTransform::Create();
    if (source->isSrgb) {
      const auto decode = linearToSrgb();
      decode->setDirection(ocio::TRANSFORM_DIR_INVERSE == decode->getDirection() ? ocio::TRANSFORM_DIR_FORWARD
                                                                                 : ocio::TRANSFORM_DIR_INVERSE);
      group->appendTransform(decode);
    }
    const auto change = ocio::ColorSpaceTransform::Create();
    change->setSrc(source->name.c_str());
    change->setDst(target->name.c_str());
    group->appendTransform(change);
    if (target->isSrgb) group->appendTransform(linearToSrgb());
    const auto processor = config_->getProcessor(group);
    if (processor->isNoOp()) return std::make_unique<const Transform>(nullptr);
    return std::make_unique<const Transform>(processor->getOptimizedCPUProcessor(ocio::OPTIMIZATION_LOSSLESS));
  }

  ocio::ConstConfigRcPtr config_;
  std::string working_;
  std::mutex mutex_;
  std::map<std::pair<std::string, std::string>, Known> known_;
};

}  // namespace

ocio::ConstConfigRcPtr openColorConfig(const std::string& file) {
  if (!file.empty()) return ocio::Config::CreateFromFile(file.c_str());
  const char* environment = std::getenv("OCIO");
  if (environment && *environment) return ocio::Config::CreateFromFile(environment);
  return builtinConfig();
}

std::unique_ptr<ColorSource> makeColors(const ColorSettings& settings, std::string& message) {
  try {
    ocio::SetLoggingLevel(ocio::LOGGING_LEVEL_NONE);
    auto config = openColorConfig(settings.config);
    std::string working = settings.workingSpace.empty() ? ocio::ROLE_SCENE_LINEAR : settings.workingSpace;
    if (config->getColorSpace(working.c_str())) return std::make_unique<Colors>(std::move(config), std::move(working));
    message = "the OpenColorIO config has no colour space '" + working + "'";
  } catch (const std::exception& error) {
    message = error.what();
  }
  return nullptr;
}

}  // namespace aerosol::image
