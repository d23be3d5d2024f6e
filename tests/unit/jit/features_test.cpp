// Parameters, instances, spaces, messages, counters and budgets, each by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <thread>

#include "core/base/hash.h"
#include "tests/unit/jit/kernel_runner.h"
#include "tests/unit/jit/program_builder.h"

namespace aerosol::jit::test {

namespace types = lang::types;

namespace {

constexpr int widths[] = {16, 8, 4, 1};

float asFloat(std::uint64_t bits) { return std::bit_cast<float>(static_cast<std::uint32_t>(bits)); }

/// Instance blocks one behind the other.
std::vector<unsigned char> blocksOf(const KernelInterface& interface, const lang::Program& program,
                                    const std::vector<Values>& instances) {
  std::vector<unsigned char> data;
  for (const Values& values : instances) {
    const std::vector<unsigned char> block = instanceBlock(interface, program, values);
    data.insert(data.end(), block.begin(), block.end());
  }
  return data;
}

TEST(Parameters, comeFromEachPointsInstance) {
  ProgramBuilder b;
  b.output(b.parameter("f", types::floating, std::vector<float>{1}));
  b.output(b.parameter("c", types::color, std::vector<float>{1, 2, 3}));
  b.output(b.parameter("i", types::integer, std::vector<std::int32_t>{4}));
  b.output(b.parameter("s", types::string, std::vector<std::string>{"default"}));
  const VariableId array = b.parameter("a", types::floating.arrayOf(3), std::vector<float>{5, 6, 7});
  b.output(b.emit(Op::element, types::floating, {array, b.emit(Op::toInt, types::integer, {b.global(Global::u)})}));
  const auto program = b.build();
  const std::vector<Values> instances = {
      {},
      {std::vector<float>{10}, std::vector<float>{20, 30, 40}, std::vector<std::int32_t>{-50},
       std::vector<std::string>{"given"}, std::vector<float>{60, 70, 80}},
      {std::monostate{}, std::vector<float>{7, 8, 9}}};
  for (const int width : widths) {
    KernelRequest request = requestFor(program, width);
    request.severalInstances = true;
    const Kernel kernel = compileOrFail(request);
    EXPECT_TRUE(kernel.interface().readsInstances);
    Batch batch = Batch::random(40, 1);
    batch.instanceData = blocksOf(kernel.interface(), *program, instances);
    for (std::size_t i = 0; i < batch.count; ++i) {
      batch.instances.push_back(i < 16 ? 1 : static_cast<std::int32_t>(i % 3));
      batch.global(Global::u)[i] = static_cast<float>(i % 3);
    }
    const Outcome outcome = run(kernel, batch);
    for (std::size_t i = 0; i < batch.count; ++i) {
      const int instance = batch.instances[i];
      EXPECT_EQ(asFloat(outcome.outputs[0][i]), instance == 1 ? 10 : 1);
      EXPECT_EQ(asFloat(outcome.outputs[3][i]), instance == 1 ? 40 : instance == 2 ? 9 : 3);
      EXPECT_EQ(static_cast<std::int32_t>(outcome.outputs[4][i]), instance == 1 ? -50 : 4);
      EXPECT_EQ(outcome.outputs[5][i], hashString(instance == 1 ? "given" : "default"));
      EXPECT_EQ(asFloat(outcome.outputs[6][i]),
                (instance == 1 ? 60.0f : 5.0f) + (instance == 1 ? 10.0f : 1.0f) * static_cast<float>(i % 3));
    }
  }
}

TEST(Parameters, ofOneInstanceAreUniform) {
  ProgramBuilder b;
  b.output(b.emit(Op::add, types::floating, {b.parameter("f", types::floating, std::vector<float>{1}), b.floating(2)}));
  const auto program = b.build();
  const Kernel kernel = compileOrFail(requestFor(program, 16));
  EXPECT_TRUE(kernel.interface().isConstant());
  EXPECT_FALSE(kernel.interface().readsInstances);
  EXPECT_TRUE(kernel.interface().readsInstanceData);
  Batch batch = Batch::random(20, 1);
  batch.instanceData = instanceBlock(kernel.interface(), *program, {std::vector<float>{5}});
  EXPECT_EQ(asFloat(run(kernel, batch).outputs[0][19]), 7.0f);
}

TEST(Parameters, foldAway) {
  ProgramBuilder b;
  const VariableId scale = b.parameter("scale", types::floating, std::vector<float>{1});
  const VariableId other = b.parameter("other", types::floating, std::vector<float>{1});
  b.output(b.emit(Op::multiply, types::floating, {scale, other}));
  const auto program = b.build();
  KernelRequest request = requestFor(program, 8);
  request.folded = {{0, std::vector<float>{3}}};
  const Kernel kernel = compileOrFail(request);
  ASSERT_EQ(kernel.interface().fields.size(), 1u);
  EXPECT_EQ(kernel.interface().fields[0].parameter, 1u);
  Batch batch = Batch::random(3, 1);
  batch.instanceData = instanceBlock(kernel.interface(), *program, {std::vector<float>{100}, std::vector<float>{5}});
  EXPECT_EQ(asFloat(run(kernel, batch).outputs[0][2]), 15.0f);
}

TEST(Parameters, variantsShareInstanceBlocks) {
  ProgramBuilder b;
  b.output(b.parameter("first", types::floating, std::vector<float>{1}));
  b.output(b.parameter("second", types::color, std::vector<float>{1, 2, 3}));
  const auto program = b.build();
  KernelRequest request = requestFor(program, 8);
  const Kernel whole = compileOrFail(request);
  request.outputs = {program->outputs[1]};
  const Kernel part = compileOrFail(request);
  EXPECT_EQ(whole.interface().fields, part.interface().fields);
  EXPECT_EQ(whole.interface().instanceStride, part.interface().instanceStride);
  ASSERT_EQ(part.interface().outputs.size(), 3u);
  EXPECT_EQ(part.interface().outputs[0].index, 1u);
}

/// default = u * 10 where the instance gives none.
TEST(Parameters, computeTheirDefaultWhereNoneIsGiven) {
  ProgramBuilder b;
  const VariableId p = b.parameter("p", types::floating, {});
  const VariableId isSet = b.isSetFlag(p);
  b.branch(
      isSet, [] {}, [&] { b.assign(p, b.emit(Op::multiply, types::floating, {b.global(Global::u), b.floating(10)})); });
  b.output(p);
  const auto program = b.build();
  for (const int width : widths) {
    KernelRequest request = requestFor(program, width);
    request.severalInstances = true;
    const Kernel kernel = compileOrFail(request);
    Batch batch = Batch::random(30, 9);
    batch.instanceData = blocksOf(kernel.interface(), *program, {{}, {std::vector<float>{3}}});
    for (std::size_t i = 0; i < batch.count; ++i) batch.instances.push_back(static_cast<std::int32_t>(i % 2));
    const Outcome outcome = run(kernel, batch);
    for (std::size_t i = 0; i < batch.count; ++i) {
      EXPECT_EQ(asFloat(outcome.outputs[0][i]), i % 2 ? 3.0f : batch.global(Global::u)[i] * 10);
    }
    request.severalInstances = false;
    request.folded = {{0, {}}};
    EXPECT_EQ(asFloat(run(compileOrFail(request), batch).outputs[0][1]), batch.global(Global::u)[1] * 10);
    request.folded = {{0, std::vector<float>{4}}};
    EXPECT_EQ(asFloat(run(compileOrFail(request), batch).outputs[0][1]), 4.0f);
  }
}

/// Matrix between two spaces, applied to P.
std::shared_ptr<const lang::Program> transformOf(const std::string& from, const std::string& to) {
  ProgramBuilder b;
  const VariableId matrix = b.local(types::matrix, "m");
  const VariableId found = b.call("getmatrix_i_ssm", types::integer, {b.text(from), b.text(to), matrix}, 4);
  b.output(b.call("transformp_v_mv", types::point, {matrix, b.global(Global::P)}));
  b.output(found);
  return b.build();
}

TEST(Spaces, comeFromTheInstance) {
  const auto program = transformOf("object", "shader");
  for (const int width : widths) {
    KernelRequest request = requestFor(program, width);
    request.severalInstances = true;
    const Kernel kernel = compileOrFail(request);
    EXPECT_FALSE(kernel.interface().asksHostForSpaces);
    Batch batch = Batch::random(40, 3);
    for (int instance = 0; instance < 2; ++instance) {
      AerosolInstanceHeader header{};
      const auto scale = static_cast<float>(instance + 1);
      for (const int i : {0, 5, 10}) {
        header.objectToWorld[i] = 2 * scale;
        header.worldToShader[i] = 1;
      }
      header.objectToWorld[3] = 10 * scale;
      header.worldToShader[7] = 100;
      const std::vector<unsigned char> block = instanceBlock(kernel.interface(), *program, {}, header);
      batch.instanceData.insert(batch.instanceData.end(), block.begin(), block.end());
    }
    for (std::size_t i = 0; i < batch.count; ++i)
      batch.instances.push_back(i < 20 ? 1 : static_cast<std::int32_t>(i % 2));
    const Outcome outcome = run(kernel, batch);
    for (std::size_t i = 0; i < batch.count; ++i) {
      const auto scale = static_cast<float>(batch.instances[i] + 1);
      EXPECT_FLOAT_EQ(asFloat(outcome.outputs[0][i]), batch.global(Global::P, 0)[i] * 2 * scale + 10 * scale);
      EXPECT_FLOAT_EQ(asFloat(outcome.outputs[1][i]), batch.global(Global::P, 1)[i] * 2 * scale + 100);
      EXPECT_EQ(outcome.outputs[3][i], 1u);
    }
  }
}

TEST(Spaces, comeFromTheHostByName) {
  HostSpaces spaces;
  spaces[hashString("camera")] = {3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1};
  for (const int width : widths) {
    KernelRequest request = requestFor(transformOf("camera", "common"), width);
    const Kernel kernel = compileOrFail(request);
    EXPECT_TRUE(kernel.interface().asksHostForSpaces);
    EXPECT_TRUE(kernel.interface().reads(Global::time));
    Batch batch = Batch::random(25, 4);
    const Outcome outcome = run(kernel, batch, spaces);
    const Kernel unknown = compileOrFail(requestFor(transformOf("nowhere", "common"), width));
    const Outcome nothing = run(unknown, batch, spaces);
    for (std::size_t i = 0; i < batch.count; ++i) {
      // The test's host moves the space along x with time.
      const float time = batch.global(Global::time)[i];
      EXPECT_FLOAT_EQ(asFloat(outcome.outputs[0][i]), batch.global(Global::P, 0)[i] * 3 + time);
      EXPECT_EQ(outcome.outputs[3][i], 1u);
      EXPECT_EQ(nothing.outputs[3][i], 0u);
    }
  }
}

TEST(Messages, carryTheirArguments) {
  ProgramBuilder b;
  b.line(7);
  const VariableId u = b.global(Global::u);
  b.branch(b.emit(Op::greater, types::integer, {u, b.floating(0)}), [&] {
    b.message(lang::MessageKind::error, "%g %d %s %g %g %g", {u, b.integer(-3), b.text("word"), b.triple(1, 2, 3)});
  });
  b.output(u);
  const auto program = b.build();
  for (const int width : widths) {
    KernelRequest request = requestFor(program, width);
    const Kernel kernel = compileOrFail(request);
    ASSERT_EQ(kernel.interface().sites.size(), 1u);
    EXPECT_EQ(kernel.interface().sites[0].format, "%g %d %s %g %g %g");
    EXPECT_EQ(kernel.interface().sites[0].location.line, 7);
    Batch batch = Batch::random(35, 5);
    const Outcome outcome = run(kernel, batch);
    std::size_t next = 0;
    for (std::size_t i = 0; i < batch.count; ++i) {
      const float value = batch.global(Global::u)[i];
      if (value <= 0) continue;
      ASSERT_LT(next, outcome.records.size());
      const Record& record = outcome.records[next++];
      EXPECT_EQ(record.lane, i);
      EXPECT_EQ(record.kind, static_cast<std::uint32_t>(AEROSOL_MESSAGE_ERROR));
      ASSERT_EQ(record.values.size(), 6u);
      EXPECT_EQ(asFloat(record.values[0]), value);
      EXPECT_EQ(static_cast<std::int32_t>(record.values[1]), -3);
      EXPECT_EQ(kernel.interface().strings.at(record.values[2]), "word");
      EXPECT_EQ(asFloat(record.values[5]), 3.0f);
    }
    EXPECT_EQ(next, outcome.records.size());
    request.messages = false;
    const Kernel silent = compileOrFail(request);
    EXPECT_TRUE(silent.interface().sites.empty());
    EXPECT_TRUE(run(silent, batch).records.empty());
  }
}

TEST(Budget, stopsEndlessLoopsPointByPoint) {
  ProgramBuilder b;
  b.line(3);
  const VariableId x = b.local(types::floating, "x");
  const VariableId count = b.local(types::integer, "n");
  b.loop([&] { return b.emit(Op::less, types::integer, {x, b.floating(10)}); },
         [&] {
           b.emitTo(x, Op::add, {x, b.global(Global::u)});
           b.emitTo(count, Op::add, {count, b.integer(1)});
         });
  b.output(count);
  const auto program = b.build();
  for (const int width : widths) {
    Batch batch = Batch::random(20, 6);
    batch.loopBudget = 100;
    for (std::size_t i = 0; i < batch.count; ++i) batch.global(Global::u)[i] = i % 3 == 0 ? 0.0f : 1.0f;
    const Outcome outcome = run(compileOrFail(requestFor(program, width)), batch);
    for (std::size_t i = 0; i < batch.count; ++i) {
      const bool endless = i % 3 == 0;
      EXPECT_EQ(outcome.outputs[0][i], endless ? 100u : 10u);
      const std::vector<Record> records = outcome.recordsOf(i);
      ASSERT_EQ(records.size(), endless ? 1u : 0u);
      if (endless) {
        EXPECT_EQ(records[0].kind, static_cast<std::uint32_t>(AEROSOL_REPORT_BUDGET));
        EXPECT_EQ(records[0].line, 3);
      }
    }
  }
}

TEST(Counters, countLanesByWhatTheyRun) {
  ProgramBuilder b;
  const VariableId result = b.local(types::floating, "r");
  const VariableId u = b.global(Global::u);
  b.branch(b.emit(Op::greater, types::integer, {u, b.floating(0)}),
           [&] { b.assign(result, b.call("perlin_f_v", types::floating, {b.global(Global::P)})); });
  b.output(result);
  const auto program = b.build();
  KernelRequest request = requestFor(program, 8);
  request.counters = true;
  const Kernel kernel = compileOrFail(request);
  Batch batch = Batch::random(16, 7);
  const auto share = [&](auto&& inside) {
    for (std::size_t i = 0; i < batch.count; ++i) batch.global(Global::u)[i] = inside(i) ? 1.0f : -1.0f;
    const AerosolKernelCounters counters = run(kernel, batch).counters;
    EXPECT_GT(counters.lanesRun, 0u);
    EXPECT_LE(counters.lanesUsed, counters.lanesRun);
    return static_cast<double>(counters.lanesUsed) / static_cast<double>(counters.lanesRun);
  };
  EXPECT_EQ(share([](std::size_t) { return true; }), 1.0);
  EXPECT_EQ(share([](std::size_t) { return false; }), 1.0) << "skipped code does not count";
  EXPECT_NEAR(share([](std::size_t i) { return i % 2 == 0; }), 0.5, 0.05);
  EXPECT_EQ(share([](std::size_t i) { return i < 8; }), 1.0) << "whole chunks go the same way";
  batch.active.assign(16, 0xffffffffu);
  std::fill(batch.active.begin() + 4, batch.active.begin() + 8, 0u);
  EXPECT_NEAR(share([](std::size_t) { return true; }), 0.75, 1e-9);
  request.counters = false;
  EXPECT_EQ(run(compileOrFail(request), batch).counters.lanesRun, 0u);
}

TEST(Compiler, worksInManyThreads) {
  std::vector<std::thread> threads;
  std::vector<float> results(12, 0.0f);
  for (std::size_t t = 0; t < results.size(); ++t) {
    threads.emplace_back([t, &results] {
      ProgramBuilder b;
      b.output(b.emit(Op::add, types::floating, {b.global(Global::u), b.floating(static_cast<float>(t))}));
      Batch batch = Batch::random(5, 1);
      batch.global(Global::u)[4] = 0.5f;
      results[t] = asFloat(run(compileOrFail(requestFor(b.build(), 8)), batch).outputs[0][4]);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t t = 0; t < results.size(); ++t) EXPECT_EQ(results[t], static_cast<float>(t) + 0.5f);
}

TEST(Target, isChosenFromTheHostOrForced) {
  const auto native = chooseTarget();
  ASSERT_TRUE(native);
  EXPECT_EQ(native->isa, *hostIsa());
  EXPECT_EQ(native->width, *hostIsa() == Isa::x86_64_v4 ? 16 : 8);
  EXPECT_EQ(*chooseTarget(4, "avx2"), (Target{4, Isa::x86_64_v3}));
  EXPECT_EQ(*chooseTarget({}, "x86-64-v3"), (Target{8, Isa::x86_64_v3}));
  EXPECT_FALSE(chooseTarget(5));
  const auto unknown = chooseTarget({}, "neon");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.errors().entries()[0].notes.at(0).find("avx512"), std::string::npos);
}

}  // namespace

}  // namespace aerosol::jit::test
