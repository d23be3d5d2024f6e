// Every function of the run-time library through compiled kernels: the same bits at all widths, for all instruction
// sets, and in the uniform form.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "core/lang/builtins.h"
#include "tests/unit/jit/kernel_runner.h"
#include "tests/unit/jit/program_builder.h"

namespace aerosol::jit::test {

namespace types = lang::types;

namespace {

struct Function {
  std::string symbol;
  Type result;
  std::vector<Type> arguments;
  std::uint32_t outputs = 0;
};

void addNoise(std::vector<Function>& functions) {
  const std::vector<std::vector<Type>> plain = {
      {types::floating}, {types::floating, types::floating}, {types::point}, {types::point, types::floating}};
  for (const Type& result : {types::floating, types::color}) {
    for (const std::vector<Type>& arguments : plain) {
      for (const char* base : {"perlin", "uperlin", "cell", "hash", "simplex", "usimplex"}) {
        functions.push_back({lang::symbolOf(base, result, arguments), result, arguments});
      }
      std::vector<Type> twice = arguments;
      twice.insert(twice.end(), arguments.begin(), arguments.end());
      for (const char* base : {"pperlin", "puperlin", "pcell", "phash"}) {
        functions.push_back({lang::symbolOf(base, result, twice), result, twice});
      }
    }
  }
}

/// Noise with its partial derivatives, which it writes to arguments behind the others.
void addNoiseGradients(std::vector<Function>& functions) {
  const auto add = [&](const std::string& base, const Type& result, const std::vector<Type>& coordinates,
                       bool periodic) {
    Function function{"", result, coordinates};
    if (periodic) function.arguments.insert(function.arguments.end(), coordinates.begin(), coordinates.end());
    for (const Type& coordinate : coordinates) {
      const bool isTriple = coordinate.isTriple();
      for (int i = 0; i < (isTriple && result.isTriple() ? 3 : 1); ++i) {
        function.outputs |= 1u << function.arguments.size();
        function.arguments.push_back(isTriple ? types::vector : result);
      }
    }
    function.symbol = lang::symbolOf(base, result, function.arguments);
    functions.push_back(std::move(function));
  };
  for (const Type& result : {types::floating, types::color}) {
    for (const std::vector<Type>& coordinates : std::vector<std::vector<Type>>{
             {types::floating}, {types::floating, types::floating}, {types::point}, {types::point, types::floating}}) {
      for (const char* const base : {"gperlin", "guperlin", "gsimplex", "gusimplex"})
        add(base, result, coordinates, false);
      for (const char* const base : {"gpperlin", "gpuperlin"}) add(base, result, coordinates, true);
    }
  }
}

/// All that the table of built-in functions calls, and what its special rows become.
std::vector<Function> libraryFunctions() {
  std::vector<Function> functions;
  std::set<std::string> known;
  lang::BuiltinOverloads overloads;
  for (const lang::BuiltinRow& row : lang::builtinTable()) {
    if (row.kind == lang::BuiltinKind::special) continue;
    for (const auto& overload : overloads.find(row.name)) {
      if (overload->row->kind == lang::BuiltinKind::host) continue;  // Not in the run-time library.
      Function function;
      function.outputs = overload->outputs;
      function.result = overload->result;
      function.arguments = overload->parameters;
      if (row.kind == lang::BuiltinKind::componentwise) {
        if (function.result.isTriple()) function.result = types::floating;
        for (Type& type : function.arguments) {
          if (type.isTriple()) type = types::floating;
        }
      }
      function.symbol = lang::symbolOf(overload->row->symbol, function.result, function.arguments);
      if (known.insert(function.symbol).second) functions.push_back(std::move(function));
    }
  }
  addNoise(functions);
  addNoiseGradients(functions);
  std::erase_if(functions, [&, seen = std::set<std::string>()](const Function& function) mutable {
    return !seen.insert(function.symbol).second;
  });
  functions.push_back({"atan_f_f", types::floating, {types::floating}});
  functions.push_back({"sincos_x_fff", types::none, {types::floating, types::floating, types::floating}, 6});
  functions.push_back({"inverse_m_m", types::matrix, {types::matrix}});
  for (const char* base : {"transformp", "transformv", "transformn"}) {
    functions.push_back({std::string(base) + "_v_mv", types::vector, {types::matrix, types::vector}});
  }
  return functions;
}

/// A kernel that applies the function to its parameters, which the instance blocks give.
std::shared_ptr<const lang::Program> programOf(const Function& function) {
  ProgramBuilder b;
  std::vector<VariableId> arguments;
  for (std::size_t i = 0; i < function.arguments.size(); ++i) {
    const bool isOutput = (function.outputs >> i & 1u) != 0;
    const Type& type = function.arguments[i];
    const std::string name = "p" + std::to_string(i);
    const std::size_t size = type == types::matrix ? 16 : type.isTriple() ? 3 : 1;
    ConstantValue zeros = std::vector<float>(size, 0.0f);
    if (type == types::integer) zeros = std::vector<std::int32_t>(1, 0);
    const VariableId parameter = b.parameter(name, type, zeros);
    arguments.push_back(isOutput ? b.local(type, name) : parameter);
  }
  const VariableId result = b.call(function.symbol, function.result, arguments, function.outputs);
  if (result != lang::noVariable) b.output(result);
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if ((function.outputs >> i & 1u) != 0) b.output(arguments[i]);
  }
  return b.build();
}

/// Values of all magnitudes, and the awkward ones.
float sample(std::uint64_t k) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  static constexpr float special[] = {0.0f,      -0.0f,  1.0f,  -1.0f,  0.5f,         infinity,
                                      -infinity, 1e-42f, 3e38f, -3e38f, 2147483648.0f};
  std::uint64_t h = (k + 1) * 0x9e3779b97f4a7c15u;
  h ^= h >> 29;
  h *= 0xbf58476d1ce4e5b9u;
  h ^= h >> 32;
  if (h % 16 == 0) return special[h / 16 % std::size(special)];
  const float unit = static_cast<float>(h >> 40) / 16777216.0f * 2.0f - 1.0f;
  return unit * std::exp2(static_cast<float>(static_cast<int>(h % 23) - 9));
}

Values valuesFor(const Function& function, std::uint64_t instance) {
  Values values;
  for (std::size_t i = 0; i < function.arguments.size(); ++i) {
    const Type& type = function.arguments[i];
    const std::uint64_t key = instance * 64 + i * 17;
    if (type == types::integer) {
      values.emplace_back(
          std::vector<std::int32_t>{static_cast<std::int32_t>(sample(key) * 16.0f > 1e9f ? 7
                                                              : sample(key) < -6e7f      ? -7
                                                                                         : sample(key) * 16.0f)});
      continue;
    }
    const std::size_t size = type == types::matrix ? 16 : type.isTriple() ? 3 : 1;
    std::vector<float> floats;
    for (std::size_t k = 0; k < size; ++k) floats.push_back(sample(key + k));
    values.emplace_back(std::move(floats));
  }
  return values;
}

constexpr std::size_t pointCount = 61;

Batch batchFor(const Function& function, const lang::Program& program, const KernelInterface& interface) {
  Batch batch = Batch::random(pointCount, 1);
  for (std::size_t i = 0; i < pointCount; ++i) {
    batch.instances.push_back(static_cast<std::int32_t>(i));
    const std::vector<unsigned char> block = instanceBlock(interface, program, valuesFor(function, i));
    batch.instanceData.insert(batch.instanceData.end(), block.begin(), block.end());
  }
  return batch;
}

class Library : public testing::TestWithParam<Function> {};

TEST_P(Library, givesTheSameBitsEverywhere) {
  const Function& function = GetParam();
  const auto program = programOf(function);
  std::vector<std::vector<std::uint64_t>> expected;
  std::vector<Target> targets = {{1, Isa::x86_64_v3}, {4, Isa::x86_64_v3}, {8, Isa::x86_64_v3}, {16, Isa::x86_64_v3}};
  if (*hostIsa() == Isa::x86_64_v4) {
    targets.push_back({16, Isa::x86_64_v4});
    targets.push_back({8, Isa::x86_64_v4});
  }
  for (const Target& target : targets) {
    KernelRequest request = requestFor(program, target.width, target.isa);
    request.severalInstances = true;
    const Kernel kernel = compileOrFail(request);
    const Outcome outcome = run(kernel, batchFor(function, *program, kernel.interface()));
    if (expected.empty()) expected = outcome.outputs;
    ASSERT_EQ(outcome.outputs, expected) << "width " << target.width << " " << name(target.isa);
  }
  // One instance: everything is uniform.
  const Kernel uniform = compileOrFail(requestFor(program, 16));
  for (std::size_t i = 0; i < pointCount; ++i) {
    Batch batch = Batch::random(1, 1);
    batch.instanceData = instanceBlock(uniform.interface(), *program, valuesFor(function, i));
    const Outcome outcome = run(uniform, batch);
    for (std::size_t k = 0; k < expected.size(); ++k) {
      ASSERT_EQ(outcome.outputs[k][0], expected[k][i]) << "uniform, instance " << i << ", output " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Library, testing::ValuesIn(libraryFunctions()),
                         [](const testing::TestParamInfo<Function>& info) { return info.param.symbol; });

}  // namespace

}  // namespace aerosol::jit::test
