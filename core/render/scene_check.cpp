#include "core/render/scene_check.h"

#include <algorithm>
#include <filesystem>

#include "core/render/preparation/shapes.h"
#include "core/render/preparation/state.h"

namespace aerosol::render {

namespace {

bool isThere(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored);
}

void checkShader(Preparation& state, const scene::ShaderUse& use, const char* kind) {
  auto bound = bindShader(use, kind, {}, state.shaderSources(), state.scene->shading, state.warnings);
  if (!bound) state.appendNew(bound.errors());
}

/// A file that is missing was reported where its name was read.
void checkMesh(Preparation& state, const scene::Shape& shape) {
  if (shape.isCurves() && isThere(shape.file)) {
    const auto curves = accel::loadCurves(shape.file.string(), curveBasis(shape), {});
    if (!curves) state.appendAt(shape.origin.location, curves.errors());
  }
  if (!shape.isFromFile() || !isThere(shape.file)) return;
  const auto mesh = state.meshFiles.load(shape, {}, state.warnings);
  if (!mesh) state.appendAt(shape.origin.location, mesh.errors());
}

void checkEmitter(Preparation& state, const scene::Emitter& emitter) {
  if (emitter.type == scene::EmitterType::envmap && !isThere(emitter.file)) return;
  if (emitter.type == scene::EmitterType::background) return;  // All of it is its shader.
  const auto light = makeLight(state.registry, emitter);
  if (!light) state.appendNew(light.errors());
}

/// Whether all parameters are there that the type counts on: a wrong one was reported and left out.
bool isComplete(const scene::Volume& volume, const VolumeType& type) {
  return std::ranges::all_of(type.described.parameters, [&](const scene::ParameterSpec& spec) {
    return (!spec.required && !spec.defaultValue) || volume.find(spec.name);
  });
}

void checkVolume(Preparation& state, const scene::Volume& volume) {
  const VolumeType* type = state.registry.volume(volume.type);
  if (!type || !isComplete(volume, *type)) return;
  const scene::Volume still = state.standing(volume, false);
  const auto shape = type->make(
      {still, type->place(still), state.description.searchPath, state.warnings, state.scene->services.get(), {}});
  if (!shape) state.appendAt(volume.origin.location, shape.errors());
}

}  // namespace

Diagnostics checkParts(const scene::SceneDescription& description, const Registry& registry,
                       const PrepareOptions& options) {
  Diagnostics warnings;
  Preparation state(description, registry, options, warnings);
  for (const scene::ShaderUse& use : description.materials) checkShader(state, use, "surface");
  for (const scene::Displacement& each : description.displacements) checkShader(state, each.shader, "displacement");
  for (const scene::Medium& medium : description.media) checkShader(state, medium.shader, "volume");
  for (const scene::Shape& shape : description.shapes) checkMesh(state, shape);
  for (const scene::Emitter& emitter : description.emitters) checkEmitter(state, emitter);
  for (const scene::Volume& volume : description.volumes) checkVolume(state, volume);
  description.sources->annotate(state.errors);
  return state.errors;
}

}  // namespace aerosol::render
