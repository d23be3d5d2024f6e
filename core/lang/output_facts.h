// What a shader's code tells of its results, whatever it is given.
#pragma once

#include "core/lang/analysis.h"

namespace aerosol::lang {

/// Whether an output's components have the same bits in all points, because they are computed alike, for the given
/// parameters. False where that cannot be seen from the code. What the program does not have is grey: it is 0.
bool isGrey(const Program& program, const ParameterValues& values, OutputKind output);

/// Whether an output is 0 in all points, as far as the code shows; 0 times what is not finite counts as 0.
bool isZero(const Program& program, const ParameterValues& values, OutputKind output);

}  // namespace aerosol::lang
