#include "core/app/tools/shade_arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aerosol::app {
namespace {

using testing::HasSubstr;

ShadeArguments parsed(const std::vector<std::string>& words) {
  auto result = parseShadeArguments(words);
  if (const Reply* reply = std::get_if<Reply>(&result)) {
    ADD_FAILURE() << reply->text;
    return {};
  }
  return std::get<ShadeArguments>(result);
}

std::string refusal(const std::vector<std::string>& words) {
  const auto result = parseShadeArguments(words);
  const Reply* const reply = std::get_if<Reply>(&result);
  return reply ? reply->text : "accepted";
}

TEST(ShadeArguments, ParametersBelongToTheNextShader) {
  const ShadeArguments shade = parsed(
      {"--param",  "a",   "1",      "-param:type=color", "b",     "1,0,0", "one",       "--param", "c",   "x",
       "--shader", "two", "second", "--layer",           "third", "three", "--connect", "one_0",   "out", "second",
       "in"});
  ASSERT_EQ(shade.layers.size(), 3u);
  EXPECT_EQ(shade.layers[0].shader, "one");
  EXPECT_EQ(shade.layers[0].layer, "");
  ASSERT_EQ(shade.layers[0].values.size(), 2u);
  EXPECT_EQ(shade.layers[0].values[1].name, "b");
  EXPECT_EQ(shade.layers[0].values[1].value.type, lang::types::color);
  ASSERT_EQ(shade.layers[1].values.size(), 1u);
  EXPECT_EQ(shade.layers[1].layer, "second");
  EXPECT_EQ(shade.layers[2].layer, "third");
  EXPECT_TRUE(shade.layers[2].values.empty());
  ASSERT_EQ(shade.connections.size(), 1u);
  EXPECT_EQ(shade.connections[0].toInput, "in");
}

TEST(ShadeArguments, ModifiersOfParameters) {
  const ShadeArguments shade = parsed({"--param:lockgeom=0", "a", "1", "--param:interpolated=1:type=float[2]", "b",
                                       "1,2", "--param:interactive=1", "c", "1", "x"});
  EXPECT_TRUE(shade.layers[0].values[0].interpolated);
  EXPECT_TRUE(shade.layers[0].values[1].interpolated);
  EXPECT_FALSE(shade.layers[0].values[2].interpolated);
  EXPECT_TRUE(shade.layers[0].values[2].interactive);
}

TEST(ShadeArguments, OldAndNewNames) {
  for (const char* name : {"-g", "--res", "-res"}) {
    const ShadeArguments shade = parsed({name, "8", "4", "x"});
    EXPECT_EQ(shade.grid.width, 8);
    EXPECT_EQ(shade.grid.height, 4);
  }
  EXPECT_EQ(parsed({"--scalest", "2", "3", "x"}).grid.vScale, 3);
  EXPECT_EQ(parsed({"-od", "half", "x"}).dataFormat, "half");
}

TEST(ShadeArguments, RefusesWhatCannotBe) {
  EXPECT_THAT(refusal({}), HasSubstr("no shader"));
  EXPECT_THAT(refusal({"x", "--param", "a", "1"}), HasSubstr("without a shader behind them: a"));
  EXPECT_THAT(refusal({"--param:type=flot", "a", "1", "x"}), HasSubstr("'flot' is not a type"));
  EXPECT_THAT(refusal({"--param:typ=float", "a", "1", "x"}), HasSubstr("no modifier 'typ'"));
  EXPECT_THAT(refusal({"--param:type=int", "a", "1.5", "x"}), HasSubstr("not a value of type int"));
  EXPECT_THAT(refusal({"-g", "8"}), HasSubstr("-g needs XRES YRES"));
  EXPECT_THAT(refusal({"-g", "0", "1", "x"}), HasSubstr("at least 1"));
  EXPECT_THAT(refusal({"--conect", "x"}), HasSubstr("'--connect'"));
  EXPECT_THAT(refusal({"--group", "g", "x"}), HasSubstr("exclude each other"));
}

TEST(ShadeArguments, RemembersWhatMeansNothing) {
  EXPECT_THAT(parsed({"-O2", "--llvm_opt", "3", "--options", "searchpath:shader=lib,lazylayers=0", "x"}).ignored,
              testing::ElementsAre("-O2", "--llvm_opt", "--options lazylayers=0"));
}

}  // namespace
}  // namespace aerosol::app
