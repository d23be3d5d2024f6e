// A scene ready to be rendered. Const once preparation is over; every thread reads it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/accel/scene.h"
#include "core/render/aov/aov_plan.h"
#include "core/render/camera.h"
#include "core/render/carried_volume.h"
#include "core/render/closure.h"
#include "core/render/contribution_map.h"
#include "core/render/filter.h"
#include "core/render/lamp_directions.h"
#include "core/render/light_choice.h"
#include "core/render/light_set.h"
#include "core/render/linked_lights.h"
#include "core/render/message_log.h"
#include "core/render/optional_effects.h"
#include "core/render/sample_stream.h"
#include "core/render/sampling_plan.h"
#include "core/render/volume_look.h"
#include "core/shading/attributes.h"
#include "core/shading/kernel_host.h"
#include "core/shading/services.h"
#include "core/shading/shading_system.h"
#include "core/volume/bounds/bound_builder.h"
#include "core/volume/medium.h"
#include "core/volume/medium_stack.h"
#include "core/volume/phase.h"
#include "core/volume/trackers/voxel_medium.h"

namespace aerosol::render {

/// A surface: what it is made of and what lies on its two sides.
struct PreparedObject {
  shading::InstanceRef material;
  bool isBoundary = false;                   ///< Null material: rays pass, and change medium.
  const volume::Medium* interior = nullptr;  ///< On the side away from the normal; null: vacuum.
  const volume::Medium* exterior = nullptr;
  std::optional<int> priority;           ///< Of the interior, where no closure describes one.
  bool saysInside = false;               ///< A closure of its material describes the interior.
  bool passesShadows = false;            ///< Its material has an answer of its own for shadow rays.
  bool passesPoints = false;             ///< Lights that are points or directions shine through it straight.
  bool facesViewer = false;              ///< Shaders are told normals towards the viewer.
  bool castsShadows = true;              ///< Otherwise shadow rays pass.
  bool stopsScattered = true;            ///< Rays that surfaces and media scatter meet it.
  std::uint32_t lightLinks = 0;          ///< As of media: which lights light it; 0: all.
  bool clipsVolumes = false;             ///< The interior rules out volume primitives too.
  std::optional<std::uint32_t> light;    ///< Index of its area light.
  std::vector<const Closure*> closures;  ///< By closure site of the material's program.
  /// What a closure says is inside, where paths keep no stack: the same everywhere on the surface.
  std::optional<volume::Interior> body;
  struct Output {
    std::uint32_t site = 0;
    std::string name;
  };
  std::vector<Output> outputs;                          ///< Closures that give their weight to an AOV.
  std::vector<Output> labelNames;                       ///< Closures that light path expressions may know by a name.
  std::vector<std::uint32_t> labels;                    ///< By site, as AovPlan numbers them; empty where none matters.
  std::vector<std::vector<lang::ClosureLayer>> layers;  ///< What lies on them, by site; empty where nothing is layered.

  /// Whether the shape says what is on its sides. One that does not stands in whatever medium there is.
  bool separatesMedia() const { return interior || exterior || priority || clipsVolumes; }
  /// The medium behind it, `here` being that before it, where no stack is kept.
  const volume::Medium* behind(bool entering, const volume::Medium* here) const {
    if (body) return entering ? volume::mediumOf(*body) : exterior;
    if (!interior && !exterior) return here;
    return entering ? interior : exterior;
  }
  /// What crossing the face of its body means, with nothing around it.
  volume::Crossing crossBody(bool entering) const {
    return {.iorBefore = entering ? 1 : body->ior, .iorAfter = entering ? body->ior : 1, .hasIndices = body->saysIndex};
  }
};

/// Path tracing parameters (Mitsuba's meaning).
struct PathSettings {
  int maxDepth = -1;  ///< Longest path in segments; -1: unbounded.
  int rrDepth = 5;    ///< Path length from which Russian roulette is played.
  bool hideEmitters = false;
  float stepScale = 1;
  EffectSwitch equiangular = true;  ///< Distances in media are also sampled for the lights beside the ray.
  float splitThreshold = 0;    ///< Clusters of lights are split whose spread is a larger part of all light; 0: none.
  bool jointLights = false;    ///< Places along rays for lights come from the tables of marching.
  bool lampDirections = true;  ///< And directions towards lamps in media.
  EffectSwitch clampsIndirect = false;
  float clampIndirect = 0;  ///< The largest value of light that was scattered twice or more, where it is clamped.
};

/// How a medium moves by its velocity: its shader is run at x - (t - reference) v(x).
struct MediumVelocity {
  shading::InstanceRef shader;  ///< Whose variant Variant::velocity gives v, in world space.
  float factor = 1;             ///< From what it gives to scene units per second.
  float referenceTime = 0;
  const CarriedVolume* within =
      nullptr;  ///< Outside of which there was nothing at the reference time; null: no bounds.

  /// Whether a place was inside of that; `placed` is the instance of the medium's shader.
  bool held(const shading::Instance& placed, Point<World> atReference, float time) const {
    if (!within) return true;
    return within->held(placed.motion ? placed.motion->at(time).inverse()(atReference)
                                      : placed.objectToWorld.inverse()(atReference));
  }
};

/// Whether a kernel reads how its inputs change from pixel to pixel.
bool readsFootprints(const jit::KernelInterface& kernel);

struct PreparedScene {
  std::optional<accel::Scene> geometry;
  shading::ShadingSystem shading;
  shading::NamedSpaces namedSpaces;
  std::unique_ptr<shading::Services> services;  ///< Safe to use from all threads, like everything here.
  shading::SceneAttributes attributes;
  std::vector<volume::Medium> media;                            ///< Addresses are stable.
  std::vector<shading::InstanceRef> mediumShaders;              ///< By medium index.
  std::vector<SourceLocation> mediumLocations;                  ///< By medium index.
  std::vector<std::string> mediumNames;                         ///< Shader names by medium index.
  std::vector<std::optional<MediumVelocity>> velocities;        ///< By medium index; empty when no medium has one.
  std::vector<std::unique_ptr<const volume::BoundTree>> trees;  ///< By medium index; null where a medium has none.
  std::vector<std::unique_ptr<const volume::VoxelMedium>> voxelMedia;  ///< By medium index; null where there are none.
  std::vector<volume::BoundStatistics> treeStatistics;                 ///< By medium index.
  SamplingPlan samplingPlan;                                           ///< The methods of all media.
  std::vector<std::string> samplingReasons;                            ///< By medium index: the methods, and why.
  std::vector<std::vector<const Closure*>> siteClosures;               ///< By family, then closure site; null: none.
  std::vector<PreparedObject> objects;                                 ///< By accel::ObjectId.
  std::vector<const volume::Medium*> volumes;                          ///< By accel::VolumeId.
  std::vector<const volume::Medium*> cameraVolumes;                    ///< The same as rays from the camera see them,
  std::vector<const volume::Medium*> shadowVolumes;                    ///< and as shadow rays do.
  EffectSwitch hasCoarseVolumes;  ///< Paths with more segments than `coarseAfter` see volumes with coarser voxels.
  int coarseAfter = 0;
  std::vector<const volume::Medium*> coarseVolumes, coarseShadowVolumes;  ///< By accel::VolumeId, where there are any.
  std::vector<std::optional<VolumeLook>> looks;             ///< By medium index; empty when no volume has one.
  std::vector<std::unique_ptr<LinkedLights>> linkedLights;  ///< Of media that not all lights light.
  /// What shaders may ask of the meshes that they are on: by family, then instance; null where a mesh has no
  /// attributes. May be shorter.
  std::vector<std::vector<const accel::TriangleMesh*>> attributeMeshes;
  Shutter shutter;
  EffectSwitch changes;  ///< Something changes while the shutter is open: every path has a time of its own.
  /// Some shader reads how its inputs change from pixel to pixel: paths keep the differentials of their rays.
  EffectSwitch keepsFootprints;
  float largestFootprint = 0;                    ///< No change of a position is longer.
  const volume::Medium* cameraMedium = nullptr;  ///< Surface-defined medium around the camera.
  /// Some surface is met by shadow rays and not by all others: what these find has to be seen by shadow rays too.
  bool hidesSurfaces = false;
  EffectSwitch shadowsPass;       ///< Some material lets light through unbent, and says how much.
  EffectSwitch asksMedia = true;  ///< Some medium is sampled otherwise than by closed forms.
  EffectSwitch nestsMedia;        ///< Some material says what is inside: paths keep a stack of interiors.
  EffectSwitch hasSubsurface;     ///< Some material lets light into its body.
  volume::PriorityOrder priorityOrder = volume::PriorityOrder::higherWins;
  volume::MediumStack initialMedia;  ///< Around the camera; used when media nest.
  EffectSwitch probesMedia;          ///< Paths may begin in different media: each one looks by itself.
  LightSet lights;
  std::vector<LampInMedia> lampsInMedia;        ///< Towards which directions are chosen.
  LightChoice lightChoice = LightChoice::none;  ///< Of places along rays through media.
  EffectSwitch splitsLights;                    ///< Vertices may sample several clusters of lights.
  EffectSwitch hasMovingLights;
  std::vector<std::optional<shading::InstanceRef>> lightTextures;  ///< By light: what its light is multiplied by.
  std::optional<Camera> camera;
  std::optional<Filter> filter;
  SamplerKind sampler = SamplerKind::sobol;
  std::uint64_t seed = 0;
  const volume::PhaseFunction* phase = nullptr;                            ///< Of the lobes that volume shaders return.
  std::vector<std::shared_ptr<const volume::PhaseFunction>> mediumPhases;  ///< Of media that have their own.

  const volume::PhaseFunction& phaseOf(const volume::Medium& medium) const {
    return medium.phase ? *medium.phase : *phase;
  }
  PathSettings path;
  ContributionMap contributions;        ///< For Russian roulette; empty: by throughput.
  std::unique_ptr<const AovPlan> aovs;  ///< Null when none are asked for; films with its layout gather them.
  std::uint32_t loopBudget = 1u << 20;
  std::unique_ptr<MessageLog> messages = std::make_unique<MessageLog>();
  EffectSwitch lightsMeetFaces;  ///< Some light may lie on a face of a material that says what is inside.

  const accel::TriangleMesh* meshWithAttributes(shading::InstanceRef shader) const {
    if (shader.family >= attributeMeshes.size()) return nullptr;
    const auto& meshes = attributeMeshes[shader.family];
    return shader.index < meshes.size() ? meshes[shader.index] : nullptr;
  }
  /// From now on the shader finds the attributes of the object's mesh.
  void giveAttributes(shading::InstanceRef shader, accel::ObjectId object) {
    const accel::TriangleMesh* mesh = geometry->mesh(object);
    if (!mesh || mesh->attributes.empty()) return;
    if (attributeMeshes.size() <= shader.family) attributeMeshes.resize(shader.family + 1);
    auto& meshes = attributeMeshes[shader.family];
    if (meshes.size() <= shader.index) meshes.resize(shader.index + 1);
    meshes[shader.index] = mesh;
  }

  /// Null where a medium does not move so.
  const MediumVelocity* velocityOf(std::uint32_t medium) const {
    return hasOptionalEffects && medium < velocities.size() && velocities[medium] ? &*velocities[medium] : nullptr;
  }
  /// Null where the shader is left as it is.
  const VolumeLook* lookOf(std::uint32_t medium) const {
    return hasOptionalEffects && medium < looks.size() && looks[medium] ? &*looks[medium] : nullptr;
  }
  /// Null where all lights count.
  const LinkedLights* linksOf(const volume::Medium& medium) const {
    return !hasOptionalEffects || medium.lightLinks == 0 ? nullptr : linkedLights[medium.lightLinks - 1].get();
  }
  const LinkedLights* linksOf(const PreparedObject& object) const {
    return !hasOptionalEffects || object.lightLinks == 0 ? nullptr : linkedLights[object.lightLinks - 1].get();
  }
  const LightSet& lightsOf(const LinkedLights* links) const {
    return hasOptionalEffects && links ? links->lights : lights;
  }
  /// Whether the light is multiplied by a texture.
  bool isTextured(std::uint32_t light) const { return hasOptionalEffects && lightTextures[light]; }
  /// The media of volumes for a ray of this type (shading::ray) from where `links` hold, by accel::VolumeId. The ray is
  /// the path's segment number `length`.
  std::span<const volume::Medium* const> volumesFor(std::uint32_t rayTypes, const LinkedLights* links,
                                                    int length) const {
    if (hasOptionalEffects && links) return links->volumes;
    if (seesCoarse(length)) return coarseVolumes;
    return rayTypes == shading::ray::camera ? cameraVolumes : volumes;
  }
  /// The same for the shadow ray that is segment number `length`.
  std::span<const volume::Medium* const> shadowVolumesFor(int length) const {
    return seesCoarse(length) ? coarseShadowVolumes : shadowVolumes;
  }
  /// All that a volume primitive holds for one ray or another. (One medium may be several of them.)
  std::vector<const volume::Medium*> mediaOf(std::size_t volume) const {
    std::vector<const volume::Medium*> all{volumes[volume], cameraVolumes[volume], shadowVolumes[volume]};
    if (volume < coarseVolumes.size()) all.insert(all.end(), {coarseVolumes[volume], coarseShadowVolumes[volume]});
    return all;
  }
  bool seesCoarse(int length) const { return hasCoarseVolumes && length > coarseAfter; }
};

}  // namespace aerosol::render
