#include "core/scene/definitions.h"

#include <fmt/format.h>

#include <utility>

namespace aerosol::scene {

namespace {

/// Values made of values made of values grow fast: no real one is longer than this.
constexpr std::size_t longestValue = std::size_t{1} << 20;

bool isNameStart(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool isNamePart(char c) { return isNameStart(c) || (c >= '0' && c <= '9'); }

/// The name after the `$` at `at` and where it ends; an empty name when there is none.
std::pair<std::string_view, std::size_t> nameAfterDollar(std::string_view text, std::size_t at) {
  const bool braced = at + 1 < text.size() && text[at + 1] == '{';
  const std::size_t start = at + (braced ? 2 : 1);
  std::size_t end = start;
  while (end < text.size() && isNamePart(text[end])) ++end;
  const std::string_view name = text.substr(start, end - start);
  if (!Definitions::isName(name)) return {{}, end};
  if (!braced) return {name, end};
  if (end >= text.size() || text[end] != '}') return {{}, end};
  return {name, end + 1};
}

}  // namespace

bool Definitions::isName(std::string_view name) {
  if (name.empty() || !isNameStart(name[0])) return false;
  for (const char c : name) {
    if (!isNamePart(c)) return false;
  }
  return true;
}

Definitions::Definitions(const std::map<std::string, std::string>& commandLine) {
  for (const auto& [name, value] : commandLine) definitions_[name] = {value, true, false, std::nullopt};
}

void Definitions::setDefault(const std::string& name, std::string value, const SourceLocation& location) {
  const auto [found, isNew] = definitions_.try_emplace(name);
  if (isNew) found->second.value = std::move(value);
  if (!found->second.defaultLocation) found->second.defaultLocation = location;
}

std::optional<std::string> Definitions::substitute(std::string_view text, TextError& error) {
  std::string result;
  std::size_t at = 0;
  while (at < text.size()) {
    if (text[at] != '$') {
      result += text[at++];
      continue;
    }
    if (at + 1 < text.size() && text[at + 1] == '$') {
      result += '$';
      at += 2;
      continue;
    }
    const auto [name, end] = nameAfterDollar(text, at);
    if (name.empty()) {
      error = {at, "'$' is not followed by a name: write $name or ${name}, or $$ for a dollar sign"};
      return std::nullopt;
    }
    const auto found = definitions_.find(name);
    if (found == definitions_.end()) {
      error = {at, fmt::format("'${}' is not defined", name)};
      return std::nullopt;
    }
    found->second.used = true;
    result += found->second.value;
    at = end;
    if (result.size() > longestValue) {
      error = {0, fmt::format("the value is longer than {} bytes after its names are replaced", longestValue)};
      return std::nullopt;
    }
  }
  return result;
}

std::vector<std::string> Definitions::names() const {
  std::vector<std::string> names;
  for (const auto& [name, definition] : definitions_) names.push_back(name);
  return names;
}

std::vector<std::string> Definitions::unusedFromCommandLine() const {
  std::vector<std::string> names;
  for (const auto& [name, definition] : definitions_) {
    if (definition.fromCommandLine && !definition.used) names.push_back(name);
  }
  return names;
}

std::map<std::string, SourceLocation> Definitions::unusedDefaults() const {
  std::map<std::string, SourceLocation> unused;
  for (const auto& [name, definition] : definitions_) {
    if (!definition.used && !definition.fromCommandLine && definition.defaultLocation) {
      unused[name] = *definition.defaultLocation;
    }
  }
  return unused;
}

}  // namespace aerosol::scene
