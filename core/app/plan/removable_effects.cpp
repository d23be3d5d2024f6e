#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/app/plan/effects.h"

namespace aerosol::app {

namespace {

void dropEmitters(scene::SceneDescription& description, scene::EmitterType type) {
  std::erase_if(description.emitters, [&](const scene::Emitter& each) { return each.type == type; });
}

}  // namespace

const std::vector<RemovableEffect>& removableEffects() {
  using scene::SceneDescription;
  static const std::vector<RemovableEffect> effects{
      {"depth-of-field", "everything is in focus",
       [](SceneDescription& d) {
         d.sensor.type = scene::SensorType::perspective;
         d.sensor.apertureRadius = 0;
       }},
      {"motion", "everything stands as it does when the shutter opens",
       [](SceneDescription& d) { d.sensor.shutterClose = d.sensor.shutterOpen; }},
      {"velocity-blur", "media do not move by their velocities",
       [](SceneDescription& d) {
         for (scene::Volume& volume : d.volumes) volume.velocity = {};
       }},
      {"equiangular-sampling", "the same image in the mean; more noise around lights in media",
       [](SceneDescription& d) { d.integrator.equiangular = false; }},
      {"light-splitting", "the same image in the mean; one of many lights is sampled at a point, with more noise",
       [](SceneDescription& d) { d.integrator.splitLights = 0; }},
      {"lamp-directions", "the same image in the mean; more noise of light that lamps in media scatter twice or more",
       [](SceneDescription& d) { d.integrator.lampDirections = false; }},
      {"multiple-scattering", "light is scattered once at most: clouds get darker",
       [](SceneDescription& d) {
         d.integrator.maxDepth = d.integrator.maxDepth < 0 ? 2 : std::min(2, d.integrator.maxDepth);
       }},
      {"russian-roulette", "paths go on to max_depth: the same image in the mean, at another cost",
       [](SceneDescription& d) { d.integrator.rrDepth = std::numeric_limits<int>::max(); }},
      {"contribution-roulette", "roulette goes by throughput: the same image in the mean",
       [](SceneDescription& d) { d.integrator.roulette = scene::Roulette::throughput; }},
      {"derivatives", "what shaders see has no size: textures are not filtered, fine patterns not smoothed",
       [](SceneDescription& d) { d.integrator.footprints = false; }},
      {"volumes", "volume primitives are left out", [](SceneDescription& d) { d.volumes.clear(); }},
      {"surface-media", "media inside and outside of shapes are left out",
       [](SceneDescription& d) {
         for (scene::Shape& shape : d.shapes) shape.interior = shape.exterior = {};
         d.sensor.medium = {};
       }},
      {"displacement", "surfaces keep the form that they are modelled in",
       [](SceneDescription& d) {
         for (scene::Shape& shape : d.shapes) shape.displacement.reset();
       }},
      {"area-lights", "shapes do not emit light",
       [](SceneDescription& d) {
         for (scene::Shape& shape : d.shapes) shape.emitter.reset();
       }},
      {"constant-light", "constant environments are black",
       [](SceneDescription& d) { dropEmitters(d, scene::EmitterType::constant); }},
      {"directional-lights", "directional lights are left out",
       [](SceneDescription& d) { dropEmitters(d, scene::EmitterType::directional); }},
      {"point-lights", "point lights are left out",
       [](SceneDescription& d) { dropEmitters(d, scene::EmitterType::point); }},
      {"spot-lights", "spot lights are left out",
       [](SceneDescription& d) { dropEmitters(d, scene::EmitterType::spot); }},
      {"projectors", "projectors are left out",
       [](SceneDescription& d) { dropEmitters(d, scene::EmitterType::projector); }},
      {"environment-maps", "environment maps are black",
       [](SceneDescription& d) { dropEmitters(d, scene::EmitterType::envmap); }},
      {"sun-and-sky", "there is neither the sun nor the sky of a place",
       [](SceneDescription& d) { dropEmitters(d, scene::EmitterType::sunsky); }},
  };
  return effects;
}

Diagnostics removeEffects(const std::vector<std::string>& names, scene::SceneDescription& description) {
  Diagnostics errors;
  std::vector<std::string> known;
  for (const RemovableEffect& effect : removableEffects()) known.push_back(effect.name);
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      std::vector<std::string> notes;
      if (std::string near = didYouMean(name, known); !near.empty()) notes.push_back(std::move(near));
      notes.push_back(fmt::format("effects that can be left out: {}", fmt::join(known, ", ")));
      errors.error({}, fmt::format("--without {}: there is no such effect", name), std::move(notes));
      continue;
    }
    removableEffects()[static_cast<std::size_t>(found - known.begin())].remove(description);
  }
  return errors;
}

}  // namespace aerosol::app
