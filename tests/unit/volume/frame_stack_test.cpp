#include "core/volume/frame_stack.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

namespace aerosol::volume {
namespace {

bool isAligned(const void* p) { return reinterpret_cast<std::uintptr_t>(p) % FrameStack::alignment == 0; }

/// Writes every byte of a block, which AddressSanitizer checks.
void fill(void* block, std::size_t size, int value) { std::memset(block, value, size); }

bool isFilled(const void* block, std::size_t size, int value) {
  const auto* bytes = static_cast<const unsigned char*>(block);
  for (std::size_t i = 0; i < size; ++i) {
    if (bytes[i] != static_cast<unsigned char>(value)) return false;
  }
  return true;
}

TEST(FrameStackTest, BlocksAreAlignedAndReusedLastInFirstOut) {
  FrameStack stack(4096);
  EXPECT_TRUE(stack.isEmpty());
  void* first = stack.allocate(100);
  void* second = stack.allocate(1);
  EXPECT_TRUE(isAligned(first));
  EXPECT_TRUE(isAligned(second));
  EXPECT_GE(static_cast<std::byte*>(second) - static_cast<std::byte*>(first), 100);
  FrameStack::free(second);
  void* third = stack.allocate(200);
  EXPECT_EQ(third, second);
  FrameStack::free(third);
  FrameStack::free(first);
  EXPECT_TRUE(stack.isEmpty());
  EXPECT_EQ(stack.allocate(8), first);
  FrameStack::free(first);
  EXPECT_EQ(stack.heapBlocks(), 0u);
}

TEST(FrameStackTest, PeakIsTheLargestUse) {
  FrameStack stack(4096);
  void* a = stack.allocate(64);
  void* b = stack.allocate(640);
  const std::size_t peak = stack.peakBytes();
  EXPECT_GE(peak, 704u);
  FrameStack::free(b);
  void* c = stack.allocate(64);
  EXPECT_EQ(stack.peakBytes(), peak);
  FrameStack::free(c);
  FrameStack::free(a);
}

TEST(FrameStackTest, WhatDoesNotFitComesFromTheHeapAndIsCounted) {
  FrameStack stack(512);
  void* fits = stack.allocate(128);
  void* large = stack.allocate(1000);
  EXPECT_EQ(stack.heapBlocks(), 1u);
  EXPECT_TRUE(isAligned(large));
  void* fitsAgain = stack.allocate(64);
  EXPECT_EQ(stack.heapBlocks(), 1u);
  fill(fits, 128, 1);
  fill(large, 1000, 2);
  fill(fitsAgain, 64, 3);
  EXPECT_TRUE(isFilled(fits, 128, 1));
  EXPECT_TRUE(isFilled(large, 1000, 2));
  FrameStack::free(fitsAgain);
  FrameStack::free(large);
  FrameStack::free(fits);
  EXPECT_TRUE(stack.isEmpty());
  FrameStack::free(stack.allocate(1000));
  EXPECT_EQ(stack.heapBlocks(), 2u);
}

TEST(FrameStackTest, ACapacityOfZeroTakesEverythingFromTheHeap) {
  FrameStack stack(0);
  void* block = stack.allocate(64);
  fill(block, 64, 7);
  FrameStack::free(block);
  EXPECT_EQ(stack.heapBlocks(), 1u);
}

TEST(FrameStackTest, RandomUseKeepsBlocksApart) {
  struct Block {
    void* memory;
    std::size_t size;
    int value;
  };
  std::mt19937 random(3);
  FrameStack stack(8192);
  std::vector<Block> blocks;
  for (int step = 0; step < 20000; ++step) {
    if (!blocks.empty() && (random() % 2 == 0 || blocks.size() > 30)) {
      const Block block = blocks.back();
      blocks.pop_back();
      ASSERT_TRUE(isFilled(block.memory, block.size, block.value));
      FrameStack::free(block.memory);
    } else {
      const Block block{nullptr, 1 + random() % 900, static_cast<int>(random() % 256)};
      blocks.push_back(block);
      blocks.back().memory = stack.allocate(block.size);
      ASSERT_TRUE(isAligned(blocks.back().memory));
      fill(blocks.back().memory, block.size, block.value);
    }
  }
  while (!blocks.empty()) {
    FrameStack::free(blocks.back().memory);
    blocks.pop_back();
  }
  EXPECT_TRUE(stack.isEmpty());
  EXPECT_GT(stack.heapBlocks(), 0u);
}

#ifdef AEROSOL_ASAN
TEST(FrameStackTest, MemoryIsPoisonedBeforeUseAndAfterFree) {
  FrameStack stack(1024);
  auto* first = static_cast<char*>(stack.allocate(64));
  EXPECT_FALSE(__asan_address_is_poisoned(first));
  EXPECT_FALSE(__asan_address_is_poisoned(first + 63));
  auto* second = static_cast<char*>(stack.allocate(64));
  EXPECT_FALSE(__asan_address_is_poisoned(second));
  FrameStack::free(second);
  EXPECT_TRUE(__asan_address_is_poisoned(second));
  EXPECT_FALSE(__asan_address_is_poisoned(first));
  FrameStack::free(first);
  EXPECT_TRUE(__asan_address_is_poisoned(first));
}

TEST(FrameStackDeathTest, ReadingAFreedFrameIsAnError) {
  FrameStack stack(1024);
  auto* block = static_cast<volatile char*>(stack.allocate(64));
  FrameStack::free(const_cast<char*>(block));
  EXPECT_DEATH({ [[maybe_unused]] const char c = block[0]; }, "use-after-poison");
}
#endif

}  // namespace
}  // namespace aerosol::volume
