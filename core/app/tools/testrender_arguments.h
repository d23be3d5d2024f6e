// What a command line of OSL's testrender asks for.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/app/arguments.h"
#include "core/app/command_line.h"

namespace aerosol::app {

/// Whether a program of this name (with any folder in front) is testrender.
bool isTestrender(std::string_view program);

/// `testrender [options] scene.xml output`, as a render; or help, or what is wrong. `shaderPath`: $AEROSOL_SHADER_PATH,
/// folders with colons between.
std::variant<Arguments, Reply> parseTestrenderArguments(const std::vector<std::string>& words,
                                                        std::string_view shaderPath);

}  // namespace aerosol::app
