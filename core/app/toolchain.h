// What commands need to turn shaders into kernels.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/app/arguments.h"
#include "core/base/paths.h"
#include "core/base/result.h"
#include "core/jit/compiler.h"
#include "core/jit/object_cache.h"
#include "core/jit/target.h"
#include "core/shading/shader_library.h"

namespace aerosol::app {

struct Toolchain {
  Installation installation;
  std::shared_ptr<jit::ObjectCache> cache;  ///< Null: nothing is kept.
  std::shared_ptr<jit::Compiler> compiler;
  jit::Target target;
};

/// Without a usable cache folder shaders are compiled every time, and a warning says why.
Result<Toolchain> openToolchain(const KernelArguments& arguments, Diagnostics& warnings);

/// The cache that the arguments ask for; null with a warning when it cannot be used.
std::shared_ptr<jit::ObjectCache> openCache(const KernelArguments& arguments, Diagnostics& warnings);

/// Native plugins in these folders, an empty one being the current one, and their subfolders of kinds of shaders.
std::shared_ptr<lang::NativeSource> openPlugins(const std::vector<std::filesystem::path>& folders);

/// Shaders outside a scene: those of the arguments' path and of the installation.
shading::ShaderLibrary openShaderLibrary(const KernelArguments& arguments, const Installation& installation,
                                         std::shared_ptr<jit::ObjectCache> cache, std::vector<std::string> defines = {},
                                         std::vector<std::string> undefines = {});

}  // namespace aerosol::app
