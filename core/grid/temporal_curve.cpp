#include "core/grid/temporal_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aerosol::grid {

std::size_t fitCurve(std::span<const float> times, std::span<const float> values, float error, std::uint8_t* chosen) {
  const auto at = [](std::span<const float> list, std::size_t i) { return static_cast<double>(list[i]); };
  const double allowed = static_cast<double>(error);
  const std::size_t count = times.size();
  chosen[0] = 0;
  std::size_t kept = 1, begin = 0;
  const bool isConstant = std::ranges::all_of(
      values, [&](float v) { return std::fabs(static_cast<double>(v) - at(values, 0)) <= allowed; });
  if (isConstant) return kept;
  while (begin + 1 < count) {
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    std::size_t end = begin + 1;
    for (std::size_t i = begin + 1; i < count && low <= high; ++i) {
      const double span = at(times, i) - at(times, begin), rise = at(values, i) - at(values, begin);
      const double slope = rise / span;
      if (slope >= low && slope <= high) end = i;
      low = std::max(low, (rise - allowed) / span);
      high = std::min(high, (rise + allowed) / span);
    }
    chosen[kept++] = static_cast<std::uint8_t>(end);
    begin = end;
  }
  return kept;
}

}  // namespace aerosol::grid
