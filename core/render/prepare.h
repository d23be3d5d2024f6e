// From the description of a scene to a scene that can be rendered.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/jit/compiler.h"
#include "core/render/prepared_scene.h"
#include "core/render/registry.h"
#include "core/scene/description.h"

namespace aerosol::render {

struct PrepareOptions {
  std::vector<std::filesystem::path> shaderPath;  ///< Searched before the scene's own search path and the library.
  std::filesystem::path shaderLibrary;            ///< The installed shaders with stdosl.h.
  std::filesystem::path plugins;                  ///< The installed native plugins; empty: none.
  std::shared_ptr<jit::Compiler> compiler;
  std::shared_ptr<jit::ObjectCache> cache;  ///< May be null.
  jit::Target target;
  std::string embreeIsa;                ///< Empty: the best of this machine.
  int textureMemory_MB = 1024;          ///< For decoded texels, at least 16.
  ColorSettings colors = {};            ///< Of the colour spaces that shaders name.
  bool laneCounters = false;            ///< Kernels count the lanes that work (slower).
  std::uint32_t loopBudget = 1u << 20;  ///< Iterations of one loop that one point may run.
  std::optional<SamplingPlan> plan;     ///< Methods of all media, in place of the scene's and the renderer's choice.
  std::vector<scene::AovRequest> aovs;  ///< Beside those of the scene.
  int deepSlices = 0;                   ///< Of a deep image, through media; 0: none.
  int threads = 0;                      ///< That preparation may use; 0: all of the machine.
};

/// Everything wrong with the scene is in the errors, each where it is written. `warnings` also takes those of shaders.
Result<std::unique_ptr<const PreparedScene>> prepare(const scene::SceneDescription& description,
                                                     const Registry& registry, const PrepareOptions& options,
                                                     Diagnostics& warnings);

}  // namespace aerosol::render
