// Which loops are counted and written out is decided by the program's text, before any code is made of it.
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "core/jit/counted_loop.h"
#include "core/lang/compile.h"

namespace aerosol::jit::test {

namespace {

struct Decision {
  std::optional<unsigned> rounds;
  bool isWrittenOut = false;
};

/// About the first loop of the code.
std::optional<Decision> decide(const lang::Program& program, const lang::Code& code) {
  for (const lang::Instruction& instruction : code) {
    if (instruction.op == lang::Op::loop)
      return Decision{countedRounds(program, code, instruction, 1000), isWrittenOut(program, code, instruction)};
    for (const lang::Code& body : instruction.bodies)
      if (const auto inside = decide(program, body)) return inside;
  }
  return std::nullopt;
}

Decision decide(const std::string& loop) {
  const std::string source =
      "shader counted(int some = 3, output float sum = 0) { float table[4] = {1, 2, 3, 4}; " + loop + " }";
  const auto compiled = lang::compileString(source, "counted.osl", {});
  EXPECT_TRUE(compiled) << (compiled ? "" : format(compiled.errors()));
  if (!compiled) return {};
  const auto decision = decide(*compiled->program, compiled->program->body);
  EXPECT_TRUE(decision) << "the program has no loop";
  return decision.value_or(Decision{});
}

}  // namespace

TEST(CountedLoop, IsWrittenOutWhereItsRoundsAreFew) {
  const Decision four = decide("for (int i = 0; i < 4; ++i) sum += table[i];");
  EXPECT_EQ(four.rounds, 4u);
  EXPECT_TRUE(four.isWrittenOut);
  const Decision down = decide("for (int i = 3; i > 0; i -= 2) sum += table[i];");
  EXPECT_EQ(down.rounds, 2u);
  EXPECT_TRUE(down.isWrittenOut);
}

// The optimiser would go through all numbers that the counter can hold: two minutes for one loop.
TEST(CountedLoop, StaysALoopWhereItIsNeverEntered) {
  for (const char* const head : {"int i = 4; i < 4; ++i", "int i = 5; i < 4; ++i", "int i = 0; i > 4; --i",
                                 "int i = 7; i != 7; ++i", "int i = 0; i <= -1; i++"}) {
    const Decision decision = decide(std::string("for (") + head + ") sum += table[u > 0.5];");
    EXPECT_EQ(decision.rounds, 0u) << head;
    EXPECT_FALSE(decision.isWrittenOut) << head;
  }
}

TEST(CountedLoop, StaysALoopWhereItWouldBeLong) {
  const Decision many = decide("for (int i = 0; i < 65; ++i) sum += i;");
  EXPECT_EQ(many.rounds, 65u);
  EXPECT_FALSE(many.isWrittenOut);
  EXPECT_FALSE(decide("for (int i = 0; i < 60; ++i) sum += sin(sum) * cos(sum) + pow(sum, 3);").isWrittenOut);
  EXPECT_FALSE(decide("for (int i = 0; i < 4; ++i) for (int j = 0; j < 4; ++j) sum += table[j];").isWrittenOut);
  EXPECT_FALSE(decide("for (int i = 0; i < some; ++i) sum += 1;").isWrittenOut);
  // The counter would wrap around before it is past the end.
  EXPECT_FALSE(decide("for (int i = 2147483640; i <= 2147483647; ++i) sum += 1;").isWrittenOut);
}

}  // namespace aerosol::jit::test
