// Trackers without shaders and without a scheduler: a function stands for the density.
#pragma once

#include <coroutine>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/volume/medium.h"
#include "core/volume/task.h"

namespace aerosol::test {

/// Fulfils volume::Evaluator with a function of medium and place. Answers are there at once, or after a real suspension
/// that `finish` ends.
class DensityEvaluator {
 public:
  using Density = std::function<volume::Coefficients(const volume::Medium&, Point<World>)>;

  explicit DensityEvaluator(Density density, bool suspends = false)
      : density_(std::move(density)), suspends_(suspends), frames_(8192) {}

  volume::FrameStack& frames() { return frames_; }
  volume::TrackerStatistics& trackerStatistics() { return statistics_; }

  void ask(const volume::Medium& medium, Point<World> point, volume::Quantity quantity) {
    if (wereRead_) answers_.clear();
    wereRead_ = false;
    volume::Coefficients answer = density_(medium, point);
    if (quantity == volume::Quantity::extinction) onlyExtinction(answer);
    answers_.push_back(answer);
    ++asked_;
    if (recorded_) recorded_->push_back({point, answer, medium.index});
  }

  auto answers() {
    struct Awaiter {
      DensityEvaluator& evaluator;
      bool await_ready() const { return !evaluator.suspends_; }
      void await_suspend(std::coroutine_handle<> handle) const { evaluator.waiting_ = handle; }
      std::span<const volume::Coefficients> await_resume() const {
        evaluator.wereRead_ = true;
        return evaluator.answers_;
      }
    };
    return Awaiter{*this};
  }

  /// Runs a task to its end.
  template <class T>
  T finish(volume::Task<T> task) {
    task.start();
    while (!task.isDone()) std::exchange(waiting_, nullptr).resume();
    return task.take();
  }

  std::uint64_t asked() const { return asked_; }

  struct Question {
    Point<World> point;
    volume::Coefficients answer;
    std::uint32_t medium = 0;  ///< Its index.
  };
  /// Collects what is asked from now on; null ends it.
  void recordInto(std::vector<Question>* questions) { recorded_ = questions; }

 private:
  /// The contract of Quantity::extinction: nothing else is set, so nothing else may be read.
  static void onlyExtinction(volume::Coefficients& c) {
    const Color unset(std::numeric_limits<float>::quiet_NaN());
    c.sigmaS = c.emission = unset;
    for (volume::Lobe& lobe : c.lobes) lobe = {unset, unset.r};
  }

  Density density_;
  bool suspends_;
  volume::FrameStack frames_;
  volume::TrackerStatistics statistics_;
  std::vector<volume::Coefficients> answers_;
  std::vector<Question>* recorded_ = nullptr;
  std::coroutine_handle<> waiting_;
  std::uint64_t asked_ = 0;
  bool wereRead_ = false;
};

}  // namespace aerosol::test
