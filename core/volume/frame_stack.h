// Memory for the coroutine frames of one path: a stack, because nested coroutines end in the reverse order of their
// start.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <vector>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define AEROSOL_ASAN 1
#endif
#endif
#ifdef AEROSOL_ASAN
#include <sanitizer/asan_interface.h>
#endif

namespace aerosol::volume {

/// A last-in first-out arena. Blocks are 64-byte aligned. What does not fit comes from the heap and is counted, so
/// that the capacity can be chosen from measurements; such blocks are kept for the next one that does not fit. Freed
/// memory is poisoned for AddressSanitizer.
class FrameStack {
 public:
  static constexpr std::size_t alignment = 64;

  explicit FrameStack(std::size_t capacity)
      : capacity_(roundUp(capacity)),
        memory_(static_cast<std::byte*>(::operator new(capacity_, std::align_val_t{alignment}))) {
    poison(memory_, capacity_);
  }
  ~FrameStack() {
    unpoison(memory_, capacity_);
    for (const Spare& spare : spare_) {
      unpoison(spare.block, spare.size);
      ::operator delete(spare.block, std::align_val_t{alignment});
    }
    ::operator delete(memory_, std::align_val_t{alignment});
  }
  FrameStack(const FrameStack&) = delete;
  FrameStack& operator=(const FrameStack&) = delete;

  /// At least `size` bytes. Must be freed before every block that was allocated earlier.
  void* allocate(std::size_t size) {
    std::size_t total = roundUp(size) + alignment;
    std::byte* block;
    if (used_ + total <= capacity_) {
      block = memory_ + used_;
      unpoison(block, total);
      used_ += total;
      if (used_ > peak_) peak_ = used_;
    } else {
      block = takeSpare(total);
      ++heapBlocks_;
    }
    ::new (block) Header{this, total};
    return block + alignment;
  }

  /// Frees what `allocate` of any stack returned.
  static void free(void* pointer) {
    std::byte* block = static_cast<std::byte*>(pointer) - alignment;
    const Header header = *std::launder(reinterpret_cast<Header*>(block));
    header.owner->release(block, header.size);
  }

  std::size_t peakBytes() const { return peak_; }
  std::size_t heapBlocks() const { return heapBlocks_; }
  bool isEmpty() const { return used_ == 0; }

 private:
  struct Header {
    FrameStack* owner;
    std::size_t size;
  };
  static_assert(sizeof(Header) <= alignment);

  static constexpr std::size_t roundUp(std::size_t n) { return (n + alignment - 1) / alignment * alignment; }

  void release(std::byte* block, std::size_t size) {
    if (block >= memory_ && block < memory_ + capacity_) {
      used_ = static_cast<std::size_t>(block - memory_);
      poison(block, size);
    } else {
      poison(block, size);
      spare_.push_back({block, size});
    }
  }

  struct Spare {
    std::byte* block;
    std::size_t size;
  };

  /// A block from the heap of at least `size` bytes; `size` becomes what it has.
  std::byte* takeSpare(std::size_t& size) {
    for (Spare& spare : spare_) {
      if (spare.size < size) continue;
      const Spare found = spare;
      spare = spare_.back();
      spare_.pop_back();
      unpoison(found.block, found.size);
      size = found.size;
      return found.block;
    }
    return static_cast<std::byte*>(::operator new(size, std::align_val_t{alignment}));
  }

#ifdef AEROSOL_ASAN
  static void poison(void* p, std::size_t n) { __asan_poison_memory_region(p, n); }
  static void unpoison(void* p, std::size_t n) { __asan_unpoison_memory_region(p, n); }
#else
  static void poison(void*, std::size_t) {}
  static void unpoison(void*, std::size_t) {}
#endif

  std::size_t capacity_;
  std::byte* memory_;
  std::size_t used_ = 0;
  std::size_t peak_ = 0;
  std::size_t heapBlocks_ = 0;
  std::vector<Spare> spare_;
};

/// What a coroutine's first parameter must offer: the stack on which its frame is laid.
template <class C>
concept HasFrames = requires(C& context) {
  { context.frames() } -> std::same_as<FrameStack&>;
};

}  // namespace aerosol::volume
