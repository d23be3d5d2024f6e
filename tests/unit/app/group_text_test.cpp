#include "core/app/tools/group_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aerosol::app {
namespace {

using testing::HasSubstr;
using Floats = std::vector<float>;
using Texts = std::vector<std::string>;

constexpr const char* rings = R"(
param string name "rings.tx" ;      # set pending 'name'
param float scale 3.5 ;
shader "texturemap" "tex1" ;
param color woodcolor 0.42 0.38 0.22 [[ int interpolated=1, int interactive = 0 ]] ;
float[] weights 1 2 3 4 ;
shader wood wood1 ; connect tex1.Cout wood1.rings.a ;
)";

GroupText parsed(const std::string& text) {
  auto group = parseGroupText(text, "g");
  EXPECT_TRUE(group) << format(group.errors());
  return group ? *group : GroupText{};
}

void expectRings(const GroupText& group) {
  ASSERT_EQ(group.layers.size(), 2u);
  EXPECT_EQ(group.layers[0].shader, "texturemap");
  EXPECT_EQ(group.layers[0].layer, "tex1");
  ASSERT_EQ(group.layers[0].values.size(), 2u);
  EXPECT_EQ(std::get<Texts>(group.layers[0].values[0].value.value), Texts{"rings.tx"});
  ASSERT_EQ(group.layers[1].values.size(), 2u);
  EXPECT_EQ(group.layers[1].values[0].value.type, lang::types::color);
  EXPECT_TRUE(group.layers[1].values[0].interpolated);
  EXPECT_EQ(group.layers[1].values[1].value.type, lang::types::floating.arrayOf(4));
  EXPECT_EQ(std::get<Floats>(group.layers[1].values[1].value.value), (Floats{1, 2, 3, 4}));
  ASSERT_EQ(group.connections.size(), 1u);
  EXPECT_EQ(group.connections[0].fromLayer, "tex1");
  EXPECT_EQ(group.connections[0].fromOutput, "Cout");
  EXPECT_EQ(group.connections[0].toLayer, "wood1");
  EXPECT_EQ(group.connections[0].toInput, "rings.a");
}

TEST(GroupText, ReadsParametersShadersAndConnections) { expectRings(parsed(rings)); }

TEST(GroupText, PrintsWhatReadsBackTheSame) {
  const GroupText group = parsed(rings);
  expectRings(parsed(printGroupText(group.layers, group.connections)));
}

TEST(GroupText, MissingValuesAreZero) {
  const GroupText group = parsed("param color c 1 ; param string[2] s \"a;b\" ; shader x y ;");
  EXPECT_EQ(std::get<Floats>(group.layers[0].values[0].value.value), (Floats{1, 0, 0}));
  EXPECT_EQ(std::get<Texts>(group.layers[0].values[1].value.value), (Texts{"a;b", ""}));
}

TEST(GroupText, MistakesHavePlaces) {
  const auto mistake = [](const std::string& text) {
    const auto group = parseGroupText(text, "g");
    return group ? "accepted" : format(group.errors());
  };
  EXPECT_THAT(mistake("shader a b ;\n  shadr c d ;"), HasSubstr("g:2:3: error: unknown statement 'shadr'"));
  EXPECT_THAT(mistake("param flot x 1 ;"), HasSubstr("g:1:7: error: 'flot' is not a type"));
  EXPECT_THAT(mistake("param int x 1.5 ;"), HasSubstr("not values of type int"));
  EXPECT_THAT(mistake("shader a b c ;"), HasSubstr("expected ';', found 'c'"));
  EXPECT_THAT(mistake("connect a b.c ;"), HasSubstr("expected layer.parameter"));
  EXPECT_THAT(mistake("param int x 1 ;"), HasSubstr("without a shader"));
}

}  // namespace
}  // namespace aerosol::app
