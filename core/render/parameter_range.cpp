#include "core/render/parameter_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace aerosol::render {

namespace {

std::vector<double> numbersOf(const lang::ConstantValue& value) {
  if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&value)) return {ints->begin(), ints->end()};
  if (const auto* floats = std::get_if<std::vector<float>>(&value)) return {floats->begin(), floats->end()};
  return {};
}

/// Empty when the parameter has no such limit.
std::vector<double> limit(const lang::Parameter& parameter, std::string_view name) {
  for (const lang::MetadataValue& entry : parameter.metadata) {
    if (entry.name == name) return numbersOf(entry.value);
  }
  return {};
}

/// The limit of a component; `otherwise` when there is none.
double at(const std::vector<double>& limits, std::size_t component, double otherwise) {
  if (limits.empty()) return otherwise;
  return limits[std::min(component, limits.size() - 1)];
}

}  // namespace

void warnOutsideRange(const lang::Parameter& parameter, const lang::ConstantValue& value, std::string_view shader,
                      const SourceLocation& location, Diagnostics& warnings) {
  const std::vector<double> low = limit(parameter, "min"), high = limit(parameter, "max");
  if (low.empty() && high.empty()) return;
  const std::vector<double> numbers = numbersOf(value);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double from = at(low, i, -infinity), to = at(high, i, infinity);
    if (numbers[i] >= from && numbers[i] <= to) continue;
    const std::string range = high.empty()  ? fmt::format("at least {:.6g}", from)
                              : low.empty() ? fmt::format("at most {:.6g}", to)
                                            : fmt::format("from {:.6g} to {:.6g}", from, to);
    warnings.warning(location, fmt::format("parameter '{}' of shader '{}' is {:.6g}; the shader is made for values {}",
                                           parameter.name, shader, numbers[i], range));
    return;
  }
}

}  // namespace aerosol::render
