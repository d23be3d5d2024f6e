// The commands that stand for the programs of OSL: compile is oslc, info is oslinfo, shade is testshade.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// "shade" and its like; nothing for another command.
std::optional<Tool> toolOfCommand(std::string_view command);

/// What a program called "testshade", "oslinfo" or "oslc" (with any folder in front) is; nothing for another name.
std::optional<Tool> toolOfProgram(std::string_view program);

/// The help of a tool.
std::string toolHelp(Tool tool);

ExitCode runTool(const ToolArguments& arguments, const Console& console);

}  // namespace aerosol::app
