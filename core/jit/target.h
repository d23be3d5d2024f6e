// What kernels are compiled for: a number of lanes and an instruction set.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/result.h"

namespace aerosol::jit {

/// Instruction set levels. All give the same bits; they differ in speed alone.
enum class Isa : std::uint8_t {
  x86_64_v3,  ///< AVX2 and FMA; native width 8
  x86_64_v4,  ///< AVX-512 F, BW, CD, DQ, VL; native width 16
};

/// "x86-64-v3" or "x86-64-v4".
std::string_view name(Isa isa);

struct Target {
  int width = 8;  ///< Lanes: 16, 8, 4 or 1.
  Isa isa = Isa::x86_64_v3;

  bool operator==(const Target&) const = default;
};

/// The best level that this processor and operating system have; empty below x86-64-v3.
std::optional<Isa> hostIsa();

/// The target for this host. Either part may be forced: a width of 16, 8, 4 or 1, and an instruction set by its name or
/// as "avx2" or "avx512". An error names the valid choices, or says what the host lacks.
Result<Target> chooseTarget(std::optional<int> width = {}, std::optional<std::string_view> isa = {});

}  // namespace aerosol::jit
