// Programs made of dice: every kind of control flow, nested, over ints, floats, triples and arrays.
#pragma once

#include <cstdint>
#include <memory>

#include "core/lang/program.h"

namespace aerosol::jit::test {

struct RandomProgramOptions {
  int statements = 12;
  int depth = 4;
  bool messages = true;
  bool arrays = true;
  bool integers = true;  ///< Bit operations, divisions and conversions of ints.
};

std::shared_ptr<const lang::Program> randomProgram(std::uint64_t seed, const RandomProgramOptions& options = {});

}  // namespace aerosol::jit::test
