// Blocks of instances that move, one a point: the instance as it stands at the point's time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/lang/program.h"

namespace aerosol::shading {

struct Family;

/// Kernels find the matrices of an instance in its block. Where an instance moves each point gets a block of its own,
/// so kernels need not know of motion.
class MovedInstances {
 public:
  /// `stride` bytes a block; instances and times by point. `padded` at least as many as points: what kernels read.
  void place(const Family& family, std::size_t stride, std::span<const std::int32_t> instances,
             std::span<const float> times, std::size_t padded);

  const unsigned char* blocks() const { return blocks_.data(); }
  /// The number of each point's block.
  const std::int32_t* numbers() const { return numbers_.data()->data(); }

 private:
  std::vector<unsigned char> blocks_;
  /// Kernels load whole vectors.
  struct alignas(64) Line : std::array<std::int32_t, 16> {};
  std::vector<Line> numbers_;
};

/// Whether a shader uses the place of its object for anything but P in object space. Ranges over a box of the object
/// then hold for one place alone.
bool usesPlaceBeyondP(const lang::Program& program);

}  // namespace aerosol::shading
