// Where a running program finds what was installed with it.
#pragma once

#include <filesystem>

#include "core/base/result.h"

namespace aerosol {

/// The folders of an installation, all found relative to the executable, so that the whole tree may be moved. A build
/// tree has the same layout.
struct Installation {
  std::filesystem::path prefix;
  std::filesystem::path modules;  ///< Shared objects opened at first use: lib/aerosol.
  std::filesystem::path runtime;  ///< Bitcode of the kernels' runtime library: lib/aerosol/runtime.
  std::filesystem::path plugins;  ///< Native plugins that come with the program: lib/aerosol/plugins.
  std::filesystem::path shaders;  ///< `stdosl.h` and the shader library: share/aerosol/shaders.
  std::filesystem::path scenes;   ///< share/aerosol/scenes.
};

/// The installation to which `executable` in its bin/ folder belongs. Nothing has to exist; symbolic links that do are
/// resolved.
Installation installationOf(const std::filesystem::path& executable);

/// The running program's installation. An error when the system does not tell where its executable is (no /proc), or
/// when the folder of modules is missing beside it.
Result<Installation> findInstallation();

}  // namespace aerosol
