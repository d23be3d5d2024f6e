// The language tests by the interpreter: what the front end makes of them, without a code generator. Each is run as it
// is compiled, and once more after it was specialised to its parameters.
#include <gtest/gtest.h>

#include <cmath>

#include "core/lang/analysis.h"
#include "core/lang/compile.h"
#include "core/lang/derivatives.h"
#include "tests/language/language_case.h"
#include "tests/unit/lang/interpreter.h"

namespace aerosol::lang::testing {
namespace {

using aerosol::testing::LanguageCase;
using aerosol::testing::LanguageExpectation;
using aerosol::testing::LanguagePoint;

CompileOptions options() {
  CompileOptions result;
  result.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  return result;
}

ConstantValue converted(const ConstantValue& value, const Type& type) {
  const auto* floats = std::get_if<std::vector<float>>(&value);
  if (!floats || type.base != BaseType::integer) return value;
  return std::vector<std::int32_t>(floats->begin(), floats->end());
}

void expectValue(const LanguageExpectation& expectation, const PointResult& result) {
  const auto found = result.outputs.find(expectation.name);
  ASSERT_TRUE(found != result.outputs.end()) << "line " << expectation.line << ": no output " << expectation.name;
  if (const auto* strings = std::get_if<std::vector<std::string>>(&expectation.value)) {
    EXPECT_EQ(std::get<std::vector<std::string>>(found->second.value), *strings) << "line " << expectation.line;
    return;
  }
  const auto& wanted = std::get<std::vector<float>>(expectation.value);
  std::vector<float> got;
  if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&found->second.value)) {
    got.assign(ints->begin(), ints->end());
  } else {
    got = std::get<std::vector<float>>(found->second.value);
  }
  ASSERT_EQ(got.size(), wanted.size()) << "line " << expectation.line;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const bool same = got[i] == wanted[i] || (std::isnan(got[i]) && std::isnan(wanted[i])) ||
                      std::fabs(got[i] - wanted[i]) <= expectation.tolerance;
    EXPECT_TRUE(same) << "line " << expectation.line << ": " << expectation.name << " component " << i << " is "
                      << got[i] << ", not " << wanted[i];
  }
}

void runPoint(const Program& program, const LanguageCase& test, const LanguagePoint& point) {
  PointInputs inputs;
  inputs.globals = point.globals;
  inputs.toCommon = test.spaces;
  for (const Parameter& parameter : program.parameters)
    if (const auto given = test.parameters.find(parameter.name); given != test.parameters.end())
      inputs.parameters[parameter.name] = converted(given->second, parameter.type);
  const PointResult result = interpret(program, inputs);
  for (const LanguageExpectation& expectation : point.expectations) expectValue(expectation, result);
  EXPECT_EQ(result.messages, point.messages);
}

ParameterValues fixedValues(const Program& program, const LanguageCase& test) {
  ParameterValues values;
  for (std::uint32_t i = 0; i < program.parameters.size(); ++i) {
    const Parameter& parameter = program.parameters[i];
    const auto given = test.parameters.find(parameter.name);
    if (given != test.parameters.end()) {
      values[i] = converted(given->second, parameter.type);
    } else {
      values[i] = parameter.hasConstantDefault ? parameter.defaultValue : ConstantValue{};
    }
  }
  return values;
}

class LanguageFile : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(LanguageFile, GivesWhatItsCommentsSay) {
  const LanguageCase test = aerosol::testing::readLanguageCase(GetParam());
  ASSERT_TRUE(test.error.empty()) << test.error;
  std::size_t expectations = 0;
  for (const LanguagePoint& point : test.points) expectations += point.expectations.size() + point.messages.size();
  EXPECT_GT(expectations, 0u) << "the file expects nothing";
  const auto compiled = compileFile(GetParam(), options());
  ASSERT_TRUE(compiled) << format(compiled.errors());
  const Program program = expandDerivatives(*compiled->program);
  for (const auto& [name, value] : test.parameters) {
    EXPECT_TRUE(std::any_of(program.parameters.begin(), program.parameters.end(),
                            [&](const Parameter& parameter) { return parameter.name == name; }))
        << "no parameter " << name;
  }
  if (test.runtimeOnly) return;
  const Program special = specialise(program, fixedValues(program, test));
  const Program sliced = slice(special, special.outputs, Messages::keep);
  for (const LanguagePoint& point : test.points) {
    runPoint(program, test, point);
    SCOPED_TRACE("specialised");
    runPoint(special, test, point);
    runPoint(sliced, test, point);
  }
}

INSTANTIATE_TEST_SUITE_P(Files, LanguageFile,
                         ::testing::ValuesIn(aerosol::testing::languageFiles(AEROSOL_SOURCE_DIR "/tests/language")),
                         [](const auto& info) { return info.param.stem().string(); });

}  // namespace
}  // namespace aerosol::lang::testing
