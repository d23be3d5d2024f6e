#include "core/app/plan/effects.h"
#include "core/app/plan/event_costs.h"
#include "core/app/plan/features.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "tests/render/film_checks.h"
#include "tests/support/test_tables.h"

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
  std::string sensor{};           ///< Elements inside of it.
  std::set<std::string> rests{};  ///< Of `on`: that have nothing to do all the same.
  std::string sensorType = "perspective";
  std::string placement{};   ///< Of the sensor.
  std::string integrator{};  ///< Elements inside of it.
};

constexpr const char* open = R"(<float name="shutter_open" value="0"/><float name="shutter_close" value="1"/>)";
constexpr const char* sliding = R"(<animation name="to_world"><transform time="0"><translate x="0"/></transform>
    <transform time="1"><translate x="0.5"/></transform></animation>)";
/// A shader of a surface.
std::string paint(const char* code) {
  return fmt::format(R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/></transform>
    <bsdf type="osl"><source>surface paint() {{ {} }}</source></bsdf></shape>)",
                     code);
}
std::string lamps(int count) {
  std::string all;
  for (int i = 0; i < count; ++i) {
    all += fmt::format(R"(<emitter type="point" id="l{}"><point name="position" x="{}" y="2" z="-2"/></emitter>)", i,
                       0.1 * i);
  }
  return all;
}
/// Voxels laid into a box: what is solved cell by cell.
const std::string voxels =
    R"(<volume type="grid"><string name="filename" value=")" AEROSOL_SOURCE_DIR
    R"(/scenes/cloud.vdb"/><medium type="grid"><string name="filename" value=")" AEROSOL_SOURCE_DIR
    R"(/scenes/cloud.vdb"/></medium></volume>)";
constexpr const char* picture = R"(<texture type="bitmap" name="{}"><string name="filename" value=")" AEROSOL_SOURCE_DIR
                                R"(/tests/render/shaders/sky.ppm"/></texture>)";
std::string pictureFor(const char* name) {
  return std::string(picture).replace(std::string(picture).find("{}"), 2, name);
}

constexpr const char* lamp = R"(<emitter type="point"><point name="position" x="0" y="2" z="-2"/></emitter>)";

const std::vector<EffectCase>& cases() {
  static const std::vector<EffectCase> list{
      {"nothing", "", {}},
      {"sky", sky, {"constant-light"}},
      {"ground", std::string(sky) + ground, {"constant-light", "surfaces"}},
      {"absorber", volume(absorber), {"volumes", "constant-media"}},
      {"cloudlet", sky + volume(homogeneous), {"constant-light", "volumes", "constant-media", "volume-scattering"}},
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
      {"chromatic_ramp",
       volume(ramp("null", R"(<rgb name="tint" value="1, 2, 3"/>)")),
       {"volumes", "heterogeneity", "null-scattering", "bound-trees", "chromatic-extinction"},
       "",
       {"chromatic-extinction"}},
      {"glass",
       std::string(sky) + R"(<shape type="sphere"><bsdf type="dielectric"/></shape>)",
       {"constant-light", "surfaces"}},
      {"nested_glass",
       std::string(sky) +
           R"(<shape type="sphere"><bsdf type="dielectric"><integer name="priority" value="1"/></bsdf></shape>)",
       {"constant-light", "surfaces", "nested-media"}},
      {"clamped",
       std::string(sky) + R"(<shape type="sphere"><transform name="to_world"><scale value="30"/></transform>
           <bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
           <emitter type="point"><point name="position" x="0" y="2" z="-2"/></emitter>)",
       {"light-sampling", "constant-light", "point-lights", "surfaces", "clamped-indirect"},
       "",
       {},
       "perspective",
       "",
       R"(<float name="clamp_indirect" value="0.0001"/>)"},
      {"displaced",
       std::string(sky) + R"(<shape type="sphere"><displacement type="height"/></shape>)",
       {"constant-light", "surfaces", "displacement"}},
      {"subsurface",
       std::string(sky) + R"(<shape type="sphere"><bsdf type="subsurface"/></shape>)",
       {"constant-light", "surfaces", "subsurface"}},
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
      {"lamp_inside",
       std::string(R"(<emitter type="point"><point name="position" x="0" y="0.2" z="0"/></emitter>)") +
           volume(homogeneous),
       {"light-sampling", "point-lights", "volumes", "constant-media", "volume-scattering", "equiangular-sampling",
        "lamp-directions"}},
      {"tabulated_lamp",
       R"(<emitter type="point"><point name="position" x="0" y="0.2" z="0"/></emitter>)" + volume(homogeneous),
       {"light-sampling", "point-lights", "volumes", "constant-media", "volume-scattering", "joint-lights",
        "lamp-directions"},
       "",
       {},
       "perspective",
       "",
       R"(<boolean name="joint_lights" value="true"/>)"},
      {"expected",
       sky + volume(homogeneous),
       {"constant-light", "volumes", "constant-media", "volume-scattering", "contribution-roulette"},
       "",
       {},
       "perspective",
       "",
       R"(<string name="roulette" value="contribution"/>)"},
      {"lamp_in_smoke", lamp + volume(absorber), {"light-sampling", "point-lights", "volumes", "constant-media"}},
      {"still", fmt::format(R"(<shape type="sphere">{}</shape>)", sliding), {"surfaces"}},
      {"moving_shape",
       fmt::format(R"(<shape type="sphere">{}</shape>)", sliding),
       {"surfaces", "motion", "moving-shapes"},
       open},
      {"moving_light",
       fmt::format(R"(<emitter type="point">{}</emitter>)", sliding) + ground,
       {"light-sampling", "point-lights", "surfaces", "motion", "moving-lights"},
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
       {"volumes", "constant-media", "holdouts"}},
      {"lens",
       std::string(sky) + ground,
       {"constant-light", "surfaces", "depth-of-field"},
       R"(<float name="aperture_radius" value="0.1"/>)",
       {},
       "thinlens"},
      {"travelling_camera",
       std::string(sky) + ground,
       {"constant-light", "surfaces", "motion", "moving-camera"},
       open,
       {},
       "perspective",
       R"(<animation name="to_world"><transform time="0"><lookat origin="0,0,-5" target="0,0,0" up="0,1,0"/></transform>
    <transform time="1"><lookat origin="0,1,-5" target="0,0,0" up="0,1,0"/></transform></animation>)"},
      {"camera_in_a_face",
       sky +
           fmt::format(R"(<shape type="cube"><transform name="to_world"><scale x="9" y="1" z="9"/>
           <translate y="-1"/></transform><integer name="priority" value="1"/><bsdf type="null"/>{}</shape>)",
                       std::string(absorber).replace(0, 7, "<medium name=\"interior\"")) +
           R"(<shape type="sphere"><bsdf type="dielectric"><integer name="priority" value="2"/></bsdf></shape>)",
       {"constant-light", "constant-media", "surfaces", "medium-boundaries", "nested-media", "media-probes"}},
      {"sun",
       std::string(R"(<emitter type="directional"><vector name="direction" x="0" y="-1" z="1"/></emitter>)") + ground,
       {"light-sampling", "directional-lights", "surfaces"}},
      {"beamer",
       std::string(R"(<emitter type="projector"><transform name="to_world"><lookat origin="0,2,-2" target="0,-1,0"
           up="0,0,1"/></transform></emitter>)") +
           ground,
       {"light-sampling", "projectors", "surfaces"}},
      {"map",
       std::string(R"(<emitter type="envmap"><string name="filename" value=")" AEROSOL_SOURCE_DIR
                   R"(/tests/render/shaders/sky.ppm"/></emitter>)") +
           ground,
       {"light-sampling", "environment-maps", "surfaces"}},
      {"scripted_sky",
       std::string(R"(<emitter type="background"><bsdf type="osl"><source>surface s() { Ci = background(); }</source>
           </bsdf></emitter>)") +
           ground,
       {"light-sampling", "background-shaders", "surfaces"}},
      {"panel",
       std::string(R"(<shape type="sphere"><point name="center" x="0" y="3" z="0"/><emitter type="area"/></shape>)") +
           ground,
       {"light-sampling", "area-lights", "surfaces"}},
      {"poster",
       R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/></transform>
           <emitter type="area">)" +
           pictureFor("radiance") + "</emitter></shape>" + ground,
       {"light-sampling", "area-lights", "light-textures", "surfaces", "textures"}},
      {"many_lamps",
       lamps(40) + ground,
       {"light-sampling", "point-lights", "light-hierarchy", "light-splitting", "surfaces"}},
      {"linked",
       lamps(2) + std::string(R"(<volume type="sphere"><string name="lights" value="l1"/>)") + homogeneous +
           "</volume>",
       {"light-sampling", "point-lights", "light-links", "volumes", "constant-media", "volume-scattering",
        "equiangular-sampling"}},
      {"window",
       std::string(lamp) + ground +
           R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/></transform>
           <bsdf type="dielectric"><integer name="straight_shadows" value="1"/></bsdf></shape>)",
       {"light-sampling", "point-lights", "surfaces", "straight-shadows"}},
      {"voxels",
       voxels,
       {"volumes", "heterogeneity", "analytic-voxels", "bound-trees", "volume-scattering", "textures"},
       "",
       {"heterogeneity", "textures"}},
      {"coarse_voxels",
       sky + voxels,
       {"volumes", "heterogeneity", "analytic-voxels", "bound-trees", "volume-scattering", "textures", "constant-light",
        "level-of-detail"},
       "",
       {"heterogeneity", "textures"},
       "perspective",
       "",
       R"(<integer name="lod_depth" value="1"/>)"},
      {"picture",
       std::string(sky) + R"(<shape type="sphere"><bsdf type="diffuse">)" + pictureFor("reflectance") +
           "</bsdf></shape>",
       {"constant-light", "surfaces", "textures"}},
      {"filtered",
       sky + paint("Ci = (filterwidth(u) + 0.1) * diffuse(N);"),
       {"constant-light", "surfaces", "derivatives"}},
      {"changed",
       R"(<volume type="sphere"><float name="density" value="0.5"/>)" + ramp("null") + "</volume>",
       {"volumes", "heterogeneity", "null-scattering", "bound-trees", "volume-looks"}}};
  return list;
}

class Effects : public ::testing::TestWithParam<EffectCase> {};

/// Effects that nearly any scene has.
const std::set<std::string> always{"multiple-scattering", "russian-roulette", "ray-tracing"};

TEST_P(Effects, AreOnWhereTheyAreCalledForAndDoNothingElsewhere) {
  const TestScene scene = loadScene(GetParam().integrator,
                                    {.fov = 40,
                                     .width = 8,
                                     .height = 8,
                                     .medium = GetParam().sensor,
                                     .type = GetParam().sensorType,
                                     .placement = GetParam().placement},
                                    GetParam().content);
  ASSERT_TRUE(scene.scene());
  auto film = scene.film();
  const render::WorkerStatistics statistics = scene.renderInto(*film, {.threads = 1, .endSample = 32}).statistics;
  for (const app::Effect& effect : app::listEffects(scene.description(), *scene.scene())) {
    EXPECT_FALSE(effect.reason.empty()) << effect.name;
    if (always.contains(effect.name)) continue;
    EXPECT_EQ(effect.isOn, GetParam().on.contains(effect.name)) << effect.name << ": " << effect.reason;
    ASSERT_TRUE(effect.work) << effect.name;
    if (!effect.isOn) EXPECT_EQ(effect.work(statistics), 0u) << effect.name;
    const bool mayRest = effect.name == "light-sampling" || effect.name.ends_with("light") ||
                         effect.name.ends_with("sky") || effect.name.ends_with("lights") ||
                         GetParam().rests.contains(effect.name);
    if (effect.isOn && !mayRest) EXPECT_GT(effect.work(statistics), 0u) << effect.name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Effects, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return std::string(info.param.name); });

/// Those that nearly any scene has, left out by the integrator; those of other outputs; and those of what is printed.
TEST(CommonEffects, DoNothingWhereTheyAreLeftOut) {
  const std::string content = sky + volume(homogeneous);
  const auto workOf = [&](const std::string& integrator, const std::string& effect, const std::string& scene) {
    const TestScene loaded = loadScene(integrator, {.fov = 40, .width = 8, .height = 8}, scene);
    if (!loaded.scene()) return std::pair(false, std::uint64_t{0});
    auto film = loaded.film();
    const render::WorkerStatistics statistics = loaded.renderInto(*film, {.threads = 1, .endSample = 64}).statistics;
    for (const app::Effect& each : app::listEffects(loaded.description(), *loaded.scene())) {
      if (each.name == effect) return std::pair(each.isOn, each.work(statistics));
    }
    ADD_FAILURE() << "there is no effect " << effect;
    return std::pair(false, std::uint64_t{0});
  };
  const auto expectOnlyWith = [&](const char* effect, const std::string& with, const std::string& without) {
    const auto [isOn, work] = workOf(with, effect, content);
    EXPECT_TRUE(isOn && work > 0) << effect << ' ' << work;
    EXPECT_EQ(workOf(without, effect, content), std::pair(false, std::uint64_t{0})) << effect;
  };
  expectOnlyWith("multiple-scattering", "", R"(<integer name="max_depth" value="2"/>)");
  expectOnlyWith("russian-roulette", R"(<integer name="rr_depth" value="1"/>)",
                 R"(<integer name="max_depth" value="4"/>)");
  const std::string spoken = paint("if (u &lt; 2) printf(\"u\"); Ci = diffuse(N);"), silent = paint("Ci = diffuse(N);");
  EXPECT_GT(workOf("", "shader-messages", spoken).second, 0u);
  EXPECT_EQ(workOf("", "shader-messages", silent), std::pair(false, std::uint64_t{0}));
}

/// Each effect is on in one of the scenes above, or named in one of those tests.
TEST(EffectTable, EveryEffectHasItsTests) {
  const TestScene scene = loadScene("", {.fov = 40, .width = 4, .height = 4}, sky);
  ASSERT_TRUE(scene.scene());
  std::set<std::string> shown{"ray-tracing", "multiple-scattering", "russian-roulette", "shader-messages",
                              "layers",      "deep-output"};
  for (const EffectCase& each : cases()) shown.insert(each.on.begin(), each.on.end());
  std::set<std::string> known, rows;
  for (const app::Feature& feature : app::features()) EXPECT_TRUE(rows.insert(std::string(feature.row)).second);
  for (const app::Effect& effect : app::listEffects(scene.description(), *scene.scene())) {
    std::istringstream names{std::string(app::rowsOfEffect(effect.name))};
    EXPECT_NE(names.str(), "") << effect.name << " belongs to no feature";
    for (std::string row; names >> row;) EXPECT_TRUE(rows.contains(row)) << row << " of " << effect.name;
    EXPECT_TRUE(known.insert(effect.name).second) << effect.name << " is there twice";
    EXPECT_TRUE(shown.contains(effect.name)) << effect.name << " is on in no case";
    // Layers are timed by a second pilot.
    const bool isTimed = effect.name == "layers" || effect.name == "deep-output";
    EXPECT_TRUE(isTimed || effect.share || app::nanosecondsOfEvent(effect.name)) << effect.name << " has no share";
  }
  for (const std::string& name : shown) EXPECT_TRUE(known.contains(name)) << name << " is no effect";
  // What turning it on does to the image: the table names tests against closed forms.
  const std::map<std::string, std::vector<std::string>> table =
      tableOfTests(AEROSOL_SOURCE_DIR "/tests/render/effects.md");
  const std::set<std::string> tests = testsInSources();
  for (const std::string& name : known) {
    const auto row = table.find(name);
    ASSERT_TRUE(row != table.end()) << name << " has no row in effects.md";
    EXPECT_FALSE(row->second.empty()) << name << " has no test in effects.md";
    for (const std::string& test : row->second) EXPECT_TRUE(tests.contains(test)) << name << " names " << test;
  }
  for (const auto& [name, row] : table) EXPECT_TRUE(known.contains(name)) << name << " of effects.md is no effect";
}

/// Forced off, an effect of one of the scenes above is off in the plan, and nothing is done for it.
class RemovedEffects : public ::testing::TestWithParam<std::string> {};

TEST_P(RemovedEffects, AreOffAndDoNothing) {
  const std::string& removed = GetParam();
  // What has no counter of its own is seen by another one.
  const bool isSurfaceMedia = removed == "surface-media";
  const std::string name = isSurfaceMedia ? "constant-media" : removed;
  const auto found = std::find_if(cases().begin(), cases().end(), [&](const EffectCase& each) {
    return isSurfaceMedia ? std::string(each.name) == "interior" : each.on.contains(name);
  });
  ASSERT_NE(found, cases().end()) << removed << " is on in no case";
  const TestScene scene = loadScene(found->integrator,
                                    {.fov = 40,
                                     .width = 8,
                                     .height = 8,
                                     .medium = found->sensor,
                                     .type = found->sensorType,
                                     .placement = found->placement},
                                    found->content, {.mayWarn = true, .without = {removed}});
  ASSERT_TRUE(scene.scene());
  auto film = scene.film();
  const render::WorkerStatistics statistics = scene.renderInto(*film, {.threads = 1, .endSample = 8}).statistics;
  const std::vector<app::Effect> effects = app::listEffects(scene.description(), *scene.scene());
  const auto effect = std::find_if(effects.begin(), effects.end(), [&](const auto& each) { return each.name == name; });
  ASSERT_NE(effect, effects.end()) << "the plan has no " << name;
  EXPECT_FALSE(effect->isOn) << effect->reason;
  EXPECT_EQ(effect->work(statistics), 0u);
}

/// All that can be removed but what scenes of other tests show.
std::vector<std::string> namesOfRemoved() {
  const std::set<std::string> elsewhere{"multiple-scattering", "russian-roulette", "layers", "deep-output"};
  std::vector<std::string> names;
  for (const app::RemovableEffect& each : app::removableEffects()) {
    if (!elsewhere.contains(each.name)) names.push_back(each.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, RemovedEffects, ::testing::ValuesIn(namesOfRemoved()), [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(NamesOfEffects, UnknownOnesAreRefusedWithTheKnown) {
  scene::SceneDescription description;
  const Diagnostics errors = app::removeEffects({"volume"}, description);
  ASSERT_EQ(errors.errorCount(), 1);
  EXPECT_NE(errors.entries()[0].notes[0].find("'volumes'"), std::string::npos);
}

}  // namespace
}  // namespace aerosol::test
