// The table of closures: what a shader may add to Ci.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/lang/type.h"

namespace aerosol::lang {

struct ClosureParameter {
  std::string name;
  Type type;
};

struct ClosureRow {
  const char* name;
  const char* parameters;  ///< As declared: "color albedo, float anisotropy".
  const char* options;     ///< Optional ones, given as "name", value behind the others; declared likewise.
  bool surface;            ///< Has a meaning in surface shaders.
  bool volume;             ///< Has a meaning in volume shaders.
  const char* doc;
};

/// The closure of closures; all others have values as parameters.
inline constexpr const char* layerClosure = "layer";

std::span<const ClosureRow> closureTable();

/// The rows of that name: several where a closure may be called with different parameters.
std::vector<const ClosureRow*> findClosures(std::string_view name);

std::vector<ClosureParameter> closureParameters(const ClosureRow& row);
std::vector<ClosureParameter> closureOptions(const ClosureRow& row);

/// `closure color anisotropic_vdf(color albedo, color extinction, float anisotropy)`
std::string toString(const ClosureRow& row);

std::vector<std::string> closureNames();

}  // namespace aerosol::lang
