// XML files → the generic tree: constants, includes, search path, typed parameter values.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/scene/element.h"
#include "core/scene/reporter.h"
#include "core/scene/source_text.h"

namespace aerosol::scene {

/// The text of a whole file; none (and why, in `error`) when it cannot be read or is larger than 1 GiB.
std::optional<std::string> readFile(const std::filesystem::path& path, std::string& error);

/// Reads `root` and what it includes. All texts end up in `texts`. Elements and attributes that the dialect does not
/// know, wrong values and unused `defines` are reported; the tree holds what could be read, so that checks can go on.
SceneTree readTree(const SourceText& root, const std::map<std::string, std::string>& defines, SourceTexts& texts,
                   Reporter& reporter);

/// The tags of objects: integrator, sensor, shape, …
const std::vector<std::string>& objectTags();

/// A relative name looked for in `directory`, then in `searchPath`; none when it is in neither.
std::optional<std::filesystem::path> findFile(const std::string& name, const std::filesystem::path& directory,
                                              const std::vector<std::filesystem::path>& searchPath);

/// "looked in a, b" for a name that `findFile` does not find.
std::string describeSearch(const std::string& name, const std::filesystem::path& directory,
                           const std::vector<std::filesystem::path>& searchPath);

}  // namespace aerosol::scene
