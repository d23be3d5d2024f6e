#include <fmt/format.h>

#include <numbers>

#include "tests/render/film_checks.h"

// Lights inside and beside of media: single scattering next to the lamp against quadrature, with distances chosen for
// the light and without, and what that choice is worth.

namespace aerosol::test {
namespace {

using std::numbers::pi;

/// A lamp at `light`, a point or a small sphere of radius `lampRadius`, inside of the unit ball of fog, which scatters
/// once and alike in all directions. Quadrature is in the angle under which the lamp sees the ray.
class LampInFog {
 public:
  std::array<double, 3> light{0.1, 0.3, -0.2};
  double sigma = 1.5, albedo = 0.8, intensity = 2;
  double lampRadius = 0;  ///< With it `intensity` is a radiance.

  Color operator()(const Ray<World>& ray) const {
    const std::array<double, 2> inside = throughSphere(ray, 1);
    double projection = 0, distance2 = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double way = light[i] - static_cast<double>(ray.origin[static_cast<int>(i)]);
      projection += way * static_cast<double>(ray.direction[static_cast<int>(i)]);
      distance2 += way * way;
    }
    distance2 -= projection * projection;
    const double distance = std::sqrt(distance2);
    const auto overAngle = [&](double angle) {
      const double x = distance * std::tan(angle), d2 = distance2 + x * x;
      const double through = std::exp(-sigma * (projection + x - inside[0]));
      return through * arriving(std::sqrt(d2)) * d2 / distance;
    };
    const double value = sigma * albedo / (4 * pi) *
                         integrate(overAngle, std::atan((inside[0] - projection) / distance),
                                   std::atan((inside[1] - projection) / distance), 40);
    return Color(static_cast<float>(value));
  }

  std::string xml(const std::string& sampling) const {
    const std::string lamp =
        lampRadius > 0 ? fmt::format(R"(<shape type="sphere"><point name="center" x="0.1" y="0.3" z="-0.2"/>
                <float name="radius" value="{}"/><emitter type="area"><rgb name="radiance" value="{}"/></emitter></shape>)",
                                     lampRadius, intensity)
                       : fmt::format(R"(<emitter type="point"><point name="position" x="0.1" y="0.3" z="-0.2"/>
                <rgb name="intensity" value="{}"/></emitter>)",
                                     intensity);
    const std::string medium =
        sampling.empty()
            ? R"(<medium type="homogeneous"><rgb name="sigma_t" value="1.5"/><rgb name="albedo" value="0.8"/></medium>)"
            // The slope makes the shader one that varies; where it is seen it is next to nothing.
            : fmt::format(R"(<medium type="ramp">{}<float name="at_zero" value="1.5"/>
                             <float name="slope" value="1e-7"/><float name="most" value="2"/>
                             <rgb name="albedo" value="0.8"/></medium>)",
                          sampling);
    return lamp + "<volume type=\"sphere\">" + medium + "</volume>";
  }

 private:
  /// Irradiance from all sides at a distance, weakened on the way. The sphere: over the cone that it fills.
  double arriving(double distance) const {
    if (!(lampRadius > 0)) return intensity * std::exp(-sigma * distance) / (distance * distance);
    const double lowest = std::sqrt(1 - lampRadius * lampRadius / (distance * distance));
    const auto overCosine = [&](double mu) {
      const double way =
          distance * mu - std::sqrt(std::max(0.0, lampRadius * lampRadius - distance * distance * (1 - mu * mu)));
      return 2 * pi * intensity * std::exp(-sigma * way);
    };
    return integrate(overCosine, lowest, 1, 4);
  }
};

/// Past the lamp: the nearest rays are 0.02 away from it.
const TestSensor besideTheLamp{.target = "0.1, 0.2, -0.2", .fov = 1.9, .width = 12, .height = 12};
constexpr const char* once = R"(<integer name="max_depth" value="2"/>)";
constexpr const char* onceWithout =
    R"(<integer name="max_depth" value="2"/><boolean name="equiangular" value="false"/>)";

/// What a medium asks for; nothing: a constant one. Each way to sample distances and each to estimate transmittance.
struct Method {
  const char* name;
  const char* xml;
  friend std::ostream& operator<<(std::ostream& out, const Method& m) { return out << m.name; }
};
constexpr std::array methods{
    Method{"closedForm", ""},
    Method{"nullScattering", R"(<string name="distance" value="null"/>)"},
    Method{"marching", R"(<string name="distance" value="marching"/><float name="step_size" value="0.02"/>)"},
    Method{"relaxedAndUnbiased", R"(<string name="distance" value="relaxed"/><float name="step_size" value="0.2"/>
        <string name="transmittance" value="unbiased"/>)"},
    Method{"marchingAndRatio", R"(<string name="distance" value="marching"/><float name="step_size" value="0.02"/>
        <string name="transmittance" value="ratio"/>)"},
    Method{"nullAndTwoCombs", R"(<string name="distance" value="null"/><float name="step_size" value="0.05"/>
        <string name="transmittance" value="two_combs"/>)"},
    Method{"delta", R"(<string name="distance" value="delta"/><string name="transmittance" value="delta"/>)"}};

class LightsInFog : public ::testing::TestWithParam<Method> {};

TEST_P(LightsInFog, APointMeetsQuadrature) {
  const LampInFog expected;
  const TestScene scene = loadScene(once, besideTheLamp, expected.xml(GetParam().xml));
  EXPECT_TRUE(shows(scene, *scene.render(256), expected));
}

TEST_P(LightsInFog, ASphereMeetsQuadrature) {
  LampInFog expected;
  expected.lampRadius = 0.01;
  expected.intensity = 5000;
  const TestScene scene = loadScene(once, besideTheLamp, expected.xml(GetParam().xml));
  EXPECT_TRUE(shows(scene, *scene.render(256), expected));
}

/// The three ways to the same value come apart when one of them is off by 2%.
TEST_P(LightsInFog, AFaultOfTwoPercentIsFound) {
  LampInFog expected;
  const TestScene scene = loadScene(once, besideTheLamp, expected.xml(GetParam().xml));
  const auto film = scene.render(256);
  expected.intensity *= 1.02;
  EXPECT_FALSE(shows(scene, *film, expected));
}

/// Places by the tables of marching.
class JointLights : public ::testing::TestWithParam<Method> {
 protected:
  const std::string joint = R"(<boolean name="joint_lights" value="true"/>)";
};

TEST_P(JointLights, MeetQuadrature) {
  LampInFog expected;
  for (const double radius : {0.0, 0.01}) {
    expected.lampRadius = radius;
    expected.intensity = radius > 0 ? 5000 : 2;
    const TestScene scene = loadScene(once + joint, besideTheLamp, expected.xml(GetParam().xml));
    ASSERT_EQ(scene.scene()->lightChoice, render::LightChoice::tabulated);
    EXPECT_TRUE(shows(scene, *scene.render(256), expected)) << radius;
    expected.intensity *= 1.02;
    EXPECT_FALSE(shows(scene, *scene.render(256), expected)) << radius;
  }
}

/// Few lights and many, one of them behind an overlap of media, after several scatterings.
TEST_P(JointLights, SeveralLightsShowTheSame) {
  for (const int count : {3, 40}) {
    std::string content = R"(<emitter type="constant"><rgb name="radiance" value="0.05"/></emitter>)";
    for (int i = 0; i < count; ++i) {
      content += fmt::format(R"(<emitter type="point"><point name="position" x="{}" y="{}" z="{}"/>
          <rgb name="intensity" value="{}"/></emitter>)",
                             0.9 * std::sin(5.0 * i), 0.9 * std::cos(3.0 * i), 0.6 * std::sin(2.0 * i + 1),
                             (1 + i % 3) * 0.6 / count);
    }
    content += fmt::format(R"(<volume type="sphere">{0}</volume><volume type="sphere"><transform name="to_world">
        <scale value="0.5"/><translate x="0.2"/></transform>{0}</volume>)",
                           GetParam().xml[0] ? fmt::format(R"(<medium type="ramp">{}<float name="at_zero" value="1"/>
            <float name="slope" value="0.4"/><float name="most" value="2"/><rgb name="albedo" value="0.8"/></medium>)",
                                                           GetParam().xml)
                                             : R"(<medium type="homogeneous"><rgb name="sigma_t" value="1, 1.4, 2"/>
            <rgb name="albedo" value="0.9, 0.7, 0.6"/></medium>)");
    const TestSensor view{.target = "0, -0.1, 0", .fov = 20, .width = 8, .height = 8};
    TestSensor other = view;
    other.seed = 1;
    const std::string depth = R"(<integer name="max_depth" value="4"/>)";
    const TestScene with = loadScene(depth + joint, view, content), without = loadScene(depth, other, content);
    ASSERT_EQ(with.scene()->lightChoice, render::LightChoice::tabulated);
    EXPECT_TRUE(showTheSame(*with.render(1024), *without.render(1024), 0.02)) << count;
  }
}

INSTANTIATE_TEST_SUITE_P(All, JointLights, ::testing::Values(methods[0], methods[2], methods[4]),
                         [](const auto& info) { return std::string(info.param.name); });

/// What needs tables is said to have none.
TEST(JointLightsElsewhere, HaveNoEffectAndAreReported) {
  const LampInFog lamp;
  TestSensor sensor{.width = 4, .height = 4};
  SceneOptions options;
  options.mayWarn = true;
  const std::string cloud = R"(<volume type="sphere"><medium type="cumulus"><string name="distance" value="null"/>
      </medium></volume>)";
  const TestScene scene =
      loadScene(R"(<boolean name="joint_lights" value="true"/>)", sensor, lamp.xml("") + cloud, options);
  EXPECT_EQ(scene.scene()->lightChoice, render::LightChoice::equiangular);
  EXPECT_NE(scene.warnings().find("'joint_lights' has no effect"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(All, LightsInFog, ::testing::ValuesIn(methods),
                         [](const auto& info) { return std::string(info.param.name); });

/// A lamp of a hundredth of the fog's size: over the whole ball of fog, and around the lamp.
TEST(LightsInFogVariance, IsManyTimesLessWithDistancesChosenForTheLight) {
  LampInFog lamp;
  lamp.lampRadius = 0.01;
  lamp.intensity = 5000;
  const TestSensor wholeBall{.fov = 24, .width = 16, .height = 16};
  const std::string content = lamp.xml("");
  // Seen by the camera itself, the lamp's edge would be all that varies.
  const std::string hidden = R"(<boolean name="hide_emitters" value="true"/>)";
  const TestScene with = loadScene(once + hidden, wholeBall, content);
  const TestScene without = loadScene(onceWithout + hidden, wholeBall, content);
  const double ratio = summedVariance(*without.render(1024)) / summedVariance(*with.render(1024));
  RecordProperty("ratio", fmt::format("{:.1f}", ratio));
  EXPECT_GT(ratio, 10);
  // Around the lamp, where most of the light is.
  const TestScene near = loadScene(once + hidden, besideTheLamp, content);
  const TestScene nearWithout = loadScene(onceWithout + hidden, besideTheLamp, content);
  const double nearRatio = summedVariance(*nearWithout.render(1024)) / summedVariance(*near.render(1024));
  RecordProperty("nearRatio", fmt::format("{:.1f}", nearRatio));
  EXPECT_GT(nearRatio, 25);
}

/// The same light with the same colours whatever method serves: lamps of each shape, with and without the choice.
TEST(LightsInFogShapes, BothWaysShowTheSame) {
  const auto shape = [](const char* type, const char* place) {
    return fmt::format(R"(<shape type="{}"><transform name="to_world">{}</transform>
        <emitter type="area"><rgb name="radiance" value="6, 3, 2"/></emitter></shape>
        <volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="0.6, 1, 1.4"/>
        <rgb name="albedo" value="0.9, 0.6, 0.4"/><float name="g" value="0.5"/></medium></volume>)",
                       type, place);
  };
  constexpr const char* inside = R"(<scale value="0.2"/><rotate x="1" y="1" angle="40"/><translate y="0.3"/>)";
  const TestSensor view{.fov = 24, .width = 8, .height = 8};
  for (const char* type : {"disk", "rectangle", "cube", "sphere"}) {
    for (const char* depth : {R"(<integer name="max_depth" value="2"/>)", R"(<integer name="max_depth" value="5"/>)"}) {
      const std::string off = std::string(depth) + R"(<boolean name="equiangular" value="false"/>)";
      TestSensor other = view;
      other.seed = 1;
      const TestScene with = loadScene(depth, view, shape(type, inside));
      const TestScene without = loadScene(off, other, shape(type, inside));
      EXPECT_TRUE(showTheSame(*with.render(1024), *without.render(3072), 0.04)) << type << ' ' << depth;
    }
  }
}

/// Several lights of different strength, two of them outside of the fog, one far away.
TEST(LightsInFogMany, BothWaysShowTheSame) {
  std::string content = R"(<volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="1"/>
      <rgb name="albedo" value="0.9"/></medium></volume><emitter type="constant"><rgb name="radiance" value="0.2"/></emitter>)";
  for (const auto& [place, intensity] : {std::pair{R"(x="0.4" y="0.5" z="0")", 1.0},
                                         {R"(x="-0.5" y="-0.4" z="0.3")", 0.3},
                                         {R"(x="0" y="1.3" z="-0.3")", 3.0},
                                         {R"(x="40" y="0" z="0")", 2000.0}}) {
    content +=
        fmt::format(R"(<emitter type="point"><point name="position" {}/><rgb name="intensity" value="{}"/></emitter>)",
                    place, intensity);
  }
  const TestSensor view{.target = "0, -0.2, 0", .fov = 6, .width = 8, .height = 8};
  TestSensor other = view;
  other.seed = 1;
  const TestScene with = loadScene(once, view, content), without = loadScene(onceWithout, other, content);
  EXPECT_TRUE(showTheSame(*with.render(1024), *without.render(8192), 0.01));
}

/// Forty lamps in fog and on a floor: one sample, or one of each of several clusters, at every vertex and along rays.
TEST(LightSplitting, ShowsTheSame) {
  for (const bool isConstant : {true, false}) {
    std::string content = R"(<emitter type="constant"><rgb name="radiance" value="0.05"/></emitter>
        <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="2"/>
        <translate y="-0.8"/></transform><bsdf type="diffuse"/></shape>)";
    for (int i = 0; i < 40; ++i) {
      const double size = i % 4 == 0 ? 0.03 : 0;
      const std::string place = fmt::format(R"(x="{}" y="{}" z="{}")", 0.8 * std::sin(5.0 * i),
                                            0.7 * std::cos(3.0 * i) + 0.05, 0.6 * std::sin(2.0 * i + 1));
      content += size > 0
                     ? fmt::format(R"(<shape type="sphere"><point name="center" {}/><float name="radius" value="{}"/>
          <bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="4"/></emitter></shape>)",
                                   place, size)
                     : fmt::format(R"(<emitter type="point"><point name="position" {}/>
          <rgb name="intensity" value="{}"/></emitter>)",
                                   place, 0.01 * (1 + i % 3));
    }
    content += fmt::format(R"(<volume type="sphere">{}</volume>)",
                           isConstant ? R"(<medium type="homogeneous"><rgb name="sigma_t" value="0.8"/></medium>)"
                                      : R"(<medium type="ramp"><string name="distance" value="null"/>
            <float name="at_zero" value="0.8"/><float name="slope" value="0.4"/><float name="most" value="1.5"/>
            <rgb name="albedo" value="0.8"/></medium>)");
    const TestSensor view{.target = "0, -0.2, 0", .fov = 16, .width = 8, .height = 8};
    TestSensor other = view;
    other.seed = 1;
    const std::string depth = R"(<integer name="max_depth" value="3"/>)";
    const TestScene with = loadScene(depth + R"(<float name="split_lights" value="0.05"/>)", view, content);
    const TestScene without = loadScene(depth + R"(<float name="split_lights" value="0"/>)", other, content);
    ASSERT_TRUE(with.scene()->splitsLights);
    ASSERT_FALSE(without.scene()->splitsLights);
    EXPECT_TRUE(showTheSame(*with.render(512), *without.render(1024), 0.02)) << isConstant;
  }
}

constexpr const char* noLampDirections = R"(<boolean name="lamp_directions" value="false"/>)";

/// Lamps of all kinds in a medium that scatters many times, forwards or not: directions towards them change no mean.
TEST(LampsInMedia, DirectionsTowardsThemShowTheSame) {
  const auto content = [](const std::string& lamp, const char* medium) {
    return lamp + fmt::format(R"(<volume type="sphere">{}</volume>)", medium);
  };
  const std::string ball = R"(<shape type="sphere"><point name="center" x="0.1" y="0.3" z="-0.2"/>
      <float name="radius" value="0.1"/><bsdf type="diffuse"/>
      <emitter type="area"><rgb name="radiance" value="6, 3, 2"/></emitter></shape>)";
  const std::string two = R"(<emitter type="constant"><rgb name="radiance" value="0.1"/></emitter>
      <emitter type="point"><point name="position" x="0.4" y="0.5" z="0"/><rgb name="intensity" value="1, 0.5, 0.2"/></emitter>
      <emitter type="point"><point name="position" x="-0.4" y="-0.2" z="0.1"/><rgb name="intensity" value="0.4"/></emitter>)";
  constexpr const char* fog = R"(<medium type="homogeneous"><rgb name="sigma_t" value="1, 1.5, 2"/>
      <rgb name="albedo" value="0.9, 0.8, 0.6"/></medium>)";
  constexpr const char* forward = R"(<medium type="homogeneous"><rgb name="sigma_t" value="2"/>
      <rgb name="albedo" value="0.9"/><float name="g" value="0.6"/></medium>)";
  constexpr const char* ramp = R"(<medium type="ramp"><string name="distance" value="null"/>
      <float name="at_zero" value="1"/><float name="slope" value="0.5"/><float name="most" value="2"/>
      <rgb name="albedo" value="0.8"/></medium>)";
  const std::string depth = R"(<integer name="max_depth" value="6"/><boolean name="hide_emitters" value="true"/>)";
  const TestSensor view{.fov = 24, .width = 8, .height = 8};
  TestSensor other = view;
  other.seed = 1;
  for (const auto& [lamp, medium] : {std::pair{ball, fog}, {two, forward}, {ball, ramp}, {two, fog}}) {
    const TestScene with = loadScene(depth, view, content(lamp, medium));
    const TestScene without = loadScene(depth + noLampDirections, other, content(lamp, medium));
    ASSERT_FALSE(with.scene()->lampsInMedia.empty());
    ASSERT_TRUE(without.scene()->lampsInMedia.empty());
    EXPECT_TRUE(showTheSame(*with.render(1024), *without.render(2048), 0.03)) << medium;
  }
}

/// Outside of media, and without equiangular sampling, there are none.
TEST(LampsInMedia, AreThoseThatStandInThem) {
  const auto countOf = [](const std::string& integrator, const char* y) {
    const TestScene scene =
        loadScene(integrator, {.width = 4, .height = 4},
                  fmt::format(R"(<emitter type="point"><point name="position" x="0" y="{}" z="0"/></emitter>
          <volume type="sphere"><medium type="homogeneous"/></volume>)",
                              y));
    return scene.scene()->lampsInMedia.size();
  };
  EXPECT_EQ(countOf("", "0.5"), 1u);
  EXPECT_EQ(countOf("", "1.5"), 0u);
  EXPECT_EQ(countOf(noLampDirections, "0.5"), 0u);
  EXPECT_EQ(countOf(R"(<boolean name="equiangular" value="false"/>)", "0.5"), 0u);
}

/// Light that is scattered up to 16 times.
TEST(LampsInMediaVariance, IsSeveralTimesLessWithDirectionsTowardsThem) {
  LampInFog lamp;
  lamp.lampRadius = 0.01;
  lamp.intensity = 5000;
  const std::string depth = R"(<integer name="max_depth" value="16"/><boolean name="hide_emitters" value="true"/>)";
  const TestSensor wholeBall{.fov = 24, .width = 16, .height = 16};
  const TestScene with = loadScene(depth, wholeBall, lamp.xml(""));
  const TestScene without = loadScene(depth + noLampDirections, wholeBall, lamp.xml(""));
  const double ratio = summedVariance(*without.render(512)) / summedVariance(*with.render(512));
  RecordProperty("ratio", fmt::format("{:.1f}", ratio));
  EXPECT_GT(ratio, 2);
}

/// Roulette does not take the paths that were sent towards the lamp, though each of these weighs little.
TEST(LampsInMediaVariance, IsNotBroughtBackByRoulette) {
  LampInFog lamp;
  lamp.lampRadius = 0.001;
  lamp.intensity = 5e5;
  const std::string depth = R"(<integer name="max_depth" value="16"/><boolean name="hide_emitters" value="true"/>)";
  const TestSensor wholeBall{.fov = 24, .width = 16, .height = 16};
  const TestScene whole = loadScene(depth + R"(<integer name="rr_depth" value="100"/>)", wholeBall, lamp.xml(""));
  const double variance = summedVariance(*whole.render(1024));
  for (const auto& [roulette, most] : {std::pair{"throughput", 2.5}, {"contribution", 1.4}}) {
    const TestScene played = loadScene(
        depth + fmt::format(R"(<integer name="rr_depth" value="1"/><string name="roulette" value="{}"/>)", roulette),
        wholeBall, lamp.xml(""));
    const double ratio = summedVariance(*played.render(1024)) / variance;
    RecordProperty(roulette, fmt::format("{:.2f}", ratio));
    EXPECT_LT(ratio, most) << roulette;
  }
}

}  // namespace
}  // namespace aerosol::test
