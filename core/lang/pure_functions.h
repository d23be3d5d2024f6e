// Host functions whose results depend on their arguments alone: strings. They run where the shader runs, or once, when
// all arguments are constants.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "core/lang/fold.h"
#include "core/lang/host_call.h"

namespace aerosol::lang {

using PureFunction = void (*)(HostCall& call);

/// Null when there is none of that name.
PureFunction findPureFunction(std::string_view name);

/// Runs a call on constants; arguments that the function writes are changed. The result has type none where the
/// function has none. Nothing when there is no such function.
std::optional<Constant> evaluateCall(std::string_view function, const Type& result, std::span<Constant> arguments,
                                     std::uint32_t outputs);

}  // namespace aerosol::lang
