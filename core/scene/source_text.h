// The texts of the files that a scene was read from: places, lines, and where relative names start.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/diagnostic.h"

namespace aerosol::scene {

/// One file's text. Lines end at a line feed; a carriage return before it belongs to the line end.
class SourceText {
 public:
  /// `directory` is what relative file names in this text start from.
  SourceText(std::string file, std::string text, std::filesystem::path directory);

  const std::string& file() const { return file_; }
  const std::string& text() const { return text_; }
  const std::filesystem::path& directory() const { return directory_; }

  /// The place of the byte at `offset`; an offset beyond the text is its end.
  SourceLocation at(std::size_t offset) const;
  /// The text of a line, counted from 1; empty when there is no such line.
  std::string_view line(int number) const;

 private:
  std::string file_;
  std::string text_;
  std::filesystem::path directory_;
  std::vector<std::size_t> lineStarts_;
};

/// All texts of one scene by file name.
class SourceTexts {
 public:
  /// The text stays where it is until the whole object is destroyed. A file read twice is kept once.
  const SourceText& add(std::string file, std::string text, std::filesystem::path directory);
  /// Null when unknown.
  const SourceText* find(const std::string& file) const;
  /// By file name.
  const std::map<std::string, std::unique_ptr<const SourceText>>& all() const { return texts_; }
  /// Fills in the source lines of messages that lack theirs; lines of more than 500 bytes are not shown,
  /// control characters only as '?'.
  void annotate(Diagnostics& diagnostics) const;
  void annotate(Diagnostic& diagnostic) const;

 private:
  std::map<std::string, std::unique_ptr<const SourceText>> texts_;
};

}  // namespace aerosol::scene
