#include "core/app/doctor/doctor_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/app/doctor/examination.h"
#include "core/app/quantity.h"
#include "core/render/medium_facts.h"

namespace aerosol::app {

namespace {

/// Without what shaders say of files that have been told of at the place where the scene names them.
Diagnostics withoutFiles(const Diagnostics& found, const Diagnostics& files) {
  Diagnostics rest;
  for (const Diagnostic& each : found.entries()) {
    const bool isKnown = std::ranges::any_of(files.entries(), [&](const Diagnostic& file) {
      const std::string name = file.message.substr(0, file.message.find('"', 1) + 1);
      return each.message.find("cannot read") != std::string::npos && each.message.find(name) != std::string::npos;
    });
    if (!isKnown) rest.add(each);
  }
  return rest;
}

/// Where a ray would have more steps than come to an end, paths are tried with so many.
constexpr double pilotSteps = 1000;

}  // namespace

ExitCode doctorCommand(const DoctorArguments& arguments, const Console& console) {
  SceneSession session(arguments.render, console);
  if (!session.load()) return ExitCode::badInput;
  shrinkFilm(session.description().film, arguments.size);
  if (!session.prepare()) return ExitCode::badInput;
  const scene::SceneDescription& description = session.description();
  Diagnostics found = examineInputs(description, session.scene());
  found.append(examineGeometry(description, session.scene()));
  found.append(examineSampling(description, session.scene()));
  if (const double steps = render::mostStepsAcross(session.scene()); steps > render::endlessSteps) {
    session.description().integrator.stepScale *= static_cast<float>(steps / pilotSteps);
    if (!session.prepareAgain()) return ExitCode::badInput;
  }
  const PilotReport pilot = renderPilot(session, 0.5);
  found.append(withoutFiles(examinePilot(description, session.scene(), pilot), session.fileWarnings()));
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
