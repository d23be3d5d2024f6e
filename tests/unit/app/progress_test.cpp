#include "core/app/progress.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "core/app/quantity.h"

namespace aerosol::app {
namespace {

/// What is written to a stream.
class Captured {
 public:
  Captured() : stream_(open_memstream(&text_, &size_)) {}
  ~Captured() {
    std::fclose(stream_);
    std::free(text_);
  }
  Captured(const Captured&) = delete;
  Captured& operator=(const Captured&) = delete;

  std::FILE* stream() { return stream_; }
  std::string text() {
    std::fflush(stream_);
    return {text_, size_};
  }

 private:
  char* text_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* stream_;
};

TEST(Progress, TellsShareTimesAndRate) {
  EXPECT_EQ(progressText({0.25, 30, 1'500'000}), " 25%  elapsed 0:30  remaining 1:30  50.0 k samples/s");
  EXPECT_EQ(progressText({1, 3600, 7'200'000'000}), "100%  elapsed 1:00:00  remaining 0:00  2.00 M samples/s");
}

TEST(Progress, TellsTheErrorAndWhenItWillBeSmaller) {
  // A quarter after 30 s: an error of 1.8% is 1.0% after 3.24 times the work.
  const std::string text = progressText({0.25, 30, 1'500'000, 0, 0.018});
  EXPECT_NE(text.find("samples/s  error 1.8%, 1.0% in about 1:07"), std::string::npos) << text;
  const std::string late = progressText({0.9, 30, 1'500'000, 0, 0.018});
  EXPECT_EQ(late.substr(late.find("  error")), "  error 1.8%") << "it will not be reached";
  const std::string target = progressText({0.25, 30, 1'500'000, 0, 0.018}, 0.009);
  EXPECT_NE(target.find("error 1.8%, 0.90% in about 1:30"), std::string::npos) << target;
}

TEST(Progress, KnowsNothingBeforeTheFirstSample) {
  EXPECT_EQ(progressText({0, 0, 0}), "  0%  elapsed 0:00  remaining -:--  0 samples/s");
}

TEST(Progress, IsDoneOnlyWhenAllIsDone) { EXPECT_EQ(progressText({0.99999, 1, 1}).substr(0, 4), " 99%"); }

TEST(Progress, WritesALineEveryTenthWithoutATerminal) {
  Captured captured;
  ProgressDisplay display({.err = captured.stream()});
  for (int i = 0; i <= 1000; ++i) display.show({i / 1000.0, i * 1.0, static_cast<std::uint64_t>(i)});
  display.finish();
  const std::string text = captured.text();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_EQ(text.find('\r'), std::string::npos);
  EXPECT_TRUE(text.starts_with(" 10%  elapsed 1:40")) << text;
  EXPECT_NE(text.find("\n100%"), std::string::npos);
}

TEST(Progress, WritesOneLineForStepsTakenTogether) {
  Captured captured;
  ProgressDisplay display({.err = captured.stream()});
  display.show({0.05, 1, 1});
  EXPECT_EQ(captured.text(), "");
  display.show({0.55, 2, 1});
  display.show({0.59, 3, 1});
  EXPECT_EQ(captured.text(), progressText({0.55, 2, 1}) + "\n");
}

TEST(Progress, RewritesOneLineOnATerminal) {
  Captured captured;
  ProgressDisplay display({.err = captured.stream(), .isTerminal = true, .columns = 80});
  const render::Progress slow{0.5, 3600, 100}, quick{0.6, 60, 100};
  display.show(slow);
  display.show(quick);
  display.finish();
  const std::string first = progressText(slow), second = progressText(quick);
  ASSERT_GT(first.size(), second.size());
  EXPECT_EQ(captured.text(), "\r" + first + "\r" + second + std::string(first.size() - second.size(), ' ') + "\n");
}

TEST(Progress, StaysWithinTheTerminal) {
  Captured captured;
  ProgressDisplay display({.err = captured.stream(), .isTerminal = true, .columns = 20});
  display.show({0.5, 3600, 100});
  EXPECT_EQ(captured.text().size(), 1u + 19u);
}

TEST(Quantity, Clocks) {
  EXPECT_EQ(formatClock(0), "0:00");
  EXPECT_EQ(formatClock(59.9), "0:59");
  EXPECT_EQ(formatClock(61), "1:01");
  EXPECT_EQ(formatClock(3 * 3600 + 4 * 60 + 5), "3:04:05");
  EXPECT_EQ(formatClock(-1), "-:--");
  EXPECT_EQ(formatClock(1e300), "-:--");
}

TEST(Quantity, Durations) {
  EXPECT_EQ(formatDuration(0.00042), "0.4 ms");
  EXPECT_EQ(formatDuration(0.412), "412 ms");
  EXPECT_EQ(formatDuration(9.34), "9.3 s");
  EXPECT_EQ(formatDuration(90), "1:30");
}

TEST(Quantity, Counts) {
  EXPECT_EQ(formatCount(0), "0");
  EXPECT_EQ(formatCount(999), "999");
  EXPECT_EQ(formatCount(1000), "1,000");
  EXPECT_EQ(formatCount(1234567890), "1,234,567,890");
  EXPECT_EQ(formatCount(1, "point"), "1 point");
  EXPECT_EQ(formatCount(2000, "point"), "2,000 points");
  EXPECT_EQ(formatShort(950), "950");
  EXPECT_EQ(formatShort(999.7), "1.00 k");
  EXPECT_EQ(formatShort(45'600'000), "45.6 M");
  EXPECT_EQ(formatMean(20000), "20,000");
  EXPECT_EQ(formatMean(15.83), "15.8");
  EXPECT_EQ(formatPercent(1, 3), "33.3 %");
  EXPECT_EQ(formatPercent(0, 0), "-");
}

}  // namespace
}  // namespace aerosol::app
