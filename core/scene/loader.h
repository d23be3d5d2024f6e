// Reads a scene: the one entrance to this library.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/scene/description.h"
#include "core/scene/parameter.h"

namespace aerosol::scene {

struct LoadOptions {
  std::map<std::string, std::string> defines;  ///< `-D name=value`; each has to be used by the scene.
  std::vector<std::string> overrides;          ///< `--set target.parameter=value`, applied in order (see overrides.h).
  KnownTypes knownTypes;                       ///< Object types of plugins.
  std::string sensor = {};                     ///< Which of several, by id or number from 0; empty: the first.
};

/// Reads a scene file. All errors that could be found come back together; `warnings` gets what is merely doubtful.
Result<SceneDescription> load(const std::filesystem::path& path, const LoadOptions& options, Diagnostics& warnings);

/// A scene as far as it could be read, and everything that is wrong with it.
struct Reading {
  std::optional<SceneDescription> scene;  ///< Not to be rendered when there are errors; none without any content.
  Diagnostics errors;
};

/// As `load`, for those who look for more errors in what could be read.
Reading read(const std::filesystem::path& path, const LoadOptions& options, Diagnostics& warnings);

/// Reads a scene from text. Messages call it `name`; relative file names start from `directory`.
Result<SceneDescription> loadString(std::string text, const std::string& name, const std::filesystem::path& directory,
                                    const LoadOptions& options, Diagnostics& warnings);

}  // namespace aerosol::scene
