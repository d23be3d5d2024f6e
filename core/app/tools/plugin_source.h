// Native plugins from source: `aerosol compile gear.cpp` makes gear.bc.
#pragma once

#include <filesystem>

#include "core/app/arguments.h"
#include "core/app/console.h"

namespace aerosol::app {

/// Does the name say that it is C or C++?
bool isPluginSource(const std::filesystem::path& file);

/// Runs clang (19 or older; $AEROSOL_CLANG names another) on the file and looks at what came out. The bitcode is named
/// after the file, in the current folder, or as the arguments say. False when something is wrong, which was told.
bool compilePluginSource(const std::filesystem::path& file, const CompileArguments& arguments, const Console& console);

}  // namespace aerosol::app
