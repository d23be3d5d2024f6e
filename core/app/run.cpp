#include "core/app/run.h"

#include <cstdlib>
#include <variant>

#include "core/app/bake_command.h"
#include "core/app/check_command.h"
#include "core/app/command_line.h"
#include "core/app/denoise_command.h"
#include "core/app/doctor/doctor_command.h"
#include "core/app/help_command.h"
#include "core/app/merge_command.h"
#include "core/app/plan/plan_command.h"
#include "core/app/render_command.h"
#include "core/app/study/study_command.h"
#include "core/app/submit/submit_command.h"
#include "core/app/tools/testrender_arguments.h"
#include "core/app/tools/tool.h"
#include "core/app/version_command.h"
#include "core/shading/native_plugins.h"

namespace aerosol::app {

namespace {

struct Runner {
  const Console& console;

  ExitCode operator()(const RenderArguments& arguments) const { return renderCommand(arguments, console); }
  ExitCode operator()(const MergeArguments& arguments) const { return mergeCommand(arguments, console); }
  ExitCode operator()(const DenoiseArguments& arguments) const { return denoiseCommand(arguments, console); }
  ExitCode operator()(const StudyArguments& arguments) const { return studyCommand(arguments, console); }
  ExitCode operator()(const PlanArguments& arguments) const { return planCommand(arguments, console); }
  ExitCode operator()(const DoctorArguments& arguments) const { return doctorCommand(arguments, console); }
  ExitCode operator()(const CheckArguments& arguments) const { return checkCommand(arguments, console); }
  ExitCode operator()(const SubmitArguments& arguments) const { return submitCommand(arguments, console); }
  ExitCode operator()(const BakeArguments& arguments) const { return bakeCommand(arguments, console); }
  ExitCode operator()(const HelpArguments& arguments) const { return helpCommand(arguments, console); }
  ExitCode operator()(const ToolArguments& arguments) const { return runTool(arguments, console); }
  ExitCode operator()(const VersionArguments&) const { return versionCommand(console); }
};

}  // namespace

ExitCode run(const std::string& program, const std::vector<std::string>& arguments, const Console& console) {
  const char* const shaderPath = std::getenv("AEROSOL_SHADER_PATH");
  // What the program says to itself: see shading::NativePlugins.
  if (arguments.size() == 2 && arguments[0] == "--check-plugin") {
    const std::string problem = shading::tryPlugin(arguments[1]);
    console.print(problem);
    std::fflush(console.out);
    return problem.empty() ? ExitCode::success : ExitCode::badInput;
  }
  const auto tool = toolOfProgram(program);
  std::variant<Arguments, Reply> parsed = Arguments(ToolArguments{});
  if (isTestrender(program)) {
    parsed = parseTestrenderArguments(arguments, shaderPath ? shaderPath : "");
  } else if (tool) {
    parsed = Arguments(ToolArguments{*tool, true, arguments, {}});
  } else {
    parsed = parseCommandLine(arguments, shaderPath ? shaderPath : "");
  }
  ExitCode code = ExitCode::success;
  if (const Reply* reply = std::get_if<Reply>(&parsed)) {
    code = reply->code;
    code == ExitCode::success ? console.print(reply->text) : console.note(reply->text);
  } else {
    code = std::visit(Runner{console}, std::get<Arguments>(parsed));
  }
  if (std::fflush(console.out) != 0 || std::ferror(console.out)) {
    console.note("aerosol: error: cannot write to the standard output\n");
    if (code == ExitCode::success) code = ExitCode::badInput;
  }
  return code;
}

}  // namespace aerosol::app
