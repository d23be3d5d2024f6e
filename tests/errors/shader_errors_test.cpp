// One bad shader a file: `NAME.osl` states in comments exactly the messages that it has to give, in their order:
//
//   // expect 3:14: part of the error's text
//   // expect include/file.inc:3:14: part of the text, for an error in a file that it includes
//   // warn 3:14: part of the warning's text
//
// Every message has to carry the source line that it points into.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "core/lang/compile.h"

namespace aerosol::lang {
namespace {

namespace fs = std::filesystem;

struct Expected {
  Severity severity = Severity::error;
  SourceLocation location;
  std::string text;
};

const fs::path& folder() {
  static const fs::path path = fs::path(AEROSOL_SOURCE_DIR) / "tests/errors/shader";
  return path;
}

std::vector<std::string> cases() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder())) {
    if (entry.path().extension() == ".osl") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> linesOf(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Takes a number and the colon behind it off the text; 0 when there is none.
int takeNumber(std::string_view& text) {
  int number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc() || end == text.data() + text.size() || *end != ':') return 0;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()) + 1);
  return number;
}

/// `[file:]line:column: text`
Expected readExpectation(std::string_view text, const fs::path& shader) {
  Expected result;
  result.location.file = shader.string();
  if (text.empty() || text[0] < '0' || text[0] > '9') {
    const std::size_t colon = text.find(':');
    EXPECT_NE(colon, std::string_view::npos) << text;
    result.location.file = (folder() / text.substr(0, colon)).string();
    text.remove_prefix(std::min(colon + 1, text.size()));
  }
  result.location.line = takeNumber(text);
  result.location.column = takeNumber(text);
  EXPECT_TRUE(result.location.line > 0 && result.location.column > 0)
      << "an expectation without line and column: " << text;
  result.text = std::string(text.substr(std::min(text.find_first_not_of(' '), text.size())));
  EXPECT_FALSE(result.text.empty());
  return result;
}

std::vector<Expected> expectationsOf(const fs::path& shader) {
  std::vector<Expected> list;
  for (const std::string& line : linesOf(shader)) {
    for (const auto& [mark, severity] :
         {std::pair{"// expect ", Severity::error}, std::pair{"// warn ", Severity::warning}}) {
      const std::size_t at = line.find(mark);
      if (at == std::string::npos) continue;
      list.push_back(readExpectation(std::string_view(line).substr(at + std::string_view(mark).size()), shader));
      list.back().severity = severity;
    }
  }
  return list;
}

/// The text of the place's line, without its line end.
std::string lineAt(const SourceLocation& location) {
  const auto lines = linesOf(location.file);
  if (location.line < 1 || static_cast<std::size_t>(location.line) > lines.size()) return {};
  std::string line = lines[static_cast<std::size_t>(location.line) - 1];
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

std::string text(const SourceLocation& location) {
  return fmt::format("{}:{}:{}", location.file, location.line, location.column);
}

class ShaderErrors : public testing::TestWithParam<std::string> {};

TEST_P(ShaderErrors, GiveTheExpectedMessages) {
  const fs::path shader = folder() / (GetParam() + ".osl");
  const std::vector<Expected> expected = expectationsOf(shader);
  ASSERT_TRUE(std::any_of(expected.begin(), expected.end(), [](const Expected& e) {
    return e.severity == Severity::error;
  })) << "the file expects no error";
  CompileOptions options;
  options.standardLibrary = fs::path(AEROSOL_SOURCE_DIR) / "shaders/stdosl.h";
  const auto result = compileFile(shader, options);
  ASSERT_FALSE(result) << "the shader compiles";
  const auto& entries = result.errors().entries();
  for (std::size_t i = 0; i < std::min(entries.size(), expected.size()); ++i) {
    EXPECT_EQ(entries[i].severity, expected[i].severity) << format(entries[i]);
    EXPECT_EQ(text(entries[i].location), text(expected[i].location)) << format(entries[i]);
    EXPECT_NE(entries[i].message.find(expected[i].text), std::string::npos)
        << format(entries[i]) << "is expected to say: " << expected[i].text;
    EXPECT_EQ(entries[i].sourceLine, lineAt(entries[i].location));
    EXPECT_LE(entries[i].location.column, static_cast<int>(entries[i].sourceLine.size()) + 1);
  }
  EXPECT_EQ(entries.size(), expected.size()) << format(result.errors());
}

INSTANTIATE_TEST_SUITE_P(All, ShaderErrors, testing::ValuesIn(cases()), [](const auto& info) { return info.param; });

}  // namespace
}  // namespace aerosol::lang
