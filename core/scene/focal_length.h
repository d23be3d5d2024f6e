// Focal lengths as text: "50mm".
#pragma once

#include <optional>
#include <string>

#include "core/scene/value.h"

namespace aerosol::scene {

/// Millimetres, > 0, from a number with or without "mm"; none for anything else.
inline std::optional<double> parseFocalLength(const std::string& text) {
  std::string_view number = trim(text);
  if (number.ends_with("mm")) number.remove_suffix(2);
  TextError error;
  const std::optional<double> millimetres = parseNumber(number, error);
  return millimetres && *millimetres > 0 ? millimetres : std::nullopt;
}

}  // namespace aerosol::scene
