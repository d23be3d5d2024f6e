// The text of a record that a kernel left, formatted as OSL's printf does.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/shading/kernel_host.h"

namespace aerosol::shading {

/// The text of a string in shaders by its hash.
using StringLookup = std::function<std::string_view(std::uint64_t)>;

/// A message's text by its format (see lang::formatText). `values` are the components of arguments of these types.
std::string formatMessage(const std::string& format, const std::vector<lang::Type>& types,
                          const std::vector<AerosolRecordValue>& values, const StringLookup& text);

/// The whole text of a record: a message's own, or the sentence for a report.
std::string describe(const Record& record, const jit::KernelInterface& interface, const StringLookup& text);

/// The file that a record of kind AEROSOL_MESSAGE_FILE is for.
std::string fileOf(const Record& record, const StringLookup& text);

/// Where in the source it was left.
const SourceLocation& locationOf(const Record& record, const jit::KernelInterface& interface);

}  // namespace aerosol::shading
