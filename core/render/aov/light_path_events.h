// What happens to a light path, as expressions over paths see it: from the camera to where light comes from.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace aerosol::render {

enum class PathEvent : std::uint8_t {
  camera,
  reflectDiffuse,
  reflectGlossy,
  reflectSpecular,
  transmitDiffuse,
  transmitGlossy,
  transmitSpecular,
  straight,    ///< Through a surface without a bend; any number of them in a row is one event.
  volume,      ///< Scattered by a medium.
  light,       ///< The end: a light of the scene.
  background,  ///< The end: a light that surrounds the scene.
  object,      ///< The end: a surface that emits by its shader.
  medium       ///< The end: a medium that emits.
};
inline constexpr std::size_t pathEventCount = 13;

/// The letters of an event's type and of its scattering; '-' stands for none.
struct EventLetters {
  char type, scattering;
};
inline constexpr std::array<EventLetters, pathEventCount> eventLetters = {{{'C', '-'},
                                                                           {'R', 'D'},
                                                                           {'R', 'G'},
                                                                           {'R', 'S'},
                                                                           {'T', 'D'},
                                                                           {'T', 'G'},
                                                                           {'T', 'S'},
                                                                           {'T', 's'},
                                                                           {'V', '-'},
                                                                           {'L', '-'},
                                                                           {'B', '-'},
                                                                           {'O', '-'},
                                                                           {'O', 'V'}}};

constexpr bool isEnd(PathEvent event) { return event >= PathEvent::light; }

/// An event with one of `labelCount` labels, the first of which stands for none: what automata read.
using PathSymbol = std::uint32_t;
constexpr PathSymbol symbolOf(PathEvent event, std::size_t label, std::size_t labelCount) {
  return static_cast<PathSymbol>(static_cast<std::size_t>(event) * labelCount + label);
}

}  // namespace aerosol::render
