// What the work for one effect takes about, where it cannot be told apart by looking at where threads are.
#pragma once

#include <optional>
#include <string_view>

namespace aerosol::app {

/// Nanoseconds of one of the events that the effect's `work` counts. Static, so that a plan does not depend on how busy
/// a machine is; of the right order, not more. Nothing for effects whose share is measured.
std::optional<double> nanosecondsOfEvent(std::string_view effect);

}  // namespace aerosol::app
