#include "core/scene/xml_reader.h"

#include <gtest/gtest.h>

namespace aerosol::scene {
namespace {

/// The bytes of the text from an attribute's value on must be the value.
void expectExact(const std::string& text, const XmlElement& element) {
  EXPECT_EQ(text[element.offset], '<');
  EXPECT_EQ(text.substr(element.offset + 1, element.tag.size()), element.tag);
  for (const XmlAttribute& a : element.attributes) {
    EXPECT_EQ(text.substr(a.nameOffset, a.name.size()), a.name);
    if (a.exact) EXPECT_EQ(text.substr(a.valueOffset, a.value.size()), a.value);
  }
  for (const XmlElement& child : element.children) expectExact(text, child);
}

TEST(ReadXml, KeepsTheOffsetsOfEverything) {
  const std::string text =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\r\n<!DOCTYPE scene>\n<!-- <a b=\"c\"> -->\n"
      "<scene version='3.0.0'\n\t  id = \"x>y\" >\r\n  <a\n b='\"'\n/><c d=\"é ß\" e=''><f/></c>\n</scene>\n";
  const SourceText source("a.xml", text, {});
  Reporter reporter;
  const auto root = readXml(source, reporter);
  ASSERT_TRUE(root) << format(reporter.errors());
  EXPECT_FALSE(reporter.failed());
  EXPECT_EQ(root->tag, "scene");
  ASSERT_EQ(root->attributes.size(), 2u);
  EXPECT_EQ(root->attributes[1].value, "x>y");
  ASSERT_EQ(root->children.size(), 2u);
  EXPECT_EQ(root->children[1].attributes[1].value, "");
  EXPECT_EQ(root->children[1].children[0].tag, "f");
  expectExact(text, *root);
}

TEST(ReadXml, ReplacedEntitiesAreNotExact) {
  const std::string text = "<a b=\"1 &lt; 2\" c=\"3\"/>";
  const SourceText source("a.xml", text, {});
  Reporter reporter;
  const auto root = readXml(source, reporter);
  ASSERT_TRUE(root);
  EXPECT_EQ(root->attributes[0].value, "1 < 2");
  EXPECT_FALSE(root->attributes[0].exact);
  EXPECT_TRUE(root->attributes[1].exact);
  expectExact(text, *root);
}

TEST(ReadXml, AByteOrderMarkDoesNotShiftPlaces) {
  const std::string text = "\xEF\xBB\xBF<scene version=\"3\"><b c=\"d\"/></scene>";
  const SourceText source("a.xml", text, {});
  Reporter reporter;
  const auto root = readXml(source, reporter);
  ASSERT_TRUE(root) << format(reporter.errors());
  expectExact(text, *root);
}

TEST(ReadXml, RefusesOtherEncodings) {
  const SourceText source("a.xml", std::string("\xFF\xFE<\0s\0/\0>\0", 10), {});
  Reporter reporter;
  EXPECT_FALSE(readXml(source, reporter));
  EXPECT_EQ(reporter.errors().entries()[0].location, (SourceLocation{"a.xml", 1, 1}));
}

TEST(ReadXml, SurvivesDeepNesting) {
  std::string text;
  for (int i = 0; i < 200000; ++i) text += "<a>";
  for (int i = 0; i < 200000; ++i) text += "</a>";
  const SourceText source("a.xml", text, {});
  Reporter reporter;
  EXPECT_TRUE(readXml(source, reporter));
  ASSERT_EQ(reporter.errorCount(), 1);
  EXPECT_EQ(reporter.errors().entries()[0].location.column, 3 * nestingLimit + 1);
}

TEST(ReadXml, SurvivesDeepNestingThatNeverEnds) {
  std::string text;
  for (int i = 0; i < 200000; ++i) text += "<a>";
  const SourceText source("a.xml", text, {});
  Reporter reporter;
  EXPECT_FALSE(readXml(source, reporter));
  EXPECT_EQ(reporter.errors().entries()[0].message, "<a> is never closed: </a> is missing");
}

}  // namespace
}  // namespace aerosol::scene
