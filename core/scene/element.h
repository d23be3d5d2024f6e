// The generic tree of a scene: objects, their written parameters and their children, all with places.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/motion.h"
#include "core/scene/value.h"

namespace aerosol::scene {

/// One written parameter: `<float name="radius" value="2"/>`.
struct Property {
  std::string name;
  std::string tag;              ///< The element's tag as written: float, rgb, spectrum …
  std::optional<Value> value;   ///< None when the text was wrong, which has been reported.
  SourceLocation location;      ///< Of the element.
  SourceLocation nameLocation;  ///< Of the text of the name.
  SourceLocation valueLocation;
  std::vector<MotionKey> keys = {};  ///< Of an `<animation>`; `value` is the first of them.
};

/// What a shader does, written into the scene or standing in a file: `<source>` or `<group>`.
struct Code {
  std::string tag;
  std::string text;
  SourceLocation location;                    ///< Of the first byte of the text, or of the file's name.
  std::optional<std::filesystem::path> file;  ///< Instead of the text.
};

/// One object, or with the tag `ref` the mention of one by `id`.
struct Element {
  std::string tag;
  std::string type;
  std::string id;
  std::string name;
  SourceLocation location;
  SourceLocation typeLocation;
  SourceLocation idLocation;
  SourceLocation nameLocation;
  std::vector<Property> properties;
  std::vector<Element> children;
  std::string output = {};  ///< Of a layer: which of its outputs is meant.
  SourceLocation outputLocation = {};
  std::optional<Code> code = {};
};

/// `<alias id="existing" as="other"/>`: a second id.
struct Alias {
  std::string id;
  std::string as;
  SourceLocation idLocation;
  SourceLocation asLocation;
};

/// A whole scene with its includes merged.
struct SceneTree {
  Element scene;
  std::vector<Alias> aliases;
  std::vector<std::filesystem::path> searchPath;  ///< Folders of `<path>`, in the order written.
};

}  // namespace aerosol::scene
