// Loops whose rounds are known from the program's text.
#pragma once

#include <optional>

#include "core/lang/program.h"

namespace aerosol::jit {

/// Rounds of `for (i = a; i < b; i += c)` in `code`, where a, b and c are constants, nothing else writes the counter,
/// and there are at most `most`; fewer where the body breaks off. None: not such a loop.
std::optional<unsigned> countedRounds(const lang::Program& program, const lang::Code& code,
                                      const lang::Instruction& loop, unsigned most);

/// Whether a loop in `code` is written out, so that what depends on the round is constant: an innermost one of few
/// known rounds, cheap in all. Never one that is not entered: the optimiser would count its rounds until the counter
/// wraps around.
bool isWrittenOut(const lang::Program& program, const lang::Code& code, const lang::Instruction& loop);

}  // namespace aerosol::jit
