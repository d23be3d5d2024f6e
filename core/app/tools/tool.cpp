#include "core/app/tools/tool.h"

#include <array>

#include "core/app/tools/compile_tool.h"
#include "core/app/tools/info_command.h"
#include "core/app/tools/shade_arguments.h"
#include "core/app/tools/shade_command.h"

namespace aerosol::app {

namespace {

struct ToolRow {
  Tool tool;
  std::string_view command, program;
  std::string (*help)();
  ExitCode (*run)(const ToolArguments& arguments, const Console& console);
};

constexpr std::array rows = {ToolRow{Tool::compile, "compile", "oslc", compileHelp, compileTool},
                             ToolRow{Tool::info, "info", "oslinfo", infoHelp, infoCommand},
                             ToolRow{Tool::shade, "shade", "testshade", shadeHelp, shadeCommand}};

const ToolRow& rowOf(Tool tool) {
  std::size_t i = 0;
  while (i + 1 < rows.size() && rows[i].tool != tool) ++i;
  return rows[i];
}

}  // namespace

std::optional<Tool> toolOfCommand(std::string_view command) {
  for (const ToolRow& row : rows)
    if (row.command == command) return row.tool;
  return {};
}

std::optional<Tool> toolOfProgram(std::string_view program) {
  const std::size_t slash = program.rfind('/');
  if (slash != std::string_view::npos) program.remove_prefix(slash + 1);
  for (const ToolRow& row : rows)
    if (row.program == program) return row.tool;
  return {};
}

std::string toolHelp(Tool tool) { return rowOf(tool).help(); }

ExitCode runTool(const ToolArguments& arguments, const Console& console) {
  return rowOf(arguments.tool).run(arguments, console);
}

}  // namespace aerosol::app
