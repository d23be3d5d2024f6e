// The parameters of an instance as the front end takes them.
#pragma once

#include "core/lang/analysis.h"
#include "core/shading/shading_system.h"

namespace aerosol::shading {

/// Of all parameters of the program; those that the instance does not give have their default.
inline lang::ParameterValues valuesOf(const lang::Program& program, const Instance& instance) {
  lang::ParameterValues values;
  for (std::uint32_t i = 0; i < program.parameters.size(); ++i) values[i] = {};
  for (const ParameterValue& value : instance.values) values[value.parameter] = value.value;
  return values;
}

}  // namespace aerosol::shading
