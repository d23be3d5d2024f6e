// The dear part of a program that only some of the points run.
#pragma once

#include <cstdint>
#include <optional>

#include "core/lang/program.h"
#include "core/lang/uniformity.h"

namespace aerosol::jit {

/// A part of a program that is run under a varying condition and costs most of the whole. Its points are worth being
/// collected: the kernel first runs the program without the part over all points, which settles those that do not come
/// to it, and then the whole over the others alone, packed into full lanes. No point's result depends on it.
struct DearPart {
  enum class Place : std::uint8_t { whenTrue, whenFalse, behind };

  const lang::Instruction* branch = nullptr;
  Place place{};  ///< A side of the branch, or what stands behind it and not all points come to.
};

/// The innermost such part; none where running the rest twice would cost more than a sixth, or would be noticed
/// (messages, reports).
std::optional<DearPart> findDearPart(const lang::Program& program, const lang::Uniformity& uniformity);

}  // namespace aerosol::jit
