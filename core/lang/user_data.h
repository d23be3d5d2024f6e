// Parameters that take values which the geometry carries under their names.
#pragma once

#include <string_view>

#include "core/lang/program.h"

namespace aerosol::lang {

/// Whether the parameter's metadata asks for that: `lockgeom = 0`, or `interpolated = 1`.
bool readsUserData(const Parameter& parameter);

/// The shader with a parameter that takes such a value, as if its metadata had asked for it.
Program bindUserData(Program program, std::string_view parameter);

/// Whether the call gives user data by a name, and with it derivatives: `userdata` (name, variable), and `getattribute`
/// with the same arguments.
bool givesUserData(const Program& program, const Instruction& instruction);

}  // namespace aerosol::lang
