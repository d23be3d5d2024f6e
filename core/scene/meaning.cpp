#include "core/scene/meaning.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "core/scene/checks.h"
#include "core/scene/grouped_placement.h"
#include "core/scene/id_table.h"
#include "core/scene/integrator_reader.h"
#include "core/scene/property_reader.h"
#include "core/scene/sensor_reader.h"
#include "core/scene/shader_builder.h"
#include "core/scene/syntax.h"
#include "core/scene/tables.h"

namespace aerosol::scene {

namespace {

/// Builds one description from one tree.
class SceneBuilder {
 public:
  SceneBuilder(const SceneTree& tree, const KnownTypes& known, const SourceTexts& texts, const std::string& sensor,
               Reporter& reporter)
      : tree_(tree),
        known_(known),
        texts_(texts),
        sensor_(sensor),
        reporter_(reporter),
        ids_(tree, reporter),
        shaders_(scene_, ids_, reporter) {}

  SceneDescription build() {
    readSensors(tree_, sensor_, ids_, shaders_, reporter_, scene_);
    if (const Element* integrator = singleOf("integrator")) {
      readIntegrator(*integrator, ids_, reporter_, scene_.integrator);
    } else {
      scene_.integrator.origin.location = tree_.scene.location;
    }
    for (const Element& element : tree_.scene.children) {
      if (element.tag == "shape") readShape(element);
      if (element.tag == "volume" && !givesValues(element)) readVolume(element);
      if (element.tag == "emitter") readSceneEmitter(element);
    }
    if (!reporter_.failed()) warnOfUnused();
    return std::move(scene_);
  }

 private:
  /// The only object of a kind that a scene may have once; null when there is none.
  const Element* singleOf(const std::string& tag) {
    std::vector<Child> children;
    for (const Element& element : tree_.scene.children) {
      if (element.tag == tag) children.push_back({&element, &element});
    }
    return IdTable::single(children, tag, reporter_).object;
  }

  /// The type's place in its table; none when it is unknown, which is reported.
  template <class T>
  std::optional<std::size_t> readTyped(const Element& element, const std::vector<TypeTable<T>>& tables, T& object) {
    const TypeTable<T>* table = scene::readTyped(element, tables, object, reporter_);
    return table ? std::optional(static_cast<std::size_t>(table - tables.data())) : std::nullopt;
  }

  std::optional<Emitter> readEmitter(const Element& element) {
    Emitter emitter;
    const auto type = readTyped(element, emitterTypes(), emitter);
    if (!type) return std::nullopt;
    emitter.type = static_cast<EmitterType>(*type);
    if (emitter.type == EmitterType::background) {
      readBackground(element, emitter);
    } else {
      readLightTexture(element, emitter);
    }
    if (emitter.origin.has("filename")) findEmitterFile(emitter);
    if (emitter.beamWidth && *emitter.beamWidth > emitter.cutoffAngle) {
      reporter_.error(emitter.origin.of("beam_width"), "'beam_width' is wider than 'cutoff_angle'");
    }
    checkSun(emitter);
    if (emitter.origin.has("fov") && emitter.origin.has("focal_length")) {
      reporter_.error(emitter.origin.of("focal_length"),
                      "'fov' and 'focal_length' both give the angle: write one of them");
    }
    for (const char* other : {"position", "direction"}) {
      if (!emitter.origin.has(other) || !emitter.origin.has("to_world")) continue;
      reporter_.error(emitter.origin.of("to_world"),
                      fmt::format("'to_world' and '{}' both place the light: write one of them", other));
    }
    return emitter;
  }

  /// A direction and a time would be two places of the sun.
  void checkSun(const Emitter& emitter) {
    if (!emitter.sun.direction) return;
    for (const char* other :
         {"latitude", "longitude", "timezone", "year", "month", "day", "hour", "minute", "second"}) {
      if (!emitter.origin.has(other)) continue;
      reporter_.error(emitter.origin.of(other),
                      fmt::format("'sun_direction' and '{}' both place the sun: write one of them", other));
    }
  }

  void readBackground(const Element& element, Emitter& emitter) {
    const Child shader = IdTable::single(ids_.children(element, {"bsdf"}, reporter_), "bsdf", reporter_);
    if (shader.object) {
      emitter.texture = shaders_.material(*shader.object);
    } else if (element.children.empty()) {
      reporter_.error(element.location, fmt::format("{} lacks its shader", describe(element)),
                      {"write a <bsdf type=\"…\"> or a <ref id=\"…\"/> to one into it"});
    }
  }

  /// The texture inside of an area light (its radiance), of a spot or of a projector.
  void readLightTexture(const Element& element, Emitter& emitter) {
    const bool isArea = emitter.type == EmitterType::area, isSpot = emitter.type == EmitterType::spot;
    const bool isProjector = emitter.type == EmitterType::projector;
    // In which medium a light is, shadow rays find out on the way there: what the scene says of it is only read.
    std::vector<std::string> tags = {"medium"};
    if (isArea || isSpot || isProjector) tags.emplace_back("texture");
    const Child texture = IdTable::single(ids_.children(element, tags, reporter_), "texture", reporter_);
    if (!texture.object) return;
    const std::string wanted = isArea ? "radiance" : isProjector ? "irradiance" : "texture";
    const std::string& name = texture.use->name;
    if (name != wanted) {
      reporter_.error(name.empty() ? texture.use->location : texture.use->nameLocation,
                      fmt::format("a texture in {} needs name=\"{}\"", describe(element), wanted));
    } else if (emitter.origin.has(wanted)) {
      reporter_.error(texture.use->nameLocation, fmt::format("parameter '{}' is given twice", wanted),
                      {fmt::format("the first one is at {}", format(emitter.origin.of(wanted)))});
    } else {
      emitter.texture = shaders_.lightTexture(texture);
    }
  }

  void findEmitterFile(Emitter& emitter) {
    const std::string name = emitter.file.string();
    const SourceLocation& place = emitter.origin.of("filename");
    if (const auto found = findSceneFile(name, place)) emitter.file = *found;
  }

  /// A file that an object names, next to the scene or in a `<path>`; reported when it is missing.
  std::optional<std::filesystem::path> findSceneFile(const std::string& name, const SourceLocation& place) {
    const SourceText* text = texts_.find(place.file);
    const std::filesystem::path directory = text ? text->directory() : std::filesystem::path();
    auto found = findFile(name, directory, tree_.searchPath);
    if (!found && !name.empty()) {
      reporter_.error(place, fmt::format("there is no file '{}'", name),
                      {describeSearch(name, directory, tree_.searchPath)});
    }
    return found;
  }

  void readSceneEmitter(const Element& element) {
    if (element.type == "area") {
      if (element.id.empty()) {
        reporter_.error(element.location, "an area light belongs in a shape: here it has no surface");
      }
      return;
    }
    std::optional<Emitter> emitter = readEmitter(element);
    if (!emitter) return;
    const auto surrounds = [](const Emitter& e) {
      return e.type == EmitterType::constant || e.type == EmitterType::envmap || e.type == EmitterType::sunsky ||
             e.type == EmitterType::background;
    };
    if (surrounds(*emitter)) {
      const auto first = std::find_if(scene_.emitters.begin(), scene_.emitters.end(), surrounds);
      if (first != scene_.emitters.end()) {
        reporter_.error(element.location, "a second environment: only one emitter can surround the scene",
                        {fmt::format("the first one is at {}", format(first->origin.location))});
      }
    }
    scene_.emitters.push_back(std::move(*emitter));
  }

  /// What a group of shapes holds.
  struct Group {
    std::vector<Shape> shapes;
    std::vector<Volume> volumes;
  };

  void readShape(const Element& element) {
    if (element.type == "shapegroup") return;  // An instance reads it.
    if (element.type == "instance") return readInstance(element);
    if (element.type == "merge") return readMerged(element, scene_.shapes);
    scene_.shapes.push_back(shapeOf(element));
  }

  /// Shapes that another renderer makes one of; here each stays what it is.
  void readMerged(const Element& element, std::vector<Shape>& shapes) {
    Shape nothing;
    readTyped(element, shapeTypes(), nothing);
    for (const Child& child : ids_.children(element, {"shape"}, reporter_)) {
      const std::string& type = child.object->type;
      if (type == "merge") {
        readMerged(*child.object, shapes);
      } else if (type == "shapegroup" || type == "instance") {
        reporter_.error(child.use->location, fmt::format("a shape '{}' cannot be merged", type));
      } else {
        shapes.push_back(shapeOf(*child.object));
      }
    }
  }

  void readInstance(const Element& element) {
    Shape instance;
    readTyped(element, shapeTypes(), instance);
    const Child child = IdTable::single(ids_.children(element, {"shape"}, reporter_), "shape", reporter_);
    if (!child.object) {
      if (element.children.empty()) {
        reporter_.error(element.location, "shape 'instance' lacks its group",
                        {"write a <ref id=\"…\"/> to a shapegroup into it"});
      }
      return;
    }
    if (child.object->type != "shapegroup") {
      reporter_.error(child.use->location,
                      fmt::format("an instance shows a shapegroup, not a shape '{}'", child.object->type));
      return;
    }
    const auto place = [&](auto object) {
      if (const auto problem = placeInGroup(instance.toWorld, object.toWorld)) {
        reporter_.error(instance.origin.of("to_world"), "this instance cannot move so: " + *problem,
                        {fmt::format("the object is at {}", format(object.origin.location))});
      }
      return object;
    };
    const Group& group = groupOf(*child.object);
    for (const Shape& shape : group.shapes) scene_.shapes.push_back(place(shape));
    for (const Volume& volume : group.volumes) scene_.volumes.push_back(place(volume));
  }

  /// Read when the first instance asks for it.
  const Group& groupOf(const Element& element) {
    const auto [entry, isNew] = groups_.try_emplace(&element);
    Group& group = entry->second;
    if (!isNew) return group;
    Shape nothing;
    readTyped(element, shapeTypes(), nothing);
    const std::vector<Child> children = ids_.children(element, {"shape", "volume"}, reporter_);
    for (const Child& child : children) {
      const Element& object = *child.object;
      if (object.tag == "shape" && (object.type == "shapegroup" || object.type == "instance")) {
        reporter_.error(child.use->location,
                        fmt::format("a shape '{}' does not belong in a shapegroup: groups do not nest", object.type));
      } else if (object.type == "merge" && object.tag == "shape") {
        readMerged(object, group.shapes);
      } else if (object.tag == "shape") {
        group.shapes.push_back(shapeOf(object));
      } else if (auto volume = volumeOf(object)) {
        group.volumes.push_back(std::move(*volume));
      }
    }
    if (element.children.empty()) reporter_.error(element.location, "this shapegroup is empty");
    return group;
  }

  Shape shapeOf(const Element& element) {
    Shape shape;
    const auto type = readTyped(element, shapeTypes(), shape);
    if (type) shape.type = static_cast<ShapeType>(*type);
    if (shape.origin.has("filename")) findShapeFile(shape);
    const std::vector<Child> children =
        ids_.children(element, {"bsdf", "displacement", "emitter", "medium"}, reporter_);
    const Child emitter = IdTable::single(children, "emitter", reporter_);
    if (emitter.object) readAreaLight(emitter, shape);
    if (shape.isCurves()) checkCurves(shape, children);
    const Child bsdf = IdTable::single(children, "bsdf", reporter_);
    shape.material = bsdf.object ? shaders_.material(*bsdf.object)
                                 : shaders_.defaultMaterial(element.location, emitter.object != nullptr);
    const Child displacement = IdTable::single(children, "displacement", reporter_);
    if (displacement.object) shape.displacement = shaders_.displacement(*displacement.object);
    for (const Child& child : children) {
      if (child.object->tag == "medium") readShapeMedium(child, shape);
    }
    return shape;
  }

  /// What fibres cannot be.
  void checkCurves(Shape& shape, const std::vector<Child>& children) {
    for (const Child& child : children) {
      if (child.object->tag != "bsdf") {
        reporter_.error(child.use->location, fmt::format("fibres have no {}", child.object->tag));
        shape.emitter.reset();
      }
    }
  }

  void findShapeFile(Shape& shape) {
    if (const auto found = findSceneFile(shape.file.string(), shape.origin.of("filename"))) shape.file = *found;
  }

  void readAreaLight(const Child& child, Shape& shape) {
    if (child.object->type == "directionalarea") {
      reporter_.warning(child.use->location, "a 'directionalarea' emitter lights nothing here",
                        {"its light is parallel: no path from the camera meets it, and none finds it from a surface"});
      ids_.children(*child.object, {"texture", "medium"}, reporter_);
      return;
    }
    if (child.object->type != "area" && findType(emitterTypes(), child.object->type)) {
      reporter_.error(child.use->location,
                      fmt::format("an emitter of type '{}' does not belong in a shape", child.object->type),
                      {"a shape shines by an emitter of type area; others stand directly in the scene"});
      return;
    }
    shape.emitter = readEmitter(*child.object);
  }

  void readShapeMedium(const Child& child, Shape& shape) {
    const bool inside = child.use->name == "interior";
    if (!inside && child.use->name != "exterior") {
      reporter_.error(child.use->name.empty() ? child.use->location : child.use->nameLocation,
                      "a medium in a shape needs name=\"interior\" or name=\"exterior\"");
      return;
    }
    std::optional<Index>& slot = inside ? shape.interior : shape.exterior;
    if (slot) {
      reporter_.error(child.use->location, fmt::format("a second {} medium: only one is possible", child.use->name));
      return;
    }
    slot = shaders_.medium(*child.object);
  }

  void readVolume(const Element& element) {
    if (auto volume = volumeOf(element)) scene_.volumes.push_back(std::move(*volume));
  }

  /// Nothing where something that it needs is missing, which is reported.
  std::optional<Volume> volumeOf(const Element& element) {
    const VolumeType* type = known_.volume(element.type);
    std::vector<Child> children = ids_.children(element, {"medium"}, reporter_);
    const Child medium = IdTable::single(children, "medium", reporter_);
    if (!type) {
      std::vector<std::string> types;
      for (const VolumeType& t : known_.volumes) types.push_back(t.type);
      reportUnknownType(element, types, reporter_);
      return {};
    }
    Volume volume;
    volume.type = type->type;
    PropertyReader reader(element, volume.origin, reporter_);
    reader.apply(type->parameters, volume.parameters);
    reader.apply(volumeFields(), volume);
    reader.apply(velocityFields(), volume.velocity);
    reader.apply(samplingFields(), volume.sampling);
    reader.applyAttributes(volume.attributes);
    reader.finish();
    if (!volume.velocity.output.empty() && !volume.velocity.grid.empty()) {
      reporter_.error(volume.origin.of("velocity_grid"),
                      "'velocity' and 'velocity_grid' both give the velocity: write one of them");
    }
    if (!medium.object) {
      if (children.empty() && element.children.empty()) {
        reporter_.error(element.location, fmt::format("{} lacks its medium", describe(element)),
                        {"write a <medium type=\"…\"> or a <ref id=\"…\"/> to one into it"});
      }
      return {};
    }
    volume.medium = shaders_.medium(*medium.object);
    return volume;
  }

  /// Mitsuba's volumes are patterns over space, which feed media; ours are places where media are.
  static bool givesValues(const Element& volume) { return volume.type == "gridvolume" || volume.type == "constvolume"; }

  /// Objects that only matter where they are referred to.
  void warnOfUnused() {
    for (const Element& element : tree_.scene.children) {
      const bool standsAlone = element.tag == "sensor" || element.tag == "integrator" ||
                               (element.tag == "shape" && element.type != "shapegroup") ||
                               (element.tag == "volume" && !givesValues(element)) ||
                               (element.tag == "emitter" && element.type != "area");
      if (standsAlone || ids_.isUsed(element)) continue;
      const std::string message = element.id.empty()
                                      ? fmt::format("{} has no id, so nothing can refer to it", describe(element))
                                      : fmt::format("{} '{}' is never referred to", element.tag, element.id);
      reporter_.warning(element.location, message,
                        {fmt::format("refer to it with <ref id=\"{}\"/> where it is wanted, or remove it",
                                     element.id.empty() ? "…" : element.id)});
    }
  }

  const SceneTree& tree_;
  const KnownTypes& known_;
  const SourceTexts& texts_;
  const std::string& sensor_;
  Reporter& reporter_;
  SceneDescription scene_;
  IdTable ids_;
  ShaderBuilder shaders_;
  std::map<const Element*, Group> groups_;
};

}  // namespace

SceneDescription describeScene(const SceneTree& tree, const KnownTypes& known, const SourceTexts& texts,
                               const std::string& sensor, Reporter& reporter) {
  return SceneBuilder(tree, known, texts, sensor, reporter).build();
}

}  // namespace aerosol::scene
