#include "core/lang/analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/lang/compile.h"
#include "core/lang/fold.h"
#include "tests/unit/lang/interpreter.h"

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

Output outputOf(const Program& program, OutputKind kind) {
  const auto found = std::find_if(program.outputs.begin(), program.outputs.end(),
                                  [&](const Output& output) { return output.kind == kind; });
  EXPECT_NE(found, program.outputs.end());
  return *found;
}

Program sliced(const Program& program, OutputKind kind, Messages messages = Messages::drop) {
  const Output output = outputOf(program, kind);
  return slice(program, {&output, 1}, messages);
}

const char* const cloud =
    "volume s(float density = 1, color albedo = 0.5, int octaves = 3) {\n"
    "  color tint = albedo;\n"
    "  for (int i = 0; i < octaves; ++i) tint *= sin(P[0] + i);\n"
    "  float d = cos(P[1]);\n"
    "  if (d < 0) return;\n"
    "  printf(\"%g\", d);\n"
    "  Ci = anisotropic_vdf(tint, color(density * d), 0) + v * emission();\n"
    "}";

TEST(Slice, KeepsWhatAnOutputNeeds) {
  const Program extinction = sliced(compiled(cloud), OutputKind::sigmaT);
  const std::string listing = toString(extinction);
  EXPECT_THAT(listing, HasSubstr("cos_f_f"));
  EXPECT_THAT(listing, Not(HasSubstr("sin_f_f")));
  EXPECT_THAT(listing, Not(HasSubstr("loop")));
  EXPECT_THAT(listing, Not(HasSubstr("message")));
  EXPECT_THAT(toString(sliced(compiled(cloud), OutputKind::sigmaS)), HasSubstr("sin_f_f"));
}

TEST(Slice, KeepsMessagesWhereWanted) {
  EXPECT_THAT(toString(sliced(compiled(cloud), OutputKind::sigmaT, Messages::keep)), HasSubstr("message print"));
}

TEST(Slice, KeepsParametersInPlace) {
  const Program extinction = sliced(compiled(cloud), OutputKind::sigmaT);
  ASSERT_EQ(extinction.parameters.size(), 3u);
  EXPECT_NE(extinction.parameters[0].variable, noVariable);
  EXPECT_EQ(extinction.parameters[1].variable, noVariable);
  EXPECT_EQ(extinction.parameters[2].variable, noVariable);
  EXPECT_EQ(extinction.variables[extinction.parameters[0].variable].name, "density");
}

TEST(Slice, KeepsJumpsThatDecide) {
  const Program program = compiled(
      "shader s(output float a = 0, output float b = 0) {\n"
      "  for (int i = 0; i < 10; ++i) {\n"
      "    b += 1;\n"
      "    if (i > u) break;\n"
      "    a += 1;\n"
      "  }\n"
      "}");
  const Program second = slice(program, {&program.outputs[1], 1}, Messages::drop);
  EXPECT_THAT(toString(second), HasSubstr("breakLoop"));
  testing::PointInputs inputs;
  inputs.globals["u"] = {2.5f};
  EXPECT_EQ(testing::interpret(second, inputs).outputs.at("b").asFloat(), 4.0f);
}

TEST(Slice, DropsUnneededFunctionsAndVariables) {
  const Program extinction = sliced(compiled(cloud), OutputKind::sigmaT);
  ASSERT_EQ(extinction.functions.size(), 1u);
  EXPECT_EQ(extinction.functions[0].symbol, "cos_f_f");
  std::vector<bool> used(extinction.variables.size(), false);
  forEachInstruction(extinction.body, [&](const Instruction& instruction) {
    if (instruction.result != noVariable) used[instruction.result] = true;
    for (const VariableId argument : instruction.arguments) used[argument] = true;
  });
  for (const Output& output : extinction.outputs) used[output.variable] = true;
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
}

TEST(Specialise, ResolvesBranchesOnParameters) {
  const Program program = compiled(
      "shader s(int mode = 0, output float r = 0) { if (mode == 1) r = sin(u); else if (mode == 2) r = cos(u); else r "
      "= u; }");
  const Program special = specialise(program, {{0, std::vector<std::int32_t>{2}}});
  EXPECT_THAT(toString(special), Not(HasSubstr("branch")));
  EXPECT_THAT(toString(special), HasSubstr("cos_f_f"));
  EXPECT_THAT(toString(special), Not(HasSubstr("sin_f_f")));
}

TEST(Specialise, FoldsKindsOfNoise) {
  const Program program = compiled("shader s(string kind = \"cell\", output float r = 0) { r = noise(kind, P); }");
  EXPECT_THAT(toString(program), HasSubstr("simplex_f_v"));
  const Program special = specialise(program, {{0, program.parameters[0].defaultValue}});
  EXPECT_THAT(toString(special), HasSubstr("cell_f_v"));
  EXPECT_THAT(toString(special), Not(HasSubstr("simplex_f_v")));
  EXPECT_THAT(toString(special), Not(HasSubstr("branch")));
}

TEST(Specialise, RunsStringFunctionsThatWriteTheirArguments) {
  const Program program = compiled(
      "shader s(string text = \"a,bc\", output int n = 0, output string r = \"\") {\n"
      "  string parts[3];\n  int found[4];\n  n = split(text, parts, \",\");\n"
      "  if (regex_search(parts[1], found, \"b(c)\")) n += found[2];\n  r = parts[1];\n}");
  EXPECT_THAT(toString(program), HasSubstr("split"));
  const Program special = specialise(program, {{0, program.parameters[0].defaultValue}});
  EXPECT_THAT(toString(special), Not(HasSubstr("call")));
  EXPECT_EQ(special.variables[special.outputs[0].variable].value, ConstantValue(std::vector<std::int32_t>{3}));
  EXPECT_EQ(special.variables[special.outputs[1].variable].value, ConstantValue(std::vector<std::string>{"bc"}));
}

TEST(Specialise, AsksWordsOfArraysOnce) {
  const Program program = compiled(
      "shader s(output int r = 0, output float f = 0) {\n"
      "  string names[3] = {\"x\", \"yy\", \"zzz\"};\n  string name = names[(int)u];\n"
      "  r = name == \"yy\";\n  f = strlen(name);\n  names[1] = \"q\";\n  printf(\"%s\", names[(int)v]);\n}");
  const std::string listing = toString(specialise(program, {}));
  EXPECT_THAT(listing, Not(HasSubstr("equal")));
  EXPECT_THAT(listing, Not(HasSubstr("strlen")));
  EXPECT_THAT(listing, HasSubstr("(0 1 0)"));
  EXPECT_THAT(listing, HasSubstr("(1 2 3)"));
}

TEST(Specialise, ComputesDefaultsThatNoInstanceGives) {
  const Program program = compiled("shader s(float a = 2, float b = a * 2, output float r = 0) { r = b; }");
  const Program computed = specialise(program, {{0, std::vector<float>{3}}, {1, ConstantValue{}}});
  EXPECT_EQ(computed.variables[computed.outputs[0].variable].value, ConstantValue(std::vector<float>{6}));
  const Program given = specialise(program, {{0, std::vector<float>{3}}, {1, std::vector<float>{7}}});
  EXPECT_EQ(given.variables[given.outputs[0].variable].value, ConstantValue(std::vector<float>{7}));
}

TEST(Specialise, KeepsEveryBit) {
  const Program program = compiled(
      "shader s(float one = 1, float zero = 0, output float r[4] = {0, 0, 0, 0}) {\n"
      "  r[0] = u * one;\n  r[1] = u * zero;\n  r[2] = u + zero;\n  r[3] = u - zero;\n}");
  const std::string listing = toString(specialise(program, {{0, std::vector<float>{1}}, {1, std::vector<float>{0}}}));
  // x * 1 and x - 0 are x; x * 0 may be NaN or -0, and -0 + 0 is 0.
  EXPECT_THAT(listing, HasSubstr("setElement 0 u"));
  EXPECT_THAT(listing, HasSubstr("multiply u 0.0"));
  EXPECT_THAT(listing, HasSubstr("add u 0.0"));
  EXPECT_THAT(listing, HasSubstr("setElement 3 u"));
}

TEST(Specialise, KnowsNothingAfterLoopsAndJumps) {
  const Program program = compiled(
      "float f(float x, int n) { float y = 1; for (int i = 0; i < n; ++i) { y = 2; if (x > i) return y; y = 3; } "
      "return y; }\n"
      "shader s(int n = 2, output float r = 0) { r = f(u, n); }");
  for (const int n : {0, 2}) {
    const Program special = specialise(program, {{0, std::vector<std::int32_t>{n}}});
    for (const float u : {-1.0f, 0.5f}) {
      testing::PointInputs inputs;
      inputs.globals["u"] = {u};
      inputs.parameters["n"] = std::vector<std::int32_t>{n};
      EXPECT_EQ(testing::interpret(special, inputs).outputs.at("r").asFloat(),
                testing::interpret(program, inputs).outputs.at("r").asFloat());
    }
  }
}

TEST(Reads, NamesGlobalsParametersAndSpaces) {
  const Program program =
      compiled("shader s(float a = 1, float b = 2, output float r = 0) { r = a + u + transform(\"object\", P)[0]; }");
  const Reads reads = findReads(program);
  EXPECT_TRUE(reads.any(Global::u));
  EXPECT_TRUE(reads.any(Global::P));
  EXPECT_FALSE(reads.any(Global::v));
  EXPECT_TRUE(reads.parameters[0]);
  EXPECT_FALSE(reads.parameters[1]);
  EXPECT_TRUE(reads.spaces);
}

TEST(Constant, DependsOnParametersAlone) {
  EXPECT_TRUE(
      isConstant(compiled("volume s(float d = 1) { Ci = sin(d) * absorption(); }"),
                 outputOf(compiled("volume s(float d = 1) { Ci = sin(d) * absorption(); }"), OutputKind::sigmaT)));
  const Program varying = compiled("volume s() { Ci = sin(P[0]) * absorption() + emission(); }");
  EXPECT_FALSE(isConstant(varying, outputOf(varying, OutputKind::sigmaT)));
  EXPECT_TRUE(isConstant(varying, outputOf(varying, OutputKind::emission)));
}

TEST(Constant, IsSeenOnceParametersAreKnown) {
  const Program program = compiled(
      "volume s(float amount = 0) { float d = 1; if (amount > 0) d += amount * P[0]; Ci = d * absorption(); }");
  EXPECT_FALSE(isConstant(program, outputOf(program, OutputKind::sigmaT)));
  const Program special = specialise(program, {{0, std::vector<float>{0}}});
  EXPECT_TRUE(isConstant(special, outputOf(special, OutputKind::sigmaT)));
}

// Random programs -----------------------------------------------------------------------------------------------------

/// Writes shaders at random: assignments, branches, loops with jumps, functions with early returns.
class RandomShader {
 public:
  explicit RandomShader(std::uint32_t seed) : random_(seed) {}

  std::string text() {
    std::string out = "float f(float x, int n) {\n  float a = x; float b = 1; float c = 0; int k = n;\n";
    out += statements(3, false) + "  return a + b;\n}\n";
    out +=
        "shader s(float p = 1, int n = 2, output float a = 0, output float b = 0.5) {\n  float c = u; int k = n; float "
        "x = v;\n";
    return out + statements(5, false) + "  b += f(a, k) + f(p, 1);\n}\n";
  }

 private:
  int pick(int count) { return static_cast<int>(random_() % static_cast<std::uint32_t>(count)); }

  std::string value(int depth) {
    static const char* const names[] = {"a", "b", "c", "x", "k", "u", "v", "n", "0.5", "2", "-1.25", "0"};
    if (depth == 0 || pick(3) == 0) return names[pick(12)];
    static const char* const operators[] = {" + ", " - ", " * ", " / "};
    switch (pick(6)) {
      case 0:
        return "(" + condition(depth - 1) + " ? " + value(depth - 1) + " : " + value(depth - 1) + ")";
      case 1:
        return "min(" + value(depth - 1) + ", " + value(depth - 1) + ")";
      case 2:
        return "floor(" + value(depth - 1) + ")";
      default:
        return "(" + value(depth - 1) + operators[pick(4)] + value(depth - 1) + ")";
    }
  }
  std::string condition(int depth) {
    static const char* const comparisons[] = {" < ", " > ", " == ", " != "};
    const std::string one = value(depth) + comparisons[pick(4)] + value(depth);
    if (depth == 0 || pick(3) != 0) return "(" + one + ")";
    return "(" + one + (pick(2) == 0 ? " && " : " || ") + condition(depth - 1) + ")";
  }
  std::string statements(int depth, bool inLoop) {
    std::string out;
    for (int i = 0; i < 1 + pick(4); ++i) out += statement(depth, inLoop);
    return out;
  }
  std::string statement(int depth, bool inLoop) {
    static const char* const targets[] = {"a", "b", "c"};
    switch (depth == 0 ? 0 : pick(8)) {
      case 1:
      case 2:
        return "if (" + condition(1) + ") {\n" + statements(depth - 1, inLoop) + "} else {\n" +
               statements(depth - 1, inLoop) + "}\n";
      case 3: {
        const std::string i = "i" + std::to_string(counter_++);
        return "for (int " + i + " = 0; " + i + " < " + std::to_string(1 + pick(4)) + "; ++" + i + ") {\n" +
               statements(depth - 1, true) + "}\n";
      }
      case 4:
        return "if (" + condition(1) + ") {\n" + statements(depth - 1, inLoop) +
               (inLoop ? pick(2) == 0 ? "break;" : "continue;" : "exit();") + "\n}\n";
      case 5:
        return "k = (int)(" + value(1) + ") % 7;\n";
      case 6: {
        const std::string name = "a" + std::to_string(counter_++);
        return "{ float " + name + " = " + value(2) + "; c = " + name + " * 0.5; }\n";
      }
      default:
        return std::string(targets[pick(3)]) + (pick(3) == 0 ? " += " : " = ") + value(3) + ";\n";
    }
  }

  std::mt19937 random_;
  int counter_ = 0;
};

bool sameResults(const Program& a, const Program& b, const testing::PointInputs& inputs) {
  const auto left = testing::interpret(a, inputs), right = testing::interpret(b, inputs);
  return std::all_of(left.outputs.begin(), left.outputs.end(), [&](const auto& output) {
    // A NaN is a NaN, whatever its bits.
    const float x = output.second.asFloat(), y = right.outputs.at(output.first).asFloat();
    return sameBits(Constant::ofFloat(x), Constant::ofFloat(y)) || (x != x && y != y);
  });
}

TEST(RandomPrograms, StayTheSameWhenSpecialisedAndSliced) {
  for (std::uint32_t seed = 1; seed <= 150; ++seed) {
    const std::string text = RandomShader(seed).text();
    const Program program = compiled(text);
    ASSERT_EQ(program.outputs.size(), 2u) << text;
    testing::PointInputs inputs;
    inputs.parameters["p"] = std::vector<float>{1.5f};
    inputs.parameters["n"] = std::vector<std::int32_t>{static_cast<std::int32_t>(seed % 4)};
    const Program special = specialise(program, {{0, inputs.parameters["p"]}, {1, inputs.parameters["n"]}});
    for (const float u : {-0.5f, 0.75f, 3.0f}) {
      inputs.globals["u"] = {u};
      inputs.globals["v"] = {u * u - 1};
      ASSERT_TRUE(sameResults(program, special, inputs)) << "seed " << seed << "\n"
                                                         << text << toString(program) << toString(special);
      for (const Program* whole : {&program, &special}) {
        for (const Output& output : whole->outputs)
          ASSERT_TRUE(sameResults(slice(*whole, {&output, 1}, Messages::drop), *whole, inputs))
              << "seed " << seed << "\n"
              << text;
      }
    }
  }
}

}  // namespace
}  // namespace aerosol::lang
