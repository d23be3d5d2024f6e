// What can be written into a scene, as data and as text: generated from the tables that check it.
#pragma once

#include <string>
#include <vector>

#include "core/scene/parameter.h"

namespace aerosol::scene {

/// One object type.
struct ObjectDoc {
  std::string tag;
  std::string type;
  std::vector<std::string> aliases;
  std::string doc;
  std::string nested;  ///< What may stand inside; empty when nothing may.
  std::vector<ParameterSpec> parameters;
};

/// All object types, those of `known` included.
std::vector<ObjectDoc> objectDocs(const KnownTypes& known);

/// Pages for a terminal: the elements, then each object with its parameters, types, units, ranges and defaults. With
/// a `topic`, only the objects with this tag or type; empty when there are none.
std::string documentation(const KnownTypes& known, const std::string& topic = {});

}  // namespace aerosol::scene
