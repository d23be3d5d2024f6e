#include "core/scene/source_text.h"

#include <gtest/gtest.h>

namespace aerosol::scene {
namespace {

TEST(SourceText, FindsLinesAndColumns) {
  const SourceText text("a.xml", "one\r\ntwo\n\nfour", {});
  EXPECT_EQ(text.at(0), (SourceLocation{"a.xml", 1, 1}));
  EXPECT_EQ(text.at(5), (SourceLocation{"a.xml", 2, 1}));
  EXPECT_EQ(text.at(7), (SourceLocation{"a.xml", 2, 3}));
  EXPECT_EQ(text.at(9), (SourceLocation{"a.xml", 3, 1}));
  EXPECT_EQ(text.at(10), (SourceLocation{"a.xml", 4, 1}));
  EXPECT_EQ(text.at(1000), (SourceLocation{"a.xml", 4, 5}));
  EXPECT_EQ(text.line(1), "one");
  EXPECT_EQ(text.line(3), "");
  EXPECT_EQ(text.line(4), "four");
  EXPECT_EQ(text.line(5), "");
  EXPECT_EQ(text.line(0), "");
}

TEST(SourceText, AnEmptyOneHasOneLine) {
  const SourceText text("a.xml", "", {});
  EXPECT_EQ(text.at(0), (SourceLocation{"a.xml", 1, 1}));
  EXPECT_EQ(text.line(1), "");
}

TEST(SourceTexts, AnnotateMessages) {
  SourceTexts texts;
  texts.add("a.xml", "one\ntw\x01o\n" + std::string(1000, 'x'), {});
  Diagnostics diagnostics;
  diagnostics.error({"a.xml", 2, 1}, "wrong");
  diagnostics.error({"b.xml", 2, 1}, "elsewhere");
  diagnostics.error({"a.xml", 3, 1}, "too long to show");
  texts.annotate(diagnostics);
  EXPECT_EQ(diagnostics.entries()[0].sourceLine, "tw?o");
  EXPECT_EQ(diagnostics.entries()[1].sourceLine, "");
  EXPECT_EQ(diagnostics.entries()[2].sourceLine, "");
}

}  // namespace
}  // namespace aerosol::scene
