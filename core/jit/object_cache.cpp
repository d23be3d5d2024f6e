#include "core/jit/object_cache.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <system_error>
#include <vector>

#include "core/base/hash.h"
#include "core/jit/bytes.h"

namespace aerosol::jit {

namespace {

constexpr std::uint64_t magic = 0x3165686361636561;  // "aecache1"
constexpr std::string_view temporaryPrefix = ".writing-";
constexpr std::time_t staleTemporarySeconds = 3600;

/// A file descriptor, closed when it goes.
class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  explicit operator bool() const { return descriptor_ >= 0; }

  bool stat(struct stat& status) const { return ::fstat(descriptor_, &status) == 0; }
  bool allow(mode_t mode) const { return ::fchmod(descriptor_, mode) == 0; }
  bool touch() const { return ::futimens(descriptor_, nullptr) == 0; }

  bool read(char* data, std::size_t size) const {
    while (size > 0) {
      const ssize_t done = ::read(descriptor_, data, size);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) return false;
      data += done;
      size -= static_cast<std::size_t>(done);
    }
    return true;
  }

  bool write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t done = ::write(descriptor_, bytes.data(), bytes.size());
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(done));
    }
    return true;
  }

 private:
  int descriptor_;
};

/// The checksum covers the key, so that an entry under another's name counts as damaged.
std::string checksum(std::string_view key, std::string_view bytes) { return StrongHash().add(key).add(bytes).hex(); }

std::string header(std::string_view key, std::string_view bytes) {
  ByteWriter out;
  out << magic << static_cast<std::uint64_t>(bytes.size()) << checksum(key, bytes);
  return out.take();
}

bool isValidKey(std::string_view key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  });
}

Diagnostic folderError(const std::filesystem::path& folder, const std::string& what) {
  Diagnostic error;
  error.message = "the cache folder '" + folder.string() + "' cannot be used: " + what;
  error.notes.push_back("XDG_CACHE_HOME names the folder above it");
  return error;
}

}  // namespace

std::filesystem::path ObjectCache::defaultFolder() {
  // Relative paths in XDG_CACHE_HOME are invalid and ignored (XDG Base Directory Specification).
  if (const char* base = std::getenv("XDG_CACHE_HOME"); base && base[0] == '/') {
    return std::filesystem::path(base) / "aerosol";
  }
  if (const char* home = std::getenv("HOME"); home && home[0] == '/') {
    return std::filesystem::path(home) / ".cache" / "aerosol";
  }
  return {};
}

Result<std::shared_ptr<ObjectCache>> ObjectCache::open(const std::filesystem::path& folder,
                                                       std::uint64_t maximumBytes) {
  std::error_code failure;
  std::filesystem::create_directories(folder.parent_path(), failure);
  if (failure) return folderError(folder, failure.message());
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    return folderError(folder, std::generic_category().message(errno));
  }
  // Looked at through a descriptor, so that what is checked and what is mended is one and the same folder.
  const File handle(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  struct stat status{};
  if (!handle || !handle.stat(status)) return folderError(folder, std::generic_category().message(errno));
  if (status.st_uid != ::geteuid()) return folderError(folder, "it belongs to another user");
  if ((status.st_mode & 0777) != 0700 && !handle.allow(0700)) {
    return folderError(folder, "others may write to it");
  }
  return std::shared_ptr<ObjectCache>(new ObjectCache(folder, maximumBytes));
}

ObjectCache::ObjectCache(std::filesystem::path folder, std::uint64_t maximumBytes)
    : folder_(std::move(folder)), maximumBytes_(maximumBytes), bytesSinceScan_(maximumBytes) {}

std::filesystem::path ObjectCache::pathOf(std::string_view key) const {
  assert(isValidKey(key));
  return folder_ / key;
}

std::optional<std::string> ObjectCache::get(std::string_view key) {
  const std::filesystem::path path = pathOf(key);
  const File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  struct stat status{};
  if (!file || !file.stat(status)) {
    ++misses_;
    return {};
  }
  const auto readEntry = [&]() -> std::optional<std::string> {
    const std::size_t headerSize = header(key, {}).size();
    if (!S_ISREG(status.st_mode) || status.st_uid != ::geteuid()) return {};
    if (static_cast<std::size_t>(status.st_size) < headerSize) return {};
    std::string head(headerSize, '\0');
    std::string bytes(static_cast<std::size_t>(status.st_size) - headerSize, '\0');
    if (!file.read(head.data(), head.size()) || !file.read(bytes.data(), bytes.size())) return {};
    if (head != header(key, bytes)) return {};
    return bytes;
  };
  std::optional<std::string> bytes = readEntry();
  if (!bytes) {
    ::unlink(path.c_str());
    ++damaged_;
    ++misses_;
    return {};
  }
  // Only the order of use counts, to the minute: not every read has to write.
  if (status.st_mtime + 60 < std::time(nullptr)) file.touch();
  ++hits_;
  return bytes;
}

void ObjectCache::put(std::string_view key, std::string_view bytes) {
  const std::string head = header(key, bytes);
  const std::uint64_t size = head.size() + bytes.size();
  if (size > maximumBytes_) return;
  const std::filesystem::path path = pathOf(key);
  const std::filesystem::path temporary =
      folder_ / (std::string(temporaryPrefix) + std::to_string(::getpid()) + "-" +
                 std::to_string(temporaryNumber_.fetch_add(1)) + "-" + std::string(key));
  {
    ::unlink(temporary.c_str());
    const File file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
    if (!file) return;
    if (!file.write(head) || !file.write(bytes)) {
      ::unlink(temporary.c_str());
      return;
    }
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    ::unlink(temporary.c_str());
    return;
  }
  ++written_;
  // The folder is looked through at the first write and whenever a sixteenth of its bound may have been added since.
  if (bytesSinceScan_.fetch_add(size) + size > maximumBytes_ / 16) evict();
}

void ObjectCache::evict() {
  bytesSinceScan_ = 0;
  struct Entry {
    std::filesystem::path path;
    std::uint64_t size;
    struct timespec used;
  };
  std::vector<Entry> entries;
  std::uint64_t total = 0;
  std::error_code failure;
  const std::time_t now = std::time(nullptr);
  for (std::filesystem::directory_iterator it(folder_, failure), end; !failure && it != end; it.increment(failure)) {
    struct stat status{};
    if (::lstat(it->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    const bool isTemporary = it->path().filename().native().starts_with(temporaryPrefix);
    if (isTemporary) {
      if (status.st_mtime + staleTemporarySeconds < now) ::unlink(it->path().c_str());
      continue;
    }
    const auto size = static_cast<std::uint64_t>(status.st_size);
    entries.push_back({it->path(), size, status.st_mtim});
    total += size;
  }
  if (total <= maximumBytes_) return;
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    if (a.used.tv_sec != b.used.tv_sec) return a.used.tv_sec < b.used.tv_sec;
    if (a.used.tv_nsec != b.used.tv_nsec) return a.used.tv_nsec < b.used.tv_nsec;
    return a.path < b.path;
  });
  // Down to seven eighths, so that the next write does not start over.
  const std::uint64_t goal = maximumBytes_ - maximumBytes_ / 8;
  for (const Entry& entry : entries) {
    if (total <= goal) break;
    if (::unlink(entry.path.c_str()) == 0) total -= entry.size;
  }
}

CacheStatistics ObjectCache::statistics() const { return {hits_, misses_, damaged_, written_}; }

}  // namespace aerosol::jit
