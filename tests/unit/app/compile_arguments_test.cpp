#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/app/tools/compile_tool.h"

namespace aerosol::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

CompileArguments parsed(const std::vector<std::string>& words) {
  auto result = parseCompileArguments(words);
  if (const Reply* reply = std::get_if<Reply>(&result)) {
    ADD_FAILURE() << reply->text;
    return {};
  }
  return std::get<CompileArguments>(result);
}

std::string refusal(const std::vector<std::string>& words) {
  const auto result = parseCompileArguments(words);
  const Reply* const reply = std::get_if<Reply>(&result);
  return reply ? reply->text : "accepted";
}

TEST(CompileArguments, ValuesMayBeAttached) {
  const CompileArguments compile = parsed({"-Ione", "-I", "two", "-DA", "-D", "B=2", "-o", "-Dx.oso", "a.osl"});
  EXPECT_THAT(compile.kernels.shaderPath, ElementsAre("one", "two"));
  EXPECT_THAT(compile.defines, ElementsAre("A", "B=2"));
  EXPECT_EQ(compile.outputFile, "-Dx.oso");
}

TEST(CompileArguments, RemovedMacrosAreNotDefinedBefore) {
  const CompileArguments compile = parsed({"-DA=1", "-DB", "-UA", "-DC(x)=x", "a.osl"});
  EXPECT_THAT(compile.defines, ElementsAre("B", "C(x)=x"));
  EXPECT_THAT(compile.undefines, ElementsAre("A"));
}

TEST(CompileArguments, Dependencies) {
  const CompileArguments compile = parsed({"-MMD", "-MFrule.d", "-MT", "all", "a.osl"});
  EXPECT_TRUE(compile.dependencies.wanted);
  EXPECT_FALSE(compile.dependencies.alone);
  EXPECT_FALSE(compile.dependencies.standardLibrary);
  EXPECT_EQ(compile.dependencies.file, "rule.d");
  EXPECT_EQ(compile.dependencies.target, "all");
  EXPECT_TRUE(parsed({"-M", "a.osl"}).dependencies.standardLibrary);
}

TEST(CompileArguments, RefusesWhatCannotBe) {
  EXPECT_THAT(refusal({}), HasSubstr("no shader is given"));
  EXPECT_THAT(refusal({"-o", "x.oso", "a.osl", "b.osl"}), HasSubstr("several shaders"));
  EXPECT_THAT(refusal({"-Wnone", "a.osl"}), HasSubstr("unknown option '-Wnone'"));
  EXPECT_THAT(refusal({"--width", "3", "a.osl"}), HasSubstr("'3' is not one of 16, 8, 4, 1"));
  EXPECT_THAT(parsed({"-O2", "-d", "a.osl"}).ignored, ElementsAre("-O2", "-d"));
}

}  // namespace
}  // namespace aerosol::app
