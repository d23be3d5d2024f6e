#include "core/scene/syntax.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "core/scene/attributes.h"
#include "core/scene/definitions.h"
#include "core/scene/shared_spectra.h"
#include "core/scene/spectrum_reader.h"
#include "core/scene/transform_reader.h"
#include "core/scene/upgrade.h"
#include "core/scene/world.h"
#include "core/scene/xml_reader.h"

namespace aerosol::scene {

namespace {

constexpr int includeLimit = 10000;

const std::vector<std::string>& directiveTags() {
  static const std::vector<std::string> tags = {"default", "include", "path", "alias"};
  return tags;
}

const std::vector<std::string>& propertyTags() {
  static const std::vector<std::string> tags = {"float",    "integer", "boolean", "string",    "rgb",
                                                "spectrum", "point",   "vector",  "transform", "animation"};
  return tags;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool isShader(const std::string& tag) {
  return tag == "bsdf" || tag == "medium" || tag == "texture" || tag == "displacement";
}

ValueType typeOfTag(const std::string& tag) {
  if (tag == "float") return ValueType::number;
  if (tag == "integer") return ValueType::integer;
  if (tag == "boolean") return ValueType::boolean;
  if (tag == "string") return ValueType::string;
  if (tag == "point") return ValueType::point;
  if (tag == "vector") return ValueType::vector;
  if (tag == "transform" || tag == "animation") return ValueType::transform;
  return ValueType::color;
}

/// Reads one file after the other into one tree.
class TreeReader {
 public:
  TreeReader(const std::map<std::string, std::string>& defines, SourceTexts& texts, Reporter& reporter)
      : definitions_(defines), texts_(texts), reporter_(reporter) {}

  SceneTree read(const SourceText& root) {
    tree_.scene.tag = "scene";
    tree_.scene.location = root.at(0);
    if (auto xml = readXml(root, reporter_)) {
      upgrade(*xml);
      const FileScope scope(*this, root);
      tree_.scene.location = root.at(xml->offset);
      if (xml->tag == "scene") {
        readScene(*xml, tree_.scene, true);
      } else if (xml->tag == "World") {
        tree_ = readWorld(*xml, root, reporter_);
      } else {
        reporter_.error(
            root.at(xml->offset),
            fmt::format("the root element is <{}>: a scene starts with <scene version=\"3.0.0\">", xml->tag));
      }
      spectra_.resolve(tree_, definitions_, reporter_);
      reportUnused();
    }
    return std::move(tree_);
  }

 private:
  /// The files being read, from the root to the innermost include.
  struct FileScope {
    FileScope(TreeReader& reader, const SourceText& source) : reader_(reader) { reader_.files_.push_back(&source); }
    ~FileScope() { reader_.files_.pop_back(); }
    FileScope(const FileScope&) = delete;
    FileScope& operator=(const FileScope&) = delete;
    TreeReader& reader_;
  };

  const SourceText& source() const { return *files_.back(); }
  ReadContext context() { return {source(), definitions_, reporter_}; }
  SourceLocation at(const XmlElement& xml) const { return source().at(xml.offset); }

  void reportUnused() {
    if (incomplete_) return;
    for (const std::string& name : definitions_.unusedFromCommandLine()) {
      std::vector<std::string> notes = alternatives(name, definedNames(name), "the scene defines");
      const bool isFrame = name == "frame";
      if (isFrame)
        notes.insert(notes.begin(), "without it, all frames are the same picture: write $frame where one differs");
      reporter_.error({"command line", 0, 0},
                      fmt::format("{1}-D {0}: the scene never uses '${0}'", name, isFrame ? "--frames or " : ""),
                      std::move(notes));
    }
    if (reporter_.failed()) return;
    for (const auto& [name, location] : definitions_.unusedDefaults()) {
      reporter_.warning(location, fmt::format("the default '{0}' is never used: no value holds '${0}'", name),
                        {fmt::format("write ${} where its value is wanted, or remove it", name)});
    }
  }

  std::vector<std::string> definedNames(const std::string& except) const {
    std::vector<std::string> names = definitions_.names();
    std::erase(names, except);
    return names;
  }

  /// Version 2 renamed all parameters. A file says its own version; what it includes without one is read as it is.
  static void upgrade(XmlElement& root) {
    for (const XmlAttribute& attribute : root.attributes) {
      if (attribute.name != "version") continue;
      const std::string_view text = trim(attribute.value);
      if (text.starts_with("0.") || text.starts_with("1.") || text == "0" || text == "1") upgradeNames(root);
    }
  }

  void checkVersion(const Attribute& version) {
    int major = 0;
    const std::string_view text = trim(version.value);
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), major);
    const std::string_view rest(end, static_cast<std::size_t>(text.data() + text.size() - end));
    const bool numeric = rest.find_first_not_of("0123456789.") == std::string_view::npos;
    if (code != std::errc{} || !numeric || (!rest.empty() && rest[0] != '.')) {
      reporter_.error(version.valueLocation, fmt::format("'{}' is not a version: write 3.0.0", text));
    } else if (major > 3) {
      reporter_.error(version.valueLocation, fmt::format("version {} is not read here: 0.1.0 to 3.x are", text));
    }
  }

  void readScene(const XmlElement& xml, Element& scene, bool isRoot) {
    const auto required = isRoot ? std::vector<std::string>{"version"} : std::vector<std::string>{};
    const auto optional = isRoot ? std::vector<std::string>{} : std::vector<std::string>{"version"};
    const Attributes attributes(xml, required, optional, context());
    if (const Attribute* version = attributes.find("version")) checkVersion(*version);
    for (const XmlElement& child : xml.children) readSceneChild(child, scene);
  }

  void readSceneChild(const XmlElement& xml, Element& scene) {
    if (xml.tag == "default") return readDefault(xml);
    if (xml.tag == "include") return readInclude(xml, scene);
    if (xml.tag == "path") return readPath(xml);
    if (xml.tag == "alias") return readAlias(xml);
    if (xml.tag == "spectrum") return spectra_.add(xml, context());
    if (contains(objectTags(), xml.tag)) return readObject(xml, scene);
    std::vector<std::string> valid = directiveTags();
    valid.emplace_back("spectrum");
    valid.insert(valid.end(), objectTags().begin(), objectTags().end());
    reportElement(xml, "scene", valid);
  }

  void readObjectChild(const XmlElement& xml, Element& object) {
    if (contains(propertyTags(), xml.tag)) return readProperty(xml, object);
    if (contains(objectTags(), xml.tag)) return readObject(xml, object);
    if (xml.tag == "ref") return readReference(xml, object);
    if (isShader(object.tag) && (xml.tag == "source" || xml.tag == "group")) return readCode(xml, object);
    if (xml.tag == "include") return readInclude(xml, object);
    std::vector<std::string> valid = propertyTags();
    valid.insert(valid.end(), {"ref", "include"});
    if (isShader(object.tag)) valid.insert(valid.end(), {"source", "group"});
    valid.insert(valid.end(), objectTags().begin(), objectTags().end());
    reportElement(xml, object.tag, valid);
  }

  void reportElement(const XmlElement& xml, const std::string& parent, const std::vector<std::string>& valid) {
    const bool known = contains(objectTags(), xml.tag) || contains(propertyTags(), xml.tag) ||
                       contains(directiveTags(), xml.tag) || xml.tag == "ref" || xml.tag == "scene" ||
                       xml.tag == "source" || xml.tag == "group";
    const std::string message = known ? fmt::format("<{}> does not belong in <{}>", xml.tag, parent)
                                      : fmt::format("unknown element <{}> in <{}>", xml.tag, parent);
    reporter_.error(at(xml), message, alternatives(xml.tag, valid, "valid here:"));
  }

  void expectNoChildren(const XmlElement& xml) {
    for (const XmlElement& child : xml.children) {
      reporter_.error(at(child),
                      fmt::format("<{}> does not belong in <{}>, which has no children", child.tag, xml.tag));
    }
  }

  void readDefault(const XmlElement& xml) {
    const Attributes attributes(xml, {"name", "value"}, {}, context());
    expectNoChildren(xml);
    if (!attributes.valid()) return;
    const std::string name = attributes.text("name");
    if (!Definitions::isName(name)) {
      reporter_.error(attributes.at("name"),
                      fmt::format("'{}' cannot be used as $name: write letters, digits and underscores", name));
      return;
    }
    definitions_.setDefault(name, attributes.text("value"), at(xml));
  }

  void readPath(const XmlElement& xml) {
    const Attributes attributes(xml, {"value"}, {}, context());
    expectNoChildren(xml);
    if (!attributes.valid()) return;
    const std::filesystem::path folder = source().directory() / attributes.text("value");
    std::error_code code;
    if (attributes.text("value").empty() || !std::filesystem::is_directory(folder, code)) {
      reporter_.error(attributes.at("value"), fmt::format("'{}' is not a folder", folder.string()));
      return;
    }
    tree_.searchPath.push_back(folder.lexically_normal());
  }

  void readAlias(const XmlElement& xml) {
    const Attributes attributes(xml, {"id", "as"}, {}, context());
    expectNoChildren(xml);
    if (!attributes.valid()) return;
    tree_.aliases.push_back({attributes.text("id"), attributes.text("as"), attributes.at("id"), attributes.at("as")});
  }

  void readInclude(const XmlElement& xml, Element& parent) {
    const Attributes attributes(xml, {"filename"}, {}, context());
    expectNoChildren(xml);
    if (!attributes.valid()) return;
    const std::string name = attributes.text("filename");
    const SourceLocation place = attributes.at("filename");
    const auto path = findFile(name, source().directory(), tree_.searchPath);
    if (!path) {
      reporter_.error(place, fmt::format("there is no file '{}' to include", name),
                      {describeSearch(name, source().directory(), tree_.searchPath)});
      incomplete_ = true;
      return;
    }
    if (reportCycle(*path, place)) return;
    if (++includeCount_ > includeLimit) {
      if (includeCount_ == includeLimit + 1) {
        reporter_.error(place, fmt::format("more than {} files are included", includeLimit));
      }
      return;
    }
    std::string why;
    std::optional<std::string> text = readFile(*path, why);
    if (!text) {
      reporter_.error(place, fmt::format("'{}' cannot be included: {}", path->string(), why));
      incomplete_ = true;
      return;
    }
    readIncluded(texts_.add(path->string(), std::move(*text), path->parent_path()), parent);
  }

  bool reportCycle(const std::filesystem::path& path, const SourceLocation& place) {
    std::vector<std::string> chain;
    bool found = false;
    for (const SourceText* file : files_) {
      std::error_code code;
      found = found || std::filesystem::equivalent(file->file(), path, code);
      if (found) chain.push_back(file->file());
    }
    if (!found) return false;
    chain.push_back(path.string());
    reporter_.error(place, fmt::format("'{}' includes itself", path.string()),
                    {fmt::format("{}", fmt::join(chain, " includes "))});
    return true;
  }

  void readIncluded(const SourceText& text, Element& parent) {
    if (files_.size() > static_cast<std::size_t>(nestingLimit)) {
      reporter_.error(text.at(0), fmt::format("files are included more than {} deep", nestingLimit));
      return;
    }
    auto xml = readXml(text, reporter_);
    incomplete_ = incomplete_ || !xml;
    if (!xml) return;
    upgrade(*xml);
    const FileScope scope(*this, text);
    if (xml->tag == "scene" && parent.tag == "scene") {
      readScene(*xml, parent, false);
    } else if (contains(objectTags(), xml->tag)) {
      readObject(*xml, parent, true);
    } else {
      std::vector<std::string> valid = objectTags();
      if (parent.tag == "scene") valid.insert(valid.begin(), "scene");
      reporter_.error(at(*xml), fmt::format("<{}> cannot be included in <{}>", xml->tag, parent.tag),
                      alternatives(xml->tag, valid, "valid here:"));
    }
  }

  void readObject(const XmlElement& xml, Element& parent, bool isRoot = false) {
    std::vector<std::string> optional = {"id", "name"};
    if (isShader(xml.tag) || xml.tag == "volume") optional.emplace_back("output");
    if (isRoot) optional.emplace_back("version");
    const Attributes attributes(xml, {"type"}, optional, context());
    if (const Attribute* version = attributes.find("version")) checkVersion(*version);
    Element object{.tag = xml.tag,
                   .type = attributes.text("type"),
                   .id = attributes.text("id"),
                   .name = attributes.text("name"),
                   .location = at(xml),
                   .typeLocation = attributes.at("type"),
                   .idLocation = attributes.at("id"),
                   .nameLocation = attributes.at("name"),
                   .properties = {},
                   .children = {}};
    object.output = attributes.text("output");
    object.outputLocation = attributes.at("output");
    if (attributes.has("id") && object.id.empty()) reporter_.error(object.idLocation, "attribute 'id' is empty");
    for (const XmlElement& child : xml.children) readObjectChild(child, object);
    parent.children.push_back(std::move(object));
  }

  void readReference(const XmlElement& xml, Element& parent) {
    const Attributes attributes(xml, {"id"}, {"name", "output"}, context());
    expectNoChildren(xml);
    if (!attributes.valid()) return;
    parent.children.push_back({.tag = "ref",
                               .type = {},
                               .id = attributes.text("id"),
                               .name = attributes.text("name"),
                               .location = at(xml),
                               .typeLocation = {},
                               .idLocation = attributes.at("id"),
                               .nameLocation = attributes.at("name"),
                               .properties = {},
                               .children = {},
                               .output = attributes.text("output"),
                               .outputLocation = attributes.at("output"),
                               .code = {}});
  }

  /// `<source>` or `<group>`: text, or a file.
  void readCode(const XmlElement& xml, Element& object) {
    const Attributes attributes(xml, {}, {"file"}, context());
    expectNoChildren(xml);
    if (!attributes.valid()) return;
    if (object.code) {
      reporter_.error(at(xml),
                      fmt::format("a second description of the shader: <{}> was given before", object.code->tag));
      return;
    }
    Code code{xml.tag, xml.text, source().at(xml.textOffset), std::nullopt};
    if (attributes.has("file") == !xml.text.empty()) {
      reporter_.error(at(xml), fmt::format("<{}> needs either text or a 'file'", xml.tag));
      return;
    }
    if (attributes.has("file")) {
      const std::string name = attributes.text("file");
      code.location = attributes.at("file");
      const auto path = findFile(name, source().directory(), tree_.searchPath);
      if (!path) {
        reporter_.error(code.location, fmt::format("there is no file '{}'", name),
                        {describeSearch(name, source().directory(), tree_.searchPath)});
        return;
      }
      code.file = *path;
      if (xml.tag == "group" && !readGroupFile(code)) return;
    }
    object.code = std::move(code);
  }

  bool readGroupFile(Code& code) {
    std::string why;
    auto text = readFile(*code.file, why);
    if (!text) {
      reporter_.error(code.location, fmt::format("'{}' cannot be read: {}", code.file->string(), why));
      return false;
    }
    const SourceText& kept = texts_.add(code.file->string(), std::move(*text), code.file->parent_path());
    code.text = kept.text();
    code.location = kept.at(0);
    return true;
  }

  void readProperty(const XmlElement& xml, Element& object) {
    const ValueType type = typeOfTag(xml.tag);
    const bool split = type == ValueType::point || type == ValueType::vector;
    std::vector<std::string> required = {"name"};
    std::vector<std::string> optional;
    if (split)
      optional = {"value", "x", "y", "z"};
    else if (xml.tag == "spectrum")
      optional = {"id", "value", "type", "filename"};
    else if (type != ValueType::transform)
      required.emplace_back("value");
    const Attributes attributes(xml, required, optional, context());
    const bool isKind = xml.tag == "spectrum" && attributes.has("type");
    if (type != ValueType::transform && !isKind) expectNoChildren(xml);
    if (!attributes.has("name")) return;
    Property property{.name = attributes.text("name"),
                      .tag = xml.tag,
                      .value = std::nullopt,
                      .location = at(xml),
                      .nameLocation = attributes.at("name"),
                      .valueLocation = attributes.at(isKind                       ? "type"
                                                     : attributes.has("filename") ? "filename"
                                                                                  : "value")};
    if (xml.tag == "animation") {
      if (auto keys = readAnimation(xml, context())) {
        property.value = keys->front().matrix;
        property.keys = std::move(*keys);
      }
    } else if (type == ValueType::transform) {
      property.value = readTransform(xml, context());
    } else if (attributes.valid() && xml.tag == "spectrum") {
      property.value = readSpectrum(xml, attributes, spectrumUseIn(object.tag), tree_.searchPath, context());
      if (attributes.has("id")) spectra_.add(xml, context());
    } else if (attributes.valid()) {
      property.value = split ? readSplit(xml, attributes, type) : readText(attributes, type);
    }
    if (const Property* first = findProperty(object, property.name)) {
      reporter_.error(property.nameLocation, fmt::format("parameter '{}' is given twice", property.name),
                      {fmt::format("the first one is at {}", format(first->nameLocation))});
      return;
    }
    object.properties.push_back(std::move(property));
  }

  static const Property* findProperty(const Element& object, const std::string& name) {
    for (const Property& property : object.properties) {
      if (property.name == name) return &property;
    }
    return nullptr;
  }

  std::optional<Value> readText(const Attributes& attributes, ValueType type) {
    const Attribute& attribute = *attributes.find("value");
    TextError error;
    std::optional<Value> value = parseValue(type, attribute.value, error);
    if (!value) attributes.report(attribute, error);
    return value;
  }

  /// `value="x, y, z"`, or x, y and z apart, where what is not written is 0.
  std::optional<Value> readSplit(const XmlElement& xml, const Attributes& attributes, ValueType type) {
    const Attribute* whole = attributes.find("value");
    const bool apart = attributes.has("x") || attributes.has("y") || attributes.has("z");
    if (apart == (whole != nullptr)) {
      reporter_.error(whole ? whole->nameLocation : at(xml),
                      fmt::format("<{}> needs either 'value' or some of 'x', 'y' and 'z'", xml.tag));
      return std::nullopt;
    }
    if (whole) return readText(attributes, type);
    float numbers[3] = {0, 0, 0};
    const char* const names[] = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
      const Attribute* attribute = attributes.find(names[i]);
      if (!attribute) continue;
      TextError error;
      const auto number = parseFloat(attribute->value, error);
      if (!number) {
        attributes.report(*attribute, error);
        return std::nullopt;
      }
      numbers[i] = *number;
    }
    if (type == ValueType::point) return Value(Point<Unplaced>(numbers[0], numbers[1], numbers[2]));
    return Value(Vector<Unplaced>(numbers[0], numbers[1], numbers[2]));
  }

  Definitions definitions_;
  SharedSpectra spectra_;
  SourceTexts& texts_;
  Reporter& reporter_;
  SceneTree tree_;
  std::vector<const SourceText*> files_;
  int includeCount_ = 0;
  bool incomplete_ = false;  ///< An include could not be read: what it would have used is unknown.
};

}  // namespace

const std::vector<std::string>& objectTags() {
  static const std::vector<std::string> tags = {"integrator", "sensor", "film",        "sampler", "rfilter",
                                                "shape",      "volume", "bsdf",        "medium",  "texture",
                                                "emitter",    "phase",  "displacement"};
  return tags;
}

SceneTree readTree(const SourceText& root, const std::map<std::string, std::string>& defines, SourceTexts& texts,
                   Reporter& reporter) {
  return TreeReader(defines, texts, reporter).read(root);
}

}  // namespace aerosol::scene
