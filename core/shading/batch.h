// Points gathered as structure of arrays, run through a kernel together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "core/shading/kernel_host.h"
#include "core/shading/moved_instances.h"
#include "core/shading/shading_point.h"
#include "core/shading/shading_system.h"

namespace aerosol::shading {

namespace detail {

struct FreeMemory {
  void operator()(void* p) const { std::free(p); }
};
template <class T>
using AlignedArray = std::unique_ptr<T[], FreeMemory>;

}  // namespace detail

/// A point of a volume with what its shader may read.
struct VolumePoint {
  Point<World> point;
  Vector<World> direction;  ///< Of the ray.
  float time = 0;           ///< Seconds of the scene's time.
};

/// How a point of a volume changes from pixel to pixel: dPdx, dPdy, dPdz, dIdx, dIdy.
using VolumeFootprint = std::array<float, 15>;

/// The points that wait for one kernel, in the kernel's own arrays: any number, taken off at the end. Only what the
/// kernel reads is kept.
class PointArrays {
 public:
  /// The family must outlive it.
  void bind(const Family& family, Variant variant);

  std::size_t size() const { return size_; }
  void push(const ShadingPoint& point, std::uint32_t instance) {
    const std::size_t at = next(instance);
    for (const Column& column : columns_) column.values[at] = point[column.component];
  }
  void push(const VolumePoint& point, std::uint32_t instance) {
    const std::array<float, 7> values{point.point.x,     point.point.y,     point.point.z, point.direction.x,
                                      point.direction.y, point.direction.z, point.time};
    const std::size_t at = next(instance);
    for (const Column& column : columns_) column.values[at] = column.ofVolume < 7 ? values[column.ofVolume] : 0.0f;
  }
  /// Whether the kernel of a volume reads how its points change from pixel to pixel.
  bool readsFootprints() const { return readsFootprints_; }
  void push(const VolumePoint& point, const VolumeFootprint& footprint, std::uint32_t instance) {
    push(point, instance);
    for (const Column& column : columns_)
      if (column.ofFootprint < footprint.size()) column.values[size_ - 1] = footprint[column.ofFootprint];
  }
  /// Drops all points from number `first` on.
  void shrink(std::size_t first) { size_ = first; }

 private:
  friend class Batch;

  struct Column {
    std::size_t component = 0;  ///< Of ShadingPoint.
    std::size_t ofVolume = 7;   ///< Of P, I, time; 7: always zero.
    std::size_t ofFootprint = std::tuple_size_v<VolumeFootprint>;
    float* values = nullptr;
  };

  std::size_t next(std::uint32_t instance) {
    if (size_ == capacity_) [[unlikely]]
      grow();
    instances_[size_] = static_cast<std::int32_t>(instance);
    return size_++;
  }
  void grow();

  const Family* family_ = nullptr;
  const jit::Kernel* kernel_ = nullptr;
  std::vector<Column> columns_;
  std::optional<std::size_t> timeColumn_;  ///< Where instances move.
  bool readsFootprints_ = false;
  std::size_t size_ = 0, capacity_ = 0;
  detail::AlignedArray<float> floats_;
  detail::AlignedArray<std::int32_t> instances_;
};

/// Runs kernels and holds their results; one for all kernels of a thread.
class Batch {
 public:
  explicit Batch(int capacity);

  int capacity() const { return capacity_; }

  /// Where a run must begin that takes at most a batch of the last points: kernels want whole vectors.
  std::size_t firstOfLast(const PointArrays& points) const;
  /// Runs the kernel on the points from number `first`, a multiple of 16, to the end.
  void run(KernelHost& host, const PointArrays& points, std::size_t first);

  /// Array number `output` of the kernel's interface.
  const float* output(std::size_t output) const { return static_cast<const float*>(outputPointers_[output]); }
  const jit::KernelInterface& interface() const { return kernel_->interface(); }
  const Family& family() const { return *family_; }

 private:
  int capacity_;
  std::size_t stride_;  ///< Floats from one array to the next.
  detail::AlignedArray<float> outputs_;
  std::size_t outputArrays_ = 0;
  std::array<const float*, jit::globalPointerCount> globalPointers_{};
  std::vector<void*> outputPointers_;
  const jit::Kernel* kernel_ = nullptr;
  const Family* family_ = nullptr;
  MovedInstances moved_;
};

}  // namespace aerosol::shading
