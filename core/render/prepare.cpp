#include "core/render/prepare.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>

#include "core/render/interior.h"
#include "core/render/media_probe.h"
#include "core/render/overlap.h"
#include "core/render/preparation/aovs.h"
#include "core/render/preparation/contributions.h"
#include "core/render/preparation/displacement.h"
#include "core/render/preparation/lights.h"
#include "core/render/preparation/materials.h"
#include "core/render/preparation/media.h"
#include "core/render/preparation/shapes.h"
#include "core/render/scene_attributes.h"

namespace aerosol::render {

bool readsFootprints(const jit::KernelInterface& kernel) {
  using lang::Global;
  constexpr std::array changes{Global::dPdx, Global::dPdy, Global::dPdz, Global::dIdx, Global::dIdy,
                               Global::dudx, Global::dudy, Global::dvdx, Global::dvdy};
  return std::ranges::any_of(changes, [&](Global global) { return kernel.reads(global); });
}

namespace {

void setUpCamera(Preparation& state) {
  state.scene->camera.emplace(state.description.sensor, state.description.film);
  state.scene->filter.emplace(state.description.film.filter);
  if (const auto& motion = state.scene->camera->motion()) {
    state.scene->namedSpaces.addCamera(*motion, state.scene->camera->projection());
  } else {
    const auto toWorld = state.scene->camera->toWorld(state.scene->shutter.open);
    state.scene->namedSpaces.add("camera", toWorld.matrix(), toWorld.inverseMatrix());
    state.scene->namedSpaces.addCamera(toWorld.inverseMatrix(), state.scene->camera->projection());
  }
  state.scene->sampler =
      state.description.sampler.type == scene::SamplerType::sobol ? SamplerKind::sobol : SamplerKind::independent;
  state.scene->seed = static_cast<std::uint64_t>(state.description.sampler.seed);
  const scene::Integrator& integrator = state.description.integrator;
  state.scene->path = {integrator.maxDepth,     integrator.rrDepth,        integrator.hideEmitters,
                       integrator.stepScale,    integrator.equiangular,    integrator.splitLights,
                       integrator.jointLights,  integrator.lampDirections, integrator.clampIndirect > 0,
                       integrator.clampIndirect};
  state.scene->loopBudget = state.options.loopBudget;
}

/// Whether pictures of two instants would differ.
void findChanges(Preparation& state) {
  if (state.scene->shutter.isInstant()) return;
  state.scene->changes = state.scene->changes || state.scene->camera->motion();
  for (const shading::Family& family : state.scene->shading.families()) {
    for (const auto& kernel : family.kernels) {
      const int time = jit::globalPointer(lang::Global::time);
      if (kernel && (kernel->interface().globalsRead >> time & 1u) != 0) state.scene->changes = true;
    }
  }
}

/// Whether some shader reads how its inputs change from pixel to pixel.
void findFootprints(Preparation& state) {
  PreparedScene& scene = *state.scene;
  for (const shading::Family& family : scene.shading.families()) {
    for (const auto& kernel : family.kernels) {
      if (kernel && readsFootprints(kernel->interface()))
        scene.keepsFootprints = state.description.integrator.footprints;
    }
  }
  // What covers all there is needs to be no larger; endless media have no end to their footprints but this.
  const Box<World> bounds = scene.geometry->bounds();
  const float diagonal = bounds.isEmpty() ? 0 : length(bounds.upper - bounds.lower);
  scene.largestFootprint = diagonal > 0 && std::isfinite(diagonal) ? diagonal : 1e6f;
}

bool asksForArea(const Preparation& state, shading::InstanceRef material) {
  const auto& sites = state.scene->shading.family(material).kernel(shading::Variant::surface).interface().hostSites;
  return std::any_of(sites.begin(), sites.end(), [](const auto& site) { return site.function == "surfacearea"; });
}

/// What shaders may ask about the shapes and volumes that they are on.
void describeObjects(Preparation& state) {
  for (std::size_t i = 0; i < state.description.shapes.size(); ++i) {
    const scene::Shape& shape = state.description.shapes[i];
    const shading::InstanceRef material = state.scene->objects[i].material;
    float area = 0;
    if (asksForArea(state, material))
      area = static_cast<float>(areaAtOpening(state, shape, static_cast<accel::ObjectId>(i)));
    const auto attributes = describeObject(shape.origin, shape.attributes, state.scene->attributes);
    state.scene->shading.describeObject(material, attributes, area);
    for (const volume::Medium* medium : {state.scene->objects[i].interior, state.scene->objects[i].exterior}) {
      if (medium) state.scene->shading.describeObject(state.scene->mediumShaders[medium->index], attributes, 0);
    }
  }
  for (std::size_t i = 0; i < state.description.volumes.size(); ++i) {
    const scene::Volume& volume = state.description.volumes[i];
    state.scene->shading.describeObject(state.scene->mediumShaders[state.scene->volumes[i]->index],
                                        describeObject(volume.origin, volume.attributes, state.scene->attributes), 0);
  }
}

/// Where media nest the path's stack begins with what the camera is in.
void findInitialMedia(Preparation& state) {
  using enum volume::PriorityOrder;
  state.scene->priorityOrder = state.description.integrator.lowerPriorityWins ? lowerWins : higherWins;
  const Matrix4 m = state.scene->camera->toWorld(state.scene->shutter.open).matrix();
  const Point<World> eye(static_cast<float>(m[0][3]), static_cast<float>(m[1][3]), static_cast<float>(m[2][3]));
  // Corners of the near plane, and what rounding and the filter's width add.
  const auto reach = static_cast<float>(1.1 * state.scene->camera->startReach(state.scene->shutter.open));
  if (interiorsMayMeet(state, eye, reach)) state.scene->nestsMedia = true;
  if (!state.scene->nestsMedia.isCalledFor()) {
    placeBodies(state);
    return;
  }
  state.scene->initialMedia = findMedia(*state.scene, eye, state.scene->shutter.open);
  state.scene->probesMedia = state.scene->changes || needsProbes(*state.scene, eye, reach);
}

/// Whether the bounds of a light touch those of a body.
void findLightsOnFaces(Preparation& state) {
  PreparedScene& scene = *state.scene;
  const auto boxOf = [&](std::size_t object) {
    Box<World> box = scene.geometry->surfaceBounds(static_cast<accel::ObjectId>(object));
    for (int i = 0; i < 3; ++i) {
      const float slack = 1e-5f * (std::fabs(box.lower[i]) + std::fabs(box.upper[i]));
      box.lower[i] -= slack;
      box.upper[i] += slack;
    }
    return box;
  };
  const auto touch = [](const Box<World>& a, const Box<World>& b) {
    for (int i = 0; i < 3; ++i) {
      if (a.lower[i] > b.upper[i] || b.lower[i] > a.upper[i]) return false;
    }
    return !a.isEmpty() && !b.isEmpty();
  };
  std::vector<Box<World>> bodies;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects[i].saysInside) bodies.push_back(boxOf(i));
  }
  for (std::size_t i = 0; i < scene.objects.size() && !bodies.empty(); ++i) {
    if (!scene.objects[i].light) continue;
    const Box<World> box = boxOf(i);
    scene.lightsMeetFaces = scene.lightsMeetFaces.isCalledFor() ||
                            std::ranges::any_of(bodies, [&](const Box<World>& body) { return touch(body, box); });
  }
}

/// How lights beside rays through media are chosen together with places.
void decideLightChoice(Preparation& state) {
  PreparedScene& scene = *state.scene;
  scene.lightChoice = scene.path.equiangular.isCalledFor() ? LightChoice::equiangular : LightChoice::none;
  if (!scene.path.jointLights) return;
  const auto hasTable = [](const volume::Medium& medium) {
    return !medium.mayScatter || medium.method == volume::DistanceMethod::marching ||
           medium.method == volume::DistanceMethod::closedForm;
  };
  const auto without = std::ranges::find_if_not(scene.media, hasTable);
  if (without == scene.media.end()) {
    scene.lightChoice = LightChoice::tabulated;
    return;
  }
  state.warnings.warning(
      state.description.integrator.origin.location,
      "'joint_lights' has no effect: it needs the tables of ray marching, and '" + scene.mediumNames[without->index] +
          "' is sampled otherwise",
      {"choose 'marching' as the distance of all media, on the command line by --distance marching"});
}

/// What this build leaves out and the scene calls for.
void refuseMissingEffects(Preparation& state) {
  if (hasOptionalEffects) return;
  for (const std::string& effect : optionalEffectsOf(*state.scene)) {
    state.errors.error({}, "the scene calls for '" + effect + "', which this build leaves out",
                       {"an ordinary build (cmake --preset release) has it"});
  }
}

Diagnostics fail(Preparation& state) {
  state.description.sources->annotate(state.errors);
  return state.errors;
}

Result<std::unique_ptr<const PreparedScene>> run(Preparation& state) {
  state.scene->shutter = state.description.sensor.shutter();
  setUpCamera(state);
  bindMaterials(state);
  bindDisplacements(state);
  bindLightTextures(state);
  placeMedia(state);
  showOutputs(state);
  if (state.errors.hasErrors()) return fail(state);
  state.errors.append(
      state.scene->shading.compile(*state.options.compiler, {state.options.target, state.options.laneCounters}));
  if (state.errors.hasErrors()) return fail(state);
  // Without bounds kernels nothing is proven, and that is all: the programs themselves have been compiled.
  static_cast<void>(state.scene->shading.compileBounds(*state.options.compiler, {state.options.target, false}));
  findChanges(state);
  findSiteClosures(state);
  addShapes(state);
  addVolumes(state);
  if (state.errors.hasErrors()) return fail(state);
  buildGeometry(state);
  if (state.errors.hasErrors()) return fail(state);
  findFootprints(state);
  decideMedia(state);
  partitionVolumes(*state.scene);
  addLights(state);
  if (state.errors.hasErrors()) return fail(state);
  describeObjects(state);
  findLightsOnFaces(state);
  findInitialMedia(state);
  state.scene->splitsLights = state.scene->path.splitThreshold > 0 && !state.scene->lights.tree().isEmpty();
  decideLightChoice(state);
  if (state.scene->path.equiangular.isCalledFor() && state.scene->path.lampDirections) {
    state.scene->lampsInMedia = findLampsInMedia(*state.scene);
  }
  state.scene->asksMedia = std::ranges::any_of(state.scene->media, [](const volume::Medium& medium) {
    return medium.method != volume::DistanceMethod::closedForm ||
           medium.transmittance != volume::TransmittanceMethod::closedForm;
  });
  if (!state.errors.hasErrors()) learnContributions(state);
  decideAovs(state);
  refuseMissingEffects(state);
  if (state.errors.hasErrors()) return fail(state);
  state.description.sources->annotate(state.warnings);
  return std::unique_ptr<const PreparedScene>(std::move(state.scene));
}

}  // namespace

Result<std::unique_ptr<const PreparedScene>> prepare(const scene::SceneDescription& description,
                                                     const Registry& registry, const PrepareOptions& options,
                                                     Diagnostics& warnings) {
  const auto threads = options.threads > 0 ? static_cast<std::size_t>(options.threads)
                                           : std::max<std::size_t>(1, std::thread::hardware_concurrency());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  Preparation state(description, registry, options, warnings);
  return run(state);
}

}  // namespace aerosol::render
