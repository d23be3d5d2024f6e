// One bad scene a file: `NAME.xml` has to give exactly the messages in `NAME.expected`, places, source lines, carets
// and notes included. `NAME.options` holds command-line options, one a line: `-D name=value`, `--set assignment` or
// `--sensor which`.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "core/scene/loader.h"

namespace aerosol::scene {
namespace {

const std::filesystem::path& folder() {
  static const std::filesystem::path path = std::filesystem::path(AEROSOL_SOURCE_DIR) / "tests/errors/scene";
  return path;
}

std::vector<std::string> cases() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder())) {
    if (entry.path().extension() == ".xml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string contents(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

LoadOptions readOptions(const std::filesystem::path& path) {
  LoadOptions options;
  std::istringstream stream(contents(path));
  for (std::string line; std::getline(stream, line);) {
    const std::size_t equals = line.find('=');
    if (line.starts_with("-D ")) options.defines[line.substr(3, equals - 3)] = line.substr(equals + 1);
    if (line.starts_with("--sensor ")) options.sensor = line.substr(9);
    if (line.starts_with("--set ")) options.overrides.push_back(line.substr(6));
  }
  return options;
}

/// Messages without the folder, so that they are the same wherever the sources lie.
std::string withoutFolder(std::string text) {
  const std::string prefix = folder().string() + "/";
  for (std::size_t at = 0; (at = text.find(prefix, at)) != std::string::npos;) text.erase(at, prefix.size());
  const std::string itself = "'" + folder().string() + "'";
  for (std::size_t at = 0; (at = text.find(itself, at)) != std::string::npos;) text.replace(at, itself.size(), "'.'");
  return text;
}

class SceneErrors : public testing::TestWithParam<std::string> {};

TEST_P(SceneErrors, GiveTheExpectedMessages) {
  const std::filesystem::path base = folder() / GetParam();
  Diagnostics warnings;
  const auto scene = load(base.string() + ".xml", readOptions(base.string() + ".options"), warnings);
  ASSERT_FALSE(scene);
  const std::string messages = withoutFolder(format(scene.errors()));
  EXPECT_EQ(messages, contents(base.string() + ".expected"));
}

INSTANTIATE_TEST_SUITE_P(Files, SceneErrors, testing::ValuesIn(cases()), [](const auto& test) { return test.param; });

TEST(SceneErrorFiles, AreMany) { EXPECT_GE(cases().size(), 50u); }

TEST(SceneErrorFiles, AllLocateTheirFirstError) {
  for (const std::string& name : cases()) {
    const std::string expected = contents(folder() / (name + ".expected"));
    EXPECT_NE(expected.find(": error: "), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace aerosol::scene
