#include "core/app/study/axes.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/scene/field.h"
#include "core/scene/value.h"

namespace aerosol::app {

namespace {

StudySetting withDistance(const StudyArguments& arguments, scene::DistanceSampling distance, float stepScale) {
  const bool isMarching = distance == scene::DistanceSampling::marching;
  const char* const name = isMarching                                     ? "marching"
                           : distance == scene::DistanceSampling::relaxed ? "null scattering, relaxed"
                                                                          : "null scattering";
  const char* const word = scene::Words<scene::DistanceSampling>::words[static_cast<std::size_t>(distance)];
  StudySetting setting{name, {"--distance", word}, arguments.render};
  setting.arguments.distance = distance;
  if (isMarching) {
    const float scale = stepScale * arguments.render.stepScale.value_or(1);
    setting.arguments.stepScale = scale;
    setting.words.insert(setting.words.end(), {"--step-scale", fmt::format("{}", scale)});
    setting.name += fmt::format(", steps x {}", stepScale);
  }
  return setting;
}

/// Marching with the way to lights estimated otherwise.
StudySetting withTransmittance(StudySetting setting, scene::TransmittanceSampling transmittance, const char* name) {
  const char* const word = scene::Words<scene::TransmittanceSampling>::words[static_cast<std::size_t>(transmittance)];
  setting.arguments.transmittance = transmittance;
  setting.words.insert(setting.words.end(), {"--transmittance", word});
  setting.name = fmt::format("marching, {} to lights", name);
  return setting;
}

/// "volume.step_scale" and "step_scale" stand for the option of that name, "distance" and "transmittance" for those;
/// all else is a parameter of the scene.
Result<StudySetting> vary(const StudySetting& base, const StudyAxis& axis, const std::string& value) {
  StudySetting setting = base;
  const auto add = [&](std::vector<std::string> words) {
    setting.words.insert(setting.words.end(), words.begin(), words.end());
    const std::string name = axis.parameter + " = " + value;
    setting.name = setting.name.empty() ? name : setting.name + ", " + name;
  };
  const auto refuse = [&](const std::string& what) {
    return Diagnostic{
        Severity::error, {}, fmt::format("--vary {}: '{}' is not {}", axis.parameter, value, what), {}, {}};
  };
  if (axis.parameter == "volume.step_scale" || axis.parameter == "step_scale") {
    scene::TextError error;
    const auto scale = scene::parseFloat(value, error);
    if (!scale || !(*scale > 0)) return refuse("a number greater than 0");
    setting.arguments.stepScale = *scale;
    add({"--step-scale", value});
  } else if (axis.parameter == "distance") {
    constexpr auto& words = scene::Words<scene::DistanceSampling>::words;
    const auto word = std::find(words.begin(), words.end(), value);
    if (word == words.end()) return refuse(fmt::format("one of {}", fmt::join(words, ", ")));
    setting.arguments.distance = static_cast<scene::DistanceSampling>(word - words.begin());
    add({"--distance", value});
  } else if (axis.parameter == "transmittance") {
    constexpr auto& words = scene::Words<scene::TransmittanceSampling>::words;
    const auto word = std::find(words.begin(), words.end(), value);
    if (word == words.end()) return refuse(fmt::format("one of {}", fmt::join(words, ", ")));
    setting.arguments.transmittance = static_cast<scene::TransmittanceSampling>(word - words.begin());
    add({"--transmittance", value});
  } else {
    setting.arguments.overrides.push_back(axis.parameter + "=" + value);
    add({"--set", axis.parameter + "=" + value});
  }
  return setting;
}

bool variesSteps(const StudyAxis& axis) {
  return axis.parameter.ends_with("step_scale") || axis.parameter.ends_with("step_size");
}

}  // namespace

bool hasClosedFormOfVoxels(const render::PreparedScene& scene) {
  return std::any_of(scene.media.begin(), scene.media.end(),
                     [](const volume::Medium& m) { return m.method == volume::DistanceMethod::analytic; });
}

bool hasVaryingMedium(const render::PreparedScene& scene) {
  return std::any_of(scene.media.begin(), scene.media.end(), [](const volume::Medium& m) { return !m.constant; });
}

Result<std::vector<StudySetting>> studySettings(const StudyArguments& arguments, const render::PreparedScene& scene,
                                                bool allowsNullScattering) {
  using scene::DistanceSampling;
  using scene::TransmittanceSampling;
  std::vector<StudySetting> settings;
  if (arguments.axes.empty()) {
    if (!hasVaryingMedium(scene)) return std::vector{StudySetting{"as the scene is", {}, arguments.render}};
    // Voxels in closed form are what the scene has by itself.
    if (hasClosedFormOfVoxels(scene)) settings.push_back({"as the scene is", {}, arguments.render});
    if (allowsNullScattering) {
      settings.push_back(withDistance(arguments, DistanceSampling::nullScattering, 1));
      settings.push_back(withDistance(arguments, DistanceSampling::relaxed, 1));
    }
    for (const float scale : {0.5f, 1.0f, 2.0f, 4.0f, 8.0f}) {
      settings.push_back(withDistance(arguments, DistanceSampling::marching, scale));
    }
    // The estimators of the way to lights that are neither; those who asked for one have it everywhere.
    if (arguments.render.transmittance) return settings;
    const StudySetting marching = withDistance(arguments, DistanceSampling::marching, 1);
    settings.push_back(withTransmittance(marching, TransmittanceSampling::twoCombs, "two combs"));
    if (allowsNullScattering)
      settings.push_back(withTransmittance(marching, TransmittanceSampling::unbiased, "unbiased"));
    return settings;
  }
  settings.push_back({"", {}, arguments.render});
  // Steps make a difference to marching alone.
  if (!arguments.render.distance && std::any_of(arguments.axes.begin(), arguments.axes.end(), variesSteps)) {
    settings.back().arguments.distance = DistanceSampling::marching;
    settings.back().words = {"--distance", "marching"};
  }
  for (const StudyAxis& axis : arguments.axes) {
    std::vector<StudySetting> product;
    for (const StudySetting& base : settings) {
      for (const std::string& value : axis.values) {
        auto varied = vary(base, axis, value);
        if (!varied) return varied.errors();
        product.push_back(std::move(*varied));
      }
    }
    settings = std::move(product);
  }
  return settings;
}

}  // namespace aerosol::app
