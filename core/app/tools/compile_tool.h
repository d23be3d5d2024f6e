// `aerosol compile`, which takes oslc's options: checks shaders, and writes compiled files and lists of what they
// depend on.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/app/arguments.h"
#include "core/app/command_line.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// The arguments behind the command's name, or help, or what is wrong with them.
std::variant<CompileArguments, Reply> parseCompileArguments(const std::vector<std::string>& words);

std::string compileHelp();
ExitCode compileTool(const ToolArguments& arguments, const Console& console);

}  // namespace aerosol::app
