// A file that appears completely or not at all.
#pragma once

#include <string>

#include "core/base/result.h"

namespace aerosol::image {

/// An empty file beside `target`, filled by its path and then moved there. Destroyed before `commit`, it is deleted.
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
  PendingFile(std::string target, std::string path, int descriptor)
      : target_(std::move(target)), path_(std::move(path)), descriptor_(descriptor) {}

  std::string target_, path_;
  int descriptor_ = -1;
};

}  // namespace aerosol::image
