#include <gtest/gtest.h>

#include <functional>

#include "core/accel/scene.h"
#include "core/render/light_set.h"
#include "core/render/registry.h"
#include "plugins/registration.h"
#include "tests/statistical/direction_grid.h"
#include "tests/statistical/statistics.h"

// Every registered light, and every shape that can emit, seen from near, far and aside. Rays through the same shape
// decide what is true: the density over directions, the point that is met, the light that arrives.

namespace aerosol::render {
namespace {

using test::agrees;
using test::countsAgree;
using test::DirectionGrid;
using test::RunningMean;
using test::seedOfTest;
using test::Uniforms;

constexpr int sampleCount = 100000;

Registry allPlugins() {
  Registry registry;
  registerPlugins(registry);
  return registry;
}

template <class Space = Object>
Transform<World, Space> affine(const Matrix4& m) {
  Matrix4 inverse;
  EXPECT_TRUE(invert(m, inverse));
  return {m, inverse};
}

/// A shape to sample and the same one to shoot rays at.
struct EmittingShape {
  std::string name;
  std::shared_ptr<const accel::Scene> scene;
  std::shared_ptr<const LightSurface> surface;
  Point<World> centre;
  double reach = 0;  ///< Radius of a sphere around it.
};

using Add = std::function<Result<accel::ObjectId>(accel::SceneBuilder&)>;

std::shared_ptr<const accel::Scene> build(const Add& add) {
  accel::SceneBuilder builder;
  EXPECT_TRUE(add(builder));
  auto scene = builder.build();
  EXPECT_TRUE(scene);
  return std::make_shared<const accel::Scene>(std::move(*scene));
}

const Matrix4 skewed{{{1.5, 0.3, 0, 1}, {0, 0.7, 0.2, -2}, {0.1, 0, 0.9, 3}, {0, 0, 0, 1}}};
const Matrix4 round2{{{0, -2, 0, 1}, {2, 0, 0, -2}, {0, 0, 2, 3}, {0, 0, 0, 1}}};
const Matrix4 mirrored{{{-1, 0, 0, 1}, {0, 1.2, 0.4, -2}, {0, -0.4, 1.2, 3}, {0, 0, 0, 1}}};

std::vector<EmittingShape> shapes() {
  std::vector<EmittingShape> all;
  const Point<World> centre{1, -2, 3};
  const auto mesh = [&](const std::string& name, accel::TriangleMesh m) {
    const auto scene = build([&](accel::SceneBuilder& b) { return b.addMesh(m); });
    all.push_back({name, scene, makeMeshLight(*scene->mesh(0)), centre, 3});
  };
  for (const bool flip : {false, true}) {
    for (const auto& [label, matrix] : {std::pair{"skewed", &skewed}, {"round", &round2}, {"mirrored", &mirrored}}) {
      const auto toWorld = affine(*matrix);
      const std::string suffix = std::string(" ") + label + (flip ? " flipped" : "");
      all.push_back({"sphere" + suffix, build([&](auto& b) { return b.addSphere(toWorld, false, flip); }),
                     makeSphereLight(toWorld, flip), centre, 3});
      all.push_back({"disk" + suffix, build([&](auto& b) { return b.addDisk(toWorld, false, flip); }),
                     makeDiskLight(toWorld, flip), centre, 3});
      if (!flip) {
        all.push_back({"cylinder" + suffix, build([&](auto& b) { return b.addCylinder(toWorld); }),
                       makeCylinderLight(toWorld, false), centre, 4});
      }
      accel::TriangleMesh rectangle = accel::makeRectangle(toWorld);
      rectangle.flipNormals = flip;
      all.push_back({"rectangle" + suffix, build([&](auto& b) { return b.addMesh(rectangle); }),
                     makeRectangleLight(toWorld, flip), centre, 3});
    }
  }
  mesh("rectangle mesh", accel::makeRectangle(affine(skewed)));
  accel::TriangleMesh uneven;
  uneven.positions = {{1, -2, 3}, {3, -2, 3}, {1, -1.9f, 3}, {-1, -2, 3}, {1, -4, 3}, {1, -2, 3}};
  uneven.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 5, 0}, {0, 3, 4}};
  mesh("uneven mesh with a degenerate triangle", uneven);
  return all;
}

/// A hit of the ray, as the light sees it; none when the shape is missed.
std::optional<LightHit> shoot(const accel::Scene& scene, Point<World> from, Vector<World> direction) {
  accel::SpanBuffer spans;
  accel::Counters counters;
  Ray<World> ray;
  ray.origin = from;
  ray.direction = direction;
  const auto hit = scene.closestHit(ray, spans, counters);
  if (!hit) return {};
  return LightHit{hit->point, hit->geometricNormal, direction};
}

std::vector<Point<World>> viewpoints(const EmittingShape& shape) {
  std::vector<Point<World>> all;
  for (const Vector<World> offset : {Vector<World>{0.3f, 0.2f, 5}, {-4, 3, -2}, {0.1f, 0.05f, 0.3f}, {50, -20, 40}}) {
    all.push_back(shape.centre + offset);
  }
  return all;
}

/// Directions that can meet the shape.
DirectionGrid gridAround(const EmittingShape& shape, Point<World> from) {
  const Vector<World> d = shape.centre - from;
  const double distance = static_cast<double>(length(d)), sine = shape.reach / distance;
  return {normalize(d), sine < 1 ? sine * sine / (1 + std::sqrt(1 - sine * sine)) : 2, 24, 16};
}

/// What rays say of the light that arrives in the cells of a grid.
struct Truth {
  std::vector<double> probability;  ///< Of a sample: in the cells that the shape fills; then of all others together.
  std::vector<bool> isFilled;
  double radiance = 0;  ///< Integral of the radiance.
  double density = 0;   ///< Integral of the pdf.
};

Truth shootGrid(const Light& light, const EmittingShape& shape, Point<World> from, const DirectionGrid& grid) {
  constexpr int fineness = 20;
  const auto along = [&](auto f) {
    return grid.integrateCells(
        [&](Vector<World> d) {
          const auto hit = shoot(*shape.scene, from, d);
          return hit ? static_cast<double>(f(*hit)) : 0.0;
        },
        fineness);
  };
  Truth truth;
  for (const double r : along([&](const LightHit& h) { return light.emitted(h).g; })) truth.radiance += r;
  const std::vector<double> pdfs = along([&](const LightHit& h) { return light.pdf(from, h); });
  const std::vector<double> filled = along([&](const LightHit& h) { return light.pdf(from, h) > 0 ? 1 : 0; });
  double rest = 0;
  for (std::size_t i = 0; i < pdfs.size(); ++i) {
    truth.isFilled.push_back(filled[i] > (1 - 1e-6) * grid.cellSolidAngle());
    truth.probability.push_back(truth.isFilled[i] ? pdfs[i] : 0);
    if (!truth.isFilled[i]) rest += pdfs[i];
    truth.density += pdfs[i];
  }
  truth.probability.push_back(rest);
  return truth;
}

/// The density over directions by chi-squared, each sample's point and pdf, and the light that arrives. Cells at the
/// shape's edge, which rays know less well, count together. Samples that are turned away or hidden are missing from
/// both sides.
::testing::AssertionResult check(const Light& light, const EmittingShape& shape, Point<World> from, Uniforms& random) {
  const DirectionGrid grid = gridAround(shape, from);
  const Truth truth = shootGrid(light, shape, from, grid);
  std::vector<double> observed(grid.cellCount() + 1);
  RunningMean arriving;
  int met = 0, hitNothing = 0;
  for (int i = 0; i < sampleCount; ++i) {
    const auto s = light.sample(from, {random.next(), random.next2D()});
    std::optional<LightHit> hit;
    if (s) hit = shoot(*shape.scene, from, s->direction);
    if (s && !hit) ++hitNothing;
    const bool isMet = hit && dot(hit->normal.vector(), s->normal) > 0.5f &&
                       length(hit->point - s->point) < 2e-3f + 1e-5f * s->distance;
    arriving.add(isMet ? static_cast<double>(s->value.g / s->pdf) : 0);
    if (!isMet) continue;
    ++met;
    const std::size_t cell = grid.cell(s->direction);
    ++observed[cell < grid.cellCount() && truth.isFilled[cell] ? cell : grid.cellCount()];
    if (std::fabs(length(s->point - from) / s->distance - 1) > 1e-4f || dot(s->direction, s->normal) >= 0) {
      return ::testing::AssertionFailure() << "distance or normal is wrong";
    }
    // Where the surface is seen edge on, a rounding of the point decides about the pdf.
    const float facing = -dot(s->direction, s->normal);
    const float tolerance = 1e-3f + 3e-4f / (facing * facing);
    if (std::min(facing, -dot(hit->direction, hit->normal)) < 1e-2f) continue;
    if (std::fabs(light.pdf(from, *hit) / s->pdf - 1) > tolerance) {
      return ::testing::AssertionFailure() << "a sample says pdf " << s->pdf << ", its hit " << light.pdf(from, *hit);
    }
  }
  if (met == 0 && truth.density == 0) return ::testing::AssertionSuccess() << "nothing is seen from here";
  if (hitNothing > sampleCount / 200) {
    return ::testing::AssertionFailure() << hitNothing << " samples are not on the shape";
  }
  std::vector<double> expected = truth.probability;
  for (double& e : expected) e *= sampleCount;
  // The edge as a whole: rays know its share to a percent, counting its own root.
  const double edge = expected.back(), edgeSeen = observed.back();
  if (std::fabs(edgeSeen - edge) > 0.02 * edge + 5 * std::sqrt(edge + 1) + 0.004 * sampleCount) {
    return ::testing::AssertionFailure() << edgeSeen << " samples at the edge, " << edge << " expected";
  }
  expected.pop_back();
  observed.pop_back();
  if (const auto result = countsAgree(observed, expected); !result) return result;
  // A surface seen from behind only shows at its silhouette, by rounding.
  const double fromRays = truth.radiance, error = arriving.standardError();
  const double silhouette = 1e-4 * grid.cellSolidAngle() * static_cast<double>(grid.cellCount());
  if (std::fabs(arriving.mean() - fromRays) > 0.01 * fromRays + silhouette + 4 * error) {
    return ::testing::AssertionFailure() << "arriving " << arriving.mean() << " ± " << error << ", by rays "
                                         << fromRays;
  }
  return ::testing::AssertionSuccess();
}

std::unique_ptr<const Light> make(const Registry& registry, const LightType& type,
                                  std::shared_ptr<const LightSurface> surface) {
  std::vector<scene::NamedValue> parameters;
  for (const scene::ParameterSpec& spec : type.parameters) {
    if (spec.name == "filename") parameters.push_back({spec.name, AEROSOL_SOURCE_DIR "/tests/render/shaders/sky.ppm"});
    // A sun is too small for the grids here: it has a test of its own.
    if (spec.name == "sun_scale") parameters.push_back({spec.name, 0.0f});
  }
  auto light = makeLight(registry, type.name, std::move(parameters), std::move(surface));
  EXPECT_TRUE(light) << type.name;
  return light ? std::move(*light) : nullptr;
}

TEST(Lights, EveryRegisteredOneWithASurface) {
  const Registry registry = allPlugins();
  int tested = 0;
  std::uint64_t setting = 0;
  for (const LightType& type : registry.lights()) {
    if (!type.needsSurface) continue;
    for (const EmittingShape& shape : shapes()) {
      const auto light = make(registry, type, shape.surface);
      for (const Point<World> from : viewpoints(shape)) {
        Uniforms random(seedOfTest(setting++));
        EXPECT_TRUE(check(*light, shape, from, random))
            << type.name << ' ' << shape.name << " from " << from.x << ' ' << from.y << ' ' << from.z;
        ++tested;
      }
    }
  }
  EXPECT_GT(tested, 0);
}

TEST(Lights, EveryRegisteredOneWithoutASurface) {
  const Registry registry = allPlugins();
  const Point<World> from{0.1f, 0.2f, 3};  // In the cone of a spot.
  for (const LightType& type : registry.lights()) {
    if (type.needsSurface) continue;
    const auto light = make(registry, type, nullptr);
    const DirectionGrid grid({0, 0, 1}, 2, 16, 16);
    std::vector<double> observed(grid.cellCount());
    std::vector<double> expected = grid.integrateCells([&](Vector<World> d) { return light->pdfEscaped(from, d); }, 16);
    double radiance = 0;
    // Dim parts of an environment may be left to the sampling of directions by what they light.
    const auto found = [&](Vector<World> d) { return light->pdfEscaped(from, d) > 0 ? light->escaped(d).g : 0.0f; };
    // The brightness around a sun has an edge at its middle, which coarser steps see.
    const int fineness = type.name == "sunsky" ? 64 : 16;
    for (const double r : grid.integrateCells(found, fineness)) radiance += r;
    for (double& e : expected) e *= sampleCount;
    Uniforms random(seedOfTest());
    RunningMean arriving;
    for (int i = 0; i < sampleCount; ++i) {
      const auto s = light->sample(from, {random.next(), random.next2D()});
      ASSERT_TRUE(s) << type.name;
      ASSERT_EQ(s->isDelta, light->isDelta());
      ASSERT_EQ(std::isinf(s->distance), light->isInfinite());
      ASSERT_NEAR(length(s->direction), 1, 1e-6);
      ASSERT_GT(s->pdf, 0);
      if (s->isDelta) {
        ASSERT_EQ(s->pdf, 1);
        ASSERT_EQ(light->pdfEscaped(from, s->direction), 0);
        continue;
      }
      ASSERT_NEAR(light->pdfEscaped(from, s->direction), s->pdf, 1e-5f * s->pdf);
      ++observed[grid.cell(s->direction)];
      arriving.add(static_cast<double>(s->value.g / s->pdf));
    }
    if (light->isDelta()) continue;
    EXPECT_TRUE(countsAgree(observed, expected)) << type.name;
    EXPECT_TRUE(agrees(arriving, radiance)) << type.name;
  }
}

/// Directions in the disc, and to the sky around it: densities by chi-squared over the disc, energy over both.
TEST(Lights, TheDiscOfASunIsSampledEvenly) {
  const Registry registry = allPlugins();
  const Vector<World> sun = normalize(Vector<World>(0.3f, -0.4f, 0.6f));
  for (const float aperture : {0.5358f, 20.0f}) {
    SCOPED_TRACE(aperture);
    auto light = makeLight(
        registry, "sunsky",
        {{"sun_direction", Vector<scene::Unplaced>(sun.x, sun.y, sun.z)}, {"sun_aperture", aperture}}, nullptr);
    ASSERT_TRUE(light);
    const double sine = std::sin(static_cast<double>(aperture) * std::numbers::pi / 720);
    const DirectionGrid disc(sun, 2 * sine * sine, 8, 8);
    std::vector<double> observed(disc.cellCount() + 1), expected;
    double inside = 0;
    for (const double p : disc.integrateSmoothCells([&](Vector<World> d) { return (*light)->pdfEscaped({}, d); }, 8)) {
      expected.push_back(p * sampleCount);
      inside += p;
    }
    expected.push_back((1 - inside) * sampleCount);
    EXPECT_GT(inside, 0.25);
    double radiance = 0;
    for (const double r : disc.integrateSmoothCells([&](Vector<World> d) { return (*light)->escaped(d).g; }, 8))
      radiance += r;
    Uniforms random(seedOfTest());
    RunningMean arriving;
    for (int i = 0; i < sampleCount; ++i) {
      const auto s = (*light)->sample({}, {random.next(), random.next2D()});
      const std::size_t cell = s ? disc.cell(s->direction) : disc.cellCount();
      ++observed[cell];
      arriving.add(s && cell < disc.cellCount() ? static_cast<double>(s->value.g / s->pdf) : 0);
    }
    EXPECT_TRUE(countsAgree(observed, expected));
    EXPECT_TRUE(agrees(arriving, radiance, 0.01));
  }
}

TEST(Lights, TheChoiceAmongThemFollowsItsProbabilities) {
  const Registry registry = allPlugins();
  std::vector<std::unique_ptr<const Light>> lights;
  for (const float power : {1.0f, 0.0f, 10.0f, 1e-4f, 3.0f}) {
    auto light = makeLight(registry, "point",
                           {{"intensity", Color(power)}, {"position", Point<scene::Unplaced>(power, 0, 4)}}, nullptr);
    ASSERT_TRUE(light);
    lights.push_back(std::move(*light));
  }
  const LightSet set(std::move(lights), 1);
  std::vector<double> observed(5), expected;
  for (std::uint32_t i = 0; i < 5; ++i)
    expected.push_back(sampleCount * static_cast<double>(set.probability(i, {0, 0, 0})));
  EXPECT_EQ(expected[1], 0);
  EXPECT_GT(expected[3], 0.02 * sampleCount);
  Uniforms random(seedOfTest());
  RunningMean arriving;
  double truth = 0;
  for (const double power : {1.0, 10.0, 1e-4, 3.0}) truth += power / (16 + power * power);
  for (int i = 0; i < sampleCount; ++i) {
    const float u = random.next();
    ++observed[set.choose({0, 0, 0}, u)->index];
    const auto s = set.sample({0, 0, 0}, u, {random.next(), random.next2D()});
    arriving.add(static_cast<double>(s->value.g / s->pdf));
  }
  EXPECT_TRUE(countsAgree(observed, expected));
  EXPECT_TRUE(agrees(arriving, truth));
}

/// Another light with one thing 2% wrong.
class Planted final : public Light {
 public:
  enum class Fault { none, value, pdf, sampling };
  Planted(const Light& inner, Fault fault) : inner_(inner), fault_(fault) {}
  std::optional<LightSample> sample(Point<World> from, const LightUniforms& u) const override {
    LightUniforms used = u;
    if (fault_ == Fault::sampling) used.place[1] *= 0.98f;
    auto s = inner_.sample(from, used);
    if (s && fault_ == Fault::value) s->value *= 1.02f;
    return s;
  }
  float pdf(Point<World> from, const LightHit& hit) const override {
    return inner_.pdf(from, hit) * (fault_ == Fault::pdf ? 1.02f : 1.0f);
  }
  Color emitted(const LightHit& hit) const override { return inner_.emitted(hit); }
  Color power(float radius) const override { return inner_.power(radius); }
  float importance(Point<World> at) const override { return inner_.importance(at); }
  bool isDelta() const override { return inner_.isDelta(); }
  bool isInfinite() const override { return inner_.isInfinite(); }

 private:
  const Light& inner_;
  Fault fault_;
};

TEST(Lights, APlantedErrorOfTwoPercentIsCaught) {
  const Registry registry = allPlugins();
  const auto toWorld = affine(round2);
  const EmittingShape sphere{
      "sphere", build([&](auto& b) { return b.addSphere(toWorld); }), makeSphereLight(toWorld, false), {1, -2, 3}, 3};
  const auto light = make(registry, *registry.light("area"), sphere.surface);
  const Point<World> from{1.5f, -2.5f, 8};
  for (const auto fault : {Planted::Fault::value, Planted::Fault::pdf, Planted::Fault::sampling}) {
    Uniforms random(seedOfTest());
    EXPECT_FALSE(check(Planted(*light, fault), sphere, from, random)) << static_cast<int>(fault);
  }
  Uniforms random(seedOfTest());
  EXPECT_TRUE(check(Planted(*light, Planted::Fault::none), sphere, from, random));
}

}  // namespace
}  // namespace aerosol::render
