#include "core/shading/batch.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <new>

namespace aerosol::shading {

namespace {

constexpr std::size_t alignment = 64;
constexpr std::size_t lanes = AEROSOL_MAXIMUM_WIDTH;

/// Padding lanes hold finite values: zero, or what an earlier point left.
template <class T>
detail::AlignedArray<T> allocateZeroed(std::size_t count) {
  const std::size_t rounded = (count * sizeof(T) + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, std::max(rounded, alignment));
  if (!memory) throw std::bad_alloc();
  std::memset(memory, 0, rounded);
  return detail::AlignedArray<T>(static_cast<T*>(memory));
}

/// Kernels touch one cache line of many arrays in turn; an odd number of lines between them spreads those over the
/// sets.
std::size_t oddStride(std::size_t count) {
  const std::size_t stride = (count + lanes - 1) / lanes * lanes;
  return stride / lanes % 2 == 0 ? stride + lanes : stride;
}

/// Index in VolumePoint of a component of ShadingPoint; 7: none.
std::size_t volumeComponent(int component) {
  using lang::Global;
  const int point = jit::globalPointer(Global::P), direction = jit::globalPointer(Global::I);
  if (component >= point && component < point + 3) return static_cast<std::size_t>(component - point);
  if (component >= direction && component < direction + 3) return static_cast<std::size_t>(component - direction + 3);
  return component == jit::globalPointer(Global::time) ? 6 : 7;
}

/// Index in VolumeFootprint of a component of ShadingPoint; its size: none.
std::size_t footprintComponent(int component) {
  using lang::Global;
  std::size_t first = 0;
  for (const Global global : {Global::dPdx, Global::dPdy, Global::dPdz, Global::dIdx, Global::dIdy}) {
    const int pointer = jit::globalPointer(global);
    if (component >= pointer && component < pointer + 3) return first + static_cast<std::size_t>(component - pointer);
    first += 3;
  }
  return first;
}

}  // namespace

void PointArrays::bind(const Family& family, Variant variant) {
  family_ = &family;
  kernel_ = &family.kernel(variant);
  columns_.clear();
  timeColumn_.reset();
  readsFootprints_ = false;
  for (int i = 0; i < jit::globalPointerCount; ++i) {
    if (kernel_->interface().globalsRead >> i & 1u) {
      columns_.push_back({static_cast<std::size_t>(i), volumeComponent(i), footprintComponent(i), nullptr});
      readsFootprints_ = readsFootprints_ || columns_.back().ofFootprint < std::tuple_size_v<VolumeFootprint>;
    }
  }
  size_ = capacity_ = 0;
  if (!family.moves()) return;
  const auto time = static_cast<std::size_t>(jit::globalPointer(lang::Global::time));
  const auto isTime = [time](const Column& column) { return column.component == time; };
  if (std::ranges::none_of(columns_, isTime)) columns_.push_back({.component = time, .ofVolume = 6});
  timeColumn_ = static_cast<std::size_t>(std::ranges::find_if(columns_, isTime) - columns_.begin());
}

void PointArrays::grow() {
  const std::size_t capacity = std::max<std::size_t>(2 * capacity_, 256);
  const std::size_t stride = oddStride(capacity);
  auto floats = allocateZeroed<float>(stride * columns_.size());
  auto instances = allocateZeroed<std::int32_t>(capacity);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    float* const moved = floats.get() + i * stride;
    std::copy_n(columns_[i].values, size_, moved);
    columns_[i].values = moved;
  }
  if (size_ > 0) std::copy_n(instances_.get(), size_, instances.get());
  floats_ = std::move(floats);
  instances_ = std::move(instances);
  capacity_ = capacity;
}

Batch::Batch(int capacity)
    : capacity_(std::max(1, capacity)), stride_(oddStride(static_cast<std::size_t>(capacity_) + lanes)) {}

std::size_t Batch::firstOfLast(const PointArrays& points) const {
  const auto most = static_cast<std::size_t>(capacity_);
  if (points.size() <= most) return 0;
  // At least one vector, or a batch smaller than that would never come to a beginning of one.
  return most < lanes ? (points.size() - 1) / lanes * lanes : (points.size() - most + lanes - 1) / lanes * lanes;
}

void Batch::run(KernelHost& host, const PointArrays& points, std::size_t first) {
  assert(first % lanes == 0 && points.size() - first <= stride_);
  family_ = points.family_;
  kernel_ = points.kernel_;
  for (const PointArrays::Column& column : points.columns_) globalPointers_[column.component] = column.values + first;
  // Strings take two floats' room.
  const std::size_t wanted = 2 * interface().outputs.size();
  if (wanted > outputArrays_) {
    outputArrays_ = wanted;
    outputs_ = allocateZeroed<float>(stride_ * wanted);
  }
  outputPointers_.resize(interface().outputs.size());
  for (std::size_t i = 0; i < outputPointers_.size(); ++i) outputPointers_[i] = outputs_.get() + 2 * i * stride_;

  AerosolKernelArguments arguments;
  arguments.context = host.context();
  arguments.globals = globalPointers_.data();
  arguments.instances = points.instances_.get() + first;
  arguments.active = nullptr;
  arguments.instanceData = family_->instanceData.data();
  arguments.outputs = outputPointers_.data();
  arguments.count = static_cast<std::int32_t>(points.size() - first);
  host.begin(kernel_->interface(), *family_, points.size() - first);
  if (points.timeColumn_) [[unlikely]] {
    const std::size_t count = points.size() - first;
    moved_.place(*family_, interface().instanceStride, {arguments.instances, count},
                 {points.columns_[*points.timeColumn_].values + first, count}, stride_);
    arguments.instances = moved_.numbers();
    arguments.instanceData = moved_.blocks();
    host.setInstanceData(moved_.blocks());
  }
  (*kernel_)(arguments);
}

}  // namespace aerosol::shading
