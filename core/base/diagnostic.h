// Located messages to the person who wrote the input: `file:line:column: error: text`, the source line and a caret.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace aerosol {

/// A place in a text file. Lines and columns count from 1; 0 means unknown. Columns count bytes.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;

  bool operator==(const SourceLocation&) const = default;
};

enum class Severity : std::uint8_t { note, warning, error };

/// One message. `sourceLine` is the text of the line that `location` names, without its line end; it may be empty.
struct Diagnostic {
  Severity severity = Severity::error;
  SourceLocation location;
  std::string message;
  std::string sourceLine;
  std::vector<std::string> notes;  ///< Shown below as "note: …": the cure, the known names.
};

/// `file:line:column: error: message`, the source line, a caret under the column, and the notes.
std::string format(const Diagnostic& diagnostic);

/// Messages in the order in which they were found.
class Diagnostics {
 public:
  void add(Diagnostic diagnostic);
  void error(SourceLocation location, std::string message, std::vector<std::string> notes = {});
  void warning(SourceLocation location, std::string message, std::vector<std::string> notes = {});
  void append(const Diagnostics& other);

  bool hasErrors() const { return errorCount_ > 0; }
  int errorCount() const { return errorCount_; }
  bool empty() const { return entries_.empty(); }
  const std::vector<Diagnostic>& entries() const { return entries_; }
  std::vector<Diagnostic>& entries() { return entries_; }

 private:
  std::vector<Diagnostic> entries_;
  int errorCount_ = 0;
};

/// All messages, one after the other, each ending in a line feed.
std::string format(const Diagnostics& diagnostics);

/// The candidates nearest to `name` by edit distance, nearest first, at most `count`; only plausible misspellings.
std::vector<std::string> nearestNames(std::string_view name, const std::vector<std::string>& candidates,
                                      std::size_t count = 3);

/// "did you mean 'a', 'b' or 'c'?" from `nearestNames`; empty when nothing is near.
std::string didYouMean(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace aerosol
