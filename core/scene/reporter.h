// Collects the messages of one reading of a scene.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/diagnostic.h"

namespace aerosol::scene {

/// Errors and warnings apart. After `errorLimit` errors the rest is only counted, so that a file of another kind does
/// not produce a message for each of its million elements.
class Reporter {
 public:
  static constexpr int errorLimit = 100;

  void error(SourceLocation location, std::string message, std::vector<std::string> notes = {}) {
    const int count = ++errorCount_;
    if (count <= errorLimit) errors_.error(std::move(location), std::move(message), std::move(notes));
    if (count == errorLimit + 1) errors_.error({}, "too many errors: the rest is not shown");
  }
  void warning(SourceLocation location, std::string message, std::vector<std::string> notes = {}) {
    warnings_.warning(std::move(location), std::move(message), std::move(notes));
  }

  /// Brings the messages into the order of their places, file by file as they first occur, each once.
  void sort();

  bool failed() const { return errorCount_ > 0; }
  int errorCount() const { return errorCount_; }
  Diagnostics& errors() { return errors_; }
  Diagnostics& warnings() { return warnings_; }

 private:
  Diagnostics errors_;
  Diagnostics warnings_;
  int errorCount_ = 0;
};

/// "did you mean …" when something is near, and the list of what would be valid.
std::vector<std::string> alternatives(const std::string& name, const std::vector<std::string>& valid,
                                      const std::string& intro);

/// `a, b, c`.
std::string join(const std::vector<std::string>& words);

/// `a`, `a or b`, `a, b or c`.
std::string joinWithOr(const std::vector<std::string>& words);

/// `file:line:column`, to be named in a note.
std::string format(const SourceLocation& location);

}  // namespace aerosol::scene
