// Kernels against the interpreter, point by point and bit by bit: for every width, and for points in any company.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <random>

#include "core/lang/analysis.h"
#include "core/lang/program.h"
#include "tests/unit/jit/interpreter.h"
#include "tests/unit/jit/kernel_runner.h"
#include "tests/unit/jit/random_program.h"

namespace aerosol::jit::test {

namespace {

/// Every width, and the lesser instruction set where the host has more.
std::vector<Target> targetsFor(std::uint64_t seed) {
  std::vector<Target> targets = {{16, *hostIsa()}, {8, *hostIsa()}, {4, *hostIsa()}, {1, *hostIsa()}};
  if (seed % 2 == 0) targets.push_back({seed % 4 == 0 ? 16 : 8, Isa::x86_64_v3});
  return targets;
}

std::uint64_t programCount() {
  const char* text = std::getenv("AEROSOL_RANDOM_PROGRAMS");
  return text ? std::strtoull(text, nullptr, 10) : 24;
}

/// Gives false at the first difference.
bool agree(const lang::Program& program, const Kernel& kernel, const Batch& batch,
           const std::vector<std::size_t>& points, const std::vector<PointOutcome>& expected, const std::string& what) {
  const Outcome outcome = run(kernel, batch.pick(points));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PointOutcome& wanted = expected[points[i]];
    for (std::size_t k = 0; k < outcome.outputs.size(); ++k) {
      if (outcome.outputs[k][i] == wanted.outputs[k]) continue;
      ADD_FAILURE() << what << ": point " << points[i] << " in lane " << i << ", output " << k << ": " << std::hex
                    << outcome.outputs[k][i] << " instead of " << wanted.outputs[k] << std::dec << "\n"
                    << lang::toString(program);
      return false;
    }
    if (outcome.recordsOf(i) != wanted.records) {
      ADD_FAILURE() << what << ": point " << points[i] << " in lane " << i << " left " << outcome.recordsOf(i).size()
                    << " records instead of " << wanted.records.size() << " or other ones\n"
                    << lang::toString(program);
      return false;
    }
  }
  return true;
}

/// How the parameters reach the kernel.
enum class Instances { folded, one, several };

const std::vector<Values> instanceValues = {{},
                                            {std::vector<float>{-1.5f}, std::vector<std::int32_t>{1}},
                                            {std::vector<float>{4.0f}, std::vector<std::int32_t>{-7}}};

bool testProgram(std::uint64_t seed, const RandomProgramOptions& options) {
  const auto program = randomProgram(seed, options);
  const auto instances = static_cast<Instances>(seed % 3);
  Batch batch = Batch::random(41, seed);
  batch.loopBudget = 9;
  lang::ParameterValues defaults;
  for (std::uint32_t i = 0; i < program->parameters.size(); ++i) defaults[i] = program->parameters[i].defaultValue;
  std::vector<PointOutcome> expected;
  for (std::size_t i = 0; i < batch.count; ++i) {
    // Runs of one instance, and mixtures.
    const std::size_t instance = instances == Instances::several ? (i < 18 ? 1 : i % 3) : 0;
    batch.instances.push_back(static_cast<std::int32_t>(instance));
    expected.push_back(interpret(*program, batch, i, instanceValues[instance]));
    // Code without a use leaves no reports.
    const lang::Program special =
        lang::specialise(*program, instances == Instances::folded ? defaults : lang::ParameterValues{});
    const lang::Program prepared = lang::slice(special, special.outputs, lang::Messages::keep);
    expected.back().records = interpret(prepared, batch, i, instanceValues[instance]).records;
  }
  std::vector<std::size_t> inOrder(batch.count);
  std::iota(inOrder.begin(), inOrder.end(), 0u);
  std::vector<std::size_t> shuffled = inOrder;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937_64(seed));
  for (const Target& target : targetsFor(seed)) {
    const std::string what = "seed " + std::to_string(seed) + ", width " + std::to_string(target.width) + " " +
                             std::string(name(target.isa));
    KernelRequest request = requestFor(program, target.width, target.isa);
    if (instances == Instances::folded) {
      for (const auto& [index, value] : defaults) request.folded.push_back({index, value});
    }
    request.severalInstances = instances == Instances::several;
    const Kernel kernel = compileOrFail(request);
    batch.instanceData.clear();
    for (const Values& values : instanceValues) {
      const std::vector<unsigned char> block = instanceBlock(kernel.interface(), *program, values);
      batch.instanceData.insert(batch.instanceData.end(), block.begin(), block.end());
    }
    if (!agree(*program, kernel, batch, inOrder, expected, what)) return false;
    if (!agree(*program, kernel, batch, shuffled, expected, what + ", shuffled")) return false;
    if (!agree(*program, kernel, batch, {shuffled[0]}, expected, what + ", alone")) return false;
  }
  return true;
}

TEST(RandomProgram, straightLines) {
  for (std::uint64_t seed = 1; seed <= programCount() / 4; ++seed) {
    if (!testProgram(seed, {.statements = 10, .depth = 0})) return;
  }
}

TEST(RandomProgram, shallow) {
  for (std::uint64_t seed = 1000; seed <= 1000 + programCount(); ++seed) {
    if (!testProgram(seed, {.statements = 4, .depth = 2, .arrays = false, .integers = false})) return;
  }
}

TEST(RandomProgram, everything) {
  for (std::uint64_t seed = 2000; seed <= 2000 + programCount(); ++seed) {
    if (!testProgram(seed, {.statements = 8, .depth = 4})) return;
  }
}

}  // namespace

}  // namespace aerosol::jit::test
