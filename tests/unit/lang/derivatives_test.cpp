#include "core/lang/derivatives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/lang/analysis.h"
#include "core/lang/builtins.h"
#include "core/lang/compile.h"

namespace aerosol::lang {
namespace {

std::shared_ptr<const Program> compiled(const std::string& source) {
  CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  auto result = compileString(source, "test.osl", options);
  EXPECT_TRUE(result) << format(result.errors()) << source;
  return result ? result->program : nullptr;
}

bool hasDerivatives(const Type& type) {
  return !type.closure && (type.base == BaseType::floating || type.base == BaseType::matrix || type.isTriple());
}

/// An argument of a type that varies from point to point.
std::string argument(const Type& type, const std::string& text) {
  if (type.isTriple()) return toString(type) + "(P)";
  if (type == types::floating) return "u";
  if (type == types::matrix) return "matrix(u)";
  return type == types::string ? text : "1";
}

/// Shaders that call the overload, for each string that its first argument may be.
std::vector<std::string> callsOf(const BuiltinOverload& overload) {
  const std::string name = overload.row->name;
  std::vector<std::string> texts = {"\"object\""};
  if (name == "transformu") texts = {"\"cm\""};
  if (name == "spline" || name == "splineinverse") texts = {"\"catmull-rom\""};
  if (name == "noise" || name == "pnoise") {
    texts = {"\"perlin\"", "\"uperlin\"", "\"cell\"", "\"hash\""};
    if (name == "noise") texts.insert(texts.end(), {"\"simplex\"", "\"usimplex\""});
  }
  std::vector<std::string> sources;
  for (const std::string& text : texts) {
    std::string locals, call = name + "(";
    for (std::size_t i = 0; i < overload.parameters.size(); ++i) {
      const std::string number = std::to_string(i);
      if ((overload.outputs >> i & 1u) != 0) locals += toString(overload.parameters[i]) + " out" + number + ";\n";
      call += (i > 0 ? ", " : "");
      call += (overload.outputs >> i & 1u) != 0 ? "out" + number : argument(overload.parameters[i], text);
    }
    const std::string type = overload.result == types::none ? "" : toString(overload.result);
    const std::string value = type.empty() ? call + ");\n" : type + " value = " + call + ");\n";
    std::string reads;
    for (std::size_t i = 0; i < overload.parameters.size(); ++i)
      if ((overload.outputs >> i & 1u) != 0) reads += "seen += length(vector(out" + std::to_string(i) + "));\n";
    if (!type.empty() && overload.result != types::matrix) reads += "seen += length(vector(value));\n";
    if (overload.result == types::matrix) reads += "seen += value[0][0];\n";
    sources.push_back("shader s(output float seen = 0) {\n" + locals + value + reads + "}\n");
  }
  return sources;
}

/// No function of the language gives a derivative of zero because it was forgotten.
TEST(Derivatives, everyBuiltinFunctionHasARule) {
  BuiltinOverloads overloads;
  std::size_t symbols = 0;
  for (const BuiltinRow& row : builtinTable()) {
    for (const auto& overload : overloads.find(row.name)) {
      bool gives = hasDerivatives(overload->result), takes = false;
      for (std::size_t i = 0; i < overload->parameters.size(); ++i) {
        const bool isOutput = (overload->outputs >> i & 1u) != 0;
        (isOutput ? gives : takes) |= hasDerivatives(overload->parameters[i]);
      }
      if (!gives || !takes) continue;
      for (const std::string& source : callsOf(*overload)) {
        const auto program = compiled(source);
        ASSERT_TRUE(program);
        for (const FunctionUse& function : program->functions) {
          EXPECT_TRUE(hasDerivativeRule(function.symbol)) << function.symbol << " of " << toString(*overload);
          ++symbols;
        }
      }
    }
  }
  EXPECT_GT(symbols, 200u);
}

std::set<std::string> symbolsOf(const Program& program) {
  std::set<std::string> symbols;
  forEachInstruction(program.body, [&](const Instruction& instruction) {
    if (instruction.op == Op::call) symbols.insert(program.functions[instruction.function].symbol);
  });
  return symbols;
}

/// Whether there is a variable whose name ends so. (Derivatives of temporaries are called ".dx".)
bool hasVariable(const Program& program, const std::string& name) {
  return std::any_of(program.variables.begin(), program.variables.end(),
                     [&](const Variable& variable) { return variable.name.ends_with(name); });
}

/// What a kernel with all outputs is made from.
Program expanded(const std::string& source) {
  const Program program = expandDerivatives(*compiled(source));
  return slice(program, program.outputs, Messages::keep);
}

TEST(Derivatives, aProgramThatReadsNoneStaysAsItIs) {
  const auto program = compiled("shader s(output float y = 0) { y = noise(P * 3) * sin(u); float d = Dx(y); }");
  EXPECT_FALSE(readsDerivatives(*program));
  EXPECT_EQ(toString(expandDerivatives(*program)), toString(*program));
}

TEST(Derivatives, areComputedOnlyWhereTheyAreRead) {
  const Program program = expanded(
      "shader s(output float y = 0, output float d = 0, output float w = 0) {\n"
      "  float a = u * v;\n"
      "  float b = sin(a), c = noise(P);\n"
      "  y = c;\n"
      "  w = noise(\"simplex\", a * N[0]);\n"
      "  d = Dy(b);\n"
      "}");
  for (const char* const present : {".dy", "dudy", "dvdy"}) EXPECT_TRUE(hasVariable(program, present)) << present;
  for (const char* const absent : {".dx", "c.dy", "dudx", "dPdy", "w.dy"})
    EXPECT_FALSE(hasVariable(program, absent)) << absent;
  const std::set<std::string> symbols = symbolsOf(program);
  EXPECT_TRUE(symbols.contains("uperlin_f_v"));
  EXPECT_TRUE(symbols.contains("simplex_f_f"));
  EXPECT_TRUE(symbols.contains("cos_f_f"));
}

TEST(Derivatives, ofWhatIsConstantAreConstant) {
  const Program program = expanded(
      "shader s(float amount = 2, output vector y = 0) {\n"
      "  point p = point(amount, 1, time) * floor(u);\n"
      "  y = Dx(p) + filterwidth(N) + calculatenormal(p);\n"
      "}");
  for (const char* const absent : {".dx", ".dy", "dudx", "dPdx"}) EXPECT_FALSE(hasVariable(program, absent));
  EXPECT_TRUE(symbolsOf(program).empty());
}

TEST(Derivatives, ofIndexedValuesDoNotReportASecondTime) {
  const Program program =
      expanded("shader s(int at = 7, output float y = 0) { float a[2]; a[at] = u; y = Dx(a[at] + P[at]); }");
  int loud = 0, quiet = 0;
  forEachInstruction(program.body, [&](const Instruction& instruction) {
    const bool isIndexed =
        instruction.op == Op::element || instruction.op == Op::setElement || instruction.op == Op::component;
    if (isIndexed) ++(instruction.quiet ? quiet : loud);
  });
  EXPECT_EQ(quiet, 3);
  EXPECT_EQ(loud, 0);  // Their values are not read any more.
}

}  // namespace
}  // namespace aerosol::lang
