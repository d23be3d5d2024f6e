// SIGINT and SIGTERM: the first ends the render, the second the process.
#pragma once

#include <atomic>
#include <csignal>
#include <thread>

#include "core/app/console.h"

namespace aerosol::app {

/// While it lives, the two signals are taken by a thread of its own; a signal that the process was started to ignore
/// stays ignored. Make it before any other thread, so that none of them is interrupted.
///
/// Before `startRendering` a signal ends the process with the code for an interruption: there is no picture to save.
/// Afterwards the first sets the stop flag, and the next ends the process as the signal does by default.
class InterruptWatch {
 public:
  explicit InterruptWatch(const Console& console);
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  void startRendering() { isRendering_ = true; }
  const std::atomic<bool>& stopFlag() const { return stop_; }

 private:
  void watch();
  void take(int signal);

  Console console_;
  sigset_t watched_{};
  sigset_t before_{};
  int signals_ = -1;  ///< File descriptors: where signals come out, and the end of the watch.
  int end_ = -1;
  std::atomic<bool> isRendering_{false};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace aerosol::app
