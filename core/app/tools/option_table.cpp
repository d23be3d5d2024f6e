#include "core/app/tools/option_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/base/diagnostic.h"
#include "core/scene/value.h"

namespace aerosol::app {

namespace {

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::size_t countWords(std::string_view text) {
  return text.empty() ? 0 : static_cast<std::size_t>(std::ranges::count(text, ' ')) + 1;
}

std::string dashed(const std::string& name) { return (name.size() > 2 ? "--" : "-") + name; }

using Names = std::map<std::string, const OptionRow*, std::less<>>;

std::string unknownOption(const std::string& word, const Names& names) {
  std::vector<std::string> known;
  for (const auto& [name, row] : names) known.push_back(dashed(name));
  const std::string near = didYouMean(word, known);
  return fmt::format("unknown option '{}'{}", word, near.empty() ? "" : "\n  note: " + near);
}

/// The word without its dashes, and the modifiers behind it.
std::string nameOf(const std::string& word, OptionUse& use) {
  std::vector<std::string> parts = split(std::string_view(word).substr(word.starts_with("--") ? 2 : 1), ':');
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::size_t equals = std::min(parts[i].find('='), parts[i].size());
    use.modifiers.emplace_back(parts[i].substr(0, equals), parts[i].substr(std::min(equals + 1, parts[i].size())));
  }
  return parts[0];
}

}  // namespace

std::optional<std::string> readOptions(const std::vector<std::string>& words, const std::vector<OptionRow>& rows,
                                       const std::function<std::optional<std::string>(const std::string&)>& takeWord) {
  Names names;
  for (const OptionRow& row : rows) {
    for (const std::string& name : split(row.names, ',')) names[name] = &row;
  }
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word.size() < 2 || word[0] != '-') {
      if (auto problem = takeWord(word)) return problem;
      continue;
    }
    OptionUse use;
    use.spelling = word;
    const auto found = names.find(nameOf(word, use));
    if (found == names.end()) return unknownOption(word, names);
    const std::size_t wanted = countWords(found->second->valueNames);
    if (words.size() - i - 1 < wanted) return fmt::format("{} needs {}", word, found->second->valueNames);
    use.values.assign(words.begin() + static_cast<std::ptrdiff_t>(i + 1),
                      words.begin() + static_cast<std::ptrdiff_t>(i + 1 + wanted));
    i += wanted;
    if (auto problem = found->second->take(use)) return word + ": " + *problem;
  }
  return {};
}

std::string optionHelp(const std::vector<OptionRow>& rows) {
  std::string text;
  for (const OptionRow& row : rows) {
    if (row.help.empty()) continue;
    const std::string name = dashed(row.names.substr(0, row.names.find(',')));
    text += fmt::format("  {:<34} {}\n", row.valueNames.empty() ? name : name + " " + row.valueNames, row.help);
  }
  return text;
}

TakeOption setFlag(bool& target, bool value) {
  return [&target, value](const OptionUse&) -> std::optional<std::string> {
    target = value;
    return {};
  };
}

TakeOption setText(std::string& target) {
  return [&target](const OptionUse& use) -> std::optional<std::string> {
    target = use.value();
    return {};
  };
}

TakeOption addText(std::vector<std::string>& target) {
  return [&target](const OptionUse& use) -> std::optional<std::string> {
    target.push_back(use.value());
    return {};
  };
}

namespace {

std::optional<std::string> readInteger(const std::string& text, int minimum, int& target) {
  scene::TextError error;
  const std::optional<int> value = scene::parseInteger(text, error);
  if (!value) return fmt::format("'{}' is not an integer", text);
  if (*value < minimum) return fmt::format("must be at least {}, not {}", minimum, *value);
  target = *value;
  return {};
}

std::optional<std::string> readFloat(const std::string& text, float& target) {
  scene::TextError error;
  const std::optional<float> value = scene::parseFloat(text, error);
  if (!value) return fmt::format("'{}' is not a number", text);
  target = *value;
  return {};
}

}  // namespace

TakeOption setInteger(int& target, int minimum) {
  return [&target, minimum](const OptionUse& use) { return readInteger(use.value(), minimum, target); };
}

TakeOption setIntegers(int& first, int& second, int minimum) {
  return [&first, &second, minimum](const OptionUse& use) {
    auto problem = readInteger(use.values[0], minimum, first);
    return problem ? problem : readInteger(use.values[1], minimum, second);
  };
}

TakeOption setFloats(float& first, float& second) {
  return [&first, &second](const OptionUse& use) {
    auto problem = readFloat(use.values[0], first);
    return problem ? problem : readFloat(use.values[1], second);
  };
}

}  // namespace aerosol::app
