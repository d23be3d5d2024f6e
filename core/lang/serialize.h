// Programs as bytes: the cache keeps them, so that a known source is neither preprocessed nor parsed again.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/lang/program.h"

namespace aerosol::lang {

/// Counts up whenever the layout of a program changes.
inline constexpr std::uint32_t programFormatVersion = 3;

std::string serialise(const Program& program);

/// Nothing when the bytes are not a whole program of this version.
std::optional<Program> deserialiseProgram(std::string_view bytes);

}  // namespace aerosol::lang
