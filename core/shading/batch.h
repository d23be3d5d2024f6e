// Points gathered as structure of arrays, run through a kernel together.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "core/shading/kernel_host.h"
#include "core/shading/shading_point.h"
#include "core/shading/shading_system.h"

namespace aerosol::shading {

/// Owns the arrays of one batch; reused for all kernels of a thread.
class Batch {
 public:
  explicit Batch(int capacity);

  int capacity() const { return capacity_; }

  /// Starts a batch for a kernel.
  void begin(const Family& family, Variant variant);
  /// Point number `lane`, counted from 0 without gaps. Only what the kernel reads is copied.
  void set(int lane, const ShadingPoint& point, std::uint32_t instance) {
    for (const int component : componentsRead_) {
      global(component)[lane] = point[static_cast<std::size_t>(component)];
    }
    instances_.get()[lane] = static_cast<std::int32_t>(instance);
  }
  /// Runs the kernel on the first `count` points.
  void run(KernelHost& host, int count);

  /// Array number `output` of the kernel's interface.
  const float* output(std::size_t output) const { return static_cast<const float*>(outputPointers_[output]); }
  const jit::KernelInterface& interface() const { return kernel_->interface(); }
  const Family& family() const { return *family_; }

 private:
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  template <class T>
  using Aligned = std::unique_ptr<T[], Free>;

  float* global(int component) { return globals_.get() + static_cast<std::size_t>(component) * stride_; }

  int capacity_;
  std::size_t stride_;  ///< Floats from one array to the next.
  Aligned<float> globals_;
  Aligned<std::int32_t> instances_;
  Aligned<float> outputs_;
  std::size_t outputArrays_ = 0;
  std::vector<const float*> globalPointers_;
  std::vector<void*> outputPointers_;
  std::vector<int> componentsRead_;
  const jit::Kernel* kernel_ = nullptr;
  const Family* family_ = nullptr;
};

}  // namespace aerosol::shading
