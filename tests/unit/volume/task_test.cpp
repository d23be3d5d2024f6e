#include "core/volume/task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace aerosol::volume {
namespace {

using ::testing::ElementsAre;

/// A context whose `pause` suspends the innermost coroutine until `resume`.
class TestContext {
 public:
  explicit TestContext(std::size_t capacity = 1u << 16) : frames_(capacity) {}

  FrameStack& frames() { return frames_; }
  std::vector<std::string>& log() { return log_; }

  auto pause() {
    struct Awaiter {
      TestContext& context;
      bool await_ready() const { return false; }
      void await_suspend(std::coroutine_handle<> handle) const { context.waiting_ = handle; }
      void await_resume() const {}
    };
    return Awaiter{*this};
  }
  bool isWaiting() const { return waiting_ != nullptr; }
  void resume() { std::exchange(waiting_, nullptr).resume(); }

 private:
  FrameStack frames_;
  std::vector<std::string> log_;
  std::coroutine_handle<> waiting_;
};

/// Says when it is made and when it goes.
class Tracer {
 public:
  Tracer(TestContext& context, std::string name) : context_(context), name_(std::move(name)) {
    context_.log().push_back("+" + name_);
  }
  ~Tracer() { context_.log().push_back("-" + name_); }
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

 private:
  TestContext& context_;
  std::string name_;
};

Task<int> constant(TestContext&, int value) { co_return value; }

Task<std::int64_t> sum(TestContext& context, int count) {
  std::int64_t total = 0;
  for (int i = 0; i < count; ++i) total += co_await constant(context, i);
  co_return total;
}

TEST(TaskTest, ReturnsTheSumOfWhatItAwaits) {
  TestContext context;
  Task<std::int64_t> task = sum(context, 3);
  EXPECT_FALSE(task.isDone());
  task.start();
  EXPECT_TRUE(task.isDone());
  EXPECT_EQ(task.take(), 3);
}

Task<std::unique_ptr<int>> boxed(TestContext&, int value) { co_return std::make_unique<int>(value); }

Task<std::string> text(TestContext& context) {
  const std::unique_ptr<int> value = co_await boxed(context, 42);
  co_return std::to_string(*value) + " and enough characters not to fit a short string";
}

TEST(TaskTest, MovesValuesOut) {
  TestContext context;
  {
    Task<std::string> task = text(context);
    task.start();
    ASSERT_TRUE(task.isDone());
    EXPECT_EQ(task.take(), "42 and enough characters not to fit a short string");
  }
  EXPECT_TRUE(context.frames().isEmpty());
}

Task<> leaf(TestContext& context) {
  const Tracer tracer(context, "leaf");
  co_await context.pause();
  context.log().emplace_back("resumed");
}

Task<> middle(TestContext& context) {
  const Tracer tracer(context, "middle");
  co_await leaf(context);
  context.log().emplace_back("middle goes on");
  co_await leaf(context);
}

Task<int> root(TestContext& context) {
  const Tracer tracer(context, "root");
  co_await middle(context);
  co_return 7;
}

TEST(TaskTest, SuspendsAndResumesAWholeChain) {
  TestContext context;
  {
    Task<int> task = root(context);
    task.start();
    EXPECT_TRUE(context.isWaiting());
    EXPECT_FALSE(task.isDone());
    context.resume();
    EXPECT_TRUE(context.isWaiting());
    context.resume();
    EXPECT_FALSE(context.isWaiting());
    ASSERT_TRUE(task.isDone());
    EXPECT_EQ(task.take(), 7);
  }
  EXPECT_THAT(context.log(), ElementsAre("+root", "+middle", "+leaf", "resumed", "-leaf", "middle goes on", "+leaf",
                                         "resumed", "-leaf", "-middle", "-root"));
  EXPECT_TRUE(context.frames().isEmpty());
}

TEST(TaskTest, DestroyingASuspendedChainFreesInnermostFirst) {
  TestContext context;
  {
    Task<int> task = root(context);
    task.start();
    EXPECT_TRUE(context.isWaiting());
  }
  EXPECT_THAT(context.log(), ElementsAre("+root", "+middle", "+leaf", "-leaf", "-middle", "-root"));
  EXPECT_TRUE(context.frames().isEmpty());
}

TEST(TaskTest, DestroyingATaskThatNeverRanFreesItsFrame) {
  TestContext context;
  {
    const Task<int> task = root(context);
    EXPECT_FALSE(task.isDone());
  }
  EXPECT_TRUE(context.log().empty()) << "a task runs only when started";
  EXPECT_TRUE(context.frames().isEmpty());
}

TEST(TaskTest, AssignmentDestroysWhatWasThere) {
  TestContext context, other;
  Task<int> task = root(context);
  task.start();
  task = constant(other, 3);
  EXPECT_TRUE(context.frames().isEmpty());
  task.start();
  EXPECT_EQ(task.take(), 3);
}

struct alignas(64) Wide {
  float lanes[16] = {};
};

Task<std::uintptr_t> placeOfAlignedLocal(TestContext& context) {
  Wide wide;
  co_await context.pause();
  wide.lanes[0] += 1;
  co_return reinterpret_cast<std::uintptr_t>(&wide);
}

TEST(TaskTest, LocalsOf64BytesAreAligned) {
  TestContext context;
  Task<std::uintptr_t> task = placeOfAlignedLocal(context);
  task.start();
  context.resume();
  EXPECT_EQ(task.take() % 64, 0u);
}

TEST(TaskTest, AMillionAwaitsNeedNoStack) {
  TestContext context;
  Task<std::int64_t> task = sum(context, 1000000);
  task.start();
  ASSERT_TRUE(task.isDone());
  EXPECT_EQ(task.take(), 499999500000);
  EXPECT_EQ(context.frames().heapBlocks(), 0u);
}

Task<int> depth(TestContext& context, int levels) {
  if (levels == 0) {
    co_await context.pause();
    co_return 0;
  }
  co_return 1 + co_await depth(context, levels - 1);
}

TEST(TaskTest, ADeepChainOverflowsToTheHeapAndIsFreed) {
  TestContext context(4096);
  {
    Task<int> task = depth(context, 20000);
    task.start();
    context.resume();
    ASSERT_TRUE(task.isDone());
    EXPECT_EQ(task.take(), 20000);
    EXPECT_GT(context.frames().heapBlocks(), 19000u);
  }
  EXPECT_TRUE(context.frames().isEmpty());
}

TEST(TaskTest, ADeepSuspendedChainIsDestroyed) {
  TestContext context(4096);
  {
    Task<int> task = depth(context, 1000);
    task.start();
    EXPECT_TRUE(context.isWaiting());
  }
  EXPECT_TRUE(context.frames().isEmpty());
}

}  // namespace
}  // namespace aerosol::volume
