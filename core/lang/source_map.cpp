#include "core/lang/source_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace aerosol::lang {

SourceMap::SourceMap() { entries_.push_back({noFile, 0, 0}); }

const SourceMap::Entry& SourceMap::entry(Position position) const {
  return entries_[position < entries_.size() ? position : 0];
}

SourceLocation SourceMap::locate(const Entry& entry, Position position) const {
  if (entry.file >= files_.size()) return files_.empty() ? SourceLocation{} : SourceLocation{.file = files_[0].name};
  SourceLocation location{files_[entry.file].name, static_cast<int>(entry.line), static_cast<int>(entry.column)};
  auto directive = std::upper_bound(lineDirectives_.begin(), lineDirectives_.end(), position,
                                    [](Position p, const LineDirective& d) { return p < d.first; });
  while (directive != lineDirectives_.begin()) {
    --directive;
    if (directive->file != entry.file) continue;
    location.file = directive->name;
    location.line = static_cast<int>(static_cast<std::int64_t>(entry.line) + directive->lineOffset);
    break;
  }
  return location;
}

SourceLocation SourceMap::location(Position position) const { return locate(entry(position), position); }

std::string_view SourceMap::sourceLine(Position position) const {
  const Entry& e = entry(position);
  return lineText(e.file, e.line);
}

std::string SourceMap::shownLine(std::uint32_t file, std::uint32_t line) const {
  constexpr std::size_t longest = 1000;
  const std::string_view text = lineText(file, line);
  return text.size() <= longest ? std::string(text) : std::string();
}

/// Lines end with a line feed, a carriage return, or both, as the preprocessor counts them.
std::string_view SourceMap::lineText(std::uint32_t file, std::uint32_t line) const {
  if (file >= files_.size() || line == 0) return {};
  std::string_view rest = files_[file].text;
  while (true) {
    const std::size_t end = rest.find_first_of("\r\n");
    if (line == 1) return rest.substr(0, end);
    if (end == std::string_view::npos) return {};
    const bool pair = rest[end] == '\r' && end + 1 < rest.size() && rest[end + 1] == '\n';
    rest.remove_prefix(end + (pair ? 2 : 1));
    --line;
  }
}

std::string SourceMap::expansionNote(Position position) const {
  const auto found = std::lower_bound(expansions_.begin(), expansions_.end(), position,
                                      [](const Expansion& e, Position p) { return e.position < p; });
  if (found == expansions_.end() || found->position != position) return {};
  const Macro& macro = macros_[found->macro];
  if (macro.definition.file == noFile) return fmt::format("expanded from macro '{}'", macro.name);
  const SourceLocation place = locate(macro.definition, position);
  return fmt::format("expanded from macro '{}', defined at {}:{}:{}", macro.name, place.file, place.line, place.column);
}

Diagnostic SourceMap::diagnostic(Severity severity, Position position, std::string message,
                                 std::vector<std::string> notes) const {
  if (auto note = expansionNote(position); !note.empty()) notes.push_back(std::move(note));
  return {severity, location(position), std::move(message), shownLine(entry(position).file, entry(position).line),
          std::move(notes)};
}

bool SourceMap::warningsSuppressed(Position position) const {
  const Entry& e = entry(position);
  return warningsSuppressed(e.file, e.line);
}

bool SourceMap::warningsSuppressed(std::uint32_t file, std::uint32_t line) const {
  if (line == 0) return false;
  const std::uint64_t before = std::uint64_t{file} << 32 | (line - 1);
  return std::find(suppressedLines_.begin(), suppressedLines_.end(), before) != suppressedLines_.end();
}

bool SourceMap::isInPrelude(Position position) const {
  const Entry& e = entry(position);
  return e.file < files_.size() && files_[e.file].isPrelude;
}

bool SourceMap::onSameLine(Position first, Position second) const {
  const Entry& a = entry(first);
  const Entry& b = entry(second);
  return a.file == b.file && a.line == b.line;
}

std::uint32_t SourceMap::addFile(std::string name, std::string_view text, std::shared_ptr<const void> owner,
                                 bool isPrelude) {
  files_.push_back({std::move(name), text, std::move(owner), isPrelude});
  return static_cast<std::uint32_t>(files_.size() - 1);
}

Position SourceMap::add(Entry entry) {
  assert(entry.file < files_.size());
  entries_.push_back(entry);
  return static_cast<Position>(entries_.size() - 1);
}

void SourceMap::addLineDirective(std::uint32_t file, std::string name, std::int64_t lineOffset) {
  lineDirectives_.push_back({static_cast<Position>(entries_.size()), file, std::move(name), lineOffset});
}

void SourceMap::addExpansion(std::string_view name, Entry definition) {
  const auto same = [&](const Macro& macro) {
    return macro.name == name && macro.definition.file == definition.file && macro.definition.line == definition.line;
  };
  if (macros_.empty() || !same(macros_.back())) macros_.push_back({std::string(name), definition});
  expansions_.push_back({static_cast<Position>(entries_.size() - 1), static_cast<std::uint32_t>(macros_.size() - 1)});
}

void SourceMap::suppressWarnings(std::uint32_t file, std::uint32_t line) {
  suppressedLines_.push_back(std::uint64_t{file} << 32 | line);
}

}  // namespace aerosol::lang
