#include "core/image/pending_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>
#include <random>
#include <system_error>
#include <utility>

namespace aerosol::image {

namespace {

namespace fs = std::filesystem;

Diagnostic failure(const std::string& file, const std::string& what, int code) {
  return {Severity::error, {file, 0, 0}, what + ": " + std::system_category().message(code), {}, {}};
}

fs::path folderOf(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

std::string namedByDescriptor(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

/// A file that no folder lists, so that a process which is killed leaves nothing behind; none where the file system has
/// no such files, or descriptors cannot be opened by a path.
std::optional<int> openNameless(const fs::path& folder) {
  const int descriptor = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (descriptor < 0) return {};
  if (access(namedByDescriptor(descriptor).c_str(), R_OK | W_OK) == 0) return descriptor;
  close(descriptor);
  return {};
}

std::string randomName() {
  static constexpr char digits[] = "0123456789abcdef";
  std::random_device random;
  std::string name = ".aerosol-";
  for (int i = 0; i < 16; ++i) name += digits[random() % 16];
  return name + ".tmp";
}

/// The file behind a symbolic link, which is the one to replace.
std::string resolveLink(const std::string& target) {
  std::error_code error;
  if (!fs::is_symlink(target, error)) return target;
  const fs::path resolved = fs::canonical(target, error);
  return error ? target : resolved.string();
}

/// Makes the new name itself lasting. Some file systems cannot; the content is safe without.
void syncFolder(const fs::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace

Result<PendingFile> PendingFile::create(const std::string& target) {
  const std::string place = resolveLink(target);
  struct stat status{};
  const bool exists = stat(place.c_str(), &status) == 0;
  if (exists && !S_ISREG(status.st_mode)) {
    return Diagnostic{Severity::error, {target, 0, 0}, "cannot write here: this is not a regular file", {}, {}};
  }
  if (exists && faccessat(AT_FDCWD, place.c_str(), W_OK, AT_EACCESS) != 0)
    return failure(target, "cannot replace this file", errno);
  if (const auto nameless = openNameless(folderOf(place))) {
    if (exists) fchmod(*nameless, status.st_mode & 07777);
    return PendingFile(place, namedByDescriptor(*nameless), *nameless, true);
  }
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::string path = (folderOf(place) / randomName()).string();
    const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      if (exists) fchmod(descriptor, status.st_mode & 07777);
      return PendingFile(place, path, descriptor, false);
    }
    if (errno != EEXIST) break;
  }
  return failure(target, "cannot write in the folder '" + folderOf(place).string() + "'", errno);
}

PendingFile::~PendingFile() {
  if (descriptor_ < 0) return;
  if (!isNameless_) unlink(path_.c_str());
  close(descriptor_);
}

PendingFile::PendingFile(PendingFile&& other) noexcept
    : target_(std::move(other.target_)),
      path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      isNameless_(other.isNameless_) {}

bool PendingFile::giveName() {
  if (!isNameless_) return true;
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::string path = (folderOf(target_) / randomName()).string();
    if (linkat(AT_FDCWD, path_.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      path_ = path;
      isNameless_ = false;
      return true;
    }
    if (errno != EEXIST) break;
  }
  return false;
}

Diagnostics PendingFile::commit() {
  Diagnostics errors;
  if (fsync(descriptor_) != 0) {
    errors.add(failure(target_, "cannot write this file", errno));
  } else if (!giveName() || rename(path_.c_str(), target_.c_str()) != 0) {
    errors.add(failure(target_, "cannot put the finished file here", errno));
  } else {
    close(std::exchange(descriptor_, -1));
    syncFolder(folderOf(target_));
  }
  return errors;
}

}  // namespace aerosol::image
