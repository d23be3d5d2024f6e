// The text of a record that a kernel left, formatted as OSL's printf does.
#pragma once

#include <functional>
#include <string>

#include "core/shading/kernel_host.h"

namespace aerosol::shading {

/// The text of a string in shaders by its hash.
using StringLookup = std::function<std::string(std::uint64_t)>;

/// Printf text: %d %i %o %x %X %c for ints, %e %f %g (and capitals) for floats, triples and matrices (components
/// separated by blanks), %s for strings and any other type, %% for a percent sign. A directive without an argument, or
/// one that does not fit its argument, falls back to the argument's natural form. Array arguments print all elements.
std::string formatMessage(const std::string& format, const std::vector<lang::Type>& types,
                          const std::vector<AerosolRecordValue>& values, const StringLookup& text);

/// The whole text of a record: a message's own, or the sentence for a report.
std::string describe(const Record& record, const jit::MessageSite& site, const StringLookup& text);

}  // namespace aerosol::shading
