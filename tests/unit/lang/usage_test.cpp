#include "core/lang/usage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/lang/compile.h"

namespace aerosol::lang {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Warnings about the statements of a shader with outputs f and c and a parameter p, as "column: text".
std::vector<std::string> warnings(const std::string& statements, const std::string& before = "") {
  CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  options.includePaths = {AEROSOL_SOURCE_DIR "/shaders"};
  const auto compiled = compileString(
      before + "surface s(float p = 1, output float f = 0, output color c = 0)\n{" + statements + "}", "t", options);
  EXPECT_TRUE(compiled) << format(compiled.errors());
  std::vector<std::string> result;
  if (!compiled) return result;
  for (const Diagnostic& warning : compiled->warnings.entries())
    result.push_back(std::to_string(warning.location.column) + ": " + warning.message);
  return result;
}

TEST(Usage, NamesVariablesThatNothingReads) {
  EXPECT_THAT(warnings("float a;"), ElementsAre("8: variable 'a' is never used"));
  EXPECT_THAT(warnings("float a = p;"), ElementsAre("8: variable 'a' is never used"));
  EXPECT_THAT(warnings("float a; a = 1; a = p;"), ElementsAre("8: variable 'a' is set but never read"));
  EXPECT_THAT(warnings("float a[2]; a[int(p)] = 1;"), ElementsAre("8: variable 'a' is set but never read"));
  EXPECT_THAT(warnings("vector a = 0; a.x = 1; f = a.y;"), ElementsAre());
  EXPECT_THAT(warnings("float a, b; sincos(p, a, b); f = a;"), ElementsAre());
  EXPECT_THAT(warnings("f = g(1);", "float g(float unused) { float a = 2; return 1; }\n"),
              ElementsAre(HasSubstr("'a' is never used")));
  EXPECT_THAT(warnings("for (int i = 0; i < 3; ++i) f += 1;"), ElementsAre());
}

TEST(Usage, FindsReadsBeforeAnyAssignment) {
  EXPECT_THAT(warnings("float a; f = a;"), ElementsAre("15: 'a' is read before anything is assigned to it"));
  EXPECT_THAT(warnings("float a; if (p > 0) a = 1; f = a;"), ElementsAre());
  EXPECT_THAT(warnings("float a; if (p > 0) a = 1; else f = a; f += a;"),
              ElementsAre("38: 'a' is read before anything is assigned to it"));
  EXPECT_THAT(warnings("float a; for (int i = 0; i < 3; ++i) { f += a; a = i; }"), ElementsAre());
  EXPECT_THAT(warnings("float a[2]; a[0] = 1; f = a[1];"), ElementsAre());
  EXPECT_THAT(warnings("float a; f = p > 0 ? (a = 2) : a;"),
              ElementsAre("33: 'a' is read before anything is assigned to it"));
  EXPECT_THAT(warnings("float a, b; b = a++; f = b;"),
              ElementsAre("18: 'a' is read before anything is assigned to it"));
  EXPECT_THAT(warnings("float a; void set(float x) { a = x; } set(1); f = a;"), ElementsAre());
}

TEST(Usage, LeavesFunctionsAndIncludedFilesAlone) {
  EXPECT_THAT(warnings("f = p;", "float g(float x) { return x; }\n"), ElementsAre());
  EXPECT_THAT(warnings("f = p;", "#include \"color4.h\"\n"), ElementsAre());
}

TEST(Usage, TakesOptionsForWritten) {
  EXPECT_THAT(warnings("float a; f = texture(\"x\", p, p, \"alpha\", a); f += a;"), ElementsAre());
}

TEST(Usage, FindsStatementsThatAreNeverReached) {
  EXPECT_THAT(warnings("f = 1; return; f = 2; f = 3;"), ElementsAre("17: this statement is never reached"));
  EXPECT_THAT(warnings("for (int i = 0; i < 3; ++i) { if (i > p) { f = 1; continue; f = 2; } }"),
              ElementsAre("62: this statement is never reached"));
  EXPECT_THAT(warnings("if (p > 0) { f = 1; return; } else return; f = 2;"),
              ElementsAre("45: this statement is never reached"));
  EXPECT_THAT(warnings("if (p > 0) return; f = 2;"), ElementsAre());
}

TEST(Usage, FindsCommasThatDropValues) {
  EXPECT_THAT(warnings("c = (1, 2, 3);"), ElementsAre(HasSubstr("the comma drops")));
  EXPECT_THAT(warnings("vector a = (p, 1); f = a.x;"),
              ElementsAre("15: the comma drops the value before it: this is one "
                          "value, not a list"));
  EXPECT_THAT(warnings("f = noise((p, 1));"), ElementsAre(HasSubstr("the comma drops the value before it")));
  EXPECT_THAT(warnings("for (int i = 0, j = 9; i < j; ++i, --j) f = (f += 1, f * 2);"), ElementsAre());
}

TEST(Usage, IsSilentWhereAsked) { EXPECT_THAT(warnings("\n#pragma osl nowarn\nfloat a;\n"), ElementsAre()); }

TEST(Usage, TakesTimeThatGrowsWithTheSource) {
  std::string loops, ends;
  for (int i = 0; i < 100; ++i) {
    loops += "while (f < " + std::to_string(i) + ") {";
    ends += "}";
  }
  EXPECT_THAT(warnings(loops + "float a; f += a;" + ends), ElementsAre(HasSubstr("read before")));
}

}  // namespace
}  // namespace aerosol::lang
