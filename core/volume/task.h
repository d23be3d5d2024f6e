// A coroutine that computes one value: awaited exactly once, at once, by another coroutine or by a scheduler.
#pragma once

#include <cassert>
#include <coroutine>
#include <exception>
#include <new>
#include <optional>
#include <utility>

#include "core/volume/frame_stack.h"

namespace aerosol::volume {

namespace detail {

/// Frames come from the stack of the coroutine's first parameter. Both forms of `operator new` are aligned: without
/// `-fcoro-aligned-allocation` a frame with 64-byte members would be placed at 16 bytes.
struct FramePlacement {
  template <HasFrames First, class... Rest>
  static void* operator new(std::size_t size, std::align_val_t, First& first, Rest&&...) {
    return first.frames().allocate(size);
  }
  template <HasFrames First, class... Rest>
  static void* operator new(std::size_t size, First& first, Rest&&...) {
    return first.frames().allocate(size);
  }
  static void operator delete(void* frame, std::size_t, std::align_val_t) { FrameStack::free(frame); }
  static void operator delete(void* frame, std::size_t) { FrameStack::free(frame); }
};

struct ResumeContinuation {
  bool await_ready() const noexcept { return false; }
  template <class Promise>
  std::coroutine_handle<> await_suspend(std::coroutine_handle<Promise> finished) const noexcept {
    const std::coroutine_handle<> next = finished.promise().continuation;
    return next ? next : std::noop_coroutine();
  }
  void await_resume() const noexcept {}
};

template <class T>
struct TaskPromise : FramePlacement {
  std::coroutine_handle<> continuation;
  std::optional<T> value;

  auto get_return_object() { return std::coroutine_handle<TaskPromise>::from_promise(*this); }
  std::suspend_always initial_suspend() const noexcept { return {}; }
  ResumeContinuation final_suspend() const noexcept { return {}; }
  void unhandled_exception() const noexcept { std::terminate(); }
  template <class U>
  void return_value(U&& result) {
    value.emplace(std::forward<U>(result));
  }
};

template <>
struct TaskPromise<void> : FramePlacement {
  std::coroutine_handle<> continuation;

  auto get_return_object() { return std::coroutine_handle<TaskPromise>::from_promise(*this); }
  std::suspend_always initial_suspend() const noexcept { return {}; }
  ResumeContinuation final_suspend() const noexcept { return {}; }
  void unhandled_exception() const noexcept { std::terminate(); }
  void return_void() const noexcept {}
};

}  // namespace detail

/// Lazily started: runs when awaited (`co_await f(context)`) or when a scheduler calls `start`.
template <class T = void>
class [[nodiscard]] Task {
 public:
  using promise_type = detail::TaskPromise<T>;
  using Handle = std::coroutine_handle<promise_type>;

  Task(Handle handle) : handle_(handle) {}
  Task(Task&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Task& operator=(Task&& other) noexcept {
    if (this != &other) {
      if (handle_) handle_.destroy();
      handle_ = std::exchange(other.handle_, nullptr);
    }
    return *this;
  }
  ~Task() {
    if (handle_) handle_.destroy();
  }

  bool await_ready() const noexcept { return false; }
  std::coroutine_handle<> await_suspend(std::coroutine_handle<> awaiting) noexcept {
    handle_.promise().continuation = awaiting;
    return handle_;
  }
  T await_resume() {
    if constexpr (!std::is_void_v<T>) return std::move(*handle_.promise().value);
  }

  /// Runs up to the first suspension, or to the end.
  void start() { handle_.resume(); }
  bool isDone() const { return handle_.done(); }
  /// The value of a finished task.
  T take() {
    assert(isDone());
    return await_resume();
  }

 private:
  Handle handle_;
};

}  // namespace aerosol::volume
