// Points that come to a program's dear part are packed into full lanes: nobody may see it but in the counters.
#include <gtest/gtest.h>

#include <cmath>

#include "core/jit/dear_part.h"
#include "core/lang/compile.h"
#include "core/lang/uniformity.h"
#include "tests/unit/jit/kernel_runner.h"

namespace aerosol::jit::test {

namespace {

/// `%s` takes the six octaves in various places.
constexpr const char* octaves = R"(
  float sum = 0;
  point q = P;
  float table[4] = {1, 2, 3, 4};
  for (int octave = 0; octave < 6; octave++) {
    sum += table[int(4.1 * u)] * fabs(snoise(q));
    q *= 2;
  }
)";

std::shared_ptr<const lang::Program> compile(const std::string& body) {
  const std::string source =
      "shader packed(float scale = 2, output float density = 7, output color tint = 0, output int count = 3) {" + body +
      "}";
  auto compiled = lang::compileString(source, "packed.osl", {});
  EXPECT_TRUE(compiled) << (compiled ? "" : format(compiled.errors()));
  return compiled->program;
}

const std::string earlyReturn =
    std::string("if (v > 0.2) { count = 5; return; }") + octaves + "density = sum * scale; tint = color(sum, P[0], u);";
const std::string whenTrue =
    std::string("if (v < 0.2) {") + octaves + "density = sum; } tint = density * color(1, 2, P[1]);";
const std::string whenFalse = std::string("if (v > 0.2) { tint = u; if (u > 0.5) return; } else {") + octaves +
                              "density = sum; } count = int(8 * density);";
const std::string nested = std::string("if (scale > 1) { if (v < 0.2) {") + octaves + "density = sum; } }";

class Packing : public testing::TestWithParam<std::string> {};

TEST_P(Packing, changesNoPointAndNoReport) {
  const auto program = compile(GetParam());
  Batch batch = Batch::random(2500, 7);
  for (auto& values : {&batch.global(lang::Global::u), &batch.global(lang::Global::v)}) {
    for (float& value : *values) value = std::abs(value) - std::floor(std::abs(value));
  }
  for (std::size_t i = 0; i < batch.count; ++i) {
    batch.active.push_back(i % 11 == 3 ? 0 : 0xffffffffu);
    batch.instances.push_back(static_cast<std::int32_t>(i % 2));
  }
  Outcome one;
  for (const int width : {1, 16, 8, 4}) {
    KernelRequest request = requestFor(program, width);
    request.severalInstances = true;
    request.counters = true;
    const Kernel kernel = compileOrFail(request);
    batch.instanceData = instanceBlock(kernel.interface(), *program, {});
    const auto second = instanceBlock(kernel.interface(), *program, {std::vector<float>{3}});
    batch.instanceData.insert(batch.instanceData.end(), second.begin(), second.end());
    const Outcome outcome = run(kernel, batch);
    if (width == 1) {
      one = outcome;
      EXPECT_FALSE(one.records.empty());
      continue;
    }
    EXPECT_EQ(outcome.outputs, one.outputs) << width;
    EXPECT_EQ(outcome.records.size(), one.records.size());
    for (std::size_t point = 0; point < batch.count; ++point) EXPECT_EQ(outcome.recordsOf(point), one.recordsOf(point));
    const auto used = static_cast<double>(outcome.counters.lanesUsed) / static_cast<double>(outcome.counters.lanesRun);
    EXPECT_GT(used, 0.9) << width;
  }
}

TEST_P(Packing, settlesPointsWithoutTheDearPart) {
  const auto program = compile(GetParam());
  const Kernel kernel = compileOrFail(requestFor(program, 8));
  Batch batch = Batch::random(1500, 9);
  batch.instanceData = instanceBlock(kernel.interface(), *program, {});
  for (float& v : batch.global(lang::Global::v)) v = 1;
  const Outcome outcome = run(kernel, batch);
  const Kernel scalar = compileOrFail(requestFor(program, 1));
  EXPECT_EQ(outcome.outputs, run(scalar, batch).outputs);
  batch.count = 0;
  EXPECT_TRUE(run(kernel, batch).records.empty());
}

INSTANTIATE_TEST_SUITE_P(Places, Packing, testing::Values(earlyReturn, whenTrue, whenFalse, nested));

TEST(DearPart, isNotLookedForBehindMessages) {
  const auto program = compile("printf(\"%g\", u); " + earlyReturn);
  const lang::Uniformity::Inputs inputs{
      [&](lang::VariableId id) { return program->variables[id].storage == lang::Storage::global; },
      [](const lang::Instruction&) { return false; }};
  EXPECT_FALSE(findDearPart(*program, lang::Uniformity(*program, program->body, inputs)));
  const auto silent = compile(earlyReturn);
  const lang::Uniformity::Inputs silentInputs{
      [&](lang::VariableId id) { return silent->variables[id].storage == lang::Storage::global; },
      [](const lang::Instruction&) { return false; }};
  EXPECT_TRUE(findDearPart(*silent, lang::Uniformity(*silent, silent->body, silentInputs)));
}

}  // namespace

}  // namespace aerosol::jit::test
