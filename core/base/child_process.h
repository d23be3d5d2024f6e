// Another program, run to its end.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace aerosol {

struct ChildResult {
  int exitCode = 0;
  int signal = 0;  ///< That ended it; 0: it ended by itself.
  bool timedOut = false;
  std::string output;  ///< What it wrote to its standard output, at most 64 kB.

  /// "signal 11 (Segmentation fault)"
  std::string signalName() const;
};

/// Runs `words` (the program first: a path, or a name that the system looks for) with an empty standard input. Its
/// error stream is ours where `keepsErrors`, otherwise nothing. After `seconds` it is ended.
Result<ChildResult> runChild(const std::vector<std::string>& words, int seconds, bool keepsErrors = false);

}  // namespace aerosol
