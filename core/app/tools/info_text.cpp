#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "core/app/tools/info_command.h"

namespace aerosol::app {

namespace {

using lang::BaseType;
using lang::ParameterInterface;

/// With the escapes of C.
std::string escaped(std::string_view text) {
  constexpr std::string_view plain = "\n\t\v\b\r\f\a\\\"", letters = "ntvbrfa\\\"";
  std::string result;
  for (const char c : text) {
    const std::size_t i = plain.find(c);
    if (i == std::string_view::npos) {
      result += c;
    } else {
      result += '\\';
      result += letters[i];
    }
  }
  return result;
}

/// " 1 2 3"
std::string numbers(const lang::ConstantValue& value) {
  std::string text;
  if (const auto* integers = std::get_if<std::vector<std::int32_t>>(&value)) {
    for (const std::int32_t x : *integers) text += fmt::format(" {}", x);
  } else if (const auto* floats = std::get_if<std::vector<float>>(&value)) {
    for (const float x : *floats) text += fmt::format(" {:g}", x);
  }
  return text;
}

std::string metadataLines(const std::vector<lang::MetadataValue>& metadata) {
  std::string text;
  for (const lang::MetadataValue& entry : metadata) {
    text += fmt::format("\t\tmetadata: {} {} ={}", lang::toString(entry.type), entry.name, numbers(entry.value));
    if (const auto* texts = std::get_if<std::vector<std::string>>(&entry.value))
      for (const std::string& each : *texts) text += fmt::format(" \"{}\"", escaped(each));
    text += '\n';
  }
  return text;
}

std::string typeOf(const ParameterInterface& parameter) {
  if (parameter.type.base != BaseType::structure) return lang::toString(parameter.type);
  lang::Type length = lang::types::integer;
  length.arrayLength = parameter.type.arrayLength;
  return "struct " + parameter.structName + lang::toString(length).substr(3);  // "int[4]" without "int"
}

std::string fieldsOf(const ParameterInterface& parameter, const lang::ShaderInterface& shader) {
  std::string text = "fields: {";
  for (const std::string& field : parameter.fields) {
    if (field != parameter.fields.front()) text += ", ";
    const auto leaf = std::ranges::find(shader.parameters, parameter.name + "." + field, &ParameterInterface::name);
    text += fmt::format("{} {}", typeOf(*leaf), field);
  }
  return text + "}\n";
}

std::string defaultOf(const ParameterInterface& parameter, bool verbose) {
  if (!parameter.defaultValue) return verbose ? "\t\tUnknown default value\n" : "nodefault\n";
  std::string text;
  if (const auto* texts = std::get_if<std::vector<std::string>>(&*parameter.defaultValue)) {
    for (const std::string& each : *texts)
      text += verbose ? fmt::format("\t\tDefault value: \"{}\"\n", each) : fmt::format("\"{}\" ", each);
    return verbose ? text : text + "\n";
  }
  const lang::Type& type = parameter.type;
  const bool isList = type.isArray() || type.isTriple() || type.base == BaseType::matrix;
  if (verbose) text += "\t\tDefault value:";
  return text + (isList ? " [" : "") + numbers(*parameter.defaultValue) + (isList ? " ]\n" : "\n");
}

std::string describe(const ParameterInterface& parameter, const lang::ShaderInterface& shader, bool verbose) {
  const char* output = parameter.isOutput ? "output " : "";
  std::string text = verbose ? fmt::format("    \"{}\" \"{}{}\"\n", parameter.name, output, typeOf(parameter))
                             : fmt::format("{}{} {} ", output, typeOf(parameter), parameter.name);
  if (parameter.type.base == BaseType::structure) {
    text += (verbose ? "\t\t" : "") + fieldsOf(parameter, shader);
  } else {
    text += defaultOf(parameter, verbose);
  }
  if (verbose) text += metadataLines(parameter.metadata);
  return text;
}

}  // namespace

std::string describeInterface(const lang::ShaderInterface& shader, const InfoStyle& style) {
  std::string text;
  if (style.parameter.empty()) {
    text = fmt::format("{} \"{}\"\n", shader.kind, shader.name);
    if (style.verbose) text += metadataLines(shader.metadata);
  }
  for (const ParameterInterface& parameter : shader.parameters) {
    if (style.parameter.empty() || style.parameter == parameter.name)
      text += describe(parameter, shader, style.verbose);
  }
  return text;
}

}  // namespace aerosol::app
