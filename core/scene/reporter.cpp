#include "core/scene/reporter.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace aerosol::scene {

namespace {

void sortByPlace(Diagnostics& diagnostics) {
  std::map<std::string, std::size_t> fileOrder;
  std::vector<Diagnostic>& entries = diagnostics.entries();
  for (const Diagnostic& d : entries) fileOrder.try_emplace(d.location.file, fileOrder.size());
  using Key = std::tuple<std::size_t, int, int, std::size_t>;
  std::vector<std::pair<Key, Diagnostic>> keyed;
  for (Diagnostic& d : entries) {
    const Key key(fileOrder.at(d.location.file), d.location.line, d.location.column, keyed.size());
    keyed.emplace_back(key, std::move(d));
  }
  std::sort(keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < keyed.size(); ++i) entries[i] = std::move(keyed[i].second);
  const auto same = [](const Diagnostic& a, const Diagnostic& b) {
    return a.location == b.location && a.message == b.message;
  };
  entries.erase(std::unique(entries.begin(), entries.end(), same), entries.end());
}

}  // namespace

void Reporter::sort() {
  sortByPlace(errors_);
  sortByPlace(warnings_);
}

std::string join(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, ", ")); }

std::string joinWithOr(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += words[i];
  }
  return text;
}

std::vector<std::string> alternatives(const std::string& name, const std::vector<std::string>& valid,
                                      const std::string& intro) {
  std::vector<std::string> notes;
  if (std::string near = didYouMean(name.substr(0, 64), valid); !near.empty()) notes.push_back(std::move(near));
  notes.push_back(valid.empty() ? intro + " none" : fmt::format("{} {}", intro, join(valid)));
  return notes;
}

std::string format(const SourceLocation& location) {
  if (location.line == 0) return location.file;
  return fmt::format("{}:{}:{}", location.file, location.line, location.column);
}

}  // namespace aerosol::scene
