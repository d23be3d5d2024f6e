// A folder of small immutable files on disk, keyed by hashes: compiled kernels and what is known about sources.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace aerosol::jit {

struct CacheStatistics {
  std::uint64_t hits = 0;
  std::uint64_t misses = 0;
  std::uint64_t damaged = 0;  ///< Entries that failed their checksum and were dropped.
  std::uint64_t written = 0;
};

/// Entries are written to a temporary file and renamed, so that readers and other writers, in this process or others,
/// see whole entries or none. Each carries a checksum that is verified before its bytes are handed out. Reading marks
/// an entry as used; when the folder grows beyond its bound, those unused for longest go. Failures to write are silent:
/// the cache is a convenience. All functions are thread-safe.
class ObjectCache {
 public:
  static constexpr std::uint64_t defaultMaximumBytes = 512u << 20;

  /// `$XDG_CACHE_HOME/aerosol`, or `~/.cache/aerosol`; empty when neither variable is set to an absolute path.
  static std::filesystem::path defaultFolder();

  /// Opens the folder, making it (mode 0700) where needed. An error when it is not a folder, belongs to another user,
  /// or others may write to it and that cannot be mended.
  static Result<std::shared_ptr<ObjectCache>> open(const std::filesystem::path& folder,
                                                   std::uint64_t maximumBytes = defaultMaximumBytes);

  /// The bytes that were put under the key; empty when there are none or they are damaged.
  /// `key` is made of lower-case letters, digits, '-' and '_' (a StrongHash with a prefix for the kind of entry).
  std::optional<std::string> get(std::string_view key);

  /// Keeps the bytes under the key, replacing what was there.
  void put(std::string_view key, std::string_view bytes);

  CacheStatistics statistics() const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  ObjectCache(std::filesystem::path folder, std::uint64_t maximumBytes);
  std::filesystem::path pathOf(std::string_view key) const;
  void evict();

  std::filesystem::path folder_;
  std::uint64_t maximumBytes_;
  std::atomic<std::uint64_t> bytesSinceScan_;
  std::atomic<std::uint64_t> hits_{0}, misses_{0}, damaged_{0}, written_{0};
  std::atomic<std::uint64_t> temporaryNumber_{0};
};

}  // namespace aerosol::jit
