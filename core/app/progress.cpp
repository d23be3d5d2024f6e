#include "core/app/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/app/quantity.h"

namespace aerosol::app {

std::string progressText(const render::Progress& progress) {
  const double fraction = std::clamp(progress.fraction, 0.0, 1.0);
  const double remaining =
      fraction > 0 ? progress.seconds * (1 - fraction) / fraction : std::numeric_limits<double>::infinity();
  const double rate = progress.seconds > 0 ? static_cast<double>(progress.samples) / progress.seconds : 0;
  // Rounded down: 100% means done.
  return fmt::format("{:3}%  elapsed {}  remaining {}  {} samples/s", static_cast<int>(fraction * 100),
                     formatClock(progress.seconds), formatClock(remaining), formatShort(rate));
}

void ProgressDisplay::show(const render::Progress& progress) {
  if (console_.isTerminal) {
    rewrite(progressText(progress));
    return;
  }
  const int step = static_cast<int>(std::clamp(progress.fraction, 0.0, 1.0) * plainSteps);
  if (step < nextStep_) return;
  nextStep_ = step + 1;
  console_.note(progressText(progress) + "\n");
}

void ProgressDisplay::rewrite(std::string text) {
  // The last column stays free: writing there moves some terminals on to the next line.
  text.resize(std::min(text.size(), static_cast<std::size_t>(std::max(console_.columns - 1, 1))));
  const std::size_t length = text.size();
  text.resize(std::max(length, written_), ' ');
  written_ = length;
  console_.note("\r" + text);
}

void ProgressDisplay::finish() {
  if (written_ > 0) console_.note("\n");
  written_ = 0;
}

}  // namespace aerosol::app
