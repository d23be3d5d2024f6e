// Hashes: a 64-bit one for strings in shaders, a 128-bit one for cache keys.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace aerosol {

/// The 64-bit identity of a string in shaders (xxHash, XXH3 with seed 0). The empty string hashes to 0.
std::uint64_t hashString(std::string_view text);

/// A 128-bit hash (XXH3) built up piece by piece; each piece is framed by its length, so pieces do not run together.
class StrongHash {
 public:
  StrongHash();
  ~StrongHash();
  StrongHash(const StrongHash&) = delete;
  StrongHash& operator=(const StrongHash&) = delete;

  StrongHash& add(std::string_view piece);
  StrongHash& add(std::uint64_t value);
  /// 32 lower-case hexadecimal digits.
  std::string hex() const;

 private:
  void* state_;
};

/// `StrongHash().add(content).hex()` of a regular file; nothing when it cannot be read.
std::optional<std::string> hashFile(const std::filesystem::path& file);

}  // namespace aerosol
