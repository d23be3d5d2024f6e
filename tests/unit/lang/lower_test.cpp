#include "core/lang/lower.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/lang/analysis.h"
#include "core/lang/compile.h"
#include "core/lang/reached_sites.h"

namespace aerosol::lang {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Program compiled(const std::string& text) {
  CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  const auto result = compileString(text, "test.osl", options);
  EXPECT_TRUE(result) << format(result.errors());
  return result ? *result->program : Program{};
}

/// The lines of a listing that are instructions.
std::string body(const Program& program) {
  std::string text = toString(program);
  const std::size_t begin = text.find('\n') + 1;
  text = text.substr(begin);
  for (const char* word : {"parameter ", "output "})
    while (text.rfind(word, 0) == 0) text = text.substr(text.find('\n') + 1);
  return text.substr(0, text.find("result "));
}

int count(const Program& program, Op op) {
  int result = 0;
  forEachInstruction(program.body, [&](const Instruction& instruction) { result += instruction.op == op; });
  return result;
}

/// Temporaries are written by one instruction, before they are read, in the block of their reads or around it.
void expectTemporariesInOrder(const Program& program, const Code& code, std::vector<bool> known) {
  for (const Instruction& instruction : code) {
    std::uint32_t outputs = instruction.op == Op::call ? program.functions[instruction.function].outputs : 0;
    const bool isLoop = instruction.op == Op::loop;
    if (!isLoop) {
      for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
        const VariableId id = instruction.arguments[i];
        if (program.variables[id].storage != Storage::temporary || (outputs >> i & 1u) != 0) continue;
        EXPECT_TRUE(known[id]) << "%" << id << " is read before it is written";
      }
    }
    for (const Code& inner : instruction.bodies) expectTemporariesInOrder(program, inner, known);
    forEachWritten(program, instruction, [&](VariableId id) {
      if (program.variables[id].storage != Storage::temporary) return;
      EXPECT_FALSE(known[id]) << "%" << id << " is written twice";
      known[id] = true;
    });
  }
}

TEST(Lower, FoldsConstants) {
  const Program program = compiled("shader s(float a = 2 * M_PI / 4 + (1 << 3), color c = color(1, 2, 3) * 2) {}");
  ASSERT_EQ(program.parameters.size(), 2u);
  EXPECT_EQ(std::get<std::vector<float>>(program.parameters[0].defaultValue)[0], 2 * 3.14159274f / 4 + 8);
  EXPECT_EQ(std::get<std::vector<float>>(program.parameters[1].defaultValue), (std::vector<float>{2, 4, 6}));
  EXPECT_TRUE(program.body.empty());
}

TEST(Lower, ComputesDefaultsThatAreNotConstant) {
  const Program program = compiled("shader s(float a = 2, float b = a * 2, output float r = 0) { r = b; }");
  EXPECT_TRUE(program.parameters[0].hasConstantDefault);
  ASSERT_FALSE(program.parameters[1].hasConstantDefault);
  ASSERT_NE(program.parameters[1].isSet, noVariable);
  EXPECT_TRUE(program.variables[program.parameters[1].isSet].type == types::integer);
  EXPECT_EQ(body(program),
            "branch $b is set\n"
            "--\n"
            "  $b = multiply $a 2.0 : float\n"
            "end\n"
            "$r = assign $b : float\n");
}

TEST(Lower, FlattensStructures) {
  const Program program =
      compiled("struct S { float a; color b; };\nshader s(S s = {1, 2}, output float r = 0) { r = s.b[1] + s.a; }");
  ASSERT_EQ(program.parameters.size(), 3u);
  EXPECT_EQ(program.parameters[0].name, "s.a");
  EXPECT_EQ(program.parameters[1].name, "s.b");
  for (const Variable& variable : program.variables) EXPECT_NE(variable.type.base, BaseType::structure);
}

TEST(Lower, InlinesWithoutTrace) {
  const Program program =
      compiled("float square(float x) { return x * x; }\nshader s(output float r = 0) { r = square(u) + square(v); }");
  EXPECT_EQ(count(program, Op::multiply), 2);
  EXPECT_EQ(count(program, Op::assign), 0);
  EXPECT_EQ(count(program, Op::scope), 0);
}

TEST(Lower, TurnsEarlyReturnsIntoBranches) {
  const Program program = compiled(
      "float f(float x) { if (x < 0) return 0; if (x > 1) return 1; return sqrt(x); }\n"
      "shader s(output float r = 0) { r = f(u); }");
  EXPECT_EQ(count(program, Op::leave), 0);
  EXPECT_EQ(count(program, Op::scope), 0);
  EXPECT_EQ(count(program, Op::branch), 2);
}

TEST(Lower, LeavesLoopsByAJump) {
  const Program program = compiled(
      "int f(float x) { for (int i = 0; i < 9; ++i) if (i > x) return i; return -1; }\n"
      "shader s(output int r = 0) { r = f(u); }");
  EXPECT_EQ(count(program, Op::leave), 1);
  EXPECT_EQ(count(program, Op::scope), 1);
}

TEST(Lower, SelectsWhatIsCheapAndBranchesForTheRest) {
  EXPECT_EQ(count(compiled("shader s(output float r = 0) { r = u > v ? u * 2 : v; }"), Op::select), 1);
  EXPECT_EQ(count(compiled("shader s(output float r = 0) { r = u > v ? noise(u) : v; }"), Op::branch), 1);
  EXPECT_EQ(count(compiled("shader s(output int r = 0) { r = u > v && u < 1; }"), Op::logicalAnd), 1);
  EXPECT_EQ(count(compiled("shader s(output int r = 0) { r = u > v && noise(u) < 1; }"), Op::branch), 1);
  // Reading out of range would be reported where it is not asked for.
  EXPECT_EQ(
      count(compiled("shader s(float a[2] = {1, 2}, output int r = 0) { int i = (int)u; r = i < 2 && a[i] < 1; }"),
            Op::branch),
      1);
}

TEST(Lower, DropsBranchesThatAreDecided) {
  const Program program =
      compiled("shader s(output color c = 0) { c = transformc(\"YIQ\", \"rgb\", color(u, 1, 1)); }");
  EXPECT_EQ(count(program, Op::branch), 0);
  EXPECT_EQ(count(program, Op::message), 0);
}

TEST(Lower, WritesTemporariesOnce) {
  for (const char* text : {"shader s(output float r = 0) { float x = u * 2; r = x; float y = x; r += x + y; }",
                           "struct S { float a; float b; };\nshader s(output float r = 0) { float t = u * u; S s = {t, "
                           "t}; s.a += 1; r = s.a + s.b + t; }",
                           "shader s(output float r = 0) { for (int i = 0; i < 3; ++i) { float t = noise(u + i); r += "
                           "t > 0.5 ? t : noise(t); } }",
                           "volume s() { float d = noise(P); if (d > 0.5) { Ci = d * anisotropic_vdf(1, d, 0); Ci += "
                           "emission() * d; } }"}) {
    const Program program = compiled(text);
    expectTemporariesInOrder(program, program.body, std::vector<bool>(program.variables.size(), false));
  }
}

TEST(Lower, GivesEveryMessageScalarsOnly) {
  const Program program = compiled("shader s() { printf(\"%g and %d\\n\", P, 3); }");
  EXPECT_THAT(body(program), HasSubstr("message print \"%g %g %g and %d\\n\""));
}

TEST(Lower, TakesClosuresApart) {
  const Program program = compiled("volume s(float d = 1) { Ci = d * anisotropic_vdf(color(0.5), color(2), 0.25); }");
  for (const Variable& variable : program.variables) EXPECT_FALSE(variable.type.closure);
  EXPECT_EQ(program.ci, noVariable);
  ASSERT_EQ(program.closureSites.size(), 1u);
  EXPECT_EQ(program.closureSites[0].closure, "anisotropic_vdf");
  std::vector<OutputKind> kinds;
  for (const Output& output : program.outputs) kinds.push_back(output.kind);
  EXPECT_EQ(kinds, (std::vector<OutputKind>{OutputKind::sigmaT, OutputKind::sigmaS, OutputKind::emission,
                                            OutputKind::lobeSigmaS, OutputKind::lobeAnisotropy}));
}

TEST(Lower, KeepsTheClosuresThatCiHolds) {
  const Program program = compiled(
      "surface s(float coat = 0) { closure color unused = phong(N, 3); closure color base = diffuse(N);\n"
      "  Ci = layer(coat * reflection(N), layer(coat * refraction(N, 1.5), base)); }");
  std::vector<std::string> names;
  for (const ClosureSite& site : program.closureSites) names.push_back(site.closure);
  // Not those that the layers were copied from.
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("reflection", "refraction", "diffuse"));
  for (const ClosureSite& site : program.closureSites) {
    std::vector<std::string> above;
    for (const ClosureLayer& layer : site.layers) above.push_back(program.closureSites.at(layer.top).closure);
    if (site.closure == "diffuse") EXPECT_THAT(above, ::testing::ElementsAre("refraction", "reflection"));
    if (site.closure == "refraction") EXPECT_THAT(above, ::testing::ElementsAre("reflection"));
    if (site.closure == "reflection") EXPECT_THAT(above, ::testing::IsEmpty());
  }
  const auto reached = [&](float coat) {
    const Program folded = specialise(program, {{0, std::vector<float>{coat}}});
    std::vector<std::string> found;
    const std::vector<bool> marks = reachedSites(folded);
    for (std::size_t i = 0; i < marks.size(); ++i)
      if (marks[i]) found.push_back(names[i]);
    return found;
  };
  EXPECT_THAT(reached(0), ::testing::ElementsAre("diffuse"));
  EXPECT_EQ(reached(1).size(), 3u);
}

/// Its weight is 0, and yet it dims what lies below it.
TEST(Lower, ReachesClosuresThatOnlyLieOnOthers) {
  const Program program =
      compiled("surface s() { closure color top = diffuse(N); Ci = layer(top, phong(N, 3)) + (-1) * top; }");
  const std::vector<bool> marks = reachedSites(specialise(program, {}));
  EXPECT_EQ(marks.size(), 2u);
  EXPECT_EQ(std::count(marks.begin(), marks.end(), true), 2);
}

TEST(Lower, InlinedClosuresAreSitesOfTheirOwn) {
  const Program program = compiled(
      "closure color f(float g) { return henyey_greenstein(g); }\n"
      "volume s() { Ci = f(0.1) + f(-0.1); }");
  EXPECT_EQ(std::count_if(program.outputs.begin(), program.outputs.end(),
                          [](const Output& output) { return output.kind == OutputKind::lobeAnisotropy; }),
            2);
}

TEST(Lower, AsksForSpacesByName) {
  EXPECT_THAT(body(compiled("shader s(output point p = 0) { p = transform(\"object\", P); }")),
              HasSubstr("call getmatrix_i_ssm \"common\" \"object\""));
  EXPECT_THAT(body(compiled("shader s(output point p = 0) { p = transform(\"world\", P); }")),
              Not(HasSubstr("getmatrix")));
}

TEST(Lower, FindsConstantStrings) {
  const Program program = compiled("shader s(output string r = \"\") { r = concat(\"a\", format(\"%d\", 2 + 2)); }");
  EXPECT_THAT(body(program), HasSubstr("\"a4\""));
}

}  // namespace
}  // namespace aerosol::lang
