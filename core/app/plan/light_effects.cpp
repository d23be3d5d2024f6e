#include <fmt/format.h>

#include <algorithm>

#include "core/app/plan/effects.h"
#include "core/app/plan/names.h"
#include "core/app/quantity.h"

namespace aerosol::app {

namespace {

using scene::EmitterType;

/// Kinds of emitters by the effect that they make.
struct EmitterKind {
  EmitterType type;
  const char* name;    ///< Of one, in scene files.
  const char* effect;  ///< Of all.
};

constexpr EmitterKind kinds[] = {{EmitterType::point, "point", "point-lights"},
                                 {EmitterType::spot, "spot", "spot-lights"},
                                 {EmitterType::projector, "projector", "projectors"},
                                 {EmitterType::directional, "directional", "directional-lights"},
                                 {EmitterType::constant, "constant", "constant-light"},
                                 {EmitterType::envmap, "envmap", "environment-maps"},
                                 {EmitterType::sunsky, "sunsky", "sun-and-sky"},
                                 {EmitterType::background, "background", "background-shaders"}};

using Counter = std::function<std::uint64_t(const render::WorkerStatistics&)>;

Effect effectOf(const char* name, const Names& names, const char* offReason, Counter work) {
  return {name, names.count() > 0 ? names.text() : offReason, names.count() > 0, std::move(work), {}};
}

/// Estimates of the light of these, by index.
Counter samplesOf(std::vector<std::size_t> lights) {
  return [lights = std::move(lights)](const render::WorkerStatistics& s) {
    std::uint64_t samples = 0;
    for (const std::size_t light : lights) samples += light < s.lightSamples.size() ? s.lightSamples[light] : 0;
    return samples;
  };
}

/// Of the work for lights, by how often each was asked.
std::function<double(const render::WorkerStatistics&)> shareOf(Counter samples) {
  return [samples = std::move(samples)](const render::WorkerStatistics& s) {
    std::uint64_t seen = 0, asked = 0;
    for (const std::uint64_t count : s.phases) seen += count;
    for (const std::uint64_t count : s.lightSamples) asked += count;
    if (seen == 0 || asked == 0) return 0.0;
    const auto ofLights = static_cast<double>(s.phases[static_cast<std::size_t>(Phase::lights)]);
    return ofLights / static_cast<double>(seen) * static_cast<double>(samples(s)) / static_cast<double>(asked);
  };
}

Effect kindOf(const char* name, const Names& names, const char* offReason, std::vector<std::size_t> lights) {
  const Counter samples = samplesOf(std::move(lights));
  Effect effect = effectOf(name, names, offReason, samples);
  effect.share = shareOf(samples);
  return effect;
}

}  // namespace

void addLightEffects(const scene::SceneDescription& description, const render::PreparedScene& scene,
                     std::vector<Effect>& effects) {
  for (const EmitterKind& kind : kinds) {
    Names found;
    std::vector<std::size_t> lights;
    for (std::size_t i = 0; i < description.emitters.size(); ++i) {
      const scene::Emitter& emitter = description.emitters[i];
      if (emitter.type != kind.type) continue;
      found.add(kind.name, emitter.origin.location);
      lights.push_back(i);
    }
    if (kind.type == EmitterType::constant) {
      effects.push_back(effectOf(kind.effect, found, "none in the scene", countOf(render::Work::foundLight)));
    } else {
      effects.push_back(kindOf(kind.effect, found, "none in the scene", std::move(lights)));
    }
  }
  Names areas, linked, straight;
  std::vector<std::size_t> shining;
  for (const scene::Shape& shape : description.shapes) {
    if (!shape.emitter) continue;
    areas.add("area", shape.emitter->origin.location);
    shining.push_back(description.emitters.size() + shining.size());
  }
  effects.push_back(kindOf("area-lights", areas, "no shape emits light", std::move(shining)));
  const bool hasTextures = std::ranges::any_of(scene.lightTextures, [](const auto& each) { return each.has_value(); });
  effects.push_back({"light-textures",
                     hasTextures ? "some light is multiplied by a texture" : "no light has a texture",
                     hasTextures,
                     countOf(render::Work::lightTexture),
                     {}});

  const bool isTree = !scene.lights.tree().isEmpty();
  effects.push_back({"light-hierarchy",
                     isTree ? formatCount(scene.lights.placed().size(), "light") + ", chosen through a tree"
                            : "so few lights are weighed one by one",
                     isTree,
                     countOf(render::Work::lightTree),
                     {}});
  effects.push_back({"light-splitting",
                     scene.splitsLights ? fmt::format("clusters are split while one's spread is {:.3g} of the light",
                                                      scene.path.splitThreshold)
                     : isTree           ? "the scene or the command line turns it off"
                                        : "there is no hierarchy of lights",
                     scene.splitsLights,
                     countOf(render::Work::lightSplitting),
                     {}});
  const bool mayScatter = std::ranges::any_of(scene.media, &volume::Medium::mayScatter);
  const bool mayChoose = mayScatter && !scene.lights.placed().empty();
  const bool isTabulated = mayChoose && scene.lightChoice == render::LightChoice::tabulated;
  const bool isEquiangular = mayChoose && scene.lightChoice == render::LightChoice::equiangular;
  effects.push_back({"equiangular-sampling",
                     isEquiangular              ? "distances in media are also sampled for lights beside the ray"
                     : isTabulated              ? "lights are tabulated instead"
                     : !scene.path.equiangular  ? "the scene or the command line turns it off"
                     : !mayScatter              ? "no medium scatters"
                     : scene.lights.size() == 0 ? "there are no lights"
                                                : "all lights are infinitely far away",
                     isEquiangular,
                     countOf(render::Work::chosenDistance),
                     {}});
  effects.push_back({"joint-lights",
                     isTabulated               ? "distances in media are also sampled from tables of media and lights"
                     : !scene.path.jointLights ? "not asked for"
                     : !mayChoose              ? "no light is somewhere near rays through media that scatter"
                                               : "some medium is not marched",
                     isTabulated,
                     countOf(render::Work::tabulatedLight),
                     {}});
  const bool followsLamps = !scene.lampsInMedia.empty();
  effects.push_back({"lamp-directions",
                     followsLamps ? "directions are also chosen towards " +
                                        formatCount(scene.lampsInMedia.size(), "lamp") + " in media"
                     : !scene.path.equiangular    ? "only with equiangular sampling"
                     : !scene.path.lampDirections ? "the scene or the command line turns it off"
                                                  : "few lamps in media that scatter would call for it",
                     followsLamps,
                     countOf(render::Work::lampDirection),
                     {}});
  for (const scene::Volume& volume : description.volumes) {
    if (!volume.controls.lights.empty()) linked.add(volume.type, volume.origin.location);
  }
  effects.push_back(
      effectOf("light-links", linked, "all lights light all volumes", countOf(render::Work::linkedLight)));
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects[i].passesShadows || scene.objects[i].passesPoints)
      straight.add(scene.shading.family(scene.objects[i].material).program->name,
                   description.shapes[i].origin.location);
  }
  effects.push_back(effectOf("straight-shadows", straight, "no material lets light pass unbent",
                             countOf(render::Work::straightCrossing)));
}

}  // namespace aerosol::app
