#include "core/render/preparation/aovs.h"

namespace aerosol::render {

namespace {

PathEvent endAt(const Light& light) {
  if (light.isVolume()) return PathEvent::medium;
  return light.isInfinite() && !light.isDelta() ? PathEvent::background : PathEvent::light;
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
  while (sources.lights.size() < lights.size()) add({});
  return sources;
}

}  // namespace

void decideAovs(Preparation& state) {
  std::vector<scene::AovRequest> requests = state.description.integrator.aovs;
  requests.insert(requests.end(), state.options.aovs.begin(), state.options.aovs.end());
  if (requests.empty()) return;
  auto plan = planAovs(requests, describeSources(state));
  if (!plan) {
    state.errors.append(plan.errors());
    return;
  }
  if ((*plan)->wants(AovFeature::motion)) {
    for (const scene::Shape& shape : state.description.shapes) {
      auto& motion = (*plan)->objectMotions.emplace_back();
      if (auto moving = state.motionOf(shape.toWorld)) motion.emplace(std::move(moving));
    }
  }
  state.scene->aovs = std::move(*plan);
}

}  // namespace aerosol::render
