#include "core/scene/world.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "core/scene/syntax.h"
#include "core/scene/value.h"

namespace aerosol::scene {

namespace {

using Triple = std::array<double, 3>;

Triple operator-(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Triple cross(const Triple& a, const Triple& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Triple& a) { return std::hypot(a[0], a[1], a[2]); }
Triple unit(const Triple& a) {
  const double l = length(a);
  return {a[0] / l, a[1] / l, a[2] / l};
}

/// Columns and origin of a map.
Matrix4 matrixOf(const Triple& x, const Triple& y, const Triple& z, const Triple& origin) {
  Matrix4 m = identityMatrix();
  for (std::size_t i = 0; i < 3; ++i) {
    m[i][0] = x[i];
    m[i][1] = y[i];
    m[i][2] = z[i];
    m[i][3] = origin[i];
  }
  return m;
}

class WorldReader {
 public:
  WorldReader(const SourceText& source, Reporter& reporter) : source_(source), reporter_(reporter) {}

  SceneTree read(const XmlElement& world) {
    tree_.scene.tag = "scene";
    tree_.scene.location = at(world);
    checkAttributes(world, {});
    startSensor(world);
    integrator_ = object("integrator", "path", at(world));
    // The rule of that program: of overlapping media the lower priority is there.
    set(integrator_, "lower_priority_wins", "boolean", true, at(world));
    for (const XmlElement& child : world.children) readChild(child);
    tree_.scene.children.insert(tree_.scene.children.begin(), {std::move(sensor_), std::move(integrator_)});
    return std::move(tree_);
  }

 private:
  SourceLocation at(const XmlElement& xml) const { return source_.at(xml.offset); }

  static Element object(std::string tag, std::string type, const SourceLocation& place) {
    Element element;
    element.tag = std::move(tag);
    element.type = std::move(type);
    element.location = element.typeLocation = element.idLocation = element.nameLocation = place;
    return element;
  }
  static void set(Element& element, const char* name, const char* tag, Value value, const SourceLocation& place) {
    for (Property& known : element.properties) {
      if (known.name != name) continue;
      known.value = std::move(value);
      known.location = known.nameLocation = known.valueLocation = place;
      return;
    }
    element.properties.push_back({name, tag, std::move(value), place, place, place, {}});
  }

  /// The film and its sampler have ids, so that the command line can change them.
  void startSensor(const XmlElement& world) {
    sensor_ = object("sensor", "perspective", at(world));
    set(sensor_, "fov", "float", 90.0f, at(world));
    set(sensor_, "fov_axis", "string", std::string("y"), at(world));
    set(sensor_, "to_world", "transform", lookAlong({0, 0, 0}, {0, 0, -1}, {0, 1, 0}), at(world));
    Element film = object("film", "hdrfilm", at(world));
    film.id = "film";
    set(film, "width", "integer", 640, at(world));
    set(film, "height", "integer", 480, at(world));
    film.children.push_back(object("rfilter", "tent", at(world)));
    Element sampler = object("sampler", "sobol", at(world));
    sampler.id = "sampler";
    set(sampler, "sample_count", "integer", 1, at(world));
    sensor_.children = {std::move(film), std::move(sampler)};
  }
  Element& sampler() { return sensor_.children[1]; }

  void readChild(const XmlElement& xml) {
    if (xml.tag == "Option") return readOption(xml);
    if (xml.tag == "Camera") return readCamera(xml);
    if (xml.tag == "ShaderGroup") return readGroup(xml);
    if (xml.tag == "Background") return readBackground(xml);
    if (xml.tag == "Sphere") return readSphere(xml);
    if (xml.tag == "Quad") return readQuad(xml);
    if (xml.tag == "Model") return readModel(xml);
    reporter_.error(at(xml), fmt::format("unknown element <{}> in <World>", xml.tag),
                    alternatives(xml.tag, {"Option", "Camera", "ShaderGroup", "Background", "Sphere", "Quad", "Model"},
                                 "valid here:"));
  }

  void checkAttributes(const XmlElement& xml, const std::vector<std::string>& known) {
    for (const XmlAttribute& attribute : xml.attributes) {
      if (std::find(known.begin(), known.end(), attribute.name) != known.end()) continue;
      reporter_.error(source_.at(attribute.nameOffset),
                      fmt::format("<{}> has no attribute '{}'", xml.tag, attribute.name),
                      alternatives(attribute.name, known, "it has"));
    }
  }
  static const XmlAttribute* find(const XmlElement& xml, std::string_view name) {
    for (const XmlAttribute& attribute : xml.attributes) {
      if (attribute.name == name) return &attribute;
    }
    return nullptr;
  }
  SourceLocation placeOf(const XmlElement& xml, std::string_view name) const {
    const XmlAttribute* attribute = find(xml, name);
    return attribute ? source_.at(attribute->valueOffset) : at(xml);
  }

  /// `count` numbers of an attribute; nothing when it is missing or wrong, which is reported unless it may be missing.
  std::optional<std::vector<double>> numbers(const XmlElement& xml, std::string_view name, std::size_t count,
                                             bool isRequired) {
    const XmlAttribute* attribute = find(xml, name);
    if (!attribute) {
      if (isRequired) reporter_.error(at(xml), fmt::format("<{}> lacks '{}'", xml.tag, name));
      return std::nullopt;
    }
    TextError error;
    auto found = parseNumbers(attribute->value, error);
    if (found && found->size() == count) return found;
    reporter_.error(source_.at(attribute->valueOffset),
                    found ? fmt::format("'{}' of <{}> needs {} number{}, not {}", name, xml.tag, count,
                                        count == 1 ? "" : "s", found->size())
                          : error.message);
    return std::nullopt;
  }
  std::optional<Triple> triple(const XmlElement& xml, std::string_view name, bool isRequired = false) {
    const auto found = numbers(xml, name, 3, isRequired);
    if (!found) return std::nullopt;
    return Triple{(*found)[0], (*found)[1], (*found)[2]};
  }

  /// Mitsuba's camera looks along +z and has +x to the left.
  static Matrix4 lookAlong(const Triple& eye, const Triple& direction, const Triple& up) {
    const Triple z = unit(direction), x = unit(cross(up, z));
    return matrixOf(x, cross(z, x), z, eye);
  }

  void readCamera(const XmlElement& xml) {
    checkAttributes(xml, {"eye", "dir", "look_at", "up", "fov"});
    const Triple eye = triple(xml, "eye").value_or(Triple{0, 0, 0}), up = triple(xml, "up").value_or(Triple{0, 1, 0});
    Triple direction{0, 0, -1};
    if (const auto given = triple(xml, "dir")) {
      direction = *given;
    } else if (const auto target = triple(xml, "look_at")) {
      direction = *target - eye;
    }
    if (!(length(cross(up, direction)) > 0)) {
      reporter_.error(at(xml), "the camera looks along its 'up', or nowhere");
      return;
    }
    set(sensor_, "to_world", "transform", lookAlong(eye, direction, up), at(xml));
    if (const auto fov = numbers(xml, "fov", 1, false))
      set(sensor_, "fov", "float", static_cast<float>(fov->front()), placeOf(xml, "fov"));
  }

  /// `int N`; whatever else options may be, nothing here depends on it.
  void readOption(const XmlElement& xml) {
    for (const XmlAttribute& attribute : xml.attributes) {
      const SourceLocation place = source_.at(attribute.valueOffset);
      std::string_view text = trim(attribute.value);
      TextError error;
      const bool isInteger = text.starts_with("int ");
      const auto number = isInteger ? parseNumber(text.substr(4), error) : std::nullopt;
      if (isInteger && !number) {
        reporter_.error(place, error.message);
        continue;
      }
      const int value = number ? static_cast<int>(std::clamp(*number, -1.0, 1e6)) : 0;
      if (number && attribute.name == "max_bounces") {
        set(integrator_, "max_depth", "integer", value >= 1000000 ? -1 : std::max(value, 0) + 1, place);
      } else if (number && attribute.name == "rr_depth") {
        set(integrator_, "rr_depth", "integer", std::max(value, 1), place);
      } else if (number && attribute.name == "aa") {
        set(sampler(), "sample_count", "integer", std::clamp(value, 1, 1000) * std::clamp(value, 1, 1000), place);
      } else {
        reporter_.warning(place, fmt::format("the option '{}' has no effect", attribute.name),
                          {"remove it, or leave it for other programs"});
      }
    }
  }

  /// The group as text, from elements that say the same.
  std::string textOf(const XmlElement& xml) {
    std::string text;
    for (const XmlElement& child : xml.children) {
      if (child.tag == "Parameter") {
        for (const XmlAttribute& attribute : child.attributes) text += parameterText(attribute);
      } else if (child.tag == "Shader") {
        checkAttributes(child, {"type", "name", "layer"});
        const XmlAttribute *name = find(child, "name"), *layer = find(child, "layer");
        if (name && layer) {
          text += fmt::format("shader {} {};\n", name->value, layer->value);
        } else {
          reporter_.error(at(child), "<Shader> needs 'name' and 'layer'");
        }
      } else if (child.tag == "ConnectShaders") {
        checkAttributes(child, {"srclayer", "srcparam", "dstlayer", "dstparam"});
        const XmlAttribute *from = find(child, "srclayer"), *output = find(child, "srcparam"),
                           *to = find(child, "dstlayer"), *input = find(child, "dstparam");
        if (from && output && to && input) {
          text += fmt::format("connect {}.{} {}.{};\n", from->value, output->value, to->value, input->value);
        } else {
          reporter_.error(at(child), "<ConnectShaders> needs 'srclayer', 'srcparam', 'dstlayer' and 'dstparam'");
        }
      } else {
        reporter_.error(at(child), fmt::format("unknown element <{}> in <ShaderGroup>", child.tag),
                        alternatives(child.tag, {"Parameter", "Shader", "ConnectShaders"}, "valid here:"));
      }
    }
    return text;
  }
  /// `name="float 0.5"`; without a type it is a string.
  static std::string parameterText(const XmlAttribute& attribute) {
    for (const std::string_view type : {"int ", "float ", "vector ", "point ", "color "}) {
      if (!attribute.value.starts_with(type)) continue;
      return fmt::format("param {}{} {};\n", type, attribute.name, attribute.value.substr(type.size()));
    }
    std::string quoted;
    for (const char c : attribute.value) quoted += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
    return fmt::format("param string {} \"{}\";\n", attribute.name, quoted);
  }

  void readGroup(const XmlElement& xml) {
    checkAttributes(xml, {"name", "type", "is_light", "commands"});
    if (const XmlAttribute* type = find(xml, "type"); type && type->value == "displacement") {
      reporter_.error(source_.at(type->valueOffset), "displacement shader groups are not supported");
      return;
    }
    const XmlAttribute* commands = find(xml, "commands");
    Code code{.tag = "group", .text = xml.text, .location = source_.at(xml.textOffset), .file = {}};
    if (commands) {
      code.text = commands->value;
      code.location = source_.at(commands->valueOffset);
    } else if (trim(xml.text).empty()) {
      code.text = textOf(xml);
      code.location = at(xml);
    }
    Element shader = object("bsdf", "osl", at(xml));
    shader.id = group_ = fmt::format("group {}", ++groupCount_);
    if (const XmlAttribute* name = find(xml, "name"); name && !name->value.empty()) {
      named_.emplace(name->value, group_);
    }
    shader.code = std::move(code);
    tree_.scene.children.push_back(std::move(shader));
  }

  /// A mention of a shader group; nothing where there is none yet, which is reported.
  std::optional<Element> groupFor(const XmlElement& xml, const std::string& group) {
    if (group.empty()) {
      reporter_.error(at(xml), fmt::format("no <ShaderGroup> stands before this <{}>", xml.tag));
      return std::nullopt;
    }
    Element reference = object("ref", "", at(xml));
    reference.id = group;
    return reference;
  }

  void readBackground(const XmlElement& xml) {
    checkAttributes(xml, {"resolution"});
    const auto group = groupFor(xml, group_);
    Element emitter = object("emitter", "background", at(xml));
    if (const auto resolution = numbers(xml, "resolution", 1, false)) {
      // Theirs is that of a table for sampling; what is seen should be finer.
      const double wanted = std::clamp(2 * resolution->front(), 512.0, 4096.0);
      set(emitter, "resolution", "integer", static_cast<int>(wanted), placeOf(xml, "resolution"));
    }
    if (!group) return;
    emitter.children.push_back(*group);
    tree_.scene.children.push_back(std::move(emitter));
  }

  void addShape(Element shape, const XmlElement& xml, const std::string& group) {
    const auto reference = groupFor(xml, group);
    if (!reference) return;
    shape.children.push_back(*reference);
    set(shape, "faces_viewer", "boolean", true, at(xml));
    tree_.scene.children.push_back(std::move(shape));
  }

  void readSphere(const XmlElement& xml) {
    checkAttributes(xml, {"center", "radius", "resolution", "is_light"});
    const auto center = triple(xml, "center", true);
    const auto radius = numbers(xml, "radius", 1, true);
    if (!center || !radius) return;
    Element shape = object("shape", "sphere", at(xml));
    const auto f = [](double x) { return static_cast<float>(x); };
    set(shape, "center", "point", Point<Unplaced>(f((*center)[0]), f((*center)[1]), f((*center)[2])),
        placeOf(xml, "center"));
    set(shape, "radius", "float", f(radius->front()), placeOf(xml, "radius"));
    addShape(std::move(shape), xml, group_);
  }

  void readQuad(const XmlElement& xml) {
    checkAttributes(xml, {"corner", "edge_x", "edge_y", "resolution", "is_light"});
    const auto corner = triple(xml, "corner", true), x = triple(xml, "edge_x", true), y = triple(xml, "edge_y", true);
    if (!corner || !x || !y) return;
    const Triple normal = cross(*x, *y);
    if (!(length(normal) > 0)) {
      reporter_.error(at(xml), "the edges of this quad span no area");
      return;
    }
    Triple half[2], middle = *corner;
    for (std::size_t i = 0; i < 3; ++i) {
      half[0][i] = 0.5 * (*x)[i];
      half[1][i] = 0.5 * (*y)[i];
      middle[i] += half[0][i] + half[1][i];
    }
    Element shape = object("shape", "rectangle", at(xml));
    set(shape, "to_world", "transform", matrixOf(half[0], half[1], unit(normal), middle), at(xml));
    addShape(std::move(shape), xml, group_);
  }

  /// Its faces have the groups that their materials name; where it has none of these, the groups that its objects name;
  /// all others the group before it.
  void readModel(const XmlElement& xml) {
    checkAttributes(xml, {"filename"});
    const XmlAttribute* file = find(xml, "filename");
    if (!file) {
      reporter_.error(at(xml), "<Model> lacks 'filename'");
      return;
    }
    addModel(xml, *file, {}, group_);
    const ObjNames names = readObjNames(file->value);
    const auto ofGroups = [&](const std::vector<std::string>& all) {
      std::vector<std::string> found;
      std::ranges::copy_if(all, std::back_inserter(found), [&](const std::string& n) { return named_.contains(n); });
      return found;
    };
    const std::vector<std::string> materials = ofGroups(names.materials), objects = ofGroups(names.objects);
    if (group_.empty() || (materials.empty() && objects.empty())) return;
    const std::vector<std::string>& parts = materials.empty() ? objects : materials;
    const std::string kind = materials.empty() ? "o" : "usemtl";
    Element& rest = tree_.scene.children.back();
    const bool hasRest = parts.size() < (materials.empty() ? names.objects : names.materials).size();
    if (hasRest) {
      set(rest, "faces", "string", fmt::format("not {} {}", kind, fmt::join(parts, " ")), at(xml));
    } else {
      tree_.scene.children.pop_back();
    }
    for (const std::string& part : parts) addModel(xml, *file, fmt::format("{} {}", kind, part), named_.at(part));
  }

  /// The model, or those of its faces, with a group.
  void addModel(const XmlElement& xml, const XmlAttribute& file, std::string faces, const std::string& group) {
    const SourceLocation place = source_.at(file.valueOffset);
    Element shape = object("shape", "obj", at(xml));
    set(shape, "filename", "string", file.value, place);
    set(shape, "flip_tex_coords", "boolean", false, place);
    if (!faces.empty()) set(shape, "faces", "string", std::move(faces), place);
    addShape(std::move(shape), xml, group);
  }

  struct ObjNames {
    std::vector<std::string> materials, objects;  ///< Each once; empty for faces that come before any.
  };
  /// The names that faces of the file come under. Nothing where it cannot be read, which is reported later.
  ObjNames readObjNames(const std::string& name) const {
    ObjNames names;
    if (named_.empty()) return names;
    const auto path = findFile(name, source_.directory(), {});
    std::ifstream file(path.value_or(std::filesystem::path()));
    std::string line, word, material, object;
    const auto note = [](std::vector<std::string>& list, const std::string& each) {
      if (std::ranges::find(list, each) == list.end()) list.push_back(each);
    };
    while (path && std::getline(file, line)) {
      std::istringstream words(line);
      words >> word;
      if (line.empty() || words.fail()) continue;
      if (word == "usemtl" || word == "o" || word == "g") {
        std::string& current = word == "usemtl" ? material : object;
        current.clear();
        words >> current;
      } else if (word == "f") {
        note(names.materials, material);
        note(names.objects, object);
      }
    }
    return names;
  }

  const SourceText& source_;
  Reporter& reporter_;
  SceneTree tree_;
  Element sensor_, integrator_;
  std::string group_;                         ///< Id of the last shader group.
  std::map<std::string, std::string> named_;  ///< Ids of groups by their names.
  int groupCount_ = 0;
};

}  // namespace

SceneTree readWorld(const XmlElement& world, const SourceText& source, Reporter& reporter) {
  return WorldReader(source, reporter).read(world);
}

}  // namespace aerosol::scene
