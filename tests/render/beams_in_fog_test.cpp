#include <fmt/format.h>

#include <numbers>

#include "tests/render/film_checks.h"

// Spots and projectors in fog: single scattering next to the light and across its beam against quadrature, what
// choosing distances within the beam is worth, and many of them.

namespace aerosol::test {
namespace {

using std::numbers::pi;

/// A light in the unit ball of fog that shines straight down.
struct BeamInFog {
  bool isProjector = false;
  double sigma = 1.5, albedo = 0.8, strength = 2;

  static constexpr std::array<double, 3> light{0.1, 0.3, -0.2};
  static constexpr double cutoff = 25 * pi / 180, beam = 0.75 * cutoff, tangent = 0.4;

  /// Radiant intensity towards a point, of which the light is at the origin.
  double intensity(const std::array<double, 3>& p) const {
    const double distance = std::hypot(p[0], p[1], p[2]), cosine = -p[1] / distance;
    if (!(cosine > 0)) return 0;
    if (isProjector) {
      const bool isLit = std::fabs(p[0]) < -p[1] * tangent && std::fabs(p[2]) < -p[1] * tangent;
      return isLit ? strength * pi / (cosine * cosine * cosine) : 0;
    }
    return strength * std::clamp((cutoff - std::acos(std::min(cosine, 1.0))) / (cutoff - beam), 0.0, 1.0);
  }

  Color operator()(const Ray<World>& ray) const {
    const std::array<double, 2> inside = throughSphere(ray, 1);
    std::array<double, 3> way{};
    double projection = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      way[i] = static_cast<double>(ray.origin[static_cast<int>(i)]) - light[i];
      projection -= way[i] * static_cast<double>(ray.direction[static_cast<int>(i)]);
    }
    std::array<double, 3> nearest{};
    for (std::size_t i = 0; i < 3; ++i)
      nearest[i] = way[i] + projection * static_cast<double>(ray.direction[static_cast<int>(i)]);
    const double distance = std::hypot(nearest[0], nearest[1], nearest[2]);
    const auto overAngle = [&](double angle) {
      const double x = distance * std::tan(angle);
      std::array<double, 3> p{};
      for (std::size_t i = 0; i < 3; ++i)
        p[i] = nearest[i] + x * static_cast<double>(ray.direction[static_cast<int>(i)]);
      return std::exp(-sigma * (projection + x - inside[0] + std::hypot(distance, x))) * intensity(p) / distance;
    };
    return Color(static_cast<float>(sigma * albedo / (4 * pi) *
                                    integrate(overAngle, std::atan((inside[0] - projection) / distance),
                                              std::atan((inside[1] - projection) / distance), 4000)));
  }

  std::string xml(bool varies) const {
    const std::string way = R"(<transform name="to_world"><lookat origin="0.1,0.3,-0.2" target="0.1,-1,-0.2"
        up="0,0,1"/></transform>)";
    const std::string emitter = isProjector
                                    ? fmt::format(R"(<emitter type="projector">{}<float name="fov" value="{}"/>
            <rgb name="irradiance" value="{}"/></emitter>)",
                                                  way, 2 * std::atan(tangent) * 180 / pi, strength)
                                    : fmt::format(R"(<emitter type="spot">{}<float name="cutoff_angle" value="25"/>
            <rgb name="intensity" value="{}"/></emitter>)",
                                                  way, strength);
    return emitter + "<volume type=\"sphere\">" +
           (varies ? R"(<medium type="ramp"><string name="distance" value="null"/><float name="at_zero" value="1.5"/>
               <float name="slope" value="1e-7"/><float name="most" value="2"/><rgb name="albedo" value="0.8"/></medium>)"
                   : R"(<medium type="homogeneous"><rgb name="sigma_t" value="1.5"/>
               <rgb name="albedo" value="0.8"/></medium>)") +
           "</volume>";
  }
};

/// Across the beam, far enough from its tip for quadrature over pixels.
const TestSensor acrossTheBeam{.target = "0.1, 0.1, -0.2", .fov = 1.9, .width = 12, .height = 12};
/// Just below the light.
const TestSensor belowTheLight{.target = "0.1, 0.2, -0.2", .fov = 1.9, .width = 12, .height = 12};
constexpr const char* once = R"(<integer name="max_depth" value="2"/>)";
constexpr const char* onceWithout =
    R"(<integer name="max_depth" value="2"/><boolean name="equiangular" value="false"/>)";

struct BeamCase {
  bool isProjector, varies;
  friend std::ostream& operator<<(std::ostream& out, const BeamCase& c) {
    return out << (c.isProjector ? "projector" : "spot") << (c.varies ? "InWhatVaries" : "");
  }
};

class BeamsInFog : public ::testing::TestWithParam<BeamCase> {};

TEST_P(BeamsInFog, MeetQuadrature) {
  BeamInFog expected{.isProjector = GetParam().isProjector};
  const TestScene scene = loadScene(once, acrossTheBeam, expected.xml(GetParam().varies));
  ASSERT_EQ(scene.scene()->lightChoice, render::LightChoice::equiangular);
  const auto film = scene.render(4096);
  EXPECT_TRUE(shows(scene, *film, expected));
  expected.strength *= 1.03;
  EXPECT_FALSE(shows(scene, *film, expected));
}

/// Against distances from tables, which know nothing of beams.
TEST_P(BeamsInFog, ShowTheSameAfterSeveralScatterings) {
  const BeamInFog beam{.isProjector = GetParam().isProjector};
  const std::string depth = R"(<integer name="max_depth" value="5"/>)";
  const TestSensor view{.fov = 24, .width = 8, .height = 8};
  TestSensor other = view;
  other.seed = 1;
  const TestScene with = loadScene(depth, view, beam.xml(GetParam().varies));
  const TestScene tables = loadScene(depth + R"(<boolean name="joint_lights" value="true"/>)", other, beam.xml(false));
  ASSERT_EQ(tables.scene()->lightChoice, render::LightChoice::tabulated);
  EXPECT_TRUE(showTheSame(*with.render(4096), *tables.render(8192), 0.05));
}

INSTANTIATE_TEST_SUITE_P(All, BeamsInFog,
                         ::testing::Values(BeamCase{false, false}, BeamCase{false, true}, BeamCase{true, false},
                                           BeamCase{true, true}),
                         [](const auto& info) { return testing::PrintToString(info.param); });

TEST(BeamsInFogVariance, IsManyTimesLessWithDistancesInTheBeam) {
  for (const bool isProjector : {false, true}) {
    const BeamInFog beam{.isProjector = isProjector};
    const TestScene with = loadScene(once, belowTheLight, beam.xml(false));
    const TestScene without = loadScene(onceWithout, belowTheLight, beam.xml(false));
    const double ratio = summedVariance(*without.render(1024)) / summedVariance(*with.render(1024));
    RecordProperty(isProjector ? "projector" : "spot", fmt::format("{:.1f}", ratio));
    EXPECT_GT(ratio, 20) << isProjector;
  }
}

/// Thirty spots stand in the hierarchy of lights: the same as each of them alone, in the mean.
TEST(ManyBeams, ShowTheSum) {
  const std::string fog = R"(<volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="1"/>
      <rgb name="albedo" value="0.8"/></medium></volume>)";
  const auto spot = [](int i) {
    return fmt::format(
        R"(<emitter type="spot"><transform name="to_world"><lookat origin="{0},{1},{2}" target="{3},0,{4}"
        up="0,0.1,1"/></transform><float name="cutoff_angle" value="{5}"/><rgb name="intensity" value="0.2"/></emitter>)",
        0.8 * std::sin(5.0 * i), 0.7 * std::cos(3.0 * i) + 0.05, 0.6 * std::sin(2.0 * i + 1), 0.5 * std::cos(7.0 * i),
        0.5 * std::sin(4.0 * i), 5 + 2 * i);
  };
  const TestSensor view{.fov = 24, .width = 4, .height = 4};
  std::string all = fog;
  for (int i = 0; i < 30; ++i) all += spot(i);
  const TestScene together = loadScene(once, view, all);
  ASSERT_FALSE(together.scene()->lights.tree().isEmpty());
  const auto film = together.render(16384);
  double sum = 0, error2 = 0, found = 0, foundError2 = 0;
  const auto gather = [](const render::Film& part, double& value, double& squared) {
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 4; ++x) {
        value += static_cast<double>(part.estimate(x, y).color.g);
        squared += std::pow(static_cast<double>(part.estimate(x, y).standardError.g), 2);
      }
    }
  };
  gather(*film, found, foundError2);
  for (int i = 0; i < 30; ++i) gather(*loadScene(once, view, fog + spot(i)).render(1024), sum, error2);
  EXPECT_NEAR(found, sum, 4.5 * std::sqrt(error2 + foundError2));
  EXPECT_LT(std::sqrt(error2 + foundError2), 0.015 * sum);
}

}  // namespace
}  // namespace aerosol::test
