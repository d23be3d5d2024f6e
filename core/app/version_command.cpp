#include "core/app/version_command.h"

#include <tbb/version.h>

#include <CLI/Version.hpp>
#include <string>
#include <vector>

#include "core/accel/scene.h"
#include "core/base/library_versions.h"
#include "core/grid/grid_file.h"
#include "core/image/image.h"
#include "core/jit/compiler.h"
#include "core/jit/target.h"
#include "core/lang/preprocessor.h"
#include "core/scene/xml_version.h"

namespace aerosol::app {

namespace {

/// What compiled shaders are made for on this machine.
std::string describeHost() {
  const auto target = jit::chooseTarget();
  if (!target) return "no shader can run on this processor: it is below x86-64-v3";
  return "shaders run " + std::to_string(target->width) + " points at once, " + std::string(jit::name(target->isa));
}

}  // namespace

const char* programVersion() { return AEROSOL_VERSION; }

ExitCode versionCommand(const Console& console) {
  Diagnostics errors;
  std::vector<std::string> libraries{"LLVM " + jit::llvmVersion()};
  if (const auto clang = lang::clangVersion()) {
    libraries.push_back("clang " + *clang);
  } else {
    errors.append(clang.errors());
  }
  libraries.push_back("Embree " + accel::version());
  for (const auto& versions : {image::libraryVersions(), grid::libraryVersions()}) {
    if (versions) {
      libraries.insert(libraries.end(), versions->begin(), versions->end());
    } else {
      errors.append(versions.errors());
    }
  }
  libraries.push_back(scene::xmlLibraryVersion());
  for (std::string& library : baseLibraryVersions()) libraries.push_back(std::move(library));
  libraries.push_back(std::string("oneTBB ") + TBB_runtime_version());
  libraries.push_back("CLI11 " CLI11_VERSION);

  console.print(std::string("Aerosol ") + programVersion() + "\n");
  for (const std::string& library : libraries) console.print("  " + library + "\n");
  console.print("  shading language: OSL " + std::to_string(lang::oslVersionMajor) + "." +
                std::to_string(lang::oslVersionMinor) + "\n");
  console.print("  " + describeHost() + "\n");
  console.report(errors);
  return errors.hasErrors() ? ExitCode::badInput : ExitCode::success;
}

}  // namespace aerosol::app
