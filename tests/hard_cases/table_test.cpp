#include <gtest/gtest.h>

#include "tests/support/test_tables.h"

// The table of hard cases against the tests that there are.

namespace aerosol::test {
namespace {

struct Row {
  int number = 0;
  std::vector<std::string> words;  ///< Of the column of tests.
};

std::vector<Row> rowsOf(const std::string& table) {
  static const std::regex row(R"(^\| (\d+) \|.*\| ([^|]*) \|$)");
  std::vector<Row> rows;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, row)) continue;
    std::istringstream words(match[2].str());
    rows.push_back({std::stoi(match[1].str()), {std::istream_iterator<std::string>(words), {}}});
  }
  return rows;
}

/// What is wrong with a row; empty when nothing is.
std::string faultOf(const Row& row, const std::set<std::string>& tests) {
  if (row.words.empty()) return "has no test";
  for (const std::string& word : row.words) {
    if (!tests.contains(word)) return "names " + word + ", which is no test";
  }
  return {};
}

TEST(HardCaseTable, EveryRowHasItsTests) {
  const std::vector<Row> rows = rowsOf(contentOf(AEROSOL_SOURCE_DIR "/tests/hard_cases/cases.md"));
  const std::set<std::string> tests = testsInSources();
  ASSERT_GE(tests.size(), 300u);
  ASSERT_GE(rows.size(), 30u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].number, static_cast<int>(i) + 1);
    EXPECT_EQ(faultOf(rows[i], tests), "") << "row " << rows[i].number;
  }
}

TEST(HardCaseTable, ARowWithoutATestIsFound) {
  const std::set<std::string> tests = testsInSources();
  const auto rows = rowsOf(
      "| # | case | tests |\n| 1 | a | |\n| 2 | b | No.Such |\n| 3 | c | HardCaseTable.EveryRowHasItsTests |\n"
      "| 4 | d | HardCaseTable.EveryRowHasItsTests No.Such |\n");
  ASSERT_EQ(rows.size(), 3u) << "an empty cell is no row";
  EXPECT_NE(faultOf(rows[0], tests), "");
  EXPECT_EQ(faultOf(rows[1], tests), "");
  EXPECT_NE(faultOf(rows[2], tests), "");
  EXPECT_NE(faultOf({1, {}}, tests), "");
}

}  // namespace
}  // namespace aerosol::test
