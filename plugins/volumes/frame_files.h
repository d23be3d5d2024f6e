// Voxel files that are numbered by frames.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/scene/description.h"
#include "core/scene/parameter.h"

namespace aerosol::render {

/// A file's name, and which frame of it.
inline std::vector<scene::ParameterSpec> frameParameters() {
  return {{.name = "filename",
           .type = scene::ValueType::string,
           .doc = "a .vdb or .vol file, looked up beside the scene; %04d in it (or %d, %03d …) stands for the frame",
           .required = true},
          {.name = "frame",
           .type = scene::ValueType::number,
           .unit = "frames",
           .doc = "the frame to show, of a numbered file",
           .defaultValue = 1.0f},
          {.name = "frame_offset",
           .type = scene::ValueType::number,
           .unit = "frames",
           .doc = "added to the frame",
           .defaultValue = 0.0f},
          {.name = "blend",
           .type = scene::ValueType::boolean,
           .doc = "between two frames: be where either of them is, for a medium that mixes the two",
           .defaultValue = false}};
}

/// `pattern` with its %d (%4d, %04d …) replaced; nothing when it has none, or something else after a %.
inline std::optional<std::string> frameFile(const std::string& pattern, long frame) {
  const std::size_t begin = pattern.find('%');
  if (begin == std::string::npos) return {};
  const std::size_t end = pattern.find_first_not_of("0123456789", begin + 1);
  if (end == std::string::npos || pattern[end] != 'd' || end - begin > 3) return {};
  if (pattern.find('%', end) != std::string::npos) return {};
  const std::string form = "{:" + pattern.substr(begin + 1, end - begin - 1) + "d}";
  return pattern.substr(0, begin) + fmt::format(fmt::runtime(form), frame) + pattern.substr(end + 1);
}

/// The files that a volume's parameters name: one, or two between which to blend.
inline Result<std::vector<std::string>> frameFiles(const scene::Volume& volume) {
  const auto& pattern = volume.get<std::string>("filename");
  if (pattern.find('%') == std::string::npos) return std::vector{pattern};
  const double frame =
      static_cast<double>(volume.get<float>("frame")) + static_cast<double>(volume.get<float>("frame_offset"));
  std::vector<std::string> files;
  if (std::fabs(frame) < 1e9) {
    const auto first = static_cast<long>(std::floor(frame));
    if (const auto file = frameFile(pattern, first)) files.push_back(*file);
    const bool isBetween = frame > static_cast<double>(first) && volume.get<bool>("blend");
    if (const auto file = frameFile(pattern, first + 1); file && isBetween) files.push_back(*file);
  }
  if (!files.empty()) return files;
  return Diagnostic{Severity::error,
                    volume.origin.location,
                    fmt::format("'{}' is no name of numbered files", pattern),
                    {},
                    {"a frame's number stands where %d or %04d is, once"}};
}

}  // namespace aerosol::render
