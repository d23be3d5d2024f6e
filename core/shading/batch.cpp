#include "core/shading/batch.h"

#include <cassert>
#include <cstring>
#include <new>

namespace aerosol::shading {

namespace {

constexpr std::size_t alignment = 64;
constexpr std::size_t lanes = AEROSOL_MAXIMUM_WIDTH;

void* allocateZeroed(std::size_t bytes) {
  const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, rounded);
  if (!memory) throw std::bad_alloc();
  std::memset(memory, 0, rounded);
  return memory;
}

}  // namespace

Batch::Batch(int capacity)
    : capacity_(capacity), stride_((static_cast<std::size_t>(capacity) + lanes - 1) / lanes * lanes) {
  // Kernels touch one cache line of many arrays in turn; an odd number of lines between them spreads those over the
  // sets.
  if (stride_ / lanes % 2 == 0) stride_ += lanes;
  globals_.reset(static_cast<float*>(allocateZeroed(stride_ * jit::globalPointerCount * sizeof(float))));
  instances_.reset(static_cast<std::int32_t*>(allocateZeroed(stride_ * sizeof(std::int32_t))));
  for (int i = 0; i < jit::globalPointerCount; ++i) globalPointers_.push_back(global(i));
}

void Batch::begin(const Family& family, Variant variant) {
  family_ = &family;
  kernel_ = &family.kernel(variant);
  const jit::KernelInterface& interface = kernel_->interface();
  componentsRead_.clear();
  for (int i = 0; i < jit::globalPointerCount; ++i) {
    if (interface.globalsRead >> i & 1u) componentsRead_.push_back(i);
  }
  // Strings take two floats' room.
  const std::size_t wanted = 2 * interface.outputs.size();
  if (wanted > outputArrays_) {
    outputArrays_ = wanted;
    outputs_.reset(static_cast<float*>(allocateZeroed(stride_ * wanted * sizeof(float))));
  }
  outputPointers_.clear();
  for (std::size_t i = 0; i < interface.outputs.size(); ++i)
    outputPointers_.push_back(outputs_.get() + 2 * i * stride_);
}

void Batch::run(KernelHost& host, int count) {
  assert(count <= capacity_);
  AerosolKernelArguments arguments;
  arguments.context = host.context();
  arguments.globals = globalPointers_.data();
  arguments.instances = instances_.get();
  arguments.active = nullptr;
  arguments.instanceData = family_->instanceData.data();
  arguments.outputs = outputPointers_.data();
  arguments.count = count;
  (*kernel_)(arguments);
}

}  // namespace aerosol::shading
