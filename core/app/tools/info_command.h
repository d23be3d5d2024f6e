// `aerosol info`: what a shader shows of itself, in the form of OSL's oslinfo.
#pragma once

#include <string>

#include "core/app/arguments.h"
#include "core/app/console.h"
#include "core/app/exit_code.h"
#include "core/lang/shader_interface.h"

namespace aerosol::app {

struct InfoStyle {
  bool verbose = false;
  std::string parameter;  ///< This one alone; empty: all, and the shader.
};

/// The text about one shader.
std::string describeInterface(const lang::ShaderInterface& shader, const InfoStyle& style);

std::string infoHelp();
ExitCode infoCommand(const ToolArguments& arguments, const Console& console);

}  // namespace aerosol::app
