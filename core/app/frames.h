// Frames of a sequence and the names of their files.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aerosol::app {

/// "7", "1-100", "1-100x5" (every fifth), joined by commas; frames may be negative ("-5--1"). In the order given, each
/// once. None when this is no such list or has more than a million frames.
std::optional<std::vector<int>> parseFrames(std::string_view text);

/// Whether the name has a place for the number, such as %04d or %d.
bool hasFramePlace(const std::string& name);

/// The name with the number in that place.
std::string nameOfFrame(const std::string& name, int frame);

}  // namespace aerosol::app
