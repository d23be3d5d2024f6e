#include "core/scene/source_text.h"

#include <algorithm>
#include <utility>

namespace aerosol::scene {

namespace {

constexpr std::size_t longestShownLine = 500;

}  // namespace

SourceText::SourceText(std::string file, std::string text, std::filesystem::path directory)
    : file_(std::move(file)), text_(std::move(text)), directory_(std::move(directory)), lineStarts_{0} {
  for (std::size_t i = 0; i < text_.size(); ++i) {
    if (text_[i] == '\n') lineStarts_.push_back(i + 1);
  }
}

SourceLocation SourceText::at(std::size_t offset) const {
  offset = std::min(offset, text_.size());
  const auto next = std::upper_bound(lineStarts_.begin(), lineStarts_.end(), offset);
  const std::size_t start = *(next - 1);
  return {file_, static_cast<int>(next - lineStarts_.begin()), static_cast<int>(offset - start) + 1};
}

std::string_view SourceText::line(int number) const {
  if (number < 1 || static_cast<std::size_t>(number) > lineStarts_.size()) return {};
  const auto index = static_cast<std::size_t>(number) - 1;
  const std::size_t start = lineStarts_[index];
  const std::size_t end = index + 1 < lineStarts_.size() ? lineStarts_[index + 1] - 1 : text_.size();
  std::string_view line = std::string_view(text_).substr(start, end - start);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

const SourceText& SourceTexts::add(std::string file, std::string text, std::filesystem::path directory) {
  std::unique_ptr<const SourceText>& slot = texts_[file];
  if (!slot || slot->text() != text) {
    slot = std::make_unique<const SourceText>(std::move(file), std::move(text), std::move(directory));
  }
  return *slot;
}

const SourceText* SourceTexts::find(const std::string& file) const {
  const auto found = texts_.find(file);
  return found == texts_.end() ? nullptr : found->second.get();
}

void SourceTexts::annotate(Diagnostic& diagnostic) const {
  if (!diagnostic.sourceLine.empty()) return;
  const SourceText* text = find(diagnostic.location.file);
  if (!text) return;
  const std::string_view line = text->line(diagnostic.location.line);
  if (line.size() > longestShownLine) return;
  diagnostic.sourceLine = line;
  for (char& c : diagnostic.sourceLine) {
    if (c != '\t' && static_cast<unsigned char>(c) < 0x20) c = '?';
  }
}

void SourceTexts::annotate(Diagnostics& diagnostics) const {
  for (Diagnostic& diagnostic : diagnostics.entries()) annotate(diagnostic);
}

}  // namespace aerosol::scene
