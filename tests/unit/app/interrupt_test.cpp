#include "core/app/interrupt.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

namespace aerosol::app {
namespace {

using namespace std::chrono_literals;

/// In a process of its own: `body` may send it signals.
class Interrupt : public testing::Test {
 protected:
  Interrupt() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }

  static bool isStopped(const InterruptWatch& watch) {
    for (int i = 0; i < 1000 && !watch.stopFlag(); ++i) std::this_thread::sleep_for(5ms);
    return watch.stopFlag();
  }
};

TEST_F(Interrupt, SetsTheFlagOfARender) {
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EXIT(
        {
          InterruptWatch watch(Console{});
          watch.startRendering();
          if (watch.stopFlag()) _exit(1);
          kill(getpid(), signal);
          _exit(isStopped(watch) ? 42 : 2);
        },
        testing::ExitedWithCode(42), "interrupted, writing what there is");
  }
}

TEST_F(Interrupt, KillsTheSecondTime) {
  EXPECT_EXIT(
      {
        InterruptWatch watch(Console{});
        watch.startRendering();
        kill(getpid(), SIGTERM);
        if (!isStopped(watch)) _exit(2);
        kill(getpid(), SIGTERM);
        std::this_thread::sleep_for(10s);
        _exit(1);
      },
      testing::KilledBySignal(SIGTERM), "");
}

TEST_F(Interrupt, EndsTheProcessBeforeTheRender) {
  EXPECT_EXIT(
      {
        InterruptWatch watch(Console{});
        kill(getpid(), SIGINT);
        std::this_thread::sleep_for(10s);
        _exit(1);
      },
      testing::ExitedWithCode(3), "interrupted before there was a picture");
}

TEST_F(Interrupt, LeavesIgnoredSignalsIgnored) {
  EXPECT_EXIT(
      {
        std::signal(SIGINT, SIG_IGN);
        InterruptWatch watch(Console{});
        kill(getpid(), SIGINT);
        std::this_thread::sleep_for(100ms);
        _exit(watch.stopFlag() ? 1 : 42);
      },
      testing::ExitedWithCode(42), "^$");
}

TEST_F(Interrupt, GivesTheSignalsBackInTheEnd) {
  EXPECT_EXIT(
      {
        {
          const InterruptWatch watch(Console{});
        }
        kill(getpid(), SIGTERM);
        std::this_thread::sleep_for(10s);
        _exit(1);
      },
      testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace aerosol::app
