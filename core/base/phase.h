// What a thread is at, for whoever wants to know where the time goes.
//
// Reading a clock at every change would cost more than most of what is measured. Instead each thread keeps a mark, set
// by scopes, and another thread looks at it a thousand times a second: shares of the time, at the price of two stores.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace aerosol {

enum class Phase : std::uint8_t {
  paths,      ///< Everything else: trackers, scattering, the bookkeeping of paths.
  shaders,    ///< Compiled shaders.
  gathering,  ///< Questions into batches, and answers back to paths.
  tracing,    ///< Rays against surfaces and volume primitives.
  intervals,  ///< Spans to segments.
  lights,     ///< Choosing and sampling lights.
  film,       ///< Sums of samples.
};
inline constexpr std::size_t phaseCount = 7;

/// One thread's mark. Only that thread sets it; any other may read it.
class PhaseMark {
 public:
  PhaseMark() = default;
  PhaseMark(const PhaseMark&) {}
  PhaseMark& operator=(const PhaseMark&) { return *this; }

  void set(Phase phase) { phase_.store(phase, std::memory_order_relaxed); }
  Phase get() const { return phase_.load(std::memory_order_relaxed); }

 private:
  std::atomic<Phase> phase_{Phase::paths};
};

/// Marks a phase until its end; then the one before it goes on.
class PhaseScope {
 public:
  PhaseScope(PhaseMark& mark, Phase phase) : mark_(mark), before_(mark.get()) { mark.set(phase); }
  ~PhaseScope() { mark_.set(before_); }
  PhaseScope(const PhaseScope&) = delete;
  PhaseScope& operator=(const PhaseScope&) = delete;

 private:
  PhaseMark& mark_;
  Phase before_;
};

}  // namespace aerosol
