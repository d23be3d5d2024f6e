#include "core/render/preparation/media.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "core/accel/closed_mesh.h"
#include "core/accel/simple_body.h"
#include "core/render/interior.h"
#include "core/render/medium_phase.h"
#include "core/render/medium_preparation.h"
#include "core/render/preparation/level_of_detail.h"
#include "core/render/preparation/velocities.h"
#include "core/render/voxel_media.h"

namespace aerosol::render {

namespace {

constexpr Box<Object> unitCube{{-1, -1, -1}, {1, 1, 1}};

const volume::Medium* placeMedium(Preparation& state, scene::Index index, const Transform<World, Object>& toWorld,
                                  const scene::MediumSampling& sampling, const BoundChange& change = {}) {
  const scene::ShaderUse& shader = state.description.media[index].shader;
  auto bound =
      bindShader(shader, "volume", toWorld, state.shaderSources(), state.scene->shading, state.warnings, change);
  if (!bound) {
    state.appendNew(bound.errors());
    return nullptr;
  }
  const std::string problem = problemOfDeclaredBound(*state.scene->shading.family(*bound).program);
  const auto isThis = [&](const Diagnostic& known) { return known.location == shader.nameLocation; };
  if (!problem.empty() && std::ranges::none_of(state.warnings.entries(), isThis)) {
    state.warnings.warning(shader.nameLocation, fmt::format("shader '{}': {}", shader.name, problem), {});
  }
  volume::Medium& medium = state.scene->media.emplace_back();
  if (const auto& phase = state.description.media[index].phase) {
    state.scene->mediumPhases.push_back(makePhase(*phase, state.registry));
    medium.phase = state.scene->mediumPhases.back().get();
  }
  medium.index = static_cast<std::uint32_t>(state.scene->media.size() - 1);
  state.scene->mediumShaders.push_back(*bound);
  state.scene->mediumLocations.push_back(shader.origin.location);
  state.scene->mediumNames.push_back(shader.name);
  state.placements.push_back({index, sampling, {.extent = std::numeric_limits<float>::infinity()}});
  return &medium;
}

const volume::Medium* placeMedium(Preparation& state, scene::Index index, const MovingPlace& placement,
                                  const scene::MediumSampling& sampling, const BoundChange& change = {}) {
  const volume::Medium* medium = placeMedium(state, index, placement.at(state.scene->shutter.open), sampling, change);
  if (medium) state.scene->shading.setMotion(state.scene->mediumShaders[medium->index], placement);
  return medium;
}

const volume::Medium* placeMedium(Preparation& state, scene::Index index,
                                  const scene::Placement<World, Object>& placement) {
  const scene::MediumSampling& sampling = state.description.media[index].sampling;
  if (const auto motion = state.motionOf(placement)) return placeMedium(state, index, MovingPlace(motion), sampling);
  return placeMedium(state, index, state.atOpening(placement), sampling);
}

void setLook(Preparation& state, const volume::Medium& medium, const VolumeLook& look) {
  state.scene->looks.resize(state.scene->media.size());
  state.scene->looks[medium.index] = look;
}

/// Another medium with the same shader in the same place.
const volume::Medium* copyMedium(Preparation& state, const volume::Medium& medium, const VolumeLook& look) {
  const std::uint32_t original = medium.index;
  volume::Medium& copy = state.scene->media.emplace_back(state.scene->media[original]);
  copy.index = static_cast<std::uint32_t>(state.scene->media.size() - 1);
  state.scene->mediumShaders.push_back(shading::InstanceRef(state.scene->mediumShaders[original]));
  state.scene->mediumLocations.push_back(SourceLocation(state.scene->mediumLocations[original]));
  state.scene->mediumNames.push_back(std::string(state.scene->mediumNames[original]));
  state.placements.push_back(Preparation::Placement(state.placements[original]));
  if (const MediumVelocity* moves = state.scene->velocityOf(original)) {
    const MediumVelocity same = *moves;
    state.scene->velocities.resize(state.scene->media.size());
    state.scene->velocities[copy.index] = same;
  }
  setLook(state, copy, look);
  return &copy;
}

/// The same media as long paths see them.
void placeCoarse(Preparation& state, const volume::Medium& own, const volume::Medium& onShadowRays) {
  const scene::Integrator& integrator = state.description.integrator;
  PreparedScene& scene = *state.scene;
  if (integrator.lodDepth == 0) return;
  const auto coarser = [&](const volume::Medium& medium) -> const volume::Medium* {
    const auto known = std::ranges::find(state.coarseMedia, medium.index, &CoarseMedium::medium);
    const int level = integrator.lodLevels + (known != state.coarseMedia.end() ? known->level : 0);
    const auto shader = coarserShader(state, scene.mediumShaders[medium.index], integrator.lodLevels);
    if (!shader) return &medium;
    const VolumeLook* const look = scene.lookOf(medium.index);
    const volume::Medium* const copy = copyMedium(state, medium, look ? *look : VolumeLook());
    if (!look) scene.looks[copy->index].reset();
    scene.mediumShaders[copy->index] = *shader;
    state.coarseMedia.push_back({copy->index, level, medium.index});
    scene.hasCoarseVolumes = true;
    return copy;
  };
  scene.coarseAfter = integrator.lodDepth;
  scene.coarseVolumes.push_back(coarser(own));
  scene.coarseShadowVolumes.push_back(&onShadowRays == &own ? scene.coarseVolumes.back() : coarser(onShadowRays));
}

/// A volume's medium, and more of it where shadow rays or the camera see another one.
void placeVolume(Preparation& state, const scene::Volume& volume, const VolumeType& type) {
  const auto look = lookOf(volume);
  if (!look) state.errors.append(look.errors());
  const auto motion = state.motionOf(volume.toWorld);
  const Transform<World, Object> local = type.place(state.standing(volume, motion != nullptr));
  const scene::MediumSampling sampling = state.description.samplingOf(volume);
  const BoundChange readsGrids = [&](shading::BoundGroup& bound) {
    if (type.files) state.gridAnswers.bind(bound, type.files(volume), *state.scene->services);
  };
  const volume::Medium* const own =
      motion ? placeMedium(state, volume.medium, MovingPlace(motion, asObject(local)), sampling, readsGrids)
             : placeMedium(state, volume.medium, local, sampling, readsGrids);
  const scene::VolumeControls& controls = volume.controls;
  const volume::Medium *onShadowRays = own, *fromCamera = own;
  if (own) {
    const int level = levelByDistance(state, state.scene->mediumShaders[own->index]);
    const auto shader = level > 0 ? coarserShader(state, state.scene->mediumShaders[own->index], level) : std::nullopt;
    if (shader) {
      state.scene->mediumShaders[own->index] = *shader;
      state.coarseMedia.push_back({own->index, level, {}});
    }
  }
  if (own && look) {
    state.placements[own->index].place.stepScale = controls.stepScale;
    if (*look) setLook(state, *own, **look);
    if (volume.velocity.isWanted()) placeVelocity(state, volume, own->index);
    if (controls.shadowDensity != 1) {
      VolumeLook seen = look->value_or(VolumeLook());
      seen.density *= controls.shadowDensity;
      seen.emission = 0;
      onShadowRays = copyMedium(state, *own, seen);
    }
    if (controls.holdout) {
      VolumeLook seen = look->value_or(VolumeLook());
      seen.scattersAll = true;
      fromCamera = copyMedium(state, *own, seen);
      state.scene->media[fromCamera->index].isHoldout = true;
    }
  }
  state.scene->volumes.push_back(own);
  state.scene->shadowVolumes.push_back(onShadowRays);
  state.scene->cameraVolumes.push_back(fromCamera);
  if (own && look) placeCoarse(state, *own, *onShadowRays);
}

bool hasVolume(const Box<Object>& box) {
  const Vector<Object> sides = box.upper - box.lower;
  const float volume = sides.x * sides.y * sides.z;
  return !box.isEmpty() && volume > 0 && std::isfinite(volume);
}

/// Where the media inside of shapes are, in the shape's own space.
void placeInteriors(Preparation& state) {
  for (std::size_t i = 0; i < state.description.shapes.size(); ++i) {
    const volume::Medium* const interior = state.scene->objects[i].interior;
    if (!interior) continue;
    const scene::Shape& shape = state.description.shapes[i];
    std::optional<Box<Object>>& domain = state.placements[interior->index].place.domain;
    if (shape.type == scene::ShapeType::cube && !shape.displacement) domain = unitCube;
    if (shape.type == scene::ShapeType::sphere && !shape.displacement) {
      const Vector<Object> radius(shape.radius, shape.radius, shape.radius);
      const Point<Object> center(shape.center.x, shape.center.y, shape.center.z);
      domain = Box<Object>{center - radius, center + radius};
    }
    if (!shape.isFromFile() && !shape.displacement) continue;
    Box<Object> box;
    const bool isAtHome = state.motionOf(shape.toWorld) != nullptr ||
                          state.scene->geometry->sharedPlacement(static_cast<accel::ObjectId>(i)) != nullptr;
    const Transform<Object, World> toObject =
        isAtHome ? Transform<Object, World>() : state.atOpening(shape.toWorld).inverse();
    for (const Point<World>& p : state.scene->geometry->mesh(static_cast<accel::ObjectId>(i))->positions) {
      box.extend(toObject(p));
    }
    domain = box;
  }
}

}  // namespace

void placeMedia(Preparation& state) {
  const std::size_t most = 5 * state.description.volumes.size() + 2 * state.description.shapes.size() + 1;
  state.scene->media.reserve(most + LightLinking::mostCopies(most));
  for (const scene::Volume& volume : state.description.volumes) {
    const VolumeType* type = state.registry.volume(volume.type);
    if (!type) {
      state.errors.error(volume.origin.location, fmt::format("there is no volume of type '{}'", volume.type));
      continue;
    }
    placeVolume(state, volume, *type);
  }
  for (std::size_t i = 0; i < state.description.shapes.size(); ++i) {
    const scene::Shape& shape = state.description.shapes[i];
    if (shape.interior) state.scene->objects[i].interior = placeMedium(state, *shape.interior, shape.toWorld);
    if (shape.exterior) state.scene->objects[i].exterior = placeMedium(state, *shape.exterior, shape.toWorld);
    if (shape.priority != 0) state.scene->objects[i].priority = shape.priority;
    state.scene->objects[i].clipsVolumes = shape.clipVolumes;
    state.scene->nestsMedia = state.scene->nestsMedia || shape.priority != 0 || shape.clipVolumes;
  }
  if (state.description.sensor.medium)
    state.scene->cameraMedium = placeMedium(state, *state.description.sensor.medium, scene::Placement<World, Object>());
}

namespace {

/// What the plan says takes the place of what the scene says. False where it is the plan of another scene.
bool followPlan(Preparation& state, const SamplingPlan& plan) {
  const std::string problem = whyNotFor(plan, state.scene->mediumNames);
  if (!problem.empty()) {
    state.errors.error(state.description.integrator.origin.location, problem,
                       {"make a plan of this scene, or leave it out"});
    return false;
  }
  for (std::size_t i = 0; i < plan.size(); ++i) {
    state.placements[i].sampling = plan[i].sampling.orElse(state.placements[i].sampling);
  }
  return true;
}

/// Fields of those media whose distances may be solved in closed form.
void findVoxels(Preparation& state) {
  const scene::Integrator& integrator = state.description.integrator;
  const auto mayBeAnalytic = [&](std::uint32_t medium) {
    const scene::DistanceSampling wanted = state.placements[medium].sampling.distance.value_or(integrator.distance);
    return wanted == scene::DistanceSampling::automatic || wanted == scene::DistanceSampling::analytic;
  };
  findVoxelMedia(*state.scene, mayBeAnalytic, static_cast<std::uint64_t>(integrator.boundMegabytes) * 1000000);
}

}  // namespace

namespace {

/// Whether a ray that enters the shape leaves it before it enters again: then there is no need to count.
bool isEnteredOnce(const Preparation& state, std::size_t index) {
  const auto object = static_cast<accel::ObjectId>(index);
  const scene::Shape& shape = state.description.shapes[index];
  if (shape.type == scene::ShapeType::sphere && !shape.displacement) return !shape.flipNormals;
  const accel::TriangleMesh* const mesh = state.scene->geometry->mesh(object);
  return mesh && !state.scene->geometry->sharedPlacement(object) && accel::isSimpleBody(*mesh);
}

}  // namespace

bool interiorsMayMeet(const Preparation& state, Point<World> eye, float reach) {
  std::vector<Box<World>> boxes;
  for (std::size_t i = 0; i < state.description.shapes.size(); ++i) {
    const PreparedObject& object = state.scene->objects[i];
    const scene::Shape& shape = state.description.shapes[i];
    if (!object.interior && !object.exterior && !object.saysInside) continue;
    if (shape.toWorld.motionDuring(state.scene->shutter)) return true;
    if (object.saysInside && !isEnteredOnce(state, i)) return true;
    if (!object.saysInside && shape.isFromFile() && object.interior) return true;
    const Box<World> box = state.scene->geometry->surfaceBounds(static_cast<accel::ObjectId>(i));
    if (!box.isEmpty()) boxes.push_back(box);
  }
  if (boxes.empty()) return false;
  if (state.scene->camera->motion()) return true;
  const auto meet = [](const Box<World>& a, const Box<World>& b) {
    for (int i = 0; i < 3; ++i) {
      // Faces that touch are met in either order.
      const float slack = 1e-5f * (std::fabs(a.lower[i]) + std::fabs(a.upper[i]));
      if (a.lower[i] > b.upper[i] + slack || a.upper[i] < b.lower[i] - slack) return false;
    }
    return true;
  };
  const Vector<World> around(reach, reach, reach);
  boxes.push_back({eye - around, eye + around});
  constexpr std::size_t most = 4096;
  if (boxes.size() > most) return true;
  for (std::size_t i = 1; i < boxes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (meet(boxes[i], boxes[j])) return true;
    }
  }
  return false;
}

void placeBodies(Preparation& state) {
  for (std::size_t i = 0; i < state.description.shapes.size(); ++i) {
    PreparedObject& object = state.scene->objects[i];
    if (!object.saysInside) continue;
    // What is asked is the same at any point.
    const SurfaceAnswer answer = askSurface(*state.scene, object.material, {});
    object.body = interiorOf(*state.scene, static_cast<std::uint32_t>(i), answer);
  }
}

void decideMedia(Preparation& state) {
  placeInteriors(state);
  state.errors.append(state.links.read(
      [&](const volume::Medium& medium, const VolumeLook& look) { return copyMedium(state, medium, look); }));
  if (state.errors.hasErrors()) return;
  for (volume::Medium& medium : state.scene->media) {
    const auto& motion = state.scene->shading.instance(state.scene->mediumShaders[medium.index]).motion;
    if (motion) medium.motion = &*motion;
  }
  const std::size_t count = state.scene->media.size();
  state.scene->trees.resize(count);
  state.scene->treeStatistics.resize(count);
  state.scene->samplingReasons.resize(count);
  state.scene->samplingPlan.resize(count);
  if (state.options.plan && !followPlan(state, *state.options.plan)) return;
  const scene::Integrator& integrator = state.description.integrator;
  findVoxels(state);
  const std::uint64_t share = std::max<std::size_t>(1, count);
  const volume::BoundBudget budget{.boxes = static_cast<std::uint64_t>(integrator.boundBoxes) / share,
                                   .bytes = static_cast<std::uint64_t>(integrator.boundMegabytes) * 1000000 / share};
  // Many media are decided side by side, each on one thread; a few one after the other, each on all.
  const int processors = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const bool sideBySide = count >= static_cast<std::size_t>(4 * processors);
  std::vector<Diagnostics> errors(count);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      Preparation::Placement& placement = state.placements[i];
      if (!std::isfinite(placement.place.extent)) placement.place.extent = state.sceneExtent();
      if (placement.place.domain && !hasVolume(*placement.place.domain)) placement.place.domain.reset();
      errors[i] = decideSampling(*state.scene, state.scene->media[i], placement.sampling, integrator, placement.place,
                                 budget, sideBySide ? 1 : processors);
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int i = 1; sideBySide && i < processors; ++i) threads.emplace_back(work);
    work();
  }
  for (const Diagnostics& each : errors) {
    for (const Diagnostic& found : each.entries())
      (found.severity == Severity::error ? state.errors : state.warnings).add(found);
  }
  if (!state.errors.hasErrors()) reportLevelsOfDetail(state);
}

}  // namespace aerosol::render
