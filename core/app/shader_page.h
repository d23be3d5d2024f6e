// What a shader offers, as text.
#pragma once

#include <string>

#include "core/lang/program.h"

namespace aerosol::app {

/// Name, kind, help and the parameters with types, defaults, ranges and help out of the shader's metadata.
std::string shaderPage(const lang::Program& program);

/// A constant as a scene file would write it: "1", "0.5, 0.5, 0.5", "fbm"; arrays element after element.
std::string formatConstant(const lang::ConstantValue& value);

}  // namespace aerosol::app
