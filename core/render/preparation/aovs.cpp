#include "core/render/preparation/aovs.h"

#include <algorithm>

#include "core/render/preparation/deep.h"

namespace aerosol::render {

namespace {

PathEvent endAt(const Light& light) {
  if (light.isVolume()) return PathEvent::medium;
  return light.isInfinite() && !light.isDelta() ? PathEvent::background : PathEvent::light;
}

std::string firstOf(const std::string& id, const std::string& other) { return id.empty() ? other : id; }

std::string nameOf(const scene::ShaderUse& shader) { return firstOf(shader.origin.id, shader.name); }

/// What has no id is called by its kind and its number among those of its kind.
void nameThings(const Preparation& state, AovScene& scene) {
  const scene::SceneDescription& description = state.description;
  for (std::size_t i = 0; i < description.shapes.size(); ++i) {
    const scene::Shape& shape = description.shapes[i];
    scene.objectThings.push_back(
        {firstOf(shape.origin.id, "shape_" + std::to_string(i + 1)), nameOf(description.materials[shape.material])});
  }
  scene.mediumThings.resize(state.scene->media.size());
  for (std::size_t i = 0; i < scene.mediumThings.size(); ++i) {
    const std::string medium =
        i < state.placements.size() ? nameOf(description.media[state.placements[i].medium].shader) : "medium";
    scene.mediumThings[i] = {medium, medium};
  }
  const auto rename = [&](const volume::Medium* medium, const std::string& name) {
    if (medium && medium->index < scene.mediumThings.size()) scene.mediumThings[medium->index].name = name;
  };
  for (std::size_t i = 0; i < description.shapes.size(); ++i) {
    rename(state.scene->objects[i].interior, scene.objectThings[i].name);
  }
  for (std::size_t i = 0; i < description.volumes.size(); ++i) {
    const std::string name = firstOf(description.volumes[i].origin.id, "volume_" + std::to_string(i + 1));
    const std::string material = scene.mediumThings[state.scene->volumes[i]->index].material;
    for (const volume::Medium* medium : state.scene->mediaOf(i)) {
      rename(medium, name);
      scene.mediumThings[medium->index].material = material;
    }
  }
}

/// A shader's outputs that can be shown: numbers and triples. Those of layers also by their names without the layer's.
template <class Found>
void forOutputs(const lang::Program& program, Found&& found) {
  for (std::uint32_t i = 0; i < program.parameters.size(); ++i) {
    const lang::Parameter& parameter = program.parameters[i];
    const bool isNumber = parameter.type.isTriple() || parameter.type.base == lang::BaseType::floating ||
                          parameter.type.base == lang::BaseType::integer;
    if (!parameter.isOutput || !isNumber || parameter.type.isArray()) continue;
    found(i, parameter.name);
    if (const std::size_t dot = parameter.name.find('.'); dot != std::string::npos)
      found(i, parameter.name.substr(dot + 1));
  }
}

std::vector<scene::AovRequest> requestsOf(const Preparation& state) {
  std::vector<scene::AovRequest> requests = state.description.integrator.aovs;
  requests.insert(requests.end(), state.options.aovs.begin(), state.options.aovs.end());
  return requests;
}

/// Emitters of the scene come first among the lights, then those of shapes, then media.
AovScene describeSources(const Preparation& state) {
  const LightSet& lights = state.scene->lights;
  AovScene sources;
  sources.tracesPaths = state.description.integrator.type == "path";
  const auto add = [&](const std::string& group) {
    const auto index = static_cast<std::uint32_t>(sources.lights.size());
    sources.lights.push_back({endAt(lights[index]), group});
  };
  for (const scene::Emitter& emitter : state.description.emitters) add(emitter.lightGroup);
  for (const scene::Shape& shape : state.description.shapes) {
    if (shape.emitter) add(shape.emitter->lightGroup.empty() ? shape.lightGroup : shape.emitter->lightGroup);
    sources.objects.push_back({PathEvent::object, shape.lightGroup});
  }
  nameThings(state, sources);
  for (std::uint32_t i = 0; i < state.scene->objects.size(); ++i) {
    for (const auto& [site, name] : state.scene->objects[i].outputs) sources.outputs.push_back({i, site, name});
    for (const auto& [site, name] : state.scene->objects[i].labelNames) sources.closureLabels.push_back(name);
  }
  for (std::uint32_t i = 0; i < state.scene->mediumShaders.size(); ++i) {
    const lang::Program& program = *state.scene->shading.family(state.scene->mediumShaders[i]).program;
    forOutputs(program, [&](std::uint32_t parameter, const std::string& name) {
      sources.mediumOutputs.push_back({i, parameter, name});
    });
  }
  while (sources.lights.size() < lights.size()) add({});
  return sources;
}

/// Numbers the labels of closures where expressions follow paths.
void numberLabels(PreparedScene& scene, const AovPlan& plan) {
  if (!plan.followsPaths) return;
  for (PreparedObject& object : scene.objects) {
    if (object.labelNames.empty()) continue;
    object.labels.assign(object.closures.size(), 0);
    for (const auto& [site, name] : object.labelNames) {
      const auto label = std::find(plan.labels.begin(), plan.labels.end(), name);
      object.labels[site] = static_cast<std::uint32_t>(label - plan.labels.begin());
    }
  }
}

}  // namespace

void showOutputs(Preparation& state) {
  for (const scene::AovRequest& request : requestsOf(state)) {
    if (!request.quantity.starts_with("debug:")) continue;
    for (const shading::InstanceRef shader : state.scene->mediumShaders) {
      forOutputs(*state.scene->shading.family(shader).program, [&](std::uint32_t parameter, const std::string& name) {
        if (request.quantity.substr(6) == name) state.scene->shading.showOutput(shader, parameter);
      });
    }
  }
}

void decideAovs(Preparation& state) {
  const std::vector<scene::AovRequest> requests = requestsOf(state);
  const int slices = state.options.deepSlices;
  if (requests.empty() && slices == 0) return;
  auto plan = planAovs(requests, describeSources(state));
  if (!plan) {
    state.errors.append(plan.errors());
    return;
  }
  if (slices > 0 && state.description.integrator.type != "path") {
    state.errors.error(state.description.integrator.origin.location,
                       "the integrator 'depth' follows no light, which a deep image is about");
    return;
  }
  if (slices > 0) {
    AovLayout& layout = (*plan)->layout;
    layout.deep = deepLayout(state, slices);
    layout.deep.firstSlot = layout.width;
    layout.width += layout.deep.width();
  }
  if ((*plan)->wants(AovFeature::motion) || (*plan)->wants(AovFeature::visibleMotion)) {
    for (const scene::Shape& shape : state.description.shapes) {
      auto& motion = (*plan)->objectMotions.emplace_back();
      if (auto moving = state.motionOf(shape.toWorld)) motion.emplace(std::move(moving));
    }
  }
  state.scene->aovs = std::move(*plan);
  numberLabels(*state.scene, *state.scene->aovs);
}

}  // namespace aerosol::render
