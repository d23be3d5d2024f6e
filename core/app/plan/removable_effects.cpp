#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "core/app/plan/effects.h"

namespace aerosol::app {

namespace {

/// A parameter of all materials that give it another value than 0.
void clearParameter(scene::SceneDescription& description, const char* name) {
  for (scene::ShaderUse& material : description.materials) {
    for (scene::ShaderParameter& parameter : material.parameters) {
      if (parameter.name == name) parameter.value = 0;
    }
  }
}

/// An object stands as it does when the shutter opens.
template <class P>
void freeze(P& placement, const scene::SceneDescription& description) {
  if (!placement.keys.empty()) placement = P(placement.at(description.sensor.shutterOpen));
}

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
      {"moving-camera", "the camera stands where it does when the shutter opens",
       [](SceneDescription& d) { freeze(d.sensor.toWorld, d); }},
      {"moving-shapes", "shapes stand as they do when the shutter opens",
       [](SceneDescription& d) {
         for (scene::Shape& shape : d.shapes) freeze(shape.toWorld, d);
       }},
      {"moving-lights", "lights stand as they do when the shutter opens, and shapes that shine",
       [](SceneDescription& d) {
         for (scene::Emitter& emitter : d.emitters) freeze(emitter.toWorld, d);
         for (scene::Shape& shape : d.shapes) {
           if (shape.emitter) freeze(shape.toWorld, d);
         }
       }},
      {"moving-volumes", "volume primitives stand as they do when the shutter opens",
       [](SceneDescription& d) {
         for (scene::Volume& volume : d.volumes) freeze(volume.toWorld, d);
       }},
      {"velocity-blur", "media do not move by their velocities",
       [](SceneDescription& d) {
         for (scene::Volume& volume : d.volumes) volume.velocity = {};
       }},
      {"holdouts", "volumes that cut holes are seen like others",
       [](SceneDescription& d) {
         for (scene::Volume& volume : d.volumes) volume.controls.holdout = false;
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
      {"clamped-indirect", "light is not dimmed: more noise, and the right brightness",
       [](SceneDescription& d) { d.integrator.clampIndirect = 0; }},
      {"contribution-roulette", "roulette goes by throughput: the same image in the mean",
       [](SceneDescription& d) { d.integrator.roulette = scene::Roulette::throughput; }},
      {"derivatives", "what shaders see has no size: textures are not filtered, fine patterns not smoothed",
       [](SceneDescription& d) { d.integrator.footprints = false; }},
      {"level-of-detail", "all see the voxels that are in the files: no bias, and more memory is read",
       [](SceneDescription& d) {
         d.integrator.lodPixels = 0;
         d.integrator.lodDepth = 0;
       }},
      {"light-links", "all lights light all volumes",
       [](SceneDescription& d) {
         for (scene::Volume& volume : d.volumes) volume.controls.lights.clear();
       }},
      {"light-textures", "lights with a texture shine evenly: by what the texture multiplies",
       [](SceneDescription& d) {
         for (scene::Emitter& emitter : d.emitters) {
           if (emitter.type != scene::EmitterType::background) emitter.texture.reset();
         }
         for (scene::Shape& shape : d.shapes) {
           if (shape.emitter) shape.emitter->texture.reset();
         }
       }},
      {"straight-shadows", "glass casts the shadows of what bends light: caustics, and their noise",
       [](SceneDescription& d) {
         clearParameter(d, "straight_shadows");
         d.integrator.transparentShadows = false;
       }},
      {"nested-media", "shapes that overlap do not know of each other: light is bent at every face",
       [](SceneDescription& d) {
         clearParameter(d, "priority");
         for (scene::Shape& shape : d.shapes) shape.priority = 0;
       }},
      {"volume-looks", "media are as their shaders say: factors and ramps of volumes are left out",
       [](SceneDescription& d) {
         for (scene::Volume& volume : d.volumes) {
           scene::VolumeControls plain;
           plain.stepScale = volume.controls.stepScale;
           plain.holdout = volume.controls.holdout;
           plain.lights = volume.controls.lights;
           volume.controls = plain;
         }
       }},
      {"bound-trees", "one bound holds for a whole medium: the same image in the mean, at another cost",
       [](SceneDescription& d) { d.integrator.boundBoxes = 0; }},
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
      {"background-shaders", "there is no background by a shader",
       [](SceneDescription& d) { dropEmitters(d, scene::EmitterType::background); }},
      {"layers", "nothing is gathered beside the picture",
       [](SceneDescription& d) {
         d.integrator.aovList.clear();
         d.integrator.aovs.clear();
       }},
      {"deep-output", "no deep image is gathered", [](SceneDescription&) {}},
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
