// A language test is a shader with its expectations in comments, a file for each function or feature:
//
//   // at P = 1 2 3; u = 0.5            a point to run it at (globals not named are zero; without any: one such point)
//   // with name = 1 2 3                the instance's value of a parameter
//   // space name = 16 numbers          a named space: its matrix to "common", row vectors
//   // expect name = 1 2 3 +- 1e-6      value of an output at the point above; without +-: equal, NaN to "nan"
//   // message print: text              the messages at the point above are these, in order (none: there are none)
//   // attribute object name = type: 1 2 3   what getattribute finds; objects: "global", "own" (the point's), any other
//   // userdata name = type: 1 2 3   what the geometry carries at the point above
//   // raytypes = 5                  bits of the ray's kinds, at the point above; also: backfacing, surfacearea
//   // runtime only                     calls functions whose values come from the run-time library alone (noise)
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "core/lang/program.h"

namespace aerosol::testing {

struct LanguageExpectation {
  std::string name;
  lang::ConstantValue value;  ///< Numbers are floats here, whatever the output is.
  float tolerance = 0;
  int line = 0;
};

/// A value with its type.
struct LanguageValue {
  lang::Type type;
  lang::ConstantValue value;
};

struct LanguagePoint {
  std::map<std::string, std::vector<float>> globals;
  std::map<std::string, LanguageValue> userData;
  float rayTypes = 0, backfacing = 0, surfaceArea = 0;
  std::vector<LanguageExpectation> expectations;
  std::vector<std::string> messages;
};

struct LanguageCase {
  std::map<std::string, lang::ConstantValue> parameters;  ///< Numbers are floats here.
  std::map<std::string, std::array<float, 16>> spaces;
  std::map<std::string, std::map<std::string, LanguageValue>> attributes;  ///< By object, then by name.
  std::vector<LanguagePoint> points;
  bool runtimeOnly = false;
  std::string error;  ///< What is wrong with the file's own comments.
};

/// Numbers, or strings in quotes.
inline lang::ConstantValue readLanguageValue(const std::string& text) {
  std::istringstream in(text);
  std::vector<float> numbers;
  std::vector<std::string> strings;
  for (std::string word; in >> std::ws && !in.eof();) {
    if (in.peek() == '"') {
      in.get();
      std::getline(in, word, '"');
      strings.push_back(word);
    } else {
      in >> word;
      numbers.push_back(std::stof(word));
    }
  }
  if (!strings.empty()) return strings;
  return numbers;
}

/// `type: values`; an array's length is that of the values.
inline LanguageValue readTypedValue(const std::string& text) {
  static const std::map<std::string, lang::Type> types = {
      {"int", lang::types::integer},   {"float", lang::types::floating}, {"string", lang::types::string},
      {"color", lang::types::color},   {"point", lang::types::point},    {"vector", lang::types::vector},
      {"normal", lang::types::normal}, {"matrix", lang::types::matrix}};
  const std::size_t colon = text.find(": ");
  std::string name = text.substr(0, colon);
  const std::size_t bracket = name.find('[');
  LanguageValue result{types.at(name.substr(0, bracket)), readLanguageValue(text.substr(colon + 2))};
  if (bracket != std::string::npos) result.type = result.type.arrayOf(std::stoi(name.substr(bracket + 1)));
  if (const auto* floats = std::get_if<std::vector<float>>(&result.value);
      floats && result.type.base == lang::BaseType::integer)
    result.value = std::vector<std::int32_t>(floats->begin(), floats->end());
  return result;
}

inline LanguageCase readLanguageCase(const std::filesystem::path& path) {
  LanguageCase result;
  std::ifstream file(path);
  int number = 0;
  bool explicitPoints = false;
  result.points.emplace_back();
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.rfind("// ", 0) != 0) continue;
    std::istringstream in(line.substr(3));
    std::string word;
    in >> word;
    std::string rest;
    std::getline(in >> std::ws, rest);
    const std::size_t equals = rest.find(" = ");
    const auto key = [&] { return rest.substr(0, equals); };
    const auto value = [&] { return rest.substr(equals + 3); };
    if (word == "runtime" && rest == "only") result.runtimeOnly = true;
    if (word == "message") result.points.back().messages.push_back(rest);
    if (word == "at") {
      if (explicitPoints) result.points.emplace_back();
      explicitPoints = true;
      std::istringstream parts(rest);
      for (std::string part; std::getline(parts >> std::ws, part, ';');) {
        const std::size_t at = part.find(" = ");
        result.points.back().globals[part.substr(0, at)] =
            std::get<std::vector<float>>(readLanguageValue(part.substr(at + 3)));
      }
    }
    if (word == "raytypes") result.points.back().rayTypes = std::stof(rest.substr(2));
    if (word == "backfacing") result.points.back().backfacing = std::stof(rest.substr(2));
    if (word == "surfacearea") result.points.back().surfaceArea = std::stof(rest.substr(2));
    if (word == "userdata") result.points.back().userData[key()] = readTypedValue(value());
    if (word == "attribute") {
      const std::size_t space = rest.find(' ');
      result.attributes[rest.substr(0, space)][rest.substr(space + 1, equals - space - 1)] = readTypedValue(value());
    }
    if (word != "with" && word != "space" && word != "expect") continue;
    if (equals == std::string::npos) {
      result.error = "line " + std::to_string(number) + " has no '='";
      return result;
    }
    if (word == "with") result.parameters[key()] = readLanguageValue(value());
    if (word == "space") {
      const auto numbers = std::get<std::vector<float>>(readLanguageValue(value()));
      std::copy_n(numbers.begin(), 16, result.spaces[key()].begin());
    }
    if (word == "expect") {
      LanguageExpectation expectation;
      std::string text = value();
      if (const std::size_t tolerance = text.find(" +- "); tolerance != std::string::npos) {
        expectation.tolerance = std::stof(text.substr(tolerance + 4));
        text.resize(tolerance);
      }
      expectation.name = key();
      expectation.value = readLanguageValue(text);
      expectation.line = number;
      result.points.back().expectations.push_back(std::move(expectation));
    }
  }
  return result;
}

/// All *.osl files of a folder, by name.
inline std::vector<std::filesystem::path> languageFiles(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".osl") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace aerosol::testing
