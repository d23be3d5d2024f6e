#include "core/lang/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/lang/builtins.h"
#include "core/lang/closures.h"
#include "core/lang/compile.h"
#include "core/lang/overload.h"
#include "core/lang/parser.h"

namespace aerosol::lang {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

CompileOptions options() {
  CompileOptions result;
  result.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  return result;
}

/// Messages of a source, as "line:column: text", and its warnings with "warning: " before the text.
std::vector<std::string> messages(const std::string& text) {
  const auto compiled = compileString(text, "test.osl", options());
  std::vector<std::string> result;
  for (const Diagnostic& entry : (compiled ? compiled->warnings : compiled.errors()).entries()) {
    const std::string kind = entry.severity == Severity::warning ? "warning: " : "";
    result.push_back(std::to_string(entry.location.line) + ":" + std::to_string(entry.location.column) + ": " + kind +
                     entry.message);
  }
  return result;
}

std::vector<std::string> notes(const std::string& text) {
  const auto compiled = compileString(text, "test.osl", options());
  return (compiled ? compiled->warnings : compiled.errors()).entries().at(0).notes;
}

TEST(Check, AcceptsACorrectShaderWithoutAWord) {
  EXPECT_THAT(messages("shader s(float a = 1, output float b = 0) { b = sin(a) * luminance(color(a)); }"),
              ElementsAre());
}

TEST(Check, PointsAtTheOffendingToken) {
  EXPECT_THAT(messages("shader s() {\n  float a = 1 +\n      foo;\n}"), ElementsAre("3:7: unknown name 'foo'"));
}

TEST(Check, SaysOneThingOnceWhenTypesAreUnknown) {
  EXPECT_THAT(messages("shader s() { float a = sin(foo + 1) * 2; int b = a2 ? foo : 1; }"),
              ElementsAre("1:28: unknown name 'foo'", "1:50: unknown name 'a2'", "1:55: unknown name 'foo'"));
}

TEST(Check, NamesTheNearest) {
  EXPECT_THAT(notes("shader s() { float a = smothstep(0, 1, 0.5); }"), ElementsAre(HasSubstr("'smoothstep'")));
  EXPECT_THAT(notes("volume s() { Ci = anisotropic_vfd(1, 1, 0); }"), ElementsAre(HasSubstr("'anisotropic_vdf'")));
  EXPECT_THAT(notes("shader s(float density = 1) { float a = denisty; }"), ElementsAre(HasSubstr("'density'")));
}

TEST(Check, ListsCandidatesWhereNoneFits) {
  EXPECT_THAT(notes("float f(float x, output int y) { return 1; }\nshader s() { float a = f(1); }"),
              ElementsAre(HasSubstr("candidate: float f(float x, output int y) at test.osl:1:7")));
}

TEST(Check, ChecksTheAuthorsFunctionsEvenWhereUnused) {
  EXPECT_THAT(messages("float f() { return foo; }\nshader s() {}"), ElementsAre("1:20: unknown name 'foo'"));
}

TEST(Check, FunctionsOfTheLibraryMayReadGlobalsThatAKindOfShaderLacks) {
  // The two-argument faceforward reads Ng, which is zero in volumes: nothing that the author wrote is told of.
  EXPECT_THAT(messages("volume s(output vector w = 0) { w = faceforward(I, I, I); }"), ElementsAre());
  EXPECT_THAT(messages("volume s(output vector w = 0) { w = faceforward(I, I); }"), ElementsAre());
  EXPECT_THAT(messages("volume s(output vector w = 0) { w = Ng; }"),
              ElementsAre(HasSubstr("1:37: warning: the shader global 'Ng'")));
}

TEST(Check, ChoosesByTheResultThatIsAskedFor) {
  const auto listing = [](const std::string& text) {
    const auto compiled =
        compileString("shader s(output color c = 0, output float f = 0) {" + text + "}", "t", options());
    return compiled ? toString(*compiled->program) : format(compiled.errors());
  };
  EXPECT_THAT(listing("f = noise(P);"), HasSubstr("uperlin_f_v"));
  EXPECT_THAT(listing("c = noise(P);"), HasSubstr("uperlin_v_v"));
  EXPECT_THAT(listing("c = 0.5 * noise(P);"), HasSubstr("uperlin_v_v"));
  EXPECT_THAT(listing("c = (color)noise(P, u);"), HasSubstr("uperlin_v_vf"));
  EXPECT_THAT(listing("c = abs(noise(u));"),
              HasSubstr("uperlin_v_f"));  // What is asked of a call goes for its arguments.
  EXPECT_THAT(listing("f = length(noise(u));"), HasSubstr("uperlin_f_f"));
  EXPECT_THAT(listing("c = rotate(P, noise(u), vector(1));"), HasSubstr("uperlin_f_f"));  // It would fit none here.
  EXPECT_THAT(listing("f = noise(u, v) > 0.5;"), HasSubstr("uperlin_f_ff"));
  EXPECT_THAT(listing("c = (vector)snoise(P);"), HasSubstr("perlin_v_v"));
}

TEST(Check, HasNoWordsForWhatThePragmaSilences) {
  EXPECT_THAT(messages("shader s(float a = 1) {\n#pragma osl nowarn\n  { float a = 2; }\n}"), ElementsAre());
  EXPECT_THAT(messages("shader s(float a = 1, output float b = 0) {\n  { float a = 2; b = a; }\n}"),
              ElementsAre(HasSubstr("warning: 'a' hides another variable")));
}

TEST(Check, AFileHasOneShader) {
  EXPECT_THAT(messages("surface a() {}\nvolume b() {}"),
              ElementsAre(HasSubstr("2:8: a file holds one shader, this is a second one")));
}

TEST(Check, SurvivesDeepNesting) {
  std::string sum = "1";
  for (int i = 0; i < 900; ++i) sum += "+u";
  EXPECT_THAT(messages("shader s(output float r = 0) { r = " + sum + "; }"), ElementsAre());
  std::string functions = "float f0(float x) { return x + u; }\n";
  for (int i = 1; i < 100; ++i)
    functions += "float f" + std::to_string(i) + "(float x) { return f" + std::to_string(i - 1) + "(x) + 1; }\n";
  EXPECT_THAT(messages(functions + "shader s(output float r = 0) { r = f99(u); }"), ElementsAre());
  for (int i = 100; i < 1000; ++i)
    functions += "float f" + std::to_string(i) + "(float x) { return f" + std::to_string(i - 1) + "(x) + 1; }\n";
  EXPECT_THAT(messages(functions + "shader s(output float r = 0) { r = f999(u); }"),
              ElementsAre(HasSubstr("functions call each other more than 128 deep")));
}

TEST(Check, StopsFunctionsThatExplodeWhenInlined) {
  std::string functions = "float f0(float x) { return 1; }\n";
  for (int i = 1; i < 100; ++i) {
    const std::string inner = "f" + std::to_string(i - 1) + "(x)";
    functions += "float f" + std::to_string(i) + "(float x) { return " + inner + " + " + inner + "; }\n";
  }
  EXPECT_THAT(messages(functions + "shader s(output float r = 0) { r = f99(1); }"),
              ElementsAre(HasSubstr("the shader is too large")));
}

TEST(Overload, ScoresAsTheLanguageDoes) {
  EXPECT_EQ(matchScore(types::floating, types::floating), 100);
  EXPECT_EQ(matchScore(types::floating, types::integer), 77);
  EXPECT_EQ(matchScore(types::integer, types::floating), 0);
  EXPECT_EQ(matchScore(types::floating.arrayOf(Type::unsized), types::floating.arrayOf(3)), 44);
  EXPECT_EQ(matchScore(types::point, types::vector), 32);
  EXPECT_EQ(matchScore(types::color, types::vector), 27);
  EXPECT_EQ(matchScore(types::color, types::floating), 23);
  EXPECT_EQ(matchScore(types::string, types::floating), 0);
  EXPECT_EQ(matchScore(types::closure, types::color), 0);
}

TEST(Overload, AssignsArraysToArraysAsLong) {
  const Type two = types::floating.arrayOf(2), three = types::floating.arrayOf(3);
  EXPECT_TRUE(isAssignable(three, two));
  EXPECT_FALSE(isAssignable(two, three));
  EXPECT_FALSE(isAssignable(three, types::integer.arrayOf(3)));
  EXPECT_TRUE(isAssignable(types::color.arrayOf(2), types::point.arrayOf(2)));
  EXPECT_FALSE(isAssignable(three, types::floating));
}

TEST(Builtins, EverySignatureIsWellFormed) {
  BuiltinOverloads overloads;
  for (const BuiltinRow& row : builtinTable()) {
    EXPECT_FALSE(overloads.find(row.name).empty()) << row.name;
    EXPECT_GT(std::string_view(row.doc).size(), 5u) << row.name;
    EXPECT_EQ(row.kind == BuiltinKind::special || *row.symbol != 0, true) << row.name;
    for (const auto& overload : overloads.find(row.name)) EXPECT_LE(overload->parameters.size(), 6u) << row.name;
  }
  EXPECT_TRUE(overloads.find("nothing").empty());
}

TEST(Builtins, ExpandsGenericSignatures) {
  BuiltinOverloads overloads;
  EXPECT_EQ(overloads.find("sin").size(), 5u);
  EXPECT_EQ(overloads.find("snoise").size(), 20u);
  EXPECT_EQ(toString(*overloads.find("sincos").front()), "void sincos(float, output float, output float)");
  EXPECT_EQ(toString(*overloads.find("printf").front()), "void printf(string, ...)");
  EXPECT_EQ(symbolOf("transformp", types::point, std::vector<Type>{types::matrix, types::point}), "transformp_v_mv");
  EXPECT_EQ(symbolOf("sum", types::none, std::vector<Type>{types::floating.arrayOf(3), types::integer}), "sum_x_Fi");
}

TEST(Closures, ParametersAreRead) {
  const auto rows = findClosures("medium_vdf");
  ASSERT_EQ(rows.size(), 1u);
  const auto parameters = closureParameters(*rows[0]);
  ASSERT_EQ(parameters.size(), 6u);
  EXPECT_EQ(parameters[1].name, "transmission_depth");
  EXPECT_TRUE(parameters[1].type == types::floating);
  EXPECT_TRUE(parameters[5].type == types::integer);
  EXPECT_EQ(findClosures("microfacet").size(), 1u);
  EXPECT_TRUE(findClosures("nothing").empty());
}

}  // namespace
}  // namespace aerosol::lang
