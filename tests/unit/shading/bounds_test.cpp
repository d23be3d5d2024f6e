// Bounds of the shipped volume shaders: no point of a box gives a coefficient outside, wherever the primitive stands.
#include "core/shading/bounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "core/lang/compile.h"
#include "core/shading/batch.h"

namespace aerosol::shading::test {

namespace {

constexpr int boxesPerShader = 160;
constexpr int pointsInBox = 16;

template <class T>
T valueOf(Result<T> result) {
  if (!result) throw std::runtime_error(format(result.errors()));
  return std::move(*result);
}

jit::Compiler& compiler() {
  static const auto shared = valueOf(
      jit::Compiler::create({std::filesystem::path(AEROSOL_BINARY_DIR) / "lib" / "aerosol" / "runtime", nullptr}));
  return *shared;
}

std::shared_ptr<const lang::Program> compileVolume(const std::string& source) {
  lang::CompileOptions options;
  options.includePaths = {std::filesystem::path(AEROSOL_SOURCE_DIR) / "shaders"};
  return valueOf(lang::compileString(source, "test.osl", options)).program;
}

Transform<World, Object> placement(const Matrix4& matrix) {
  Matrix4 inverse;
  EXPECT_TRUE(invert(matrix, inverse));
  return {matrix, inverse};
}

/// Turned, stretched, and somewhere else.
std::vector<Transform<World, Object>> placements() {
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Matrix4 turned = {{{2 * c, -s, 0, 3}, {2 * s, c, 0, -1}, {0, 0, 0.5, 10}, {0, 0, 0, 1}}};
  const Matrix4 far = {{{1, 0.3, 0, 20000}, {0, -1, 0.2, 0}, {0.1, 0, 1, -3000}, {0, 0, 0, 1}}};
  return {{}, placement(turned), placement(far)};
}

struct Fixture {
  ShadingSystem system;
  NamedSpaces spaces;
  KernelHost host{spaces, 1000000};
  BoundsBatch bounds{64};
  Batch points{pointsInBox};
  PointArrays waiting;

  explicit Fixture(const std::shared_ptr<const lang::Program>& program,
                   const std::vector<Transform<World, Object>>& places = placements()) {
    for (const auto& place : places) {
      Instance instance;
      instance.objectToWorld = place;
      system.add(program, std::move(instance));
    }
    const ShadingOptions options{{16, *jit::hostIsa()}, false};
    EXPECT_FALSE(system.compile(compiler(), options).hasErrors());
    EXPECT_FALSE(system.compileBounds(compiler(), options).hasErrors());
  }
  const Family& family() const { return system.families().front(); }

  CoefficientBounds boundsOf(const VolumeBox& box, std::uint32_t instance = 0) {
    CoefficientBounds result;
    bounds.evaluate(host, family(), instance, {&box, 1}, {&result, 1});
    return result;
  }
};

VolumeBox randomBox(std::mt19937_64& random) {
  std::uniform_real_distribution<float> centre(-1.1f, 1.1f), unit(0, 1);
  VolumeBox result;
  const float size = std::exp2(-12 * unit(random));
  for (int i = 0; i < 3; ++i) {
    result.box.lower[i] = centre(random);
    result.box.upper[i] = result.box.lower[i] + (random() % 9 == 0 ? 0 : size * unit(random));
  }
  result.timeLow = unit(random);
  result.timeHigh = result.timeLow + (random() % 2 == 0 ? 0 : unit(random));
  return result;
}

const Bound& boundFor(const CoefficientBounds& bounds, const jit::OutputComponent& output) {
  switch (output.kind) {
    case lang::OutputKind::sigmaT:
      return bounds.sigmaT[output.component];
    case lang::OutputKind::sigmaS:
      return bounds.sigmaS[output.component];
    case lang::OutputKind::emission:
      return bounds.emission[output.component];
    case lang::OutputKind::lobeSigmaS:
      return bounds.lobes[output.index].sigmaS[output.component];
    default:
      return bounds.lobes[output.index].anisotropy;
  }
}

bool liesIn(const VolumeBox& box, const Transform<World, Object>& place, Point<World> p) {
  const Matrix4& m = place.inverseMatrix();
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = m[i][0] * static_cast<double>(p.x) + m[i][1] * static_cast<double>(p.y) +
                     m[i][2] * static_cast<double>(p.z) + m[i][3];
    const int axis = static_cast<int>(i);
    if (x < static_cast<double>(box.box.lower[axis]) || x > static_cast<double>(box.box.upper[axis])) return false;
  }
  return true;
}

/// Points of the box, as many as are found; false where none is.
int gatherPoints(Fixture& fixture, const VolumeBox& box, std::uint32_t instance, std::mt19937_64& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  const Transform<World, Object>& place = fixture.family().instances[instance].objectToWorld;
  fixture.waiting.bind(fixture.family(), Variant::coefficients);
  int count = 0;
  for (int tries = 0; tries < 4 * pointsInBox && count < pointsInBox; ++tries) {
    Point<Object> p;
    for (int i = 0; i < 3; ++i)
      p[i] = box.box.lower[i] +
             (tries < 8 ? static_cast<float>(tries >> i & 1) : unit(random)) * (box.box.upper[i] - box.box.lower[i]);
    const Point<World> world = place(p);
    if (!liesIn(box, place, world)) continue;
    ShadingPoint point;
    point.set(lang::Global::P, world);
    point.set(lang::Global::I, normalize(Vector<World>(unit(random) - 0.5f, unit(random) - 0.5f, unit(random) - 0.5f)));
    point.set(lang::Global::time, box.timeLow + unit(random) * (box.timeHigh - box.timeLow));
    fixture.waiting.push(point, instance);
    ++count;
  }
  return count;
}

/// Gives the number of points compared.
int expectBoundsHold(Fixture& fixture, const std::string& name) {
  std::mt19937_64 random(std::hash<std::string>{}(name));
  int compared = 0;
  for (int i = 0; i < boxesPerShader; ++i) {
    const VolumeBox box = randomBox(random);
    const auto instance = static_cast<std::uint32_t>(static_cast<std::size_t>(i) % fixture.family().instances.size());
    const CoefficientBounds bounds = fixture.boundsOf(box, instance);
    const int count = gatherPoints(fixture, box, instance, random);
    if (count == 0) continue;
    fixture.points.run(fixture.host, fixture.waiting, 0);
    const auto& outputs = fixture.points.interface().outputs;
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      for (int lane = 0; lane < count; ++lane, ++compared) {
        const float value = fixture.points.output(k)[lane];
        const Bound& bound = boundFor(bounds, outputs[k]);
        const bool holds = std::isnan(value) ? bounds.mayBeNan : bound.low <= value && value <= bound.high;
        EXPECT_TRUE(holds) << name << ", instance " << instance << ", box " << i << ", output " << k << ": " << value
                           << " is not in [" << bound.low << ", " << bound.high << "]";
        if (!holds) return compared;
      }
    }
  }
  return compared;
}

TEST(Bounds, holdForShippedVolumesWhereverTheyStand) {
  const std::filesystem::path folder = std::filesystem::path(AEROSOL_SOURCE_DIR) / "shaders" / "volume";
  int shaders = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".osl") continue;
    lang::CompileOptions options;
    options.includePaths = {folder.parent_path()};
    const auto program = valueOf(lang::compileFile(entry.path(), options)).program;
    Fixture fixture(program);
    if (!fixture.family().bounds) continue;  // It is constant.
    ++shaders;
    EXPECT_GT(expectBoundsHold(fixture, entry.path().stem().string()), 1000);
  }
  EXPECT_GE(shaders, 4);
}

TEST(Bounds, anObjectsBoxIsItsOwnHoweverItIsTurned) {
  Fixture fixture(compileVolume(R"(
volume slab() {
  point p = transform("object", P);
  Ci = max(p[1], 0) * anisotropic_vdf(color(1), color(1, 2, 3), 0);
})"));
  VolumeBox box;
  box.box.lower = {-1, 0.25f, -1};
  box.box.upper = {1, 0.5f, 1};
  for (std::uint32_t instance = 0; instance < 2; ++instance) {
    const Bound extinction = fixture.boundsOf(box, instance).extinction();
    EXPECT_NEAR(extinction.low, 0.75f, 1e-4f);
    EXPECT_NEAR(extinction.high, 1.5f, 1e-4f);
  }
  box.box.upper.y = 0.25f;
  EXPECT_TRUE(fixture.boundsOf(box).isUniform(uniformTolerance));
  box.box.lower.y = box.box.upper.y = -0.25f;
  EXPECT_TRUE(fixture.boundsOf(box).isEmpty());
}

TEST(Bounds, uniformIsDecidedByValue) {
  const std::string source = R"(
volume fog(float weight = WEIGHT) {
  float sum = 0.7 + weight * noise("snoise", 9 * P);
  Ci = sum * anisotropic_vdf(color(0.9), color(1), 0.3);
})";
  const auto withWeight = [&](const std::string& weight) {
    std::string text = source;
    return compileVolume(text.replace(text.find("WEIGHT"), 6, weight));
  };
  VolumeBox box;
  box.box.lower = {-1, -1, -1};
  box.box.upper = {1, 1, 1};
  for (const char* weight : {"0", "1e-12", "-1e-12"}) {
    Fixture fixture(withWeight(weight), {Transform<World, Object>()});
    // A weight without effect may already be folded away: then nothing varies and there is nothing to bound.
    if (!fixture.family().bounds) continue;
    EXPECT_TRUE(fixture.boundsOf(box).isUniform(uniformTolerance)) << weight;
  }
  for (const char* weight : {"1e-3", "0.5"}) {
    Fixture fixture(withWeight(weight), {Transform<World, Object>()});
    EXPECT_FALSE(fixture.boundsOf(box).isUniform(uniformTolerance)) << weight;
  }
}

}  // namespace

}  // namespace aerosol::shading::test
