#include "core/app/doctor/doctor_command.h"

#include <fmt/format.h>

#include "core/app/doctor/examination.h"
#include "core/app/quantity.h"

namespace aerosol::app {

ExitCode doctorCommand(const DoctorArguments& arguments, const Console& console) {
  SceneSession session(arguments.render, console);
  if (!session.load()) return ExitCode::badInput;
  shrinkFilm(session.description().film, arguments.size);
  if (!session.prepare()) return ExitCode::badInput;
  const scene::SceneDescription& description = session.description();
  const render::PreparedScene& scene = session.scene();
  Diagnostics found = examineInputs(description, scene);
  found.append(examineGeometry(description, scene));
  found.append(examineSampling(description, scene));
  const PilotReport pilot = renderPilot(session, 0.5);
  found.append(examinePilot(description, scene, pilot));
  description.sources->annotate(found);
  console.report(found);
  const std::size_t count = found.entries().size() + session.warnings().entries().size();
  console.print(
      count == 0 ? fmt::format("{}: nothing found; {} were tried\n", arguments.render.scene.filename().string(),
                               formatCount(pilot.report.statistics.samples, "path"))
                 : fmt::format("{}: {}\n", arguments.render.scene.filename().string(), formatCount(count, "finding")));
  return count == 0 ? ExitCode::success : ExitCode::badInput;
}

}  // namespace aerosol::app
