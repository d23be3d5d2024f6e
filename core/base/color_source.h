// Colour spaces by name, as a colour configuration has them: the interface between the shaders' library and the one
// that reads configurations. It stands in the base layer because neither of the two layers sees the other.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace aerosol {

/// From one colour space to another. Safe to use from any thread.
class ColorTransform {
 public:
  virtual ~ColorTransform() = default;
  /// In place: `count` colours of three floats.
  virtual void apply(float* colors, std::size_t count) const = 0;
};

/// Safe to use from any thread.
class ColorSource {
 public:
  virtual ~ColorSource() = default;
  /// "rgb" is the space of the render. Null, with a message that lists what there is, for a name that is unknown. What
  /// it gives stays valid as long as the source does.
  virtual const ColorTransform* between(std::string_view from, std::string_view to, std::string& problem) = 0;
};

struct ColorSettings {
  std::string config;        ///< An OpenColorIO config; empty: $OCIO, or else the built-in one.
  std::string workingSpace;  ///< The config's name for the space of the render; empty: its role scene_linear.
};

}  // namespace aerosol
