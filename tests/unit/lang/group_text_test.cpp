#include "core/lang/group_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aerosol::lang {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

GroupText parsed(const std::string& text) {
  const auto group = parseGroup(text, {"group.txt", 1, 1});
  EXPECT_TRUE(group) << format(group.errors());
  return group ? *group : GroupText{};
}

std::string errors(const std::string& text, const SourceLocation& start = {"group.txt", 1, 1}) {
  const auto group = parseGroup(text, start);
  EXPECT_FALSE(group);
  return group ? "" : format(group.errors());
}

template <class T>
std::vector<T> leaves(const GivenValue& value) {
  const auto* all = std::get_if<std::vector<T>>(&value.value);
  return all ? *all : std::vector<T>{};
}

TEST(GroupText, ReadsStatements) {
  const GroupText group = parsed(
      "param string name \"rings.tx\" ;   # a comment\n"
      "param float scale 3.5 ;\n"
      "shader \"texturemap\" \"tex1\" ;\n"
      "param color tint 0.42 0.38 0.22;\n"
      "shader wood wood1;\n"
      "connect tex1.Cout wood1.rings ;\n");
  ASSERT_EQ(group.layers.size(), 2u);
  EXPECT_EQ(group.layers[0].shader, "texturemap");
  EXPECT_EQ(group.layers[0].name, "tex1");
  ASSERT_EQ(group.layers[0].values.size(), 2u);
  EXPECT_THAT(leaves<std::string>(group.layers[0].values[0]), ElementsAre("rings.tx"));
  EXPECT_THAT(leaves<float>(group.layers[0].values[1]), ElementsAre(3.5f));
  EXPECT_EQ(group.layers[0].values[1].location, (SourceLocation{"group.txt", 2, 13}));
  EXPECT_EQ(group.layers[1].values[0].type, types::color);
  EXPECT_THAT(leaves<float>(group.layers[1].values[0]), ElementsAre(0.42f, 0.38f, 0.22f));
  ASSERT_EQ(group.connections.size(), 1u);
  EXPECT_EQ(group.connections[0].sourceLayer, "tex1");
  EXPECT_EQ(group.connections[0].parameter, "rings");
  EXPECT_EQ(group.connections[0].location, (SourceLocation{"group.txt", 6, 19}));
}

TEST(GroupText, CommasSeparateAndTheLastMayBeMissing) {
  const GroupText group = parsed("param int n -3, shader a x, shader b y, connect x.o[1] y.s.a");
  ASSERT_EQ(group.layers.size(), 2u);
  EXPECT_THAT(leaves<std::int32_t>(group.layers[0].values[0]), ElementsAre(-3));
  EXPECT_EQ(group.connections[0].source, "o[1]");
  EXPECT_EQ(group.connections[0].parameter, "s.a");
}

TEST(GroupText, ReadsArraysAndFillsWithZeros) {
  const GroupText group = parsed(
      "param float[4] a 1 2 ; param string [2] s \"x\" ; param color[] c 1 2 3 4 5 6 ;"
      "param point p ; param float f .5e1 ; shader x x");
  const auto& values = group.layers[0].values;
  EXPECT_THAT(leaves<float>(values[0]), ElementsAre(1, 2, 0, 0));
  EXPECT_EQ(values[1].type, types::string.arrayOf(2));
  EXPECT_THAT(leaves<std::string>(values[1]), ElementsAre("x", ""));
  EXPECT_EQ(values[2].type, types::color.arrayOf(2));
  EXPECT_THAT(leaves<float>(values[3]), ElementsAre(0, 0, 0));
  EXPECT_THAT(leaves<float>(values[4]), ElementsAre(5));
}

TEST(GroupText, ReadsHints) {
  const GroupText group = parsed("param float f 1 [[int lockgeom=0, string label = \"a \\\"b\\\"\"]] ; shader x x ;");
  const auto& hints = group.layers[0].values[0].hints;
  ASSERT_EQ(hints.size(), 2u);
  EXPECT_EQ(hints[0].name, "lockgeom");
  EXPECT_EQ(std::get<std::vector<std::int32_t>>(hints[0].value)[0], 0);
  EXPECT_EQ(std::get<std::vector<std::string>>(hints[1].value)[0], "a \"b\"");
}

TEST(GroupText, LayersMayHaveDotsInTheirNames) {
  const GroupText group = parsed("shader a one.two ; shader b c ; connect one.two.out.x c.in");
  EXPECT_EQ(group.connections[0].sourceLayer, "one.two");
  EXPECT_EQ(group.connections[0].source, "out.x");
}

TEST(GroupText, WritesWhatItReads) {
  const char* const text =
      "param float[3] a 1 2.5 1e-20 [[ int lockgeom = 0 ]] ;\nparam string s \"a\\n\\\"b\\\\\" ;\n"
      "shader \"x\" \"one\" ;\nparam int n -7 ;\nshader \"y\" \"two\" ;\nconnect one.o[1] two.i ;\n";
  const std::string once = format(parsed(text));
  EXPECT_EQ(once, text);
}

TEST(GroupText, ErrorsAreLocated) {
  EXPECT_EQ(errors("shader a b ;\nparm int n 1 ;\nparam integer n 1;\n"),
            "group.txt:2:1: error: 'parm' is no statement of a shader group\n  parm int n 1 ;\n  ^\n"
            "  note: statements: param, shader, connect\n"
            "group.txt:3:7: error: 'integer' is no type of a parameter\n  param integer n 1;\n        ^\n"
            "  note: types: int, float, string, color, point, vector, normal, matrix, and arrays of them\n");
  EXPECT_THAT(errors("param int n 1.5 ; shader a b"), HasSubstr("group.txt:1:13: error: '1.5' is no int"));
  EXPECT_THAT(errors("param float n x ; shader a b"), HasSubstr(":15: error: 'x' is no float"));
  EXPECT_THAT(errors("param color c 1 2 3 4 ; shader a b"), HasSubstr("too many values: a color has 3"));
  EXPECT_THAT(errors("param float[0] c 1 ; shader a b"), HasSubstr("'[0]' is no length of an array"));
  EXPECT_THAT(errors("param float[2000000000] c 1 ; shader a b"), HasSubstr("is no length of an array"));
  EXPECT_THAT(errors("param float"), HasSubstr("1:12: error: the name of a parameter is missing here"));
  EXPECT_THAT(errors("shader ;"), HasSubstr("the name of a shader is missing here"));
  EXPECT_THAT(errors("shader a b c ;"), HasSubstr("1:12: error: unexpected 'c' after the statement"));
  EXPECT_THAT(errors("shader a b ; connect a.b"), HasSubstr("the parameter to connect it to is missing here"));
  EXPECT_THAT(errors("shader a b ; connect b c.d"), HasSubstr("'b' has to be written layer.parameter"));
  EXPECT_THAT(errors("shader a \"b ;\nshader c d"), HasSubstr("1:10: error: this string does not end on its line"));
  EXPECT_THAT(errors("shader a b ; param int n 1 ;"), HasSubstr("no shader follows for the parameter 'n'"));
  EXPECT_THAT(errors("param int n 1 [[ int x ]] ; shader a b"), HasSubstr("'=' and a value are missing"));
}

TEST(GroupText, PlacesCountFromWhereTheTextStands) {
  const std::string text = errors("bad ;\n bad ;", {"scene.xml", 10, 21});
  EXPECT_THAT(text, HasSubstr("scene.xml:10:21: error"));
  EXPECT_THAT(text, HasSubstr("scene.xml:11:2: error"));
}

TEST(GroupText, ErrorsAreBounded) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += "wrong ;\n";
  const auto group = parseGroup(text, {"group.txt", 1, 1});
  ASSERT_FALSE(group);
  EXPECT_LE(group.errors().errorCount(), 100);
}

}  // namespace
}  // namespace aerosol::lang
