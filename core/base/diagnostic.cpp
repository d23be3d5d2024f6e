#include "core/base/diagnostic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace aerosol {

namespace {

std::string_view word(Severity severity) {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      break;
  }
  return "error";
}

std::string place(const SourceLocation& at) {
  if (at.file.empty()) return {};
  if (at.line == 0) return fmt::format("{}: ", at.file);
  return fmt::format("{}:{}:{}: ", at.file, at.line, at.column);
}

/// The caret line keeps tabs, so that the caret stands below its column in any terminal.
std::string caretLine(std::string_view source, int column) {
  std::string pad;
  for (int i = 0; i + 1 < column; ++i) {
    pad += i < static_cast<int>(source.size()) && source[static_cast<std::size_t>(i)] == '\t' ? '\t' : ' ';
  }
  return pad + '^';
}

/// What files hold must not steer the terminal that shows it: every control character but tab and newline becomes '?',
/// one for one, so that columns stay.
std::string withoutControls(std::string text) {
  for (char& c : text) {
    const bool isControl = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    if (isControl && c != '\t' && c != '\n') c = '?';
  }
  return text;
}

/// Edit distance with transpositions (Damerau 1964, restricted form), case ignored at half price.
int editDistance(std::string_view a, std::string_view b) {
  const std::size_t n = a.size();
  const std::size_t m = b.size();
  std::vector<std::vector<int>> d(n + 1, std::vector<int>(m + 1));
  for (std::size_t i = 0; i <= n; ++i) d[i][0] = static_cast<int>(2 * i);
  for (std::size_t j = 0; j <= m; ++j) d[0][j] = static_cast<int>(2 * j);
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  for (std::size_t i = 1; i <= n; ++i) {
    for (std::size_t j = 1; j <= m; ++j) {
      const int substitute = a[i - 1] == b[j - 1] ? 0 : lower(a[i - 1]) == lower(b[j - 1]) ? 1 : 2;
      d[i][j] = std::min({d[i - 1][j] + 2, d[i][j - 1] + 2, d[i - 1][j - 1] + substitute});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 2);
    }
  }
  return d[n][m];
}

}  // namespace

std::string format(const Diagnostic& d) {
  std::string text = fmt::format("{}{}: {}\n", place(d.location), word(d.severity), d.message);
  if (!d.sourceLine.empty() && d.location.line > 0) {
    text += fmt::format("  {}\n  {}\n", d.sourceLine, caretLine(d.sourceLine, d.location.column));
  }
  for (const std::string& note : d.notes) text += fmt::format("  note: {}\n", note);
  return withoutControls(std::move(text));
}

std::string format(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& d : diagnostics.entries()) text += format(d);
  return text;
}

void Diagnostics::add(Diagnostic diagnostic) {
  if (diagnostic.severity == Severity::error) ++errorCount_;
  entries_.push_back(std::move(diagnostic));
}

void Diagnostics::error(SourceLocation location, std::string message, std::vector<std::string> notes) {
  add({Severity::error, std::move(location), std::move(message), {}, std::move(notes)});
}

void Diagnostics::warning(SourceLocation location, std::string message, std::vector<std::string> notes) {
  add({Severity::warning, std::move(location), std::move(message), {}, std::move(notes)});
}

void Diagnostics::append(const Diagnostics& other) {
  for (const Diagnostic& d : other.entries()) add(d);
}

std::vector<std::string> nearestNames(std::string_view name, const std::vector<std::string>& candidates,
                                      std::size_t count) {
  std::vector<std::pair<int, std::string>> scored;
  for (const std::string& candidate : candidates) {
    const int distance = editDistance(name, candidate);
    if (distance <= 2 + static_cast<int>(name.size()) * 2 / 3) scored.emplace_back(distance, candidate);
  }
  std::sort(scored.begin(), scored.end());
  scored.erase(std::unique(scored.begin(), scored.end()), scored.end());
  std::vector<std::string> names;
  for (const auto& [distance, candidate] : scored) {
    if (names.size() == count) break;
    names.push_back(candidate);
  }
  return names;
}

std::string didYouMean(std::string_view name, const std::vector<std::string>& candidates) {
  const std::vector<std::string> names = nearestNames(name, candidates);
  if (names.empty()) return {};
  std::string text = "did you mean ";
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
    text += fmt::format("'{}'", names[i]);
  }
  return text + "?";
}

}  // namespace aerosol
