#include "core/app/shader_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace aerosol::app {

namespace {

const lang::MetadataValue* find(const std::vector<lang::MetadataValue>& metadata, std::string_view name) {
  const auto found = std::find_if(metadata.begin(), metadata.end(), [&](const auto& m) { return m.name == name; });
  return found == metadata.end() ? nullptr : &*found;
}

/// Empty when there is no such entry.
std::string textOf(const std::vector<lang::MetadataValue>& metadata, std::string_view name) {
  const lang::MetadataValue* const entry = find(metadata, name);
  return entry ? formatConstant(entry->value) : "";
}

/// What is possible, and how far a slider would usually go.
std::string rangeOf(const lang::Parameter& parameter) {
  const std::string low = textOf(parameter.metadata, "min"), high = textOf(parameter.metadata, "max");
  const std::string usual = textOf(parameter.metadata, "UImax");
  if (low.empty() && high.empty()) return usual.empty() ? "" : ", usually up to " + usual;
  if (high.empty()) return ", at least " + low + (usual.empty() ? "" : ", usually up to " + usual);
  if (low.empty()) return ", at most " + high;
  return fmt::format(", {} to {}", low, high);
}

std::string describe(const lang::Parameter& parameter) {
  std::string text = textOf(parameter.metadata, "label");
  const std::string help = textOf(parameter.metadata, "help");
  if (!help.empty()) text += (text.empty() ? "" : ": ") + help;
  const std::string unit = textOf(parameter.metadata, "unit");
  const std::string initial = parameter.hasConstantDefault ? formatConstant(parameter.defaultValue) : "computed";
  return fmt::format("{}{}({}{}{}; default: {})", text, text.empty() ? "" : " ", lang::toString(parameter.type),
                     unit.empty() ? "" : ", " + unit, rangeOf(parameter), initial.empty() ? "\"\"" : initial);
}

}  // namespace

std::string formatConstant(const lang::ConstantValue& value) {
  if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&value))
    return fmt::format("{}", fmt::join(*ints, ", "));
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value))
    return fmt::format("{}", fmt::join(*texts, ", "));
  const auto* floats = std::get_if<std::vector<float>>(&value);
  return floats ? fmt::format("{}", fmt::join(*floats, ", ")) : "";
}

std::string shaderPage(const lang::Program& program) {
  std::string text = fmt::format("{} {}", program.kind, program.name);
  const std::string help = textOf(program.metadata, "help");
  text += help.empty() ? "\n" : "  " + help + "\n";
  std::size_t width = 0;
  for (const lang::Parameter& parameter : program.parameters) width = std::max(width, parameter.name.size());
  for (const lang::Parameter& parameter : program.parameters) {
    if (!parameter.isOutput) text += fmt::format("  {:{}}  {}\n", parameter.name, width, describe(parameter));
  }
  return text;
}

}  // namespace aerosol::app
