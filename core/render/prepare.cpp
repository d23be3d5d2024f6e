#include "core/render/prepare.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "core/accel/obj.h"
#include "core/accel/ply.h"
#include "core/grid/grid_file.h"
#include "core/lang/analysis.h"
#include "core/render/interior.h"
#include "core/render/light_linking.h"
#include "core/render/media_probe.h"
#include "core/render/medium_phase.h"
#include "core/render/medium_preparation.h"
#include "core/render/overlap.h"
#include "core/render/scene_attributes.h"
#include "core/render/scene_services.h"
#include "core/render/shader_binding.h"
#include "core/render/volume_light.h"

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
        scene_(std::make_unique<PreparedScene>()),
        links_(description, *scene_) {
    scene_->services = makeServices({searchPath(), options.textureMemory_MB});
  }

  Result<std::unique_ptr<const PreparedScene>> run() {
    scene_->shutter = description_.sensor.shutter();
    setUpCamera();
    bindMaterials();
    bindLightTextures();
    placeMedia();
    if (errors_.hasErrors()) return fail();
    errors_.append(scene_->shading.compile(*options_.compiler, {options_.target, options_.laneCounters}));
    if (errors_.hasErrors()) return fail();
    findChanges();
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
    if (!options_.plugins.empty()) path.push_back(options_.plugins);
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
      auto bound = bindShader(description_.materials[shape.material], "surface", atOpening(shape.toWorld),
                              shaderSources(), scene_->shading, warnings_);
      scene_->objects.emplace_back();
      if (bound) {
        scene_->objects.back().material = *bound;
        if (const auto motion = motionOf(shape.toWorld)) scene_->shading.setMotion(*bound, MovingPlace(motion));
      } else {
        appendNew(bound.errors());
      }
    }
  }

  void bindLightTextures() {
    const auto bind = [&](const scene::Emitter& emitter, const Transform<World, Object>& toWorld) {
      lightTextures_.emplace_back();
      if (!emitter.texture) return;
      auto bound = bindShader(description_.materials[*emitter.texture], "surface", toWorld, shaderSources(),
                              scene_->shading, warnings_);
      if (bound) {
        lightTextures_.back() = *bound;
      } else {
        appendNew(bound.errors());
      }
    };
    for (const scene::Emitter& emitter : description_.emitters) bind(emitter, emitter.toWorld);
    for (const scene::Shape& shape : description_.shapes) {
      if (shape.emitter) bind(*shape.emitter, atOpening(shape.toWorld));
    }
  }

  /// What a light's texture is in the mean, by a grid of its coordinates.
  Color meanTexture(shading::InstanceRef texture) const {
    constexpr int side = 8;
    Color sum;
    for (int i = 0; i < side * side; ++i) {
      shading::ShadingPoint point;
      point.set(lang::Global::u, (static_cast<float>(i % side) + 0.5f) / side);
      point.set(lang::Global::v, (static_cast<float>(i) / side + 0.5f) / side);
      sum += lightTextureOf(askSurface(*scene_, texture, point));
    }
    // Where the grid finds nothing light may be all the same.
    return maximum(abs(sum)) > 0 ? sum / (side * side) : Color(1e-3f);
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

  using MovingPlace = MovingTransform<World, Object>;

  Transform<World, Object> atOpening(const scene::Placement<World, Object>& placement) const {
    return placement.at(scene_->shutter.open);
  }
  /// Null where nothing changes while the shutter is open.
  std::shared_ptr<const Motion> motionOf(const scene::Placement<World, Object>& placement) {
    auto motion = placement.motionDuring(scene_->shutter);
    scene_->changes = scene_->changes || motion;
    return motion;
  }

  /// A volume as it stands when the shutter opens; one that moves, in the space that moves.
  scene::Volume standing(const scene::Volume& volume, bool moves) const {
    scene::Volume still = volume;
    still.toWorld = moves ? Transform<World, Object>() : atOpening(volume.toWorld);
    return still;
  }

  void placeMedia() {
    const std::size_t most = 3 * description_.volumes.size() + 2 * description_.shapes.size() + 1;
    scene_->media.reserve(most + LightLinking::mostCopies(most));
    for (const scene::Volume& volume : description_.volumes) {
      const VolumeType* type = registry_.volume(volume.type);
      if (!type) {
        errors_.error(volume.origin.location, fmt::format("there is no volume of type '{}'", volume.type));
        continue;
      }
      placeVolume(volume, *type);
    }
    for (std::size_t i = 0; i < description_.shapes.size(); ++i) {
      const scene::Shape& shape = description_.shapes[i];
      if (shape.interior) scene_->objects[i].interior = place(*shape.interior, shape.toWorld);
      if (shape.exterior) scene_->objects[i].exterior = place(*shape.exterior, shape.toWorld);
      if (shape.priority > 0) scene_->objects[i].priority = shape.priority;
      scene_->objects[i].clipsVolumes = shape.clipVolumes;
      scene_->nestsMedia = scene_->nestsMedia || shape.priority > 0 || shape.clipVolumes;
    }
    if (description_.sensor.medium)
      scene_->cameraMedium = place(*description_.sensor.medium, scene::Placement<World, Object>());
  }

  /// A volume's medium, and more of it where shadow rays or the camera see another one.
  void placeVolume(const scene::Volume& volume, const VolumeType& type) {
    const auto look = lookOf(volume);
    if (!look) errors_.append(look.errors());
    const auto motion = motionOf(volume.toWorld);
    const Transform<World, Object> local = type.place(standing(volume, motion != nullptr));
    const scene::MediumSampling sampling = description_.samplingOf(volume);
    const volume::Medium* const own = motion ? place(volume.medium, MovingPlace(motion, asObject(local)), sampling)
                                             : place(volume.medium, local, sampling);
    const scene::VolumeControls& controls = volume.controls;
    const volume::Medium *onShadowRays = own, *fromCamera = own;
    if (own && look) {
      placements_[own->index].place.stepScale = controls.stepScale;
      if (*look) setLook(*own, **look);
      if (volume.velocity.isWanted()) placeVelocity(volume, own->index);
      if (controls.shadowDensity != 1) {
        VolumeLook seen = look->value_or(VolumeLook());
        seen.density *= controls.shadowDensity;
        seen.emission = 0;
        onShadowRays = copyMedium(*own, seen);
      }
      if (controls.holdout) {
        VolumeLook seen = look->value_or(VolumeLook());
        seen.scattersAll = true;
        fromCamera = copyMedium(*own, seen);
        scene_->media[fromCamera->index].isHoldout = true;
      }
    }
    scene_->volumes.push_back(own);
    scene_->shadowVolumes.push_back(onShadowRays);
    scene_->cameraVolumes.push_back(fromCamera);
  }

  void setLook(const volume::Medium& medium, const VolumeLook& look) {
    scene_->looks.resize(scene_->media.size());
    scene_->looks[medium.index] = look;
  }

  /// Another medium with the same shader in the same place.
  const volume::Medium* copyMedium(const volume::Medium& medium, const VolumeLook& look) {
    const std::uint32_t original = medium.index;
    volume::Medium& copy = scene_->media.emplace_back(scene_->media[original]);
    copy.index = static_cast<std::uint32_t>(scene_->media.size() - 1);
    scene_->mediumShaders.push_back(shading::InstanceRef(scene_->mediumShaders[original]));
    scene_->mediumLocations.push_back(SourceLocation(scene_->mediumLocations[original]));
    scene_->mediumNames.push_back(std::string(scene_->mediumNames[original]));
    placements_.push_back(Placement(placements_[original]));
    if (const MediumVelocity* moves = scene_->velocityOf(original)) {
      const MediumVelocity same = *moves;
      scene_->velocities.resize(scene_->media.size());
      scene_->velocities[copy.index] = same;
    }
    setLook(copy, look);
    return &copy;
  }

  /// Finds the shader that gives a volume's velocity: the medium's own, or one that reads a grid.
  void placeVelocity(const scene::Volume& volume, std::uint32_t medium) {
    const scene::VelocityBlur& blur = volume.velocity;
    shading::InstanceRef shader = scene_->mediumShaders[medium];
    const SourceLocation& location = volume.origin.of(blur.grid.empty() ? "velocity" : "velocity_grid");
    if (!blur.grid.empty()) {
      const shading::Instance& placed = scene_->shading.instance(shader);
      auto bound = bindShader(velocityShader(volume, location), "volume", placed.objectToWorld, shaderSources(),
                              scene_->shading, warnings_);
      if (!bound) return appendNew(bound.errors());
      const auto motion = scene_->shading.instance(shader).motion;
      if (motion) scene_->shading.setMotion(*bound, *motion);
      shader = *bound;
    }
    const std::string output = blur.grid.empty() ? blur.output : "velocity";
    const lang::Program& program = *scene_->shading.family(shader).program;
    const auto isMeant = [&](const lang::Parameter& p) { return p.isOutput && p.name == output; };
    const auto found = std::ranges::find_if(program.parameters, isMeant);
    if (found == program.parameters.end() || found->type.isArray() || !found->type.isTriple()) {
      Diagnostic error{Severity::error,
                       location,
                       fmt::format("shader '{}' has no output '{}' that is a vector", program.name, output),
                       {},
                       {}};
      std::vector<std::string> outputs;
      for (const lang::Parameter& p : program.parameters) {
        if (p.isOutput && p.type.isTriple() && !p.type.isArray()) outputs.push_back(p.name);
      }
      error.notes.push_back(outputs.empty() ? "it has no vector among its outputs"
                                            : fmt::format("its vectors: {}", fmt::join(outputs, ", ")));
      return appendNew(error);
    }
    if (!scene_->shading.setVelocity(shader, output)) {
      return errors_.error(location,
                           fmt::format("another volume with the same shader takes its velocity from an output "
                                       "other than '{}'",
                                       output));
    }
    scene_->velocities.resize(scene_->media.size());
    scene_->velocities[medium] = MediumVelocity{shader, blur.factor(), blur.referenceTime};
    scene_->changes = scene_->changes || !scene_->shutter.isInstant();
  }

  /// velocity_grid.osl, reading the volume's grid, which goes on as far as it carries anything.
  scene::ShaderUse velocityShader(const scene::Volume& volume, const SourceLocation& location) {
    scene::ShaderUse use;
    use.name = "velocity_grid";
    use.nameLocation = use.origin.location = location;
    std::string file = fileOfVelocity(volume);
    if (const int voxels = reachOfVelocity(volume, file, location); voxels > 0)
      file = grid::continuedName(file, volume.velocity.grid, voxels);
    use.parameters.push_back({"filename", file, location, location});
    use.parameters.push_back({"gridname", volume.velocity.grid, location, location});
    return use;
  }

  /// Seconds times the factor of velocities, when the shutter opens and when it closes.
  std::array<double, 2> secondsOf(const scene::VelocityBlur& blur) const {
    const auto from = [&](float time) {
      return static_cast<double>(blur.factor()) * (static_cast<double>(time) - static_cast<double>(blur.referenceTime));
    };
    return {from(scene_->shutter.open), from(scene_->shutter.close)};
  }

  CarriedMatter carriedBy(const scene::Volume& volume) {
    if (volume.velocity.grid.empty()) return {};
    std::string problem;
    const VoxelFile* file = scene_->services->voxels(fileOfVelocity(volume), problem);
    return {file ? file->find(volume.velocity.grid) : nullptr, secondsOf(volume.velocity)};
  }

  static std::string fileOfVelocity(const scene::Volume& volume) {
    const scene::Value* own = volume.find("filename");
    return volume.velocity.file.empty() && own ? std::get<std::string>(*own) : volume.velocity.file;
  }

  /// Voxels that the velocities of a grid carry anything by. An error when there is no such grid; a warning when that
  /// is more than anybody means.
  int reachOfVelocity(const scene::Volume& volume, const std::string& file, const SourceLocation& location) {
    std::string problem;
    const VoxelFile* read = scene_->services->voxels(file, problem);
    const VoxelGrid* grid = read ? read->find(volume.velocity.grid) : nullptr;
    if (!read) {
      errors_.error(location, problem);
    } else if (!grid || grid->info().channels != 3) {
      errors_.error(location, fmt::format("'{}' has no vector grid '{}'", file, volume.velocity.grid));
    }
    if (!grid || grid->info().channels != 3) return 0;
    const VoxelGridInfo& info = grid->info();
    const auto [s0, s1] = secondsOf(volume.velocity);
    double square = 0;
    for (std::size_t c = 0; c < 3; ++c)
      square += std::pow(static_cast<double>(std::max(std::fabs(info.least[c]), std::fabs(info.greatest[c]))), 2);
    const double way = std::sqrt(square) * std::max(std::fabs(s0), std::fabs(s1));
    const double voxel = *std::ranges::min_element(info.voxelSize);
    constexpr double most = 256;
    const double voxels = way > 0 ? std::ceil(way / voxel) + 2 : 0;
    if (voxels > most) {
      warnings_.warning(
          location,
          fmt::format("velocities of grid '{}' carry its matter by up to {} scene units while the shutter "
                      "is open, {} voxels: blur reaches {} voxels at most",
                      volume.velocity.grid, way, voxels, most),
          {"velocities are per second; 'fps' says that they are per frame"});
    }
    return static_cast<int>(std::min(voxels, most));
  }

  const volume::Medium* place(scene::Index index, const scene::Placement<World, Object>& placement) {
    const scene::MediumSampling& sampling = description_.media[index].sampling;
    if (const auto motion = motionOf(placement)) return place(index, MovingPlace(motion), sampling);
    return place(index, atOpening(placement), sampling);
  }

  const volume::Medium* place(scene::Index index, const MovingPlace& placement, const scene::MediumSampling& sampling) {
    const volume::Medium* medium = place(index, placement.at(scene_->shutter.open), sampling);
    if (medium) scene_->shading.setMotion(scene_->mediumShaders[medium->index], placement);
    return medium;
  }

  /// The same map within the object's own spaces.
  static Transform<Object, Object> asObject(const Transform<World, Object>& local) {
    return {local.matrix(), local.inverseMatrix()};
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
      if (id && object.passesShadows) builder_.letShadowsPass(*id);
      scene_->shadowsPass = scene_->shadowsPass || object.passesShadows;
    }
  }

  /// Errors without a place of their own are those of the element.
  void appendAt(const SourceLocation& element, const Diagnostics& errors) {
    for (Diagnostic error : errors.entries()) {
      if (error.location.file.empty()) error.location = element;
      errors_.add(std::move(error));
    }
  }

  /// Whether light goes straight through: where the material asks for the kind of ray, may be transparent, and does not
  /// have the parameter `straight_shadows` set to 0.
  bool letsShadowsPass(const PreparedObject& object) const {
    const auto isTransparent = [](const Closure* c) { return c && c->kind() == ClosureKind::transparent; };
    if (std::none_of(object.closures.begin(), object.closures.end(), isTransparent)) return false;
    const shading::Family& family = scene_->shading.family(object.material);
    const auto& sites = family.kernel(shading::Variant::surface).interface().hostSites;
    if (std::none_of(sites.begin(), sites.end(), [](const auto& s) { return s.function == "raytype"; })) return false;
    const auto parameter = shading::findParameter(*family.program, "straight_shadows");
    if (!parameter) return true;
    const lang::ConstantValue* const value =
        shading::valueOf(*family.program, family.instances[object.material.index], *parameter);
    const auto* numbers = value ? std::get_if<std::vector<std::int32_t>>(value) : nullptr;
    return !numbers || numbers->empty() || numbers->front() != 0;
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
    const lang::Program folded = lang::specialise(program, valuesOf(object.material));
    const bool isLayered = std::any_of(program.closureSites.begin(), program.closureSites.end(),
                                       [](const lang::ClosureSite& site) { return !site.layers.empty(); });
    for (std::size_t i = 0; i < program.closureSites.size(); ++i) {
      const lang::ClosureSite& site = program.closureSites[i];
      if (isLayered) object.layers.push_back(site.layers);
      const auto index = static_cast<std::uint32_t>(i);
      checkSite(folded, index, object.closures[i]);
      const bool isInterior = object.closures[i] && object.closures[i]->kind() == ClosureKind::interior;
      if (isInterior && !isWeightless(folded, index)) scene_->nestsMedia = true;
    }
    if (errors_.hasErrors()) return;
    object.passesShadows = letsShadowsPass(object);
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

  /// All parameters of an instance, those that its program computes without a value.
  lang::ParameterValues valuesOf(shading::InstanceRef ref) const {
    const lang::Program& program = *scene_->shading.family(ref).program;
    lang::ParameterValues values;
    for (std::uint32_t i = 0; i < program.parameters.size(); ++i) {
      const lang::ConstantValue* value = shading::valueOf(program, scene_->shading.instance(ref), i);
      values[i] = value ? *value : lang::ConstantValue{};
    }
    return values;
  }

  /// Whether a site's weight is always black with the instance's parameters.
  static bool isWeightless(const lang::Program& program, std::uint32_t site) {
    return std::any_of(program.outputs.begin(), program.outputs.end(), [&](const lang::Output& output) {
      if (output.kind != lang::OutputKind::siteWeight || output.index != site) return false;
      const lang::Variable& variable = program.variables[output.variable];
      const auto* floats = std::get_if<std::vector<float>>(&variable.value);
      return variable.storage == lang::Storage::constant && floats &&
             std::all_of(floats->begin(), floats->end(), [](float value) { return value == 0; });
    });
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
    const std::size_t size = static_cast<std::size_t>(componentCount(closure->fields())) + 3 * site.layers.size();
    if (size > SurfaceAnswer::maximumParameters) {
      appendNew(Diagnostic{
          Severity::error,
          place,
          fmt::format(
              "closure '{}' lies below {} others: {} is the most", site.closure, site.layers.size(),
              (SurfaceAnswer::maximumParameters - static_cast<std::size_t>(componentCount(closure->fields()))) / 3),
          {},
          {}});
      return;
    }
    for (std::size_t i = 0; i < site.parameterNames.size(); ++i) {
      const std::string& name = site.parameterNames[i];
      const auto fields = closure->fields();
      const bool isLayer = std::any_of(site.layers.begin(), site.layers.end(),
                                       [&](const lang::ClosureLayer& layer) { return layer.weight == i; });
      const bool isKnown =
          isLayer || name == "label" ||
          std::any_of(fields.begin(), fields.end(), [&](const DescribedField& f) { return f.name == name; });
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

  Transform<World, Object> sphereToWorld(const scene::Shape& shape) const {
    return ballPlacement(atOpening(shape.toWorld), shape.center, shape.radius);
  }

  /// From the cylinder of radius 1 from z = 0 to 1 to the shape's own space.
  static Transform<World, Object> cylinderPlacement(const scene::Shape& shape) {
    const Vector<Object> along = shape.end - shape.center;
    const Frame<Object> frame(normalize(along));
    Matrix4 place = identityMatrix(), inverse;
    for (std::size_t i = 0; i < 3; ++i) {
      const int k = static_cast<int>(i);
      place[i][0] = static_cast<double>(frame.x[k] * shape.radius);
      place[i][1] = static_cast<double>(frame.y[k] * shape.radius);
      place[i][2] = static_cast<double>(along[k]);
      place[i][3] = static_cast<double>(shape.center[k]);
    }
    invert(place, inverse);
    return {place, inverse};
  }
  Transform<World, Object> cylinderToWorld(const scene::Shape& shape) const {
    const Transform<World, Object> place = cylinderPlacement(shape), toWorld = atOpening(shape.toWorld);
    return {multiply(toWorld.matrix(), place.matrix()), multiply(place.inverseMatrix(), toWorld.inverseMatrix())};
  }

  Result<accel::ObjectId> addMovingShape(const scene::Shape& shape, const std::shared_ptr<const Motion>& motion,
                                         bool passThrough) {
    using scene::ShapeType;
    if (shape.emitter) {
      return Diagnostic{Severity::error,
                        shape.emitter->origin.location,
                        "a shape that moves while the shutter is open cannot emit",
                        {},
                        {"give the shape one transform, or let its material glow"}};
    }
    if (shape.type == ShapeType::sphere) {
      const MovingPlace place(motion, asObject(ballPlacement(Transform<World, Object>(), shape.center, shape.radius)));
      return builder_.addSphere(place, passThrough, shape.flipNormals);
    }
    if (shape.type == ShapeType::disk) return builder_.addDisk(MovingPlace(motion), passThrough, shape.flipNormals);
    if (shape.type == ShapeType::cylinder) {
      const MovingPlace place(motion, asObject(cylinderPlacement(shape)));
      return builder_.addCylinder(place, passThrough, shape.flipNormals);
    }
    auto mesh = meshOf(shape, {});
    if (!mesh) return mesh.errors();
    return builder_.addMesh(std::move(*mesh), MovingPlace(motion), passThrough);
  }

  Result<accel::ObjectId> addShape(const scene::Shape& shape, bool passThrough) {
    using scene::ShapeType;
    if (const auto motion = motionOf(shape.toWorld)) return addMovingShape(shape, motion, passThrough);
    const Transform<World, Object> toWorld = atOpening(shape.toWorld);
    if (shape.type == ShapeType::sphere)
      return builder_.addSphere(sphereToWorld(shape), passThrough, shape.flipNormals);
    if (shape.type == ShapeType::disk) return builder_.addDisk(toWorld, passThrough, shape.flipNormals);
    if (shape.type == ShapeType::cylinder)
      return builder_.addCylinder(cylinderToWorld(shape), passThrough, shape.flipNormals);
    auto mesh = meshOf(shape, toWorld);
    if (!mesh) return mesh.errors();
    return builder_.addMesh(std::move(*mesh), passThrough);
  }

  Result<accel::TriangleMesh> meshOf(const scene::Shape& shape, const Transform<World, Object>& toWorld) {
    using scene::ShapeType;
    accel::TriangleMesh mesh;
    if (shape.type == ShapeType::obj || shape.type == ShapeType::ply) {
      const std::string file = shape.file.string();
      auto loaded = shape.type == ShapeType::obj ? accel::loadObj(file, toWorld, warnings_)
                                                 : accel::loadPly(file, toWorld, warnings_);
      if (!loaded) return loaded.errors();
      mesh = std::move(*loaded);
      if (shape.flipTexCoords.value_or(shape.type == ShapeType::obj)) {
        for (accel::TexCoord& uv : mesh.uvs) uv.v = 1 - uv.v;
      }
    } else {
      mesh = shape.type == ShapeType::cube ? accel::makeCube(toWorld) : accel::makeRectangle(toWorld);
    }
    mesh.faceNormals = mesh.faceNormals || shape.faceNormals;
    mesh.flipNormals = shape.flipNormals;
    return mesh;
  }

  void addVolumes() {
    for (std::size_t i = 0; i < description_.volumes.size(); ++i) {
      const scene::Volume& volume = description_.volumes[i];
      const VolumeType& type = *registry_.volume(volume.type);
      const auto motion = motionOf(volume.toWorld);
      const scene::Volume still = standing(volume, motion != nullptr);
      auto shape = type.make(
          {still, type.place(still), description_.searchPath, warnings_, scene_->services.get(), carriedBy(volume)});
      if (!shape) {
        appendAt(volume.origin.location, shape.errors());
        continue;
      }
      Box<World> bounds = (*shape)->worldBounds();
      if (motion) bounds = placed(bounds, MovingPlace(motion).at(scene_->shutter.open));
      for (const volume::Medium* medium : {scene_->volumes[i], scene_->shadowVolumes[i], scene_->cameraVolumes[i]}) {
        MediumPlace& place = placements_[medium->index].place;
        place.extent = length(bounds.upper - bounds.lower);
        place.domain = (*shape)->objectBounds();
        place.staysInside = true;
      }
      auto added =
          motion ? builder_.addVolume(std::move(*shape), MovingPlace(motion)) : builder_.addVolume(std::move(*shape));
      if (!added) {
        appendAt(volume.origin.location, added.errors());
      }
    }
  }

  /// A box of a space that moves, in the world.
  static Box<World> placed(const Box<World>& box, const Transform<World, Object>& place) {
    Box<World> bounds;
    for (int corner = 0; corner < 8; ++corner) {
      const auto end = [&](int axis) { return corner >> axis & 1 ? box.upper[axis] : box.lower[axis]; };
      bounds.extend(place(Point<Object>(end(0), end(1), end(2))));
    }
    return bounds;
  }

  void buildGeometry() {
    using scene::OverlapChoice;
    accel::SceneOptions options{.embreeIsa = options_.embreeIsa, .shutter = scene_->shutter};
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
    errors_.append(
        links_.read([this](const volume::Medium& medium, const VolumeLook& look) { return copyMedium(medium, look); }));
    if (errors_.hasErrors()) return;
    for (volume::Medium& medium : scene_->media) {
      const auto& motion = scene_->shading.instance(scene_->mediumShaders[medium.index]).motion;
      if (motion) medium.motion = &*motion;
    }
    const std::size_t count = scene_->media.size();
    scene_->trees.resize(count);
    scene_->treeStatistics.resize(count);
    scene_->samplingReasons.resize(count);
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
      const bool moves = motionOf(shape.toWorld) != nullptr;
      const Transform<Object, World> toObject = moves ? Transform<Object, World>() : atOpening(shape.toWorld).inverse();
      for (const Point<World>& p : scene_->geometry->mesh(static_cast<accel::ObjectId>(i))->positions) {
        box.extend(toObject(p));
      }
      domain = box;
    }
  }

  void addLights() {
    std::vector<std::unique_ptr<const Light>> lights;
    std::size_t next = 0;
    const auto add = [&](const scene::Emitter& emitter, std::shared_ptr<const LightSurface> surface) {
      const std::optional<shading::InstanceRef> texture = lightTextures_[next++];
      auto light = makeLight(registry_, emitter, std::move(surface), texture ? meanTexture(*texture) : Color(1));
      if (light) scene_->lightTextures.push_back(texture);
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
        ++next;
        continue;
      }
      if (add(*shape.emitter, surface)) scene_->objects[i].light = static_cast<std::uint32_t>(lights.size() - 1);
    }
    std::vector<std::uint32_t> glowing;
    for (const volume::Medium& medium : scene_->media) {
      const shading::InstanceRef shader = scene_->mediumShaders[medium.index];
      const std::optional<Box<Object>>& domain = placements_[medium.index].place.domain;
      std::unique_ptr<const Light> glow;
      if (!medium.constant) {
        if (medium.tree) glow = VolumeLight::make(*medium.tree);
      } else if (domain) {
        const auto& instance = scene_->shading.family(shader).instances[shader.index];
        glow = VolumeLight::make(*domain, instance.objectToWorld, medium.constant->emission);
      }
      if (!glow) continue;
      lights.push_back(std::move(glow));
      glowing.push_back(medium.index);
    }
    if (errors_.hasErrors()) return;
    scene_->lights = LightSet(std::move(lights), 0.5f * sceneExtent());
    links_.makeSets(glowing, 0.5f * sceneExtent());
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
        return makeDiskLight(atOpening(shape.toWorld), shape.flipNormals);
      case scene::ShapeType::cylinder:
        return makeCylinderLight(cylinderToWorld(shape), shape.flipNormals);
      case scene::ShapeType::rectangle:
        return makeRectangleLight(atOpening(shape.toWorld), shape.flipNormals);
      default:
        break;
    }
    const accel::TriangleMesh& mesh = *scene_->geometry->mesh(object);
    if (!shape.toWorld.motionDuring(scene_->shutter)) return makeMeshLight(mesh);
    accel::TriangleMesh placed = mesh;
    accel::transformMesh(placed, atOpening(shape.toWorld));
    return makeMeshLight(placed);
  }

  /// Where media nest the path's stack begins with what the camera is in.
  void findInitialMedia() {
    using enum volume::PriorityOrder;
    scene_->priorityOrder = description_.integrator.lowerPriorityWins ? lowerWins : higherWins;
    if (!scene_->nestsMedia) return;
    const Matrix4 m = scene_->camera->toWorld(scene_->shutter.open).matrix();
    const Point<World> eye(static_cast<float>(m[0][3]), static_cast<float>(m[1][3]), static_cast<float>(m[2][3]));
    scene_->initialMedia = findMedia(*scene_, eye, scene_->shutter.open);
    const scene::Sensor& sensor = description_.sensor;
    const float lens = sensor.type == scene::SensorType::thinlens ? sensor.apertureRadius : 0;
    scene_->probesMedia = scene_->changes || needsProbes(*scene_, eye, lens + 2 * sensor.nearClip);
  }

  /// Whether pictures of two instants would differ.
  void findChanges() {
    if (scene_->shutter.isInstant()) return;
    scene_->changes = scene_->changes || scene_->camera->motion();
    for (const shading::Family& family : scene_->shading.families()) {
      for (const auto& kernel : family.kernels) {
        const int time = jit::globalPointer(lang::Global::time);
        if (kernel && (kernel->interface().globalsRead >> time & 1u) != 0) scene_->changes = true;
      }
    }
  }

  void setUpCamera() {
    scene_->camera.emplace(description_.sensor, description_.film);
    scene_->filter.emplace(description_.film.filter);
    if (const auto& motion = scene_->camera->motion()) {
      scene_->namedSpaces.addCamera(*motion, scene_->camera->projection());
    } else {
      const auto toWorld = scene_->camera->toWorld(scene_->shutter.open);
      scene_->namedSpaces.add("camera", toWorld.matrix(), toWorld.inverseMatrix());
      scene_->namedSpaces.addCamera(toWorld.inverseMatrix(), scene_->camera->projection());
    }
    scene_->sampler =
        description_.sampler.type == scene::SamplerType::sobol ? SamplerKind::sobol : SamplerKind::independent;
    scene_->seed = static_cast<std::uint64_t>(description_.sampler.seed);
    const scene::Integrator& integrator = description_.integrator;
    scene_->path = {integrator.maxDepth, integrator.rrDepth, integrator.hideEmitters, integrator.stepScale,
                    integrator.equiangular};
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
  std::vector<std::optional<shading::InstanceRef>> lightTextures_;  ///< By emitter, then by shape that has one.
  LightLinking links_;
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
