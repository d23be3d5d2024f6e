// Numbers as people read them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace aerosol::app {

/// "0:07", "12:34", "1:02:03": whole seconds, rounded down; "-:--" when not finite or negative.
std::string formatClock(double seconds);

/// "412 ms", "9.3 s", then as formatClock from a minute on.
std::string formatDuration(double seconds);

/// With separators between thousands: "1,234,567".
std::string formatCount(std::uint64_t count);
/// "1 sample", "1,200 samples".
std::string formatCount(std::uint64_t count, std::string_view noun);

/// Three digits and a prefix: "950", "1.23 k", "45.6 M".
std::string formatShort(double number);

/// A mean of counts: "16" where it is whole, else "15.8".
std::string formatMean(double mean);

/// A relative error with two digits: "1.8%", "0.23%".
std::string formatError(double error);

/// Share of a whole: "97.3 %"; "-" of nothing.
std::string formatPercent(double part, double whole);

}  // namespace aerosol::app
