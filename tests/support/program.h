// The program as a process of its own, in a folder of its own.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "tests/support/scratch_folder.h"

namespace aerosol::test {

struct Outcome {
  std::optional<int> code;  ///< None: a signal ended it.
  std::string out, err;
};

/// An empty folder in which the program is run; removed at the end. Kernels come from the tests' common cache.
class ProgramFolder {
 public:
  ProgramFolder() = default;
  ~ProgramFolder();
  ProgramFolder(const ProgramFolder&) = delete;
  ProgramFolder& operator=(const ProgramFolder&) = delete;

  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  bool has(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Names of all files, ascending.
  std::vector<std::string> files() const;

  /// The image in a file; a failure of the test, and an empty image, where it cannot be read.
  image::ImageBuffer picture(const std::string& name) const;

  /// Runs `aerosol ARGUMENTS`; after `killAfter` the process is killed, unless it has ended before.
  Outcome run(const std::vector<std::string>& arguments, std::optional<std::chrono::milliseconds> killAfter = {}) const;
  /// The same; the process is killed as soon as it has made the file, unless it ends before, however long that takes.
  Outcome runUntil(const std::string& file, const std::vector<std::string>& arguments) const;

 private:
  pid_t start(const std::vector<std::string>& arguments) const;
  Outcome outcomeOf(int status) const;

  ScratchFolder scratch_;
  std::filesystem::path folder_ = scratch_.path();
};

}  // namespace aerosol::test
