#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "tests/unit/jit/kernel_runner.h"
#include "tests/unit/jit/program_builder.h"

namespace aerosol::jit::test {

namespace types = lang::types;

namespace {

float asFloat(std::uint64_t bits) { return std::bit_cast<float>(static_cast<std::uint32_t>(bits)); }

constexpr int widths[] = {16, 8, 4, 1};

TEST(Kernel, writesConstants) {
  ProgramBuilder b;
  b.output(b.triple(1, 2, 3));
  b.output(b.integer(-7));
  const auto program = b.build();
  for (const int width : widths) {
    const Kernel kernel = compileOrFail(requestFor(program, width));
    EXPECT_TRUE(kernel.interface().isConstant());
    EXPECT_FALSE(kernel.interface().readsInstanceData);
    const Outcome outcome = run(kernel, Batch::random(21, 1));
    ASSERT_EQ(outcome.outputs.size(), 4u);
    for (std::size_t i = 0; i < 21; ++i) {
      EXPECT_EQ(asFloat(outcome.outputs[2][i]), 3.0f);
      EXPECT_EQ(static_cast<std::int32_t>(outcome.outputs[3][i]), -7);
    }
  }
}

TEST(Kernel, addsGlobals) {
  ProgramBuilder b;
  const VariableId p = b.global(Global::P);
  const VariableId u = b.global(Global::u);
  const VariableId sum = b.emit(Op::add, types::point, {p, u});
  b.output(sum);
  const auto program = b.build();
  for (const int width : widths) {
    const Kernel kernel = compileOrFail(requestFor(program, width));
    EXPECT_TRUE(kernel.interface().reads(Global::P));
    EXPECT_TRUE(kernel.interface().reads(Global::u));
    EXPECT_FALSE(kernel.interface().reads(Global::v));
    Batch batch = Batch::random(37, 2);
    const Outcome outcome = run(kernel, batch);
    for (std::size_t i = 0; i < batch.count; ++i) {
      EXPECT_EQ(asFloat(outcome.outputs[1][i]), batch.global(Global::P, 1)[i] + batch.global(Global::u)[i]);
    }
  }
}

TEST(Kernel, leavesInactivePointsAlone) {
  ProgramBuilder b;
  b.output(b.emit(Op::multiply, types::floating, {b.global(Global::u), b.floating(2)}));
  const auto program = b.build();
  for (const int width : widths) {
    Batch batch = Batch::random(50, 3);
    batch.active.assign(50, 0);
    for (const std::size_t point : {0u, 3u, 17u, 49u}) batch.active[point] = 0xffffffffu;
    const Outcome outcome = run(compileOrFail(requestFor(program, width)), batch);
    for (std::size_t i = 0; i < 50; ++i) {
      if (batch.active[i]) {
        EXPECT_EQ(asFloat(outcome.outputs[0][i]), 2 * batch.global(Global::u)[i]);
      } else {
        EXPECT_EQ(outcome.outputs[0][i], untouched);
      }
    }
  }
}

TEST(Kernel, callsTheRuntimeLibrary) {
  ProgramBuilder b;
  b.output(b.call("sqrt_f_f", types::floating, {b.global(Global::u)}));
  b.output(b.call("sqrt_f_f", types::floating, {b.floating(9)}));
  const VariableId sine = b.local(types::floating), cosine = b.local(types::floating);
  b.call("sincos_x_fff", types::none, {b.global(Global::v), sine, cosine}, 6);
  b.output(cosine);
  const auto program = b.build();
  for (const int width : widths) {
    Batch batch = Batch::random(19, 4);
    const Outcome outcome = run(compileOrFail(requestFor(program, width)), batch);
    for (std::size_t i = 0; i < batch.count; ++i) {
      EXPECT_EQ(asFloat(outcome.outputs[0][i]), std::sqrt(std::max(batch.global(Global::u)[i], 0.0f)));
      EXPECT_EQ(asFloat(outcome.outputs[1][i]), 3.0f);
      EXPECT_NEAR(asFloat(outcome.outputs[2][i]), std::cos(batch.global(Global::v)[i]), 1e-6f);
    }
  }
}

TEST(Kernel, rejectsWhatIsTooLarge) {
  ProgramBuilder b;
  b.line(12);
  const VariableId array = b.local(types::floating.arrayOf(100000), "huge");
  b.emitTo(array, Op::setElement, {b.call("hash_i_f", types::integer, {b.global(Global::u)}), b.floating(1)});
  b.output(b.emit(Op::element, types::floating, {array, b.integer(5)}));
  const auto kernel = compiler().compile(requestFor(b.build(), 16));
  ASSERT_FALSE(kernel);
  const Diagnostic& error = kernel.errors().entries().at(0);
  EXPECT_EQ(error.location.line, 12);
  EXPECT_NE(error.message.find("'huge'"), std::string::npos) << error.message;
}

}  // namespace

}  // namespace aerosol::jit::test
