// The generic tree → the description: every object checked against its table.
#pragma once

#include <string>

#include "core/scene/description.h"
#include "core/scene/element.h"
#include "core/scene/parameter.h"
#include "core/scene/reporter.h"

namespace aerosol::scene {

/// `sensor` is the one that is wanted of several, by id or number; empty: the first. What could be understood; it is
/// complete when nothing was reported as an error. File names are looked for beside the file that they are written in,
/// then in the search path.
SceneDescription describeScene(const SceneTree& tree, const KnownTypes& known, const SourceTexts& texts,
                               const std::string& sensor, Reporter& reporter);

}  // namespace aerosol::scene
