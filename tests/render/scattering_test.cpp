#include <fmt/format.h>

#include <functional>
#include <numbers>

#include "tests/render/film_checks.h"

// Scattering in media: one order against quadrature, all orders in furnaces, the meaning of the depth limit.

namespace aerosol::test {
namespace {

double henyeyGreenstein(double g, double cosine) {
  const double d = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * std::numbers::pi * d * std::sqrt(d));
}

/// Light of a point inside a homogeneous sphere, scattered once, by quadrature along the camera ray.
class PointInSphere {
 public:
  std::array<double, 3> light{0.1, 0.6, -0.2};
  Color sigmaT{0.5f, 1, 1.25f}, albedo{0.9f, 0.7f, 0.5f};
  double intensity = 5;
  /// Of the cosine between directions of travel.
  std::function<double(double)> phase = [](double cosine) { return henyeyGreenstein(0.4, cosine); };
  std::string phaseElement = R"(<phase type="hg"><float name="g" value="0.4"/></phase>)";

  Color operator()(const Ray<World>& ray) const {
    const std::array<double, 2> inside = throughSphere(ray, 1);
    return color([&](int c) {
      const auto sigma = static_cast<double>(sigmaT[c]);
      const auto along = [&](double t) {
        double squared = 0, projected = 0;
        for (int i = 0; i < 3; ++i) {
          const auto k = static_cast<std::size_t>(i);
          const double way = light[k] - static_cast<double>(ray.origin[i]) - t * static_cast<double>(ray.direction[i]);
          squared += way * way;
          projected += way * static_cast<double>(ray.direction[i]);
        }
        const double distance = std::sqrt(squared);
        // Directions of travel: light comes from the lamp, the path goes on towards it.
        return std::exp(-sigma * (t - inside[0] + distance)) * phase(projected / distance) / squared;
      };
      return intensity * sigma * static_cast<double>(albedo[c]) * integrate(along, inside[0], inside[1], 40);
    });
  }

  std::string medium(const std::string& sampling) const {
    return sampling.empty()
               ? R"(<medium type="homogeneous"><rgb name="sigma_t" value="0.5, 1, 1.25"/>
                    <rgb name="albedo" value="0.9, 0.7, 0.5"/>)" +
                     phaseElement + "</medium>"
               // The slope makes the shader one that varies; where it is seen it is next to nothing.
               : fmt::format(
                     R"(<medium type="ramp">{}<float name="at_zero" value="1"/><float name="slope" value="1e-7"/>
                    <float name="most" value="1.7"/><rgb name="tint" value="0.5, 1, 1.25"/>
                    <rgb name="albedo" value="0.9, 0.7, 0.5"/><float name="g" value="0.4"/></medium>)",
                     sampling);
  }
  std::string content(const std::string& sampling) const {
    return R"(<emitter type="point"><point name="position" x="0.1" y="0.6" z="-0.2"/><rgb name="intensity" value="5"/>
        </emitter><volume type="sphere">)" +
           medium(sampling) + "</volume>";
  }
};

/// The camera looks below the lamp: next to it the estimate has no variance.
const TestSensor lookingBelow{.target = "0, -0.2, 0", .fov = 9, .width = 12, .height = 12};

class SingleScattering : public ::testing::TestWithParam<const char*> {};

TEST_P(SingleScattering, MeetsQuadrature) {
  const PointInSphere expected;
  const TestScene scene =
      loadScene(R"(<integer name="max_depth" value="2"/>)", lookingBelow, expected.content(GetParam()));
  EXPECT_TRUE(shows(scene, *scene.render(4096), expected));
}

TEST_P(SingleScattering, AFaultOfTwoPercentIsFound) {
  PointInSphere expected;
  const TestScene scene =
      loadScene(R"(<integer name="max_depth" value="2"/>)", lookingBelow, expected.content(GetParam()));
  const auto film = scene.render(4096);
  expected.intensity *= 1.02;
  EXPECT_FALSE(shows(scene, *film, expected));
}

std::string samplerName(const ::testing::TestParamInfo<const char*>& info) {
  constexpr std::array names{"closedForm", "nullScattering", "marching"};
  return names[info.index];
}

TEST(PhasesOfMedia, ScatterOnceAsTheirFormulasSay) {
  const auto rayleigh = [](double c) { return 3 / (16 * std::numbers::pi) * (1 + c * c); };
  PointInSphere expected;
  const auto agrees = [&](const std::string& element, const std::function<double(double)>& formula) {
    expected.phaseElement = element;
    expected.phase = formula;
    const TestScene scene = loadScene(R"(<integer name="max_depth" value="2"/>)", lookingBelow, expected.content(""));
    return shows(scene, *scene.render(2048), expected);
  };
  EXPECT_TRUE(agrees(R"(<phase type="rayleigh"/>)", rayleigh));
  EXPECT_FALSE(agrees(R"(<phase type="rayleigh"/>)", [](double c) { return henyeyGreenstein(0, c); }));
  // 1, 3, 2 over the cosine from -1 to 1 has the integral 2π (2 + 2.5).
  EXPECT_TRUE(agrees(R"(<phase type="tabphase"><string name="values" value="1, 3, 2"/></phase>)",
                     [](double c) { return (c < 0 ? 3 + 2 * c : 3 - c) / (9 * std::numbers::pi); }));
  EXPECT_TRUE(agrees(R"(<phase type="blendphase"><float name="weight" value="0.25"/><phase type="rayleigh" name="b"/>
                        <phase type="hg" name="a"><float name="g" value="-0.3"/></phase></phase>)",
                     [&](double c) { return 0.75 * henyeyGreenstein(-0.3, c) + 0.25 * rayleigh(c); }));
  EXPECT_TRUE(agrees(R"(<phase type="draine"><float name="g" value="0.5"/><float name="alpha" value="4"/></phase>)",
                     [](double c) { return henyeyGreenstein(0.5, c) * (1 + 4 * c * c) / 3; }));
}

/// A weight out of a texture over space, which is even here: the same as a number.
TEST(PhasesOfMedia, WeightsOfBlendsMayBeFed) {
  PointInSphere expected;
  expected.phase = [](double c) {
    return 0.75 * henyeyGreenstein(-0.3, c) + 0.25 * 3 / (16 * std::numbers::pi) * (1 + c * c);
  };
  expected.phaseElement = R"(<phase type="blendphase"><volume name="weight" type="constvolume">
      <float name="value" value="0.25"/></volume><phase type="hg" name="a"><float name="g" value="-0.3"/></phase>
      <phase type="rayleigh" name="b"/></phase>)";
  const TestScene scene = loadScene(R"(<integer name="max_depth" value="2"/>)", lookingBelow, expected.content(""));
  EXPECT_TRUE(shows(scene, *scene.render(2048), expected));
}

/// One that differs from place to place: left of the middle all light goes by one function, right of it by the other.
TEST(PhasesOfMedia, WeightsOfBlendsVaryOverSpace) {
  const auto halves = [](double x, double left, double right) { return x < 0 ? left : right; };
  const std::string medium = R"(<volume type="box"><transform name="to_world"><scale x="1" y="1" z="0.5"/></transform>
      <medium type="homogeneous"><rgb name="sigma_t" value="0.2"/><rgb name="albedo" value="1"/>
      <phase type="blendphase"><texture name="weight" type="osl"><source>
      shader side(output float share = 0) { share = P[0] &lt; 0 ? 0 : 1; }</source></texture>
      <phase type="hg" name="a"><float name="g" value="0.6"/></phase>
      <phase type="hg" name="b"><float name="g" value="-0.6"/></phase></phase></medium></volume>
      <emitter type="directional"><vector name="direction" x="0" y="0" z="1"/></emitter>)";
  const TestScene scene = loadScene(R"(<integer name="max_depth" value="2"/>)", {.fov = 20}, medium);
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(shows(scene, *scene.render(16384), [&](const Ray<World>& ray) {
    // The slab is 1 thick along z; light goes on along the ray, or nearly so.
    const double z = static_cast<double>(ray.direction.z), x = static_cast<double>(ray.origin.x);
    const double begin = (-0.5 - static_cast<double>(ray.origin.z)) / z, end = begin + 1 / z;
    const auto along = [&](double t) {
      const double place = x + t * static_cast<double>(ray.direction.x), depth = (t - begin) * z;
      // The path sees light that travels along +z and comes back along -ray.
      const double g = halves(place, 0.6, -0.6);
      return 0.2 * std::exp(-0.2 * (t - begin + depth)) * henyeyGreenstein(g, -z);
    };
    return Color(static_cast<float>(integrate(along, begin, end, 400)));
  }));
}

INSTANTIATE_TEST_SUITE_P(All, SingleScattering,
                         ::testing::Values("", R"(<string name="distance" value="null"/>)",
                                           R"(<string name="distance" value="marching"/>
                                              <float name="step_size" value="0.1"/>)"),
                         samplerName);

// White furnaces: where radiance is 1 from everywhere and nothing is lost, it is 1 everywhere.

constexpr const char* furnace = R"(<emitter type="constant"><rgb name="radiance" value="1"/></emitter>)";

std::string whiteMedium(const std::string& sigma, double g) {
  return fmt::format(R"(<medium type="homogeneous"><rgb name="sigma_t" value="{}"/><rgb name="albedo" value="1"/>
                        <float name="g" value="{}"/></medium>)",
                     sigma, g);
}

/// Without roulette: what is lost is lost by rounding.
constexpr const char* noRoulette = R"(<integer name="rr_depth" value="1000000"/>)";

Color one(const Ray<World>&) { return Color(1.0f); }

class Furnace : public ::testing::TestWithParam<double> {};

TEST_P(Furnace, SphereOfAWhiteMedium) {
  const TestScene scene = loadScene(
      noRoulette, {}, std::string(furnace) + "<volume type=\"sphere\">" + whiteMedium("3", GetParam()) + "</volume>");
  EXPECT_TRUE(shows(scene, *scene.render(512), one));
}

TEST_P(Furnace, ChromaticWhiteMediumOverAWhiteGround) {
  const TestScene scene =
      loadScene(R"(<integer name="rr_depth" value="100000"/>)", {.origin = "0, 2, -5"},
                std::string(furnace) + "<volume type=\"sphere\">" + whiteMedium("1, 2, 3", GetParam()) + R"(</volume>
      <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="30"/>
      <translate x="0" y="-1" z="0"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf></shape>)");
  EXPECT_TRUE(shows(scene, *scene.render(768), one));
}

TEST_P(Furnace, InteriorOfANullCube) {
  const TestScene scene = loadScene(noRoulette, {},
                                    std::string(furnace) + R"(<shape type="cube"><bsdf type="null"/>
      <medium type="homogeneous" name="interior"><rgb name="sigma_t" value="2"/><rgb name="albedo" value="1"/>)" +
                                        fmt::format(R"(<float name="g" value="{}"/></medium></shape>)", GetParam()));
  EXPECT_TRUE(shows(scene, *scene.render(512), one));
}

INSTANTIATE_TEST_SUITE_P(Anisotropies, Furnace, ::testing::Values(0.0, 0.9, -0.5),
                         [](const auto& info) { return "number" + std::to_string(info.index); });

TEST(ScriptedFurnace, BothSamplersKeepAllLight) {
  for (const char* sampling : {R"(<string name="distance" value="null"/>)",
                               R"(<string name="distance" value="marching"/><float name="step_size" value="0.2"/>)"}) {
    const TestScene scene =
        loadScene(noRoulette, {}, std::string(furnace) + R"(<volume type="sphere"><medium type="fbm">)" + sampling + R"(
        <float name="density" value="6"/><float name="threshold" value="-0.2"/><rgb name="albedo" value="1"/></medium></volume>)");
    EXPECT_TRUE(shows(scene, *scene.render(512), one)) << sampling;
  }
}

TEST(DenseFurnace, LosesNothing) {
  const TestScene scene =
      loadScene(noRoulette, {.fov = 15, .width = 8, .height = 8},
                std::string(furnace) + "<volume type=\"sphere\">" + whiteMedium("40", 0) + "</volume>");
  EXPECT_TRUE(shows(scene, *scene.render(640), one));
}

/// From the centre of an optical radius of 130 light needs about 130² / 2 collisions to get out.
TEST(DenseFurnace, TenThousandBouncesLoseNothing) {
  const TestScene scene =
      loadScene(noRoulette, {.origin = "0, 0, 0", .target = "0, 0, 1", .width = 4, .height = 4},
                std::string(furnace) + "<volume type=\"sphere\">" + whiteMedium("130", 0) + "</volume>");
  auto film = scene.film();
  const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = 20});
  EXPECT_TRUE(shows(scene, *film, one, 0.05));
  EXPECT_GT(report.statistics.pathVertices, 20u * 16 * 7000) << "not dense";
}

/// Inside a diffuse sphere of reflectance r that shines with radiance 1, paths of up to n segments see the geometric
/// series 1 + r + … + r^(n - 1); without a limit 1 / (1 - r).
class DepthLimit : public ::testing::TestWithParam<int> {};

std::string shiningSphere(double reflectance) {
  return fmt::format(R"(<shape type="sphere"><boolean name="flip_normals" value="true"/><float name="radius" value="2"/>
      <bsdf type="diffuse"><rgb name="reflectance" value="{}"/></bsdf>
      <emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>)",
                     reflectance);
}

TEST_P(DepthLimit, CountsTheSegmentsOfAPath) {
  const int depth = GetParam();
  const TestScene scene = loadScene(fmt::format(R"(<integer name="max_depth" value="{}"/>)", depth),
                                    {.origin = "0.3, 0.2, -1", .fov = 70}, shiningSphere(0.5));
  const double expected = depth < 0 ? 2 : 2 * (1 - std::pow(0.5, depth));
  EXPECT_TRUE(shows(scene, *scene.render(depth < 0 ? 1024 : 256),
                    [&](const Ray<World>&) { return Color(static_cast<float>(expected)); }));
}

INSTANTIATE_TEST_SUITE_P(All, DepthLimit, ::testing::Values(-1, 0, 1, 2, 3, 7), [](const auto& info) {
  return info.param < 0 ? "unlimited" : "depth" + std::to_string(info.param);
});

/// In a medium too: what is missing at depth n is the light that was scattered at least n times.
TEST(DepthLimitInMedia, OneShowsEmittersThroughTheMediumAndNothingElse) {
  const TestScene scene =
      loadScene(R"(<integer name="max_depth" value="1"/>)", {},
                std::string(furnace) + "<volume type=\"sphere\">" + whiteMedium("0.5", 0) + "</volume>");
  EXPECT_TRUE(shows(scene, *scene.render(1024), [](const Ray<World>& ray) {
    const std::array<double, 2> inside = throughSphere(ray, 1);
    return Color(static_cast<float>(std::exp(-0.5 * (inside[1] - inside[0]))));
  }));
}

/// A ball inside of a shining sphere shows its light; beside the ball the camera looks through the sphere into nothing.
TEST(HiddenEmitters, AreNotSeenButShine) {
  const std::string content = shiningSphere(0.5) + R"(<shape type="sphere"><point name="center" x="0" y="0" z="0.5"/>
      <float name="radius" value="0.3"/><bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf></shape>)";
  constexpr const char* hidden = R"(<integer name="max_depth" value="2"/><boolean name="hide_emitters" value="true"/>)";
  const TestScene ball = loadScene(hidden, {.origin = "0.3, 0.2, -1", .target = "0, 0, 0.5", .fov = 6}, content);
  EXPECT_TRUE(shows(ball, *ball.render(256), [](const Ray<World>&) { return Color(0.5f); }));
  const TestScene beside = loadScene(hidden, {.origin = "0.3, 0.2, -1", .target = "1, 0, 0.5", .fov = 6}, content);
  EXPECT_TRUE(shows(beside, *beside.render(16), [](const Ray<World>&) { return Color(0.0f); }));
}

/// The closed sphere filled with a medium: a furnace from inside, with absorption made up for by emission.
TEST(ThermalEquilibrium, AbsorbersAtOneTemperatureAreInvisible) {
  const TestScene scene = loadScene("", {.origin = "0.3, 0.2, -1", .fov = 70}, R"(
      <shape type="sphere"><boolean name="flip_normals" value="true"/><float name="radius" value="2"/>
      <bsdf type="diffuse"><rgb name="reflectance" value="0.4"/></bsdf>
      <emitter type="area"><rgb name="radiance" value="0.6"/></emitter></shape>
      <volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="2"/><rgb name="albedo" value="0.7"/>
      <rgb name="emission" value="0.6"/></medium></volume>)");
  EXPECT_TRUE(shows(scene, *scene.render(1024), one));
}

}  // namespace
}  // namespace aerosol::test
