#include "core/app/check_command.h"

#include <fmt/format.h>

#include "core/app/quantity.h"
#include "core/app/scene_session.h"

namespace aerosol::app {

ExitCode checkCommand(const CheckArguments& arguments, const Console& console) {
  SceneSession session(arguments.render, console);
  const Diagnostics errors = session.check();
  console.report(session.warnings());
  console.report(errors);
  const std::size_t warnings = session.warnings().entries().size();
  const auto count = static_cast<std::size_t>(errors.errorCount());
  console.print(fmt::format("{}: {}, {}\n", arguments.render.scene.filename().string(),
                            count == 0 ? "no errors" : formatCount(count, "error"),
                            warnings == 0 ? "no warnings" : formatCount(warnings, "warning")));
  return count == 0 ? ExitCode::success : ExitCode::badInput;
}

}  // namespace aerosol::app
