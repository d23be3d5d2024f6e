// Where tokens came from: a compact index of positions, and the text of their source lines for carets.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/lang/ast.h"

namespace aerosol::lang {

/// Maps the `Position` of a node to file, line and column. Position 0 is unknown. Immutable once the preprocessor has
/// filled it.
class SourceMap {
 public:
  /// One position: where the token stands (for a token from a macro: where the outermost macro was used).
  struct Entry {
    std::uint32_t file = 0;
    std::uint32_t line = 0;
    std::uint32_t column = 0;
  };

  static constexpr std::uint32_t noFile = 0xffffffffu;

  SourceMap();

  /// Line and column count from 1, columns in bytes. `#line` directives are honoured. An unknown position gives a file
  /// without a line.
  SourceLocation location(Position position) const;

  /// The physical text of the line on which the position lies, without its line end; empty when unknown.
  std::string_view sourceLine(Position position) const;

  /// "expanded from macro 'NAME', defined at file:line:column" when the token came out of a macro, otherwise empty.
  std::string expansionNote(Position position) const;

  /// A diagnostic at `position` with its source line, and a note when the token came out of a macro.
  Diagnostic diagnostic(Severity severity, Position position, std::string message,
                        std::vector<std::string> notes = {}) const;
  Diagnostic error(Position position, std::string message, std::vector<std::string> notes = {}) const {
    return diagnostic(Severity::error, position, std::move(message), std::move(notes));
  }
  Diagnostic warning(Position position, std::string message, std::vector<std::string> notes = {}) const {
    return diagnostic(Severity::warning, position, std::move(message), std::move(notes));
  }

  /// Whether `#pragma osl nowarn` stands on the line before: warnings at this position are not wanted.
  bool warningsSuppressed(Position position) const;
  bool warningsSuppressed(std::uint32_t file, std::uint32_t line) const;

  /// Whether the position lies in the standard library header.
  bool isInPrelude(Position position) const;

  /// The last position that was added: of a whole source, the end of its main file.
  Position end() const { return static_cast<Position>(entries_.size() - 1); }

  /// Whether the position lies in the main file: not in the standard library or in another file that is included.
  bool isInMainFile(Position position) const { return entry(position).file == entry(end()).file; }

  /// Whether the two positions lie on the same physical line.
  bool onSameLine(Position first, Position second) const;

  // Filling, by the preprocessor and by tests.

  /// `text` must outlive the map when it is not owned; `owner` keeps it alive.
  std::uint32_t addFile(std::string name, std::string_view text, std::shared_ptr<const void> owner, bool isPrelude);
  Position add(Entry entry);
  /// From the next position added on, `file` is called `name` in messages and its lines count `lineOffset` more.
  void addLineDirective(std::uint32_t file, std::string name, std::int64_t lineOffset);
  /// The last position added came out of macro `name`, defined at `definition` (whose file may be `noFile`).
  void addExpansion(std::string_view name, Entry definition);
  void suppressWarnings(std::uint32_t file, std::uint32_t line);
  /// The text of a physical line (counted from 1) of a file.
  std::string_view lineText(std::uint32_t file, std::uint32_t line) const;
  /// The same for a message: empty where the line is too long to be shown.
  std::string shownLine(std::uint32_t file, std::uint32_t line) const;

 private:
  struct File {
    std::string name;
    std::string_view text;
    std::shared_ptr<const void> owner;
    bool isPrelude = false;
  };
  struct LineDirective {
    Position first = 0;
    std::uint32_t file = 0;
    std::string name;
    std::int64_t lineOffset = 0;
  };
  struct Macro {
    std::string name;
    Entry definition;
  };
  struct Expansion {
    Position position = 0;
    std::uint32_t macro = 0;
  };
  SourceLocation locate(const Entry& entry, Position position) const;
  const Entry& entry(Position position) const;

  std::vector<File> files_;
  std::vector<Entry> entries_;
  std::vector<LineDirective> lineDirectives_;  ///< Ascending in `first`.
  std::vector<Expansion> expansions_;          ///< Ascending in `position`.
  std::vector<Macro> macros_;
  std::vector<std::uint64_t> suppressedLines_;  ///< file << 32 | line
};

}  // namespace aerosol::lang
