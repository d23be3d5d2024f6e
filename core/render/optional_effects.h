// The effects that a build may leave out, and the one switch for all of them.
//
// The ordinary build knows them all, and preparation decides which of them a scene calls for. A build with
// AEROSOL_LEAN (preset `lean`) knows none: the decisions below are constants there, so that compilers drop the code
// behind them, and scenes that need one are refused. It is there to be compared with: what an effect costs that a scene
// does not use is the difference between the two (tests/bench/lean_counts.sh).
#pragma once

#include <string>
#include <vector>

namespace aerosol::render {

#ifdef AEROSOL_LEAN
inline constexpr bool hasOptionalEffects = false;
#else
inline constexpr bool hasOptionalEffects = true;
#endif

/// What preparation decided about an effect.
class EffectSwitch {
 public:
  constexpr EffectSwitch() = default;
  // Reads and is set like a bool.
  constexpr EffectSwitch(bool isOn) : isOn_(isOn) {}
  constexpr operator bool() const { return hasOptionalEffects && isOn_; }
  /// Also in a build that leaves the effect out.
  constexpr bool isCalledFor() const { return isOn_; }

 private:
  bool isOn_ = false;
};

/// Something that is there where an effect is on: null elsewhere.
template <class T>
class EffectPointer {
 public:
  constexpr EffectPointer& operator=(T* pointer) {
    pointer_ = pointer;
    return *this;
  }
  constexpr operator T*() const { return hasOptionalEffects ? pointer_ : nullptr; }
  constexpr T* operator->() const { return pointer_; }
  constexpr T& operator*() const { return *pointer_; }

 private:
  T* pointer_ = nullptr;
};

struct PreparedScene;

/// The optional effects that the scene calls for, by the names of the plan.
std::vector<std::string> optionalEffectsOf(const PreparedScene& scene);

}  // namespace aerosol::render
