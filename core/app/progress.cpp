#include "core/app/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/app/quantity.h"

namespace aerosol::app {

namespace {

/// The largest of 50%, 20%, 10%, 5% … that is clearly smaller.
double nextError(double error) {
  double decade = 1;
  while (decade > error / 10) decade /= 10;
  for (const double digit : {50.0, 20.0, 10.0, 5.0, 2.0}) {
    if (digit * decade < 0.8 * error) return digit * decade;
  }
  return decade;
}

std::string errorText(const render::Progress& progress, double remaining, double target) {
  if (!(progress.error > 0)) return {};
  std::string text = fmt::format("  error {}", formatError(progress.error));
  const double goal = target > 0 ? target : nextError(progress.error);
  const double done = progress.fraction - progress.before;
  if (!(done > 0) || goal >= progress.error) return text;
  // The error falls with the square root of the samples.
  const double soFar = progress.seconds * progress.fraction / done;
  const double wait = soFar * (progress.error * progress.error / (goal * goal) - 1);
  if (target > 0 || wait < remaining) text += fmt::format(", {} in about {}", formatError(goal), formatClock(wait));
  return text;
}

}  // namespace

std::string progressText(const render::Progress& progress, double target) {
  const double fraction = std::clamp(progress.fraction, 0.0, 1.0);
  const double remaining = fraction > progress.before ? progress.seconds * (1 - fraction) / (fraction - progress.before)
                                                      : std::numeric_limits<double>::infinity();
  const double rate = progress.seconds > 0 ? static_cast<double>(progress.samples) / progress.seconds : 0;
  // Rounded down: 100% means done.
  return fmt::format("{:3}%  elapsed {}  remaining {}  {} samples/s{}", static_cast<int>(fraction * 100),
                     formatClock(progress.seconds), formatClock(remaining), formatShort(rate),
                     errorText(progress, remaining, target));
}

void ProgressDisplay::show(const render::Progress& progress) {
  if (console_.isTerminal) {
    rewrite(progressText(progress, target_));
    return;
  }
  const int step = static_cast<int>(std::clamp(progress.fraction, 0.0, 1.0) * plainSteps);
  if (step < nextStep_) return;
  nextStep_ = step + 1;
  console_.note(progressText(progress, target_) + "\n");
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
