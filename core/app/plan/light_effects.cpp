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
                                 {EmitterType::sunsky, "sunsky", "sun-and-sky"}};

Effect effectOf(const char* name, const Names& names, const char* offReason) {
  return {name, names.count() > 0 ? names.text() : offReason, names.count() > 0, {}, {}};
}

}  // namespace

void addLightEffects(const scene::SceneDescription& description, const render::PreparedScene& scene,
                     std::vector<Effect>& effects) {
  for (const EmitterKind& kind : kinds) {
    Names found;
    for (const scene::Emitter& emitter : description.emitters) {
      if (emitter.type == kind.type) found.add(kind.name, emitter.origin.location);
    }
    effects.push_back(effectOf(kind.effect, found, "none in the scene"));
  }
  Names areas, linked, straight;
  for (const scene::Shape& shape : description.shapes) {
    if (shape.emitter) areas.add("area", shape.emitter->origin.location);
  }
  effects.push_back(effectOf("area-lights", areas, "no shape emits light"));
  const bool hasTextures = std::ranges::any_of(scene.lightTextures, [](const auto& each) { return each.has_value(); });
  effects.push_back({"light-textures",
                     hasTextures ? "some light is multiplied by a texture" : "no light has a texture",
                     hasTextures,
                     {},
                     {}});

  const bool isTree = !scene.lights.tree().isEmpty();
  effects.push_back({"light-hierarchy",
                     isTree ? formatCount(scene.lights.placed().size(), "light") + ", chosen through a tree"
                            : "so few lights are weighed one by one",
                     isTree,
                     {},
                     {}});
  const bool mayScatter = std::ranges::any_of(scene.media, &volume::Medium::mayScatter);
  const bool isEquiangular = scene.path.equiangular && mayScatter && !scene.lights.placed().empty();
  effects.push_back({"equiangular-sampling",
                     isEquiangular             ? "distances in media are also sampled for lights beside the ray"
                     : !scene.path.equiangular ? "the scene or the command line turns it off"
                     : !mayScatter             ? "no medium scatters"
                                               : "no light is somewhere near rays",
                     isEquiangular,
                     {},
                     {}});
  for (const scene::Volume& volume : description.volumes) {
    if (!volume.controls.lights.empty()) linked.add(volume.type, volume.origin.location);
  }
  effects.push_back(effectOf("light-links", linked, "all lights light all volumes"));
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects[i].passesShadows)
      straight.add(scene.shading.family(scene.objects[i].material).program->name,
                   description.shapes[i].origin.location);
  }
  effects.push_back(effectOf("straight-shadows", straight, "no material lets light pass unbent"));
}

}  // namespace aerosol::app
