#include "core/render/light_linking.h"

#include <algorithm>

#include "core/lang/closure_values.h"
#include "core/shading/instance_values.h"

namespace aerosol::render {

bool LightLinking::emits(const volume::Medium& medium) const {
  if (const VolumeLook* look = scene_.lookOf(medium.index); look && look->emission == 0) return false;
  const auto& sites = scene_.shading.family(scene_.mediumShaders[medium.index]).program->closureSites;
  return std::ranges::any_of(sites, [](const lang::ClosureSite& site) { return lang::isEmitting(site.closure); });
}

/// Whether its parameters are such that it gives no light anywhere.
bool LightLinking::isDark(const volume::Medium& medium) const {
  const shading::InstanceRef shader = scene_.mediumShaders[medium.index];
  const lang::Program& program = *scene_.shading.family(shader).program;
  const lang::Program own = lang::specialise(program, shading::valuesOf(program, scene_.shading.instance(shader)));
  return std::ranges::all_of(own.outputs, [&](const lang::Output& output) {
    const lang::Variable& variable = own.variables[output.variable];
    const auto* floats = std::get_if<std::vector<float>>(&variable.value);
    const bool isZero = variable.storage == lang::Storage::constant && floats &&
                        std::ranges::all_of(*floats, [](float value) { return value == 0; });
    return output.kind != lang::OutputKind::emission || isZero;
  });
}

void LightLinking::findCandidates() {
  for (const scene::Emitter& emitter : description_.emitters) candidates_.push_back({emitter.origin.id, {}});
  for (const scene::Shape& shape : description_.shapes) {
    if (!shape.emitter) continue;
    candidates_.push_back({shape.emitter->origin.id.empty() ? shape.origin.id : shape.emitter->origin.id, {}});
  }
  const auto add = [&](const volume::Medium* medium, const std::string& id) {
    if (medium && emits(*medium)) candidates_.push_back({id, medium->index});
  };
  for (std::size_t i = 0; i < description_.volumes.size(); ++i) {
    add(scene_.volumes[i], description_.volumes[i].origin.id);
  }
  for (std::size_t i = 0; i < description_.shapes.size(); ++i) {
    add(scene_.objects[i].interior, description_.shapes[i].origin.id);
    add(scene_.objects[i].exterior, "");
  }
  add(scene_.cameraMedium, "");
}

std::uint32_t LightLinking::setOf(std::vector<bool> named) {
  auto found = std::ranges::find(sets_, named);
  if (found == sets_.end()) found = sets_.insert(sets_.end(), std::move(named));
  return static_cast<std::uint32_t>(found - sets_.begin()) + 1;
}

std::unique_ptr<LinkedLights> LightLinking::seenBy(const std::vector<bool>& named, const CopyMedium& copy) {
  auto links = std::make_unique<LinkedLights>();
  links->firstMedium = scene_.media.data();
  links->volumes = scene_.volumes;
  for (const volume::Medium& medium : scene_.media) links->media.push_back(&medium);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (!candidates_[i].medium || named[i]) continue;
    const volume::Medium* const glowing = &scene_.media[*candidates_[i].medium];
    const volume::Medium*& dark = dark_[glowing->index];
    if (!dark) {
      const VolumeLook* const own = scene_.lookOf(glowing->index);
      VolumeLook look = own ? *own : VolumeLook();
      look.emission = 0;
      dark = copy(*glowing, look);
    }
    std::ranges::replace(links->volumes, glowing, dark);
    links->media[glowing->index] = dark;
  }
  return links;
}

Diagnostics LightLinking::read(const CopyMedium& copy) {
  Diagnostics errors;
  const auto links = [](const scene::Volume& volume) { return !volume.controls.lights.empty(); };
  const auto linked = [](const scene::Shape& shape) { return !shape.lights.empty(); };
  if (std::ranges::none_of(description_.volumes, links) && std::ranges::none_of(description_.shapes, linked))
    return errors;
  findCandidates();
  std::vector<std::string> ids, shining;
  for (const Candidate& candidate : candidates_) {
    ids.push_back(candidate.id);
    if (!candidate.medium || !isDark(scene_.media[*candidate.medium])) shining.push_back(candidate.id);
  }
  for (std::size_t i = 0; i < description_.volumes.size(); ++i) {
    if (!links(description_.volumes[i])) continue;
    auto named = namedLights(description_.volumes[i].controls.lights, description_.volumes[i].origin, ids, shining);
    if (!named) {
      errors.append(named.errors());
      continue;
    }
    const std::uint32_t set = setOf(std::move(*named));
    for (const volume::Medium* medium : scene_.mediaOf(i)) {
      scene_.media[medium->index].lightLinks = set;
    }
  }
  for (std::size_t i = 0; i < description_.shapes.size(); ++i) {
    if (!linked(description_.shapes[i])) continue;
    auto named = namedLights(description_.shapes[i].lights, description_.shapes[i].origin, ids, shining);
    if (named) {
      scene_.objects[i].lightLinks = setOf(std::move(*named));
    } else {
      errors.append(named.errors());
    }
  }
  if (errors.hasErrors()) return errors;
  for (const std::vector<bool>& named : sets_) scene_.linkedLights.push_back(seenBy(named, copy));
  return errors;
}

void LightLinking::makeSets(std::span<const std::uint32_t> glowingMedia, float sceneRadius) {
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    std::vector<bool> chosen;
    for (std::size_t i = 0; i < candidates_.size() && !candidates_[i].medium; ++i) chosen.push_back(sets_[s][i]);
    for (const std::uint32_t medium : glowingMedia) {
      const auto found = std::ranges::find(candidates_, medium, &Candidate::medium);
      chosen.push_back(found != candidates_.end() && sets_[s][static_cast<std::size_t>(found - candidates_.begin())]);
    }
    scene_.linkedLights[s]->lights = LightSet(scene_.lights, chosen, sceneRadius);
  }
}

}  // namespace aerosol::render
