// The texts of strings while kernels run: those that the code and its instances know, and those that it makes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/jit/kernel_interface.h"

namespace aerosol::shading {

using StringList = std::vector<std::pair<std::uint64_t, std::string>>;

/// One a thread. A string's hash is its identity, so tables of different threads agree wherever both know a string.
class RuntimeStrings {
 public:
  /// A kernel is about to run on points 0 to count - 1. Strings made earlier stay known at least until here.
  void begin(const jit::KernelInterface& interface, const StringList* ofInstances, std::size_t count);

  /// Empty when the hash is of no known string.
  std::string_view text(std::uint64_t hash) const;
  std::uint64_t add(std::string_view text);
  enum class Room : std::uint8_t { enough, usedUp, usedUpBefore };
  /// May a point make a string of this length? Each has room for `roomOfPoint` bytes in one run, so that no shader runs
  /// out of memory.
  Room charge(std::size_t point, std::size_t bytes);

  static constexpr std::size_t roomOfPoint = std::size_t{1} << 18;

 private:
  std::unordered_map<std::uint64_t, std::string> made_;
  std::size_t madeBytes_ = 0;
  std::vector<std::uint32_t> charged_;  ///< By point; empty until the first.
  std::size_t count_ = 0;
  const jit::KernelInterface* interface_ = nullptr;
  const StringList* ofInstances_ = nullptr;
};

}  // namespace aerosol::shading
