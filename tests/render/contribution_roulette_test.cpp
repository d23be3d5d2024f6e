#include <fmt/format.h>

#include "tests/render/film_checks.h"

// Russian roulette by what paths may still bring: no mean changes, whatever the pilot has seen, and no weight explodes.

namespace aerosol::test {
namespace {

constexpr const char* byContribution = R"(<string name="roulette" value="contribution"/>)";
constexpr const char* byThroughput = R"(<string name="roulette" value="throughput"/>)";
const TestSensor view{.fov = 26, .width = 12, .height = 12};

TEST(ContributionRoulette, ShowsTheSame) {
  const std::string lamp = R"(<emitter type="point"><point name="position" x="0.3" y="0.4" z="0"/>
      <rgb name="intensity" value="1, 0.6, 0.3"/></emitter>)";
  const std::string ground = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
      <scale value="3"/><translate y="-1"/></transform><bsdf type="diffuse"/></shape>)";
  const std::string fog = R"(<volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="3, 4, 5"/>
      <rgb name="albedo" value="0.95, 0.8, 0.6"/></medium></volume>)";
  const std::string smoke = R"(<volume type="sphere"><medium type="ramp"><string name="distance" value="null"/>
      <float name="at_zero" value="3"/><float name="slope" value="2"/><float name="most" value="5"/>
      <rgb name="albedo" value="0.9"/></medium></volume>)";
  const std::string depth = R"(<integer name="max_depth" value="24"/>)";
  TestSensor other = view;
  other.seed = 1;
  for (const std::string& content : {lamp + fog, lamp + smoke + ground}) {
    const TestScene with = loadScene(depth + byContribution, view, content);
    const TestScene without = loadScene(depth + byThroughput, other, content);
    ASSERT_FALSE(with.scene()->contributions.isEmpty());
    ASSERT_TRUE(without.scene()->contributions.isEmpty());
    EXPECT_TRUE(showTheSame(*with.render(2048), *without.render(2048), 0.025));
  }
}

/// White fog in an even light cannot be seen.
TEST(ContributionRoulette, LosesNothingInAFurnace) {
  const TestScene scene =
      loadScene(byContribution, view, R"(<emitter type="constant"><rgb name="radiance" value="1"/></emitter>
      <volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="8"/><rgb name="albedo" value="1"/></medium></volume>)");
  ASSERT_FALSE(scene.scene()->contributions.isEmpty());
  EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>&) { return Color(1.0f); }));
}

/// A small bright lamp that hardly any path of the pilot sees: what survives has no more weight than the limit allows.
TEST(ContributionRoulette, MakesNoFirefliesOfWhatThePilotMissed) {
  const std::string content = R"(<emitter type="constant"><rgb name="radiance" value="0.01"/></emitter>
      <shape type="sphere"><point name="center" x="0" y="2" z="0"/><float name="radius" value="0.05"/>
        <emitter type="area"><rgb name="radiance" value="2000"/></emitter></shape>
      <shape type="cube"><transform name="to_world"><scale x="0.6" y="0.02" z="0.6"/><translate y="1.2"/></transform>
        <bsdf type="diffuse"/></shape>
      <volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="3"/>
        <rgb name="albedo" value="0.9"/></medium></volume>)";
  const auto worst = [&](const char* roulette) {
    const TestScene scene =
        loadScene(std::string(R"(<integer name="max_depth" value="40"/>)") + roulette, view, content);
    const auto film = scene.render(256);
    double sum = 0;
    for (int y = 0; y < view.height; ++y) {
      for (int x = 0; x < view.width; ++x)
        sum += std::pow(static_cast<double>(film->estimate(x, y).standardError.g), 2);
    }
    return sum;
  };
  EXPECT_LT(worst(byContribution), 2 * worst(byThroughput));
}

/// Fog on both sides of a wall with a gap, lit behind the wall: of the paths that find the gap most are split.
TEST(ContributionSplitting, ShowsTheSame) {
  const std::string walls = R"(<shape type="rectangle"><transform name="to_world"><scale x="1" y="2"/>
        <translate x="{0}1.4" z="0.3"/></transform><bsdf type="twosided"><bsdf type="diffuse">
        <rgb name="reflectance" value="0.2"/></bsdf></bsdf></shape>)";
  const std::string fog = R"(<medium name="interior" type="homogeneous"><rgb name="sigma_t" value="1.2, 1.4, 1.8"/>
      <rgb name="albedo" value="0.95, 0.9, 0.8"/></medium>)";
  const std::string content =
      fmt::format(fmt::runtime(walls), "") + fmt::format(fmt::runtime(walls), "-") +
      R"(<shape type="rectangle"><transform name="to_world"><scale value="0.4"/><rotate x="1" angle="90"/>
        <translate y="1.5" z="1.1"/></transform><emitter type="area"><rgb name="radiance" value="100"/></emitter></shape>
        <shape type="cube"><transform name="to_world"><scale value="1.6"/></transform><bsdf type="null"/>)" +
      fog + "</shape>";
  const std::string depth = R"(<integer name="max_depth" value="40"/>)";
  const TestSensor sensor{.fov = 36, .width = 24, .height = 24};
  TestSensor other = sensor;
  other.seed = 1;
  const TestScene with = loadScene(depth + byContribution, sensor, content);
  const TestScene without = loadScene(depth + byThroughput, other, content);
  ASSERT_FALSE(with.scene()->contributions.isEmpty());
  int most = 1;
  for (const float x : {-1.2f, -0.8f, -0.4f, 0.0f}) {
    for (const float y : {0.0f, 0.5f, 1.0f, 1.4f})
      most = std::max(most, with.scene()->contributions.branches({x, y, 1}, Color(1), 12, 12));
  }
  EXPECT_GT(most, 1);
  EXPECT_TRUE(showTheSame(*with.render(384), *without.render(384), 0.06));
}

/// The pilot is the same whatever renders it.
TEST(ContributionRoulette, DoesNotDependOnThreadsOrBatches) {
  const std::string content = R"(<emitter type="constant"/><volume type="sphere"><medium type="homogeneous">
      <rgb name="sigma_t" value="4"/><rgb name="albedo" value="0.8"/></medium></volume>)";
  const TestScene scene = loadScene(byContribution, view, content), again = loadScene(byContribution, view, content);
  const auto one = scene.film(), other = again.film();
  scene.renderInto(*one, {.threads = 1, .endSample = 16});
  again.renderInto(*other, {.threads = 3, .endSample = 16, .pathsInFlight = 7, .batchSize = 5});
  EXPECT_EQ(one->rgba(), other->rgba());
}

/// A pilot runs shaders more often than they were asked for: not those that print. That a loop's budget may be reported
/// is no reason.
TEST(ContributionRoulette, IsLeftToShadersThatSayNothing) {
  const auto learns = [](const char* medium) {
    const TestScene scene = loadScene(byContribution, view, std::string(R"(<emitter type="constant"/>
        <volume type="sphere"><medium type=")") + medium + R"("/></volume>)");
    return !scene.scene()->contributions.isEmpty();
  };
  EXPECT_TRUE(learns("cumulus"));
  EXPECT_FALSE(learns("talkative"));
}

}  // namespace
}  // namespace aerosol::test
