// Command lines in the manner of the OSL tools: one or two dashes, modifiers behind colons, values in separate words,
// and an order that counts.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aerosol::app {

/// An option as it stands on the command line.
struct OptionUse {
  std::string spelling;  ///< "--param:type=color"
  std::vector<std::pair<std::string, std::string>> modifiers;
  std::vector<std::string> values;

  const std::string& value() const { return values.front(); }
};

/// An option that a tool knows. `take` returns what is wrong with the values; nothing when all is well.
struct OptionRow {
  std::string names;       ///< Without dashes, the first one shown in the help: "g,res".
  std::string valueNames;  ///< As many words as the option takes values: "XRES YRES".
  std::string help;        ///< Empty: not shown.
  std::function<std::optional<std::string>(const OptionUse&)> take;
};

/// Hands each word to its row, in order; words that begin with no dash (and a dash alone) go to `takeWord`. Returns
/// what is wrong; nothing when all is well.
std::optional<std::string> readOptions(const std::vector<std::string>& words, const std::vector<OptionRow>& rows,
                                       const std::function<std::optional<std::string>(const std::string&)>& takeWord);

/// The options with their help, one a line.
std::string optionHelp(const std::vector<OptionRow>& rows);

// What `take` is for most options. The target must outlive the rows.
using TakeOption = std::function<std::optional<std::string>(const OptionUse&)>;
TakeOption setFlag(bool& target, bool value = true);
TakeOption setText(std::string& target);
TakeOption addText(std::vector<std::string>& target);
TakeOption setInteger(int& target, int minimum);
TakeOption setIntegers(int& first, int& second, int minimum);
TakeOption setFloats(float& first, float& second);

}  // namespace aerosol::app
