#include "core/app/quantity.h"

#include <fmt/format.h>

#include <cmath>

namespace aerosol::app {

std::string formatClock(double seconds) {
  if (!(seconds >= 0) || seconds > 1e9) return "-:--";
  const auto whole = static_cast<std::uint64_t>(seconds);
  const std::uint64_t hours = whole / 3600, minutes = whole / 60 % 60;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
  return fmt::format("{}:{:02}", minutes, whole % 60);
}

std::string formatDuration(double seconds) {
  if (!(seconds >= 0)) return "-";
  if (seconds < 0.00995) return fmt::format("{:.1f} ms", seconds * 1e3);
  if (seconds < 0.9995) return fmt::format("{:.0f} ms", seconds * 1e3);
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  return formatClock(seconds);
}

std::string formatCount(std::uint64_t count) {
  std::string digits = fmt::format("{}", count);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, 1, ',');
  return digits;
}

std::string formatCount(std::uint64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", formatCount(count), noun, count == 1 ? "" : "s");
}

std::string formatShort(double number) {
  constexpr const char* prefixes[] = {"", " k", " M", " G", " T"};
  std::size_t i = 0;
  while (number >= 999.5 && i < 4) {
    number /= 1000;
    ++i;
  }
  const int decimals = i == 0 ? 0 : number < 9.995 ? 2 : number < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f}{}", number, decimals, prefixes[i]);
}

std::string formatMean(double mean) {
  return mean == std::floor(mean) ? formatCount(static_cast<std::uint64_t>(mean)) : fmt::format("{:.1f}", mean);
}

std::string formatError(double error) {
  const double percent = 100 * error;
  return fmt::format("{:.{}f}%", percent, percent >= 9.95 ? 0 : percent >= 0.995 ? 1 : percent >= 0.0995 ? 2 : 3);
}

std::string formatPercent(double part, double whole) {
  return whole > 0 ? fmt::format("{:.1f} %", 100 * part / whole) : "-";
}

}  // namespace aerosol::app
