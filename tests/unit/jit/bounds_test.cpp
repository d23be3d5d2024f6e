// Range kernels against points: no point of a box gives a value outside of the box's bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

#include "tests/unit/jit/interpreter.h"
#include "tests/unit/jit/kernel_runner.h"
#include "tests/unit/jit/program_builder.h"
#include "tests/unit/jit/random_program.h"

namespace aerosol::jit::test {

namespace types = lang::types;

namespace {

constexpr int widths[] = {16, 4, 1};
constexpr std::size_t pointsInBox = 24;

std::uint64_t programCount() {
  const char* text = std::getenv("AEROSOL_RANDOM_PROGRAMS");
  return text ? std::strtoull(text, nullptr, 10) : 24;
}

/// Boxes of all sizes, from single points to some units.
Boxes randomBoxes(std::size_t count, std::uint64_t seed) {
  Boxes boxes;
  boxes.count = count;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> centre(-3.0f, 3.0f);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (std::size_t i = 0; i < boxes.low.size(); ++i) {
    for (std::size_t box = 0; box < count; ++box) {
      const float size = box % 4 == 0 ? 0.0f : std::exp2(-8.0f + 10.0f * unit(random));
      boxes.low[i].push_back(centre(random));
      boxes.high[i].push_back(boxes.low[i].back() + size);
    }
  }
  return boxes;
}

/// Points of one box: corners first, then anywhere.
Batch pointsIn(const Boxes& boxes, std::size_t box, std::uint64_t seed) {
  Batch batch;
  batch.count = pointsInBox;
  batch.loopBudget = boxes.loopBudget;
  std::mt19937_64 random(seed * 1000 + box);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (std::size_t i = 0; i < boxes.low.size(); ++i) {
    for (std::size_t point = 0; point < pointsInBox; ++point) {
      const float t = point < 8 ? static_cast<float>(random() % 2) : unit(random);
      const float low = boxes.low[i][box], high = boxes.high[i][box];
      batch.globals[i].push_back(std::min(std::max(low + t * (high - low), low), high));
    }
  }
  return batch;
}

KernelRequest rangeRequest(std::shared_ptr<const lang::Program> program, int width) {
  KernelRequest request = requestFor(program, width);
  request.domain = Domain::range;
  for (std::uint32_t i = 0; i < program->parameters.size(); ++i) {
    request.folded.push_back({i, program->parameters[i].defaultValue});
  }
  return request;
}

bool testProgram(std::uint64_t seed, const RandomProgramOptions& options) {
  const auto program = randomProgram(seed, options);
  Boxes boxes = randomBoxes(19, seed);
  boxes.loopBudget = 9;
  std::vector<bool> isFloat;
  for (const lang::Output& output : program->outputs) {
    const lang::Type& type = program->variables[output.variable].type;
    const int count = (type.isArray() ? type.arrayLength : 1) * (type.element().isTriple() ? 3 : 1);
    isFloat.insert(isFloat.end(), static_cast<std::size_t>(count), type.base != lang::BaseType::integer);
  }
  for (const int width : widths) {
    const Kernel kernel = compileOrFail(rangeRequest(program, width));
    const auto bounds = runRange(kernel, boxes);
    for (std::size_t box = 0; box < boxes.count; ++box) {
      const Batch points = pointsIn(boxes, box, seed);
      for (std::size_t point = 0; point < points.count; ++point) {
        const PointOutcome outcome = interpret(*program, points, point);
        for (std::size_t i = 0; i < outcome.outputs.size(); ++i) {
          const auto bits = static_cast<std::uint32_t>(outcome.outputs[i]);
          const double value =
              isFloat[i] ? static_cast<double>(std::bit_cast<float>(bits)) : static_cast<std::int32_t>(bits);
          const Bounds& bound = bounds[box][i];
          if (bound.holds(value)) continue;
          ADD_FAILURE() << "seed " << seed << ", width " << width << ", box " << box << ", output " << i << ": "
                        << value << " is not in [" << bound.low << ", " << bound.high << "]\n"
                        << lang::toString(*program);
          return false;
        }
      }
    }
  }
  return true;
}

TEST(Bounds, holdForStraightLines) {
  for (std::uint64_t seed = 1; seed <= programCount() / 4; ++seed) {
    if (!testProgram(seed, {.statements = 10, .depth = 0, .messages = false})) return;
  }
}

TEST(Bounds, holdForControlFlow) {
  for (std::uint64_t seed = 5000; seed <= 5000 + programCount() / 2; ++seed) {
    if (!testProgram(seed, {.statements = 5, .depth = 3, .messages = false, .arrays = false, .integers = false}))
      return;
  }
}

TEST(Bounds, holdForEverything) {
  for (std::uint64_t seed = 6000; seed <= 6000 + programCount() / 2; ++seed) {
    if (!testProgram(seed, {.statements = 6, .depth = 3, .messages = false})) return;
  }
}

/// max(2 - |P| + noise, 0), in octaves: the density of a cloud.
std::shared_ptr<const lang::Program> cloud() {
  ProgramBuilder b;
  const VariableId p = b.global(Global::P);
  const VariableId sum = b.local(types::floating, "sum");
  const VariableId weight = b.local(types::floating, "weight");
  const VariableId q = b.local(types::point, "q");
  const VariableId i = b.local(types::integer, "i");
  const VariableId density = b.local(types::floating, "density");
  b.assign(weight, b.floating(0.5f));
  b.assign(q, p);
  b.repeat(i, b.integer(3), [&] {
    const VariableId noise = b.call("perlin_f_v", types::floating, {q});
    b.emitTo(sum, Op::add, {sum, b.emit(Op::multiply, types::floating, {weight, noise})});
    b.emitTo(weight, Op::multiply, {weight, b.floating(0.5f)});
    b.emitTo(q, Op::multiply, {q, b.floating(2.0f)});
  });
  const VariableId radius = b.call("length_f_v", types::floating, {p});
  const VariableId inside = b.emit(Op::subtract, types::floating, {b.floating(2.0f), radius});
  const VariableId shape = b.emit(Op::add, types::floating, {inside, sum});
  b.assign(density, b.call("max_f_ff", types::floating, {shape, b.floating(0)}));
  b.output(density);
  return b.build();
}

TEST(Bounds, holdForACloudAndAreUseful) {
  const auto program = cloud();
  const Kernel wide = compileOrFail(requestFor(program, 16));
  const Kernel range = compileOrFail(rangeRequest(program, 16));
  const Boxes boxes = randomBoxes(64, 7);
  const auto bounds = runRange(range, boxes);
  std::size_t tight = 0;
  for (std::size_t box = 0; box < boxes.count; ++box) {
    const Batch points = pointsIn(boxes, box, 7);
    const Outcome outcome = run(wide, points);
    for (std::size_t point = 0; point < points.count; ++point) {
      const float density = std::bit_cast<float>(static_cast<std::uint32_t>(outcome.outputs[0][point]));
      EXPECT_TRUE(bounds[box][0].holds(static_cast<double>(density)))
          << "box " << box << ": " << density << " is not in [" << bounds[box][0].low << ", " << bounds[box][0].high
          << "]";
    }
    EXPECT_GE(bounds[box][0].low, 0.0);
    EXPECT_LE(bounds[box][0].high, 2.0 + 1.75);
    if (boxes.low[0][box] == boxes.high[0][box] && bounds[box][0].high - bounds[box][0].low < 0.05) ++tight;
  }
  EXPECT_GT(tight, 4u) << "boxes that are points have close bounds";
}

/// A product with itself, of numbers and of vectors, is not negative.
TEST(Bounds, knowSquares) {
  ProgramBuilder b;
  const VariableId u = b.global(Global::u), p = b.global(Global::P);
  b.output(b.emit(Op::multiply, types::floating, {u, u}));
  b.output(b.call("dot_f_vv", types::floating, {p, p}));
  const auto program = b.build();
  for (const int width : widths) {
    const Kernel kernel = compileOrFail(rangeRequest(program, width));
    Boxes boxes;
    boxes.count = 1;
    for (std::size_t i = 0; i < boxes.low.size(); ++i) {
      boxes.low[i].push_back(-1);
      boxes.high[i].push_back(2);
    }
    const auto bounds = runRange(kernel, boxes)[0];
    for (const std::size_t output : {0u, 1u}) {
      const double most = output == 0 ? 4 : 12;
      EXPECT_GE(bounds[output].low, -1e-5);
      EXPECT_GE(bounds[output].high, most);
      EXPECT_LE(bounds[output].high, most + 1e-4);
    }
  }
}

TEST(Bounds, aFunctionWithoutARuleGivesEverything) {
  ProgramBuilder b;
  b.output(b.call("unheard_of_f_v", types::floating, {b.global(Global::P)}));
  const Kernel kernel = compileOrFail(rangeRequest(b.build(), 4));
  const auto bounds = runRange(kernel, randomBoxes(3, 1));
  for (const auto& box : bounds) {
    EXPECT_EQ(box[0].low, -std::numeric_limits<double>::infinity());
    EXPECT_EQ(box[0].high, std::numeric_limits<double>::infinity());
    EXPECT_TRUE(box[0].mayBeNan);
  }
}

TEST(Bounds, anEndlessLoopGivesEverything) {
  ProgramBuilder b;
  const VariableId x = b.local(types::floating, "x");
  b.loop([&] { return b.emit(Op::less, types::integer, {x, b.global(Global::u)}); },
         [&] { b.emitTo(x, Op::add, {x, b.global(Global::v)}); });
  b.output(x);
  const Kernel kernel = compileOrFail(rangeRequest(b.build(), 4));
  Boxes boxes;
  boxes.count = 2;
  for (std::size_t i = 0; i < boxes.low.size(); ++i) {
    boxes.low[i] = {0.5f, 0.8f};
    boxes.high[i] = {1.0f, 0.8f};
  }
  // v in [0, 1] may take for ever; v = 0.5 does not.
  boxes.low[13] = {0.0f, 0.5f};
  boxes.high[13] = {1.0f, 0.5f};
  const auto bounds = runRange(kernel, boxes);
  EXPECT_EQ(bounds[0][0].high, std::numeric_limits<double>::infinity());
  EXPECT_LE(bounds[1][0].low, 1.0);
  EXPECT_GE(bounds[1][0].high, 1.0);
  EXPECT_LE(bounds[1][0].high, 1.01);
}

}  // namespace

}  // namespace aerosol::jit::test
