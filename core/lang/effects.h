// What running a program does besides computing its results, and what it takes from its surroundings.
#pragma once

#include <array>

#include "core/lang/program.h"

namespace aerosol::lang {

struct Effects {
  bool messages = false;     ///< Leaves messages.
  bool impureCalls = false;  ///< Calls functions whose order or number matters.
  std::array<bool, globalCount> reads{};
  std::array<bool, globalCount> writes{};

  bool writesGlobals() const;
  /// Whether something can tell that, when, or how often the program was run.
  bool any() const { return messages || impureCalls || writesGlobals(); }
};

Effects findEffects(const Program& program);

}  // namespace aerosol::lang
