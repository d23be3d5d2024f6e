// How far a render is, for the person who waits.
#pragma once

#include <cstdint>
#include <string>

#include "core/app/console.h"
#include "core/render/renderer.h"

namespace aerosol::app {

/// " 42%  elapsed 0:12  remaining 0:17  1.31 M samples/s". What remains is extrapolated from the mean pace so far.
/// Where the image's error is known, it follows, and when a smaller one will be reached: `target`, or else the next of
/// 10%, 5%, 2%, 1% … if that is before the end: "  error 1.8%, 1.0% in about 0:40".
std::string progressText(const render::Progress& progress, double target = 0);

/// On a terminal one line that is rewritten; otherwise a line at every tenth of the work.
class ProgressDisplay {
 public:
  explicit ProgressDisplay(const Console& console, double target = 0) : console_(console), target_(target) {}

  void show(const render::Progress& progress);
  /// Ends the line, so that other output starts on a new one.
  void finish();

 private:
  static constexpr int plainSteps = 10;

  void rewrite(std::string text);

  Console console_;
  double target_;
  int nextStep_ = 1;         ///< The next tenth to be told.
  std::size_t written_ = 0;  ///< Characters that the terminal's line holds.
};

}  // namespace aerosol::app
