// From the layers of a command line to one program with its values.
#pragma once

#include <string>
#include <vector>

#include "core/app/tools/shade_arguments.h"
#include "core/base/result.h"
#include "core/shading/shader_library.h"
#include "core/shading/shading_system.h"

namespace aerosol::app {

struct ShadeGroup {
  std::string name;
  std::vector<std::string> layers;   ///< Names.
  std::vector<std::string> shaders;  ///< Of each layer the shader's name.
  std::shared_ptr<const lang::Program> program;
  std::vector<shading::ParameterValue> values;
  Diagnostics warnings;
};

/// Finds and compiles the shaders. Values that fit no parameter are left out with a warning.
Result<ShadeGroup> buildShadeGroup(const ShadeArguments& arguments, shading::ShaderLibrary& library);

}  // namespace aerosol::app
