#include "core/app/plan/effects.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "tests/render/film_checks.h"

// Only the effects that a scene calls for: what the plan says is off has done nothing when the image is there.

namespace aerosol::test {
namespace {

constexpr const char* sky = R"(<emitter type="constant"/>)";
constexpr const char* homogeneous =
    R"(<medium type="homogeneous"><rgb name="sigma_t" value="1"/><rgb name="albedo" value="0.8"/></medium>)";
constexpr const char* ground = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
    <scale value="9"/><translate x="0" y="-1" z="0"/></transform><bsdf type="diffuse"/></shape>)";
constexpr const char* absorber =
    R"(<medium type="homogeneous"><rgb name="sigma_t" value="1"/><rgb name="albedo" value="0"/></medium>)";

std::string volume(const std::string& medium, double x = 0) {
  return fmt::format(
      R"(<volume type="sphere"><transform name="to_world"><translate x="{}" y="0" z="0"/></transform>{}</volume>)", x,
      medium);
}
std::string ramp(const char* distance, const char* more = "") {
  return fmt::format(R"(<medium type="ramp"><string name="distance" value="{}"/><float name="at_zero" value="0.6"/>
      <float name="slope" value="0.4"/><float name="most" value="1"/>{}</medium>)",
                     distance, more);
}

/// A scene and the effects that have to be on in it, of those that have a counter or that preparation decides.
struct EffectCase {
  const char* name;
  std::string content;
  std::set<std::string> on;
  std::string sensor{};  ///< Elements inside of it.
};

constexpr const char* open = R"(<float name="shutter_open" value="0"/><float name="shutter_close" value="1"/>)";
constexpr const char* sliding = R"(<animation name="to_world"><transform time="0"><translate x="0"/></transform>
    <transform time="1"><translate x="0.5"/></transform></animation>)";
constexpr const char* lamp = R"(<emitter type="point"><point name="position" x="0" y="2" z="-2"/></emitter>)";

const std::vector<EffectCase>& cases() {
  static const std::vector<EffectCase> list{
      {"nothing", "", {}},
      {"sky", sky, {"light-sampling", "constant-light"}},
      {"ground", std::string(sky) + ground, {"light-sampling", "constant-light", "surfaces"}},
      {"absorber", volume(absorber), {"volumes", "constant-media"}},
      {"cloudlet",
       sky + volume(homogeneous),
       {"light-sampling", "constant-light", "volumes", "constant-media", "volume-scattering"}},
      {"overlap", volume(absorber) + volume(absorber, 0.5), {"volumes", "constant-media", "overlap"}},
      {"disjoint", volume(absorber, -1.5) + volume(absorber, 1.5), {"volumes", "constant-media"}},
      {"null", volume(ramp("null")), {"volumes", "heterogeneity", "null-scattering", "bound-trees"}},
      {"marching", volume(ramp("marching")), {"volumes", "heterogeneity", "ray-marching", "bound-trees"}},
      {"fire",
       volume(ramp("null", R"(<rgb name="glow" value="1"/>)")),
       {"volumes", "heterogeneity", "null-scattering", "bound-trees", "volume-emission", "light-sampling"}},
      {"chromatic",
       volume(
           R"(<medium type="homogeneous"><rgb name="sigma_t" value="1, 2, 3"/><rgb name="albedo" value="0"/></medium>)"),
       {"volumes", "constant-media", "chromatic-extinction"}},
      {"glass",
       std::string(sky) + R"(<shape type="sphere"><bsdf type="dielectric"/></shape>)",
       {"light-sampling", "constant-light", "surfaces"}},
      {"nested_glass",
       std::string(sky) +
           R"(<shape type="sphere"><bsdf type="dielectric"><integer name="priority" value="1"/></bsdf></shape>)",
       {"light-sampling", "constant-light", "surfaces", "nested-media"}},
      {"subsurface",
       std::string(sky) + R"(<shape type="sphere"><bsdf type="subsurface"/></shape>)",
       {"light-sampling", "constant-light", "surfaces", "subsurface"}},
      {"interior",
       fmt::format(R"(<shape type="sphere"><bsdf type="null"/>{}</shape>)",
                   std::string(absorber).replace(0, 7, "<medium name=\"interior\"")),
       {"constant-media", "medium-boundaries"}},
      {"spot",
       std::string(R"(<emitter type="spot"><transform name="to_world"><lookat origin="0,2,-2" target="0,-1,0"
           up="0,1,0"/></transform></emitter>)") +
           ground,
       {"light-sampling", "spot-lights", "surfaces"}},
      {"day", R"(<emitter type="sunsky"/>)", {"light-sampling", "sun-and-sky"}},
      {"lamp_in_fog",
       lamp + volume(homogeneous),
       {"light-sampling", "point-lights", "volumes", "constant-media", "volume-scattering", "equiangular-sampling"}},
      {"lamp_in_smoke", lamp + volume(absorber), {"light-sampling", "point-lights", "volumes", "constant-media"}},
      {"still", fmt::format(R"(<shape type="sphere">{}</shape>)", sliding), {"surfaces"}},
      {"moving_shape",
       fmt::format(R"(<shape type="sphere">{}</shape>)", sliding),
       {"surfaces", "motion", "moving-shapes"},
       open},
      {"moving_volume",
       fmt::format(R"(<volume type="sphere">{}{}</volume>)", sliding, absorber),
       {"volumes", "constant-media", "motion", "moving-volumes"},
       open},
      {"velocity",
       R"(<volume type="sphere"><string name="velocity" value="velocity"/><medium type="drift">
           <vector name="wind" value="1, 0, 0"/><string name="distance" value="null"/></medium></volume>)",
       {"volumes", "heterogeneity", "null-scattering", "bound-trees", "motion", "velocity-blur"},
       open},
      {"holdout",
       fmt::format(R"(<volume type="sphere"><boolean name="holdout" value="true"/>{}</volume>)", absorber),
       {"volumes", "constant-media", "volume-scattering", "holdouts"}}};
  return list;
}

class Effects : public ::testing::TestWithParam<EffectCase> {};

/// Effects that nearly any scene has.
const std::set<std::string> always{"multiple-scattering", "russian-roulette", "ray-tracing"};

TEST_P(Effects, AreOnWhereTheyAreCalledForAndDoNothingElsewhere) {
  const TestScene scene =
      loadScene("", {.fov = 40, .width = 8, .height = 8, .medium = GetParam().sensor}, GetParam().content);
  ASSERT_TRUE(scene.scene());
  auto film = scene.film();
  const render::WorkerStatistics statistics = scene.renderInto(*film, {.threads = 1, .endSample = 32}).statistics;
  for (const app::Effect& effect : app::listEffects(scene.description(), *scene.scene())) {
    EXPECT_FALSE(effect.reason.empty()) << effect.name;
    if (always.contains(effect.name)) continue;
    // Chromatic extinction of a medium that varies is not ruled out.
    const bool isDoubtful =
        effect.name == "chromatic-extinction" && effect.isOn && !GetParam().on.contains(effect.name);
    if (isDoubtful) {
      EXPECT_NE(effect.reason.find("not ruled out"), std::string::npos);
    } else {
      EXPECT_EQ(effect.isOn, GetParam().on.contains(effect.name)) << effect.name << ": " << effect.reason;
    }
    if (!effect.work) continue;
    if (!effect.isOn) EXPECT_EQ(effect.work(statistics), 0u) << effect.name;
    const bool mayRest = effect.name == "nested-media" || effect.name == "light-sampling";
    if (effect.isOn && !mayRest) EXPECT_GT(effect.work(statistics), 0u) << effect.name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Effects, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return std::string(info.param.name); });

/// Forcing each effect off removes it from the plan, or its light from the image.
TEST(RemovedEffects, AreOffInThePlan) {
  const std::string content =
      std::string(sky) + R"(<emitter type="point"><point name="position" x="0" y="2" z="-2"/></emitter>
      <emitter type="directional"><vector name="direction" x="0" y="-1" z="1"/></emitter><emitter type="spot"/>
      <shape type="sphere"><point name="center" x="0" y="3" z="0"/><emitter type="area"/></shape>)" +
      ground + volume(homogeneous) +
      std::string(R"(<shape type="sphere"><point name="center" x="2" y="0" z="0"/><bsdf type="null"/>)") +
      std::string(absorber).replace(0, 7, "<medium name=\"interior\"") + "</shape>";
  const TestScene scene = loadScene("", {.fov = 40, .width = 4, .height = 4}, content);
  ASSERT_TRUE(scene.scene());
  const std::map<std::string, std::string> shownAs{{"surface-media", "medium-boundaries"}};
  int removed = 0;
  for (const app::RemovableEffect& effect : app::removableEffects()) {
    scene::SceneDescription description = scene.description();
    EXPECT_FALSE(app::removeEffects({effect.name}, description).hasErrors());
    const auto isOn = [&](const scene::SceneDescription& described) {
      for (const app::Effect& each : app::listEffects(described, *scene.scene())) {
        if (each.name == effect.name) return each.isOn;
      }
      return false;
    };
    // What depends on the description alone shows without preparing anew.
    const bool isDescribed = effect.name.ends_with("light") || effect.name.ends_with("lights") ||
                             effect.name == "multiple-scattering" || effect.name == "russian-roulette";
    if (!isDescribed) continue;
    EXPECT_TRUE(isOn(scene.description())) << effect.name;
    EXPECT_FALSE(isOn(description)) << effect.name;
    ++removed;
  }
  EXPECT_EQ(removed, 7);
}

TEST(RemovedEffects, UnknownOnesAreRefusedWithTheKnown) {
  scene::SceneDescription description;
  const Diagnostics errors = app::removeEffects({"volume"}, description);
  ASSERT_EQ(errors.errorCount(), 1);
  EXPECT_NE(errors.entries()[0].notes[0].find("'volumes'"), std::string::npos);
}

}  // namespace
}  // namespace aerosol::test
