// Bounds of random shaders, and of every row of the builtin table: kernels run on dense points of random boxes, none of
// which may give a value outside. AEROSOL_RANDOM_SHADERS sets how many shaders, AEROSOL_RANDOM_SEED where they begin;
// the number of points is printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>
#include <string>

#include "core/lang/builtins.h"
#include "core/lang/compile.h"
#include "tests/unit/jit/kernel_runner.h"
#include "tests/unit/jit/random_shader.h"

namespace aerosol::jit::test {

namespace {

constexpr std::size_t boxesPerShader = 64;
constexpr std::size_t pointsInBox = 160;

std::uint64_t option(const char* name, std::uint64_t usual) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : usual;
}

std::shared_ptr<const lang::Program> compileShader(const std::string& text) {
  auto compiled = lang::compileString(text, "random.osl", {});
  if (!compiled) throw std::runtime_error(format(compiled.errors()) + "\n" + text);
  return compiled->program;
}

KernelRequest folded(const std::shared_ptr<const lang::Program>& program, int width, Domain domain) {
  KernelRequest request = requestFor(program, width);
  request.domain = domain;
  request.messages = false;
  for (std::uint32_t i = 0; i < program->parameters.size(); ++i) {
    if (program->parameters[i].isOutput) continue;
    request.folded.push_back({i, program->parameters[i].defaultValue});
  }
  return request;
}

/// Boxes of all sizes: points, boxes in one or some cells of the lattice of noise, large, huge, and with edges that no
/// other number follows.
Boxes randomBoxes(std::uint64_t seed) {
  Boxes boxes;
  boxes.count = boxesPerShader;
  boxes.loopBudget = 40;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (std::size_t box = 0; box < boxes.count; ++box) {
    const float usual = std::exp2(-14.0f + 16.0f * unit(random));
    for (std::size_t i = 0; i < boxes.low.size(); ++i) {
      float low = 6.0f * unit(random) - 3.0f;
      float size = usual * unit(random);
      switch (box % 16) {
        case 0:
          size = 0;
          break;
        case 1:
          low = std::round(low);
          break;
        case 2:
          low *= 1e4f;
          break;
        case 3:
          low *= std::exp2(80.0f * unit(random) - 40.0f);
          size = std::abs(low) * unit(random);
          break;
        case 4:
          if (random() % 4 == 0) low = 0;
          size = random() % 2 == 0 ? 0 : 1e-30f;
          break;
        case 5:
          if (random() % 3 == 0) low = 3e38f * (unit(random) - 0.5f);
          break;
        default:
          break;
      }
      boxes.low[i].push_back(low);
      boxes.high[i].push_back(std::max(low, low + size));
    }
  }
  return boxes;
}

/// Points of one box, of the globals that are read: corners, faces and edges, then anywhere.
Batch pointsIn(const Boxes& boxes, std::size_t box, std::uint64_t globalsRead, std::uint64_t seed) {
  Batch batch;
  batch.count = pointsInBox;
  batch.loopBudget = boxes.loopBudget;
  std::mt19937_64 random(seed * 1000 + box);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (std::size_t i = 0; i < boxes.low.size(); ++i) {
    if ((globalsRead >> i & 1u) == 0) continue;
    const float low = boxes.low[i][box], high = boxes.high[i][box];
    batch.globals[i].reserve(pointsInBox);
    for (std::size_t point = 0; point < pointsInBox; ++point) {
      const bool isEnd = point < 24 || random() % 8 == 0;
      const float t = isEnd ? static_cast<float>(random() % 2) : unit(random);
      batch.globals[i].push_back(t == 0 ? low : t == 1 ? high : std::clamp(low + t * (high - low), low, high));
    }
  }
  return batch;
}

/// How close a program's bounds are.
struct Closeness {
  std::uint64_t points = 0;
  std::size_t components = 0;
  std::size_t finite = 0;  ///< Float components with two finite ends, over all boxes.
};

/// An instance that stands somewhere, turned.
std::vector<unsigned char> placedInstance(const Kernel& kernel, const lang::Program& program) {
  AerosolInstanceHeader header{};
  const std::array<float, 12> rows = {0.5f, -0.5f, 0, 1, 0.5f, 0.5f, 0, -2, 0, 0, 2, 0.25f};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    header.objectToWorld[i] = header.shaderToWorld[i] = rows[i];
    header.worldToObject[i] = header.worldToShader[i] = rows[rows.size() - 1 - i] - 0.1f;
  }
  return instanceBlock(kernel.interface(), program, {}, header);
}

/// Gives false at the first point outside.
bool boundsHold(const std::shared_ptr<const lang::Program>& program, std::uint64_t seed, int width,
                const std::string& what, Closeness& closeness) {
  const Kernel wide = compileOrFail(folded(program, 16, Domain::wide));
  const Kernel range = compileOrFail(folded(program, width, Domain::range));
  Boxes boxes = randomBoxes(seed);
  boxes.instanceData = placedInstance(range, *program);
  const auto bounds = runRange(range, boxes);
  const auto& outputs = wide.interface().outputs;
  for (std::size_t box = 0; box < boxes.count; ++box) {
    Batch points = pointsIn(boxes, box, wide.interface().globalsRead, seed);
    points.instanceData = boxes.instanceData;
    const Outcome outcome = run(wide, points);
    closeness.points += points.count;
    std::size_t next = 0;
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      if (outputs[i].type == lang::BaseType::string) continue;
      const bool isFloat = outputs[i].type == lang::BaseType::floating;
      const Bounds& bound = bounds[box][next++];
      ++closeness.components;
      if (std::isfinite(bound.low) && std::isfinite(bound.high)) ++closeness.finite;
      for (std::size_t point = 0; point < points.count; ++point) {
        const auto bits = static_cast<std::uint32_t>(outcome.outputs[i][point]);
        const double value =
            isFloat ? static_cast<double>(std::bit_cast<float>(bits)) : static_cast<std::int32_t>(bits);
        if (bound.holds(value)) continue;
        std::string text = what + ", width " + std::to_string(width) + ", box " + std::to_string(box) + ", output " +
                           std::to_string(i) + ": ";
        text += std::to_string(value) + " is not in [" + std::to_string(bound.low) + ", " + std::to_string(bound.high) +
                "]" + (bound.mayBeNan ? " or NaN" : "") + "; P";
        for (std::size_t k = 0; k < 3; ++k) {
          if (points.globals[k].empty()) continue;
          char digits[160];
          std::snprintf(digits, sizeof digits, " %.9g in [%.9g, %.9g]", static_cast<double>(points.globals[k][point]),
                        static_cast<double>(boxes.low[k][box]), static_cast<double>(boxes.high[k][box]));
          text += digits;
        }
        ADD_FAILURE() << text;
        return false;
      }
    }
  }
  return true;
}

TEST(RangeShader, boundsOfRandomShadersHold) {
  const std::uint64_t first = option("AEROSOL_RANDOM_SEED", 1);
  const std::uint64_t count = option("AEROSOL_RANDOM_SHADERS", 12);
  Closeness closeness;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const std::string text = randomShader(seed);
    const int width = std::array{16, 8, 4, 1}[seed % 4];
    if (!boundsHold(compileShader(text), seed, width, "seed " + std::to_string(seed), closeness)) {
      std::printf("%s", text.c_str());
      if (option("AEROSOL_RANDOM_SHADERS", 0) == 0) return;
    }
  }
  std::printf("%llu shaders, %llu points, %.1f%% of the bounds finite\n", static_cast<unsigned long long>(count),
              static_cast<unsigned long long>(closeness.points),
              100.0 * static_cast<double>(closeness.finite) / static_cast<double>(closeness.components));
  EXPECT_GT(closeness.finite, closeness.components / 3);
}

/// An argument of the type that varies over a box.
std::string argumentFor(const lang::Type& type, std::size_t position) {
  static constexpr std::array floats = {"u", "v", "P[0]", "time"};
  if (type == lang::types::floating) return floats[position % floats.size()];
  if (type == lang::types::integer) return position % 2 == 0 ? "(int)(4 * u)" : "(int)(9 * v)";
  if (type == lang::types::string) return "\"object\"";
  if (type.base == lang::BaseType::matrix) return "matrix(1, u, 0, 0, 0, 1, v, 0, 0.5, 0, 1, 0, 1, 2, 3, 1)";
  if (position % 2 == 0) return type == lang::types::point ? "P" : lang::toString(type) + "(P[0], P[1], P[2])";
  return lang::toString(type) + "(u, v, time)";
}

/// The shader that returns one call, or nothing where a call of the overload is no expression over numbers.
std::string callOf(const lang::BuiltinOverload& overload, const std::string& noiseKind) {
  const std::string result = lang::toString(overload.result);
  if (overload.outputs != 0 || overload.arrays != 0 || overload.variadic || overload.result == lang::types::none ||
      overload.result.closure || overload.result.isArray()) {
    return {};
  }
  std::string call;
  for (std::size_t i = 0; i < overload.parameters.size(); ++i) {
    const lang::Type& type = overload.parameters[i];
    if (type == lang::types::none) return {};
    const bool isKind = i == 0 && type == lang::types::string && !noiseKind.empty();
    call += (i == 0 ? "" : ", ") + (isKind ? "\"" + noiseKind + "\"" : argumentFor(type, i));
  }
  return "shader one(output " + result + " r = " + (overload.result == lang::types::string ? "\"\"" : "0") +
         ") { r = (" + result + ")" + overload.row->name + "(" + call + "); }";
}

/// Functions that no rule bounds: over a box that is not a point they may have any value, by choice.
const std::set<std::string> unbounded = {"hash"};

TEST(RangeShader, everyRowOfTheBuiltinTableHasARule) {
  lang::BuiltinOverloads overloads;
  std::set<std::string> seen;
  std::uint64_t points = 0;
  for (const lang::BuiltinRow& row : lang::builtinTable()) {
    if (!seen.insert(row.name).second) continue;
    for (const auto& overload : overloads.find(row.name)) {
      if (overload->row->kind == lang::BuiltinKind::host) continue;  // Unknown wherever it is asked for over boxes.
      const bool isNoise = std::string(row.name) == "noise" || std::string(row.name) == "pnoise";
      const bool isNamed = isNoise && overload->parameters[0] == lang::types::string;
      for (const char* kind : {"perlin", "uperlin", "cell", "hash", "simplex", "usimplex"}) {
        const std::string text = callOf(*overload, isNoise ? kind : "");
        if (text.empty()) break;
        auto compiled = lang::compileString(text, "row.osl", {});
        if (!compiled && isNamed) continue;  // No periodic form.
        if (!compiled) break;                // Constants are asked for.
        Closeness closeness;
        const std::string what = lang::toString(*overload);
        ASSERT_TRUE(boundsHold(compiled->program, 7, 4, what, closeness)) << text;
        if (closeness.components > 0 && !unbounded.contains(row.name))
          EXPECT_GT(closeness.finite, closeness.components / 2) << what << " has no rule";
        points += closeness.points;
        if (!isNamed) break;
      }
    }
  }
  std::printf("%zu functions, %llu points\n", seen.size(), static_cast<unsigned long long>(points));
}

}  // namespace

}  // namespace aerosol::jit::test
