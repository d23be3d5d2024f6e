#include "core/app/interrupt.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

#include "core/app/exit_code.h"

namespace aerosol::app {

InterruptWatch::InterruptWatch(const Console& console) : console_(console) {
  sigemptyset(&watched_);
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction action{};
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) sigaddset(&watched_, signal);
  }
  pthread_sigmask(SIG_BLOCK, &watched_, &before_);
  signals_ = signalfd(-1, &watched_, SFD_CLOEXEC);
  end_ = eventfd(0, EFD_CLOEXEC);
  if (signals_ >= 0 && end_ >= 0) {
    thread_ = std::thread([this] { watch(); });
  } else {
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
}

InterruptWatch::~InterruptWatch() {
  if (thread_.joinable()) {
    eventfd_write(end_, 1);
    thread_.join();
  }
  if (signals_ >= 0) close(signals_);
  if (end_ >= 0) close(end_);
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void InterruptWatch::watch() {
  for (;;) {
    pollfd files[] = {{signals_, POLLIN, 0}, {end_, POLLIN, 0}};
    if (poll(files, 2, -1) < 0 && errno != EINTR) return;
    if (files[1].revents != 0) return;
    signalfd_siginfo info{};
    if (files[0].revents != 0 && read(signals_, &info, sizeof info) == sizeof info) {
      take(static_cast<int>(info.ssi_signo));
    }
  }
}

void InterruptWatch::take(int signal) {
  if (!isRendering_) {
    console_.note("aerosol: interrupted before there was a picture\n");
    _exit(static_cast<int>(ExitCode::interrupted));
  }
  if (!stop_.exchange(true)) {
    console_.note("\naerosol: interrupted, writing what there is; once more to end at once\n");
    return;
  }
  std::signal(signal, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &watched_, nullptr);
  raise(signal);
}

}  // namespace aerosol::app
