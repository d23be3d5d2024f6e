// Guaranteed bounds of a volume shader's coefficients over boxes, from the shader itself: its program run over ranges.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/shading/kernel_host.h"
#include "core/shading/shading_system.h"

namespace aerosol::shading {

/// Points of a volume: those whose exact place in the instance's object space lies in the box, at any time of the
/// interval, seen from any direction. (Points that are computed along a ray may be rounded out of a box: it is for the
/// caller to make boxes larger by the rounding of its own points.)
struct VolumeBox {
  Box<Object> box;
  float timeLow = 0;  ///< Seconds within the shutter.
  float timeHigh = 0;
};

/// All that a quantity may be, unless it is NaN; ends may be infinite.
struct Bound {
  float low = 0;
  float high = 0;

  /// Are all values within `tolerance` times the largest magnitude of each other?
  bool isUniform(float tolerance) const;
};

/// Bounds of what a volume shader returns, each channel by itself. They hold for what the shader's kernels compute, to
/// the last bit, at any width.
struct CoefficientBounds {
  std::array<Bound, 3> sigmaT;
  std::array<Bound, 3> sigmaS;
  std::array<Bound, 3> emission;
  struct Lobe {
    std::array<Bound, 3> sigmaS;
    Bound anisotropy;
  };
  std::array<Lobe, lang::maximumLobes> lobes;
  std::uint32_t lobeCount = 0;
  bool mayBeNan = false;  ///< Some coefficient may be NaN at some point.

  /// Of the largest channel, as it is rendered: negative and undefined extinction count as 0.
  Bound extinction() const;
  /// Surely no extinction and no emission anywhere.
  bool isEmpty() const;
  /// Surely the same everywhere, up to `tolerance` times each value: a noise of weight 0 (or so small a weight) counts
  /// as none. Any one point then stands for the box.
  bool isUniform(float tolerance) const;
};

/// Bounds of a velocity, each coordinate by itself.
struct VelocityBounds {
  std::array<Bound, 3> velocity;
  bool mayBeNan = false;
};

/// Largest relative difference that no image shows and that rounding alone may cause in a constant.
inline constexpr float uniformTolerance = 1e-5f;

/// Arrays to run a family's bounds kernel with; one per thread.
class BoundsBatch {
 public:
  /// At most `capacity` boxes a run of the kernel; a multiple of 16 wastes nothing.
  explicit BoundsBatch(int capacity = 256);
  ~BoundsBatch();
  BoundsBatch(const BoundsBatch&) = delete;
  BoundsBatch& operator=(const BoundsBatch&) = delete;

  /// From now on bounds hold for points that change from pixel to pixel by up to so much (scene units, and a turn of
  /// the ray by up to 1 radian), in any direction; 0: that do not change.
  void allowFootprints(float largest) { largestFootprint_ = largest; }

  /// Bounds of instance number `instance` of the family over each box, of which there may be any number. The family
  /// must have a bounds kernel (ShadingSystem::compileBounds). Boxes that are empty give bounds that mean nothing.
  void evaluate(KernelHost& host, const Family& family, std::uint32_t instance, std::span<const VolumeBox> boxes,
                std::span<CoefficientBounds> bounds);
  /// The same of the velocity, where the family has such a kernel.
  void evaluateVelocity(KernelHost& host, const Family& family, std::uint32_t instance,
                        std::span<const VolumeBox> boxes, std::span<VelocityBounds> bounds);

 private:
  struct Arrays;
  /// Runs the kernel on part after part of the boxes; `scatter(first, count)` takes the results.
  template <class Scatter>
  void run(KernelHost& host, const Family& family, const jit::Kernel& kernel, std::uint32_t instance,
           std::span<const VolumeBox> boxes, Scatter scatter);
  void gather(const Instance& placed, std::span<const VolumeBox> boxes);
  void gatherFootprints(std::size_t boxes);
  void gatherLine(const Matrix4& toWorld, const Box<Object>& box, std::size_t at);
  void scatter(const jit::KernelInterface& interface, std::span<CoefficientBounds> bounds) const;

  std::size_t capacity_;
  float largestFootprint_ = 0;
  std::unique_ptr<Arrays> arrays_;
};

}  // namespace aerosol::shading
