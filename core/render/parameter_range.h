// What shaders say of the values that their parameters take.
#pragma once

#include <string_view>

#include "core/base/diagnostic.h"
#include "core/lang/program.h"

namespace aerosol::render {

/// Warns of numbers outside of the range that the metadata `min` and `max` of a parameter give, and of NaN where there
/// is such a range. A limit is one number for all components or one for each. (What a slider offers, `UImin` and
/// `UImax`, limits nothing.)
void warnOutsideRange(const lang::Parameter& parameter, const lang::ConstantValue& value, std::string_view shader,
                      const SourceLocation& location, Diagnostics& warnings);

}  // namespace aerosol::render
