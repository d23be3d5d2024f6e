// Runs programs point by point, from the meaning of their instructions alone: what kernels are compared with.
#pragma once

#include <cstdint>
#include <vector>

#include "core/lang/program.h"
#include "tests/unit/jit/kernel_runner.h"

namespace aerosol::jit::test {

/// The outputs of one point, component after component as bits (strings: hashes), and its records (lane 0).
struct PointOutcome {
  std::vector<std::uint64_t> outputs;
  std::vector<Record> records;
};

/// `values` are those of the parameters that the point's instance gives, by index; the others have their defaults.
/// Library functions: sqrt, floor, abs and the like, whose results are exact. No spaces.
PointOutcome interpret(const lang::Program& program, const Batch& batch, std::size_t point,
                       const std::vector<lang::ConstantValue>& values = {});

}  // namespace aerosol::jit::test
