#include "core/base/paths.h"

#include <system_error>

namespace aerosol {

Installation installationOf(const std::filesystem::path& executable) {
  const auto resolved = [](const std::filesystem::path& path) {
    std::error_code error;
    auto result = std::filesystem::weakly_canonical(path, error);
    return error ? path.lexically_normal() : result;
  };
  Installation installation;
  installation.prefix = resolved(executable).parent_path().parent_path();
  installation.modules = installation.prefix / "lib" / "aerosol";
  installation.runtime = installation.modules / "runtime";
  installation.plugins = installation.modules / "plugins";
  installation.shaders = resolved(installation.prefix / "share" / "aerosol" / "shaders");
  installation.scenes = resolved(installation.prefix / "share" / "aerosol" / "scenes");
  return installation;
}

Result<Installation> findInstallation() {
  std::error_code error;
  const auto executable = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) {
    return Diagnostic{.location = {.file = "/proc/self/exe"},
                      .message = "cannot find the running program: " + error.message(),
                      .notes = {"the /proc file system must be mounted"}};
  }
  auto installation = installationOf(executable);
  if (!std::filesystem::is_directory(installation.modules, error)) {
    return Diagnostic{.location = {.file = installation.modules.string()},
                      .message = "this folder of the installation is missing",
                      .notes = {"move or copy the whole installed tree, not the executable alone"}};
  }
  return installation;
}

}  // namespace aerosol
