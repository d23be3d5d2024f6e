#include "core/render/prepare.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "core/accel/obj.h"
#include "core/accel/ply.h"
#include "core/lang/analysis.h"
#include "core/render/interior.h"
#include "core/render/media_probe.h"
#include "core/render/medium_phase.h"
#include "core/render/medium_preparation.h"
#include "core/render/overlap.h"
#include "core/render/scene_attributes.h"
#include "core/render/scene_services.h"
#include "core/render/shader_binding.h"

namespace aerosol::render {

namespace {

/// Builds a scene step by step. Each step adds to the errors what is wrong with its part, so that one run reports all.
class Preparation {
 public:
  Preparation(const scene::SceneDescription& description, const Registry& registry, const PrepareOptions& options,
              Diagnostics& warnings)
      : description_(description),
        registry_(registry),
        options_(options),
        warnings_(warnings),
        library_(makeLibrary()),
        scene_(std::make_unique<PreparedScene>()) {
    scene_->services = makeServices({searchPath(), options.textureMemory_MB});
  }

  Result<std::unique_ptr<const PreparedScene>> run() {
    setUpCamera();
    bindMaterials();
    placeMedia();
    if (errors_.hasErrors()) return fail();
    errors_.append(scene_->shading.compile(*options_.compiler, {options_.target, options_.laneCounters}));
    if (errors_.hasErrors()) return fail();
    findSiteClosures();
    addShapes();
    addVolumes();
    if (errors_.hasErrors()) return fail();
    buildGeometry();
    if (errors_.hasErrors()) return fail();
    decideMedia();
    partitionVolumes(*scene_);
    addLights();
    if (errors_.hasErrors()) return fail();
    describeObjects();
    findInitialMedia();
    description_.sources->annotate(warnings_);
    return std::unique_ptr<const PreparedScene>(std::move(scene_));
  }

 private:
  /// Where a medium of the description is placed.
  struct Placement {
    scene::Index medium = 0;
    scene::MediumSampling sampling;
    MediumPlace place;
  };

  std::vector<std::filesystem::path> searchPath() const {
    std::vector<std::filesystem::path> path = options_.shaderPath;
    path.insert(path.end(), description_.searchPath.begin(), description_.searchPath.end());
    path.push_back(options_.shaderLibrary);
    return path;
  }

  shading::ShaderLibrary makeLibrary() const {
    const std::vector<std::filesystem::path> path = searchPath();
    lang::CompileOptions compile;
    compile.includePaths = path;
    compile.standardLibrary = options_.shaderLibrary / "stdosl.h";
    return {path, compile, options_.cache};
  }

  ShaderSources shaderSources() { return {library_, groups_, description_.layers}; }

  Diagnostics fail() {
    description_.sources->annotate(errors_);
    return errors_;
  }

  void bindMaterials() {
    describeScene(description_, scene_->attributes);
    for (const scene::Shape& shape : description_.shapes) {
      auto bound = bindShader(description_.materials[shape.material], "surface", shape.toWorld, shaderSources(),
                              scene_->shading, warnings_);
      scene_->objects.emplace_back();
      if (bound) {
        scene_->objects.back().material = *bound;
      } else {
        appendNew(bound.errors());
      }
    }
  }

  /// A material used by many shapes is reported once.
  void appendNew(const Diagnostics& errors) {
    for (const Diagnostic& each : errors.entries()) appendNew(each);
  }

  void appendNew(const Diagnostic& error) {
    const bool known = std::any_of(errors_.entries().begin(), errors_.entries().end(), [&](const Diagnostic& e) {
      return e.location == error.location && e.message == error.message;
    });
    if (!known) errors_.add(error);
  }

  void placeMedia() {
    scene_->media.reserve(description_.volumes.size() + 2 * description_.shapes.size() + 1);
    for (const scene::Volume& volume : description_.volumes) {
      const VolumeType* type = registry_.volume(volume.type);
      if (!type) {
        errors_.error(volume.origin.location, fmt::format("there is no volume of type '{}'", volume.type));
        continue;
      }
      scene_->volumes.push_back(place(volume.medium, type->place(volume), description_.samplingOf(volume)));
    }
    for (std::size_t i = 0; i < description_.shapes.size(); ++i) {
      const scene::Shape& shape = description_.shapes[i];
      if (shape.interior) scene_->objects[i].interior = place(*shape.interior, shape.toWorld);
      if (shape.exterior) scene_->objects[i].exterior = place(*shape.exterior, shape.toWorld);
      if (shape.priority > 0) scene_->objects[i].priority = shape.priority;
      scene_->objects[i].clipsVolumes = shape.clipVolumes;
      scene_->nestsMedia = scene_->nestsMedia || shape.priority > 0 || shape.clipVolumes;
    }
    if (description_.sensor.medium) scene_->cameraMedium = place(*description_.sensor.medium, {});
  }

  const volume::Medium* place(scene::Index index, const Transform<World, Object>& toWorld) {
    return place(index, toWorld, description_.media[index].sampling);
  }

  const volume::Medium* place(scene::Index index, const Transform<World, Object>& toWorld,
                              const scene::MediumSampling& sampling) {
    const scene::ShaderUse& shader = description_.media[index].shader;
    auto bound = bindShader(shader, "volume", toWorld, shaderSources(), scene_->shading, warnings_);
    if (!bound) {
      appendNew(bound.errors());
      return nullptr;
    }
    volume::Medium& medium = scene_->media.emplace_back();
    if (const auto& phase = description_.media[index].phase) {
      scene_->mediumPhases.push_back(makePhase(*phase, registry_));
      medium.phase = scene_->mediumPhases.back().get();
    }
    medium.index = static_cast<std::uint32_t>(scene_->media.size() - 1);
    scene_->mediumShaders.push_back(*bound);
    scene_->mediumLocations.push_back(shader.origin.location);
    scene_->mediumNames.push_back(shader.name);
    placements_.push_back({index, sampling, {.extent = std::numeric_limits<float>::infinity()}});
    return &medium;
  }

  void addShapes() {
    for (std::size_t i = 0; i < description_.shapes.size(); ++i) {
      const scene::Shape& shape = description_.shapes[i];
      PreparedObject& object = scene_->objects[i];
      describeMaterial(object);
      auto id = addShape(shape, object.isBoundary);
      if (!id) appendAt(shape.origin.location, id.errors());
    }
  }

  /// Errors without a place of their own are those of the element.
  void appendAt(const SourceLocation& element, const Diagnostics& errors) {
    for (Diagnostic error : errors.entries()) {
      if (error.location.file.empty()) error.location = element;
      errors_.add(std::move(error));
    }
  }

  /// Which closures the material's sites are, and whether it lets everything through.
  void describeMaterial(PreparedObject& object) {
    const lang::Program& program = *scene_->shading.family(object.material).program;
    if (program.closureSites.size() > SurfaceAnswer::maximumSites) {
      errors_.error(program.locations[program.closureSites[SurfaceAnswer::maximumSites].location],
                    fmt::format("shader '{}' has more than {} closures", program.name, SurfaceAnswer::maximumSites));
      return;
    }
    object.closures = scene_->siteClosures[object.material.family];
    const lang::Program folded = lang::specialise(program, {});
    for (std::size_t i = 0; i < program.closureSites.size(); ++i) {
      if (!program.closureSites[i].layers.empty()) {
        errors_.error(program.locations[program.closureSites[i].location],
                      "layered closures are not implemented for surfaces");
      }
      checkSite(folded, static_cast<std::uint32_t>(i), object.closures[i]);
      if (object.closures[i] && object.closures[i]->kind() == ClosureKind::interior) scene_->nestsMedia = true;
    }
    if (errors_.hasErrors()) return;
    const std::optional<SurfaceAnswer> constant = constantClosures(*scene_, object.material);
    if (!constant) return;
    Color passing;
    bool hasOther = false;
    for (std::uint32_t s = 0; s < constant->siteCount; ++s) {
      if (object.closures[s]->kind() == ClosureKind::transparent) {
        passing += constant->sites[s].weight;
      } else {
        hasOther = hasOther || !isBlack(constant->sites[s].weight);
      }
    }
    object.isBoundary = !hasOther && passing == Color(1.0f);
  }

  /// Options that a shader does not write are zero.
  static bool isZero(const lang::Program& program, std::uint32_t site, std::size_t parameter) {
    for (const lang::Output& output : program.outputs) {
      if (output.kind != lang::OutputKind::siteParameter || output.index != site || output.subIndex != parameter)
        continue;
      const lang::Variable& variable = program.variables[output.variable];
      const auto* floats = std::get_if<std::vector<float>>(&variable.value);
      return variable.storage == lang::Storage::constant && floats &&
             std::all_of(floats->begin(), floats->end(), [](float value) { return value == 0; });
    }
    return true;
  }

  /// Every parameter of the site has to mean something to the closure.
  void checkSite(const lang::Program& program, std::uint32_t index, const Closure* closure) {
    const lang::ClosureSite& site = program.closureSites[index];
    const SourceLocation& place = program.locations[site.location];
    if (!closure) {
      appendNew(Diagnostic{
          Severity::error, place, fmt::format("closure '{}' is not implemented for surfaces", site.closure), {}, {}});
      return;
    }
    for (std::size_t i = 0; i < site.parameterNames.size(); ++i) {
      const std::string& name = site.parameterNames[i];
      const auto fields = closure->fields();
      const bool isKnown = name == "label" || std::any_of(fields.begin(), fields.end(),
                                                          [&](const DescribedField& f) { return f.name == name; });
      if (isKnown || isZero(program, index, i)) continue;
      appendNew(Diagnostic{
          Severity::error, place, fmt::format("'{}' of closure '{}' is not implemented", name, site.closure), {}, {}});
    }
  }

  /// The closures of the renderer behind those of each shader.
  void findSiteClosures() {
    for (const shading::Family& family : scene_->shading.families()) {
      auto& closures = scene_->siteClosures.emplace_back();
      for (const lang::ClosureSite& site : family.program->closureSites) {
        closures.push_back(registry_.closure(site.closure));
      }
    }
  }

  static Transform<World, Object> sphereToWorld(const scene::Shape& shape) {
    return ballPlacement(shape.toWorld, shape.center, shape.radius);
  }

  Result<accel::ObjectId> addShape(const scene::Shape& shape, bool passThrough) {
    using scene::ShapeType;
    if (shape.type == ShapeType::sphere)
      return builder_.addSphere(sphereToWorld(shape), passThrough, shape.flipNormals);
    if (shape.type == ShapeType::disk) return builder_.addDisk(shape.toWorld, passThrough, shape.flipNormals);
    accel::TriangleMesh mesh;
    if (shape.type == ShapeType::obj || shape.type == ShapeType::ply) {
      const std::string file = shape.file.string();
      auto loaded = shape.type == ShapeType::obj ? accel::loadObj(file, shape.toWorld, warnings_)
                                                 : accel::loadPly(file, shape.toWorld, warnings_);
      if (!loaded) return loaded.errors();
      mesh = std::move(*loaded);
    } else {
      mesh = shape.type == ShapeType::cube ? accel::makeCube(shape.toWorld) : accel::makeRectangle(shape.toWorld);
    }
    mesh.faceNormals = mesh.faceNormals || shape.faceNormals;
    mesh.flipNormals = shape.flipNormals;
    return builder_.addMesh(std::move(mesh), passThrough);
  }

  void addVolumes() {
    for (std::size_t i = 0; i < description_.volumes.size(); ++i) {
      const scene::Volume& volume = description_.volumes[i];
      const VolumeType& type = *registry_.volume(volume.type);
      auto shape = type.make({volume, type.place(volume), description_.searchPath, warnings_, scene_->services.get()});
      if (!shape) {
        appendAt(volume.origin.location, shape.errors());
        continue;
      }
      const Box<World> bounds = (*shape)->worldBounds();
      placements_[scene_->volumes[i]->index].place = {
          .extent = length(bounds.upper - bounds.lower), .domain = (*shape)->objectBounds(), .staysInside = true};
      if (auto added = builder_.addVolume(std::move(*shape)); !added) {
        appendAt(volume.origin.location, added.errors());
      }
    }
  }

  void buildGeometry() {
    using scene::OverlapChoice;
    accel::SceneOptions options{.embreeIsa = options_.embreeIsa};
    const OverlapChoice choice = description_.integrator.overlap;
    if (choice == OverlapChoice::partition) options.overlap = accel::OverlapDesign::partition;
    if (choice == OverlapChoice::automatic) options.overlap = builder_.preferredOverlapDesign();
    auto built = builder_.build(options);
    if (built) {
      scene_->geometry.emplace(std::move(*built));
    } else {
      errors_.append(built.errors());
    }
  }

  float sceneExtent() const {
    const Box<World> bounds = scene_->geometry->bounds();
    return bounds.isEmpty() ? 1.0f : length(bounds.upper - bounds.lower);
  }

  void decideMedia() {
    // Without bounds kernels nothing is proven, and that is all: the programs themselves have been compiled.
    static_cast<void>(scene_->shading.compileBounds(*options_.compiler, {options_.target, false}));
    placeInteriors();
    const std::size_t count = scene_->media.size();
    scene_->trees.resize(count);
    scene_->treeStatistics.resize(count);
    const scene::Integrator& integrator = description_.integrator;
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
        Placement& placement = placements_[i];
        if (!std::isfinite(placement.place.extent)) placement.place.extent = sceneExtent();
        if (placement.place.domain && !hasVolume(*placement.place.domain)) placement.place.domain.reset();
        errors[i] = decideSampling(*scene_, scene_->media[i], placement.sampling, integrator, placement.place, budget,
                                   sideBySide ? 1 : processors);
      }
    };
    {
      std::vector<std::jthread> threads;
      for (int i = 1; sideBySide && i < processors; ++i) threads.emplace_back(work);
      work();
    }
    for (const Diagnostics& each : errors) errors_.append(each);
  }

  static bool hasVolume(const Box<Object>& box) {
    const Vector<Object> sides = box.upper - box.lower;
    const float volume = sides.x * sides.y * sides.z;
    return !box.isEmpty() && volume > 0 && std::isfinite(volume);
  }

  /// Where the media inside of shapes are, in the shape's own space.
  void placeInteriors() {
    for (std::size_t i = 0; i < description_.shapes.size(); ++i) {
      const volume::Medium* const interior = scene_->objects[i].interior;
      if (!interior) continue;
      const scene::Shape& shape = description_.shapes[i];
      std::optional<Box<Object>>& domain = placements_[interior->index].place.domain;
      if (shape.type == scene::ShapeType::cube) domain = unitCube;
      if (shape.type == scene::ShapeType::sphere) {
        const Vector<Object> radius(shape.radius, shape.radius, shape.radius);
        const Point<Object> center(shape.center.x, shape.center.y, shape.center.z);
        domain = Box<Object>{center - radius, center + radius};
      }
      if (shape.type != scene::ShapeType::obj && shape.type != scene::ShapeType::ply) continue;
      Box<Object> box;
      const Transform<Object, World> toObject = shape.toWorld.inverse();
      for (const Point<World>& p : scene_->geometry->mesh(static_cast<accel::ObjectId>(i))->positions) {
        box.extend(toObject(p));
      }
      domain = box;
    }
  }

  void addLights() {
    std::vector<std::unique_ptr<const Light>> lights;
    const auto add = [&](const scene::Emitter& emitter, std::shared_ptr<const LightSurface> surface) {
      auto light = makeLight(registry_, emitter, std::move(surface));
      if (!light) {
        errors_.append(light.errors());
        return false;
      }
      lights.push_back(std::move(*light));
      return true;
    };
    for (const scene::Emitter& emitter : description_.emitters) add(emitter, nullptr);
    for (std::size_t i = 0; i < description_.shapes.size(); ++i) {
      const scene::Shape& shape = description_.shapes[i];
      if (!shape.emitter) continue;
      std::shared_ptr<const LightSurface> surface = lightSurface(shape, static_cast<accel::ObjectId>(i));
      if (!surface) {
        errors_.error(shape.origin.location, "a shape without area cannot emit");
        continue;
      }
      if (add(*shape.emitter, surface)) scene_->objects[i].light = static_cast<std::uint32_t>(lights.size() - 1);
    }
    scene_->lights = LightSet(std::move(lights), 0.5f * sceneExtent());
    scene_->phase = registry_.phase("henyey_greenstein");
  }

  /// What shaders may ask about the shapes and volumes that they are on.
  void describeObjects() {
    for (std::size_t i = 0; i < description_.shapes.size(); ++i) {
      const scene::Shape& shape = description_.shapes[i];
      const shading::InstanceRef material = scene_->objects[i].material;
      float area = 0;
      if (asksForArea(material)) {
        if (const auto surface = lightSurface(shape, static_cast<accel::ObjectId>(i)))
          area = static_cast<float>(surface->area());
      }
      const auto attributes = describeObject(shape.origin, shape.attributes, scene_->attributes);
      scene_->shading.describeObject(material, attributes, area);
      for (const volume::Medium* medium : {scene_->objects[i].interior, scene_->objects[i].exterior}) {
        if (medium) scene_->shading.describeObject(scene_->mediumShaders[medium->index], attributes, 0);
      }
    }
    for (std::size_t i = 0; i < description_.volumes.size(); ++i) {
      const scene::Volume& volume = description_.volumes[i];
      scene_->shading.describeObject(scene_->mediumShaders[scene_->volumes[i]->index],
                                     describeObject(volume.origin, volume.attributes, scene_->attributes), 0);
    }
  }

  bool asksForArea(shading::InstanceRef material) const {
    const auto& sites = scene_->shading.family(material).kernel(shading::Variant::surface).interface().hostSites;
    return std::any_of(sites.begin(), sites.end(), [](const auto& site) { return site.function == "surfacearea"; });
  }

  std::unique_ptr<const LightSurface> lightSurface(const scene::Shape& shape, accel::ObjectId object) const {
    switch (shape.type) {
      case scene::ShapeType::sphere:
        return makeSphereLight(sphereToWorld(shape), shape.flipNormals);
      case scene::ShapeType::disk:
        return makeDiskLight(shape.toWorld, shape.flipNormals);
      case scene::ShapeType::rectangle:
        return makeRectangleLight(shape.toWorld, shape.flipNormals);
      default:
        return makeMeshLight(*scene_->geometry->mesh(object));
    }
  }

  /// Where media nest the path's stack begins with what the camera is in.
  void findInitialMedia() {
    using enum volume::PriorityOrder;
    scene_->priorityOrder = description_.integrator.lowerPriorityWins ? lowerWins : higherWins;
    if (!scene_->nestsMedia) return;
    const Matrix4& m = description_.sensor.toWorld.matrix();
    const Point<World> eye(static_cast<float>(m[0][3]), static_cast<float>(m[1][3]), static_cast<float>(m[2][3]));
    scene_->initialMedia = findMedia(*scene_, eye);
    const scene::Sensor& sensor = description_.sensor;
    const float lens = sensor.type == scene::SensorType::thinlens ? sensor.apertureRadius : 0;
    scene_->probesMedia = needsProbes(*scene_, eye, lens + 2 * sensor.nearClip);
  }

  void setUpCamera() {
    scene_->camera.emplace(description_.sensor, description_.film);
    scene_->filter.emplace(description_.film.filter);
    const auto& toWorld = description_.sensor.toWorld;
    scene_->namedSpaces.add("camera", toWorld.matrix(), toWorld.inverseMatrix());
    scene_->namedSpaces.addCamera(toWorld.inverseMatrix(), scene_->camera->projection());
    scene_->sampler =
        description_.sampler.type == scene::SamplerType::sobol ? SamplerKind::sobol : SamplerKind::independent;
    scene_->seed = static_cast<std::uint64_t>(description_.sampler.seed);
    const scene::Integrator& integrator = description_.integrator;
    scene_->path = {integrator.maxDepth, integrator.rrDepth, integrator.hideEmitters, integrator.stepScale};
    scene_->loopBudget = options_.loopBudget;
  }

  static constexpr Box<Object> unitCube{{-1, -1, -1}, {1, 1, 1}};

  const scene::SceneDescription& description_;
  const Registry& registry_;
  const PrepareOptions& options_;
  Diagnostics& warnings_;
  shading::ShaderLibrary library_;
  shading::GroupLibrary groups_;
  std::unique_ptr<PreparedScene> scene_;
  accel::SceneBuilder builder_;
  std::vector<Placement> placements_;  ///< By medium index.
  Diagnostics errors_;
};

}  // namespace

Result<std::unique_ptr<const PreparedScene>> prepare(const scene::SceneDescription& description,
                                                     const Registry& registry, const PrepareOptions& options,
                                                     Diagnostics& warnings) {
  const auto threads = options.threads > 0 ? static_cast<std::size_t>(options.threads)
                                           : std::max<std::size_t>(1, std::thread::hardware_concurrency());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  return Preparation(description, registry, options, warnings).run();
}

}  // namespace aerosol::render
