// A language test is a shader with its expectations in comments, a file for each function or feature:
//
//   // at P = 1 2 3; u = 0.5            a point to run it at (globals not named are zero; without any: one such point)
//   // with name = 1 2 3                the instance's value of a parameter
//   // space name = 16 numbers          a named space: its matrix to "common", row vectors
//   // expect name = 1 2 3 +- 1e-6      value of an output at the point above; without +-: equal, NaN to "nan"
//   // message print: text              the messages at the point above are these, in order (none: there are none)
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

struct LanguagePoint {
  std::map<std::string, std::vector<float>> globals;
  std::vector<LanguageExpectation> expectations;
  std::vector<std::string> messages;
};

struct LanguageCase {
  std::map<std::string, lang::ConstantValue> parameters;  ///< Numbers are floats here.
  std::map<std::string, std::array<float, 16>> spaces;
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
