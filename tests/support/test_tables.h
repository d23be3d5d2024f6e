// Tables in files of text that name the tests which hold something.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace aerosol::test {

inline std::string contentOf(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// "Suite.Name" of every test in the sources.
inline std::set<std::string> testsInSources() {
  static const std::regex definition(R"((?:^|\n)(?:TEST|TEST_F|TEST_P|TYPED_TEST)\(\s*(\w+),\s*(\w+)\s*\))");
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(AEROSOL_SOURCE_DIR "/tests")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string text = contentOf(entry.path());
    for (std::sregex_iterator at(text.begin(), text.end(), definition), end; at != end; ++at) {
      names.insert((*at)[1].str() + "." + (*at)[2].str());
    }
  }
  return names;
}

/// Of a table whose rows begin with a name in the first column: the words of the last one.
inline std::map<std::string, std::vector<std::string>> tableOfTests(const std::filesystem::path& file) {
  static const std::regex row(R"(^\| ([\w-]+) \|(?:.*\|)? ([^|]*) \|$)");
  std::map<std::string, std::vector<std::string>> rows;
  std::istringstream lines(contentOf(file));
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, row) || match[1] == "effect" || match[1].str().find("--") == 0) continue;
    std::istringstream words(match[2].str());
    rows[match[1]] = {std::istream_iterator<std::string>(words), {}};
  }
  return rows;
}

}  // namespace aerosol::test
