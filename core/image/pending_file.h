// A file that appears completely or not at all.
#pragma once

#include <string>

#include "core/base/result.h"

namespace aerosol::image {

/// An empty file in the folder of `target`, filled by its path and then moved there. Destroyed before `commit`, it is
/// deleted; a process that is killed leaves nothing behind either, where the file system has files without a name.
class PendingFile {
 public:
  /// An error when the folder is missing or cannot be written, or `target` is no regular file or read-only.
  static Result<PendingFile> create(const std::string& target);
  ~PendingFile();
  PendingFile(PendingFile&& other) noexcept;
  PendingFile& operator=(PendingFile&&) = delete;

  const std::string& path() const { return path_; }

  /// Puts the content on disk and then in the place of the target, with its permissions if there was one. No other
  /// process ever sees a part of it. Returns what went wrong; empty after success.
  Diagnostics commit();

 private:
  PendingFile(std::string target, std::string path, int descriptor, bool isNameless)
      : target_(std::move(target)), path_(std::move(path)), descriptor_(descriptor), isNameless_(isNameless) {}

  /// A name that is not the target's yet. False, with errno, where that cannot be.
  bool giveName();

  std::string target_, path_;
  int descriptor_ = -1;
  bool isNameless_ = false;  ///< `path_` is that of the descriptor.
};

}  // namespace aerosol::image
