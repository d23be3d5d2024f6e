#include "core/render/optional_effects.h"

#include <algorithm>

#include "core/render/prepared_scene.h"

namespace aerosol::render {

std::vector<std::string> optionalEffectsOf(const PreparedScene& scene) {
  const auto& media = scene.media;
  const auto isPlanned = [&](auto method) {
    return std::ranges::any_of(media, [&](const volume::Medium& medium) { return medium.method == method; });
  };
  bool hasLooks = false;
  for (std::size_t i = 0; i < scene.looks.size(); ++i) hasLooks = hasLooks || (scene.looks[i] && !media[i].constant);
  const auto isGiven = [](const auto& each) { return each.has_value(); };
  struct Known {
    const char* name;
    bool isOn;
  };
  const Known known[] = {
      {"depth-of-field", scene.camera->aperture() > 0},
      {"motion", scene.changes.isCalledFor()},
      {"velocity-blur", std::ranges::any_of(scene.velocities, isGiven)},
      {"media-probes", scene.probesMedia.isCalledFor()},
      {"nested-media", scene.nestsMedia.isCalledFor()},
      {"subsurface", scene.hasSubsurface.isCalledFor()},
      {"straight-shadows", scene.shadowsPass.isCalledFor()},
      {"volume-looks", hasLooks},
      {"level-of-detail", scene.hasCoarseVolumes.isCalledFor()},
      {"light-links", !scene.linkedLights.empty()},
      {"light-textures", std::ranges::any_of(scene.lightTextures, isGiven)},
      {"light-hierarchy", !scene.lights.tree().isEmpty()},
      {"equiangular-sampling", scene.path.equiangular.isCalledFor() && !scene.lights.placed().empty() &&
                                   std::ranges::any_of(media, &volume::Medium::mayScatter)},
      {"light-splitting", scene.splitsLights.isCalledFor()},
      {"contribution-roulette", !scene.contributions.isEmpty()},
      {"clamped-indirect", scene.path.clampsIndirect.isCalledFor()},
      {"joint-lights", scene.lightChoice == LightChoice::tabulated},
      {"lamp-directions", !scene.lampsInMedia.empty()},
      {"volume-emission", scene.lights.hasVolumes()},
      {"analytic-voxels", isPlanned(volume::DistanceMethod::analytic)},
      {"null-scattering", isPlanned(volume::DistanceMethod::nullScattering)},
      {"ray-marching", isPlanned(volume::DistanceMethod::marching)},
      {"derivatives", scene.keepsFootprints.isCalledFor()},
      {"layers", scene.aovs != nullptr},
  };
  std::vector<std::string> names;
  for (const Known& effect : known) {
    if (effect.isOn) names.emplace_back(effect.name);
  }
  return names;
}

}  // namespace aerosol::render
