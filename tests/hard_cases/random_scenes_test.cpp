#include <fmt/format.h>
#include <rapidcheck.h>

#include <cstdlib>

#include "core/jit/target.h"
#include "tests/render/film_checks.h"

// Small random scenes of volumes, dielectrics, lights and cameras. Whatever is in them: nothing is NaN, no pixel is
// negative beyond its noise, no bit depends on threads and widths, units do not matter, and where all light comes from
// a sky of 1 nothing is brighter than that.

namespace aerosol::test {
namespace {

using rc::gen::element;
using rc::gen::inRange;

double between(double low, double high) { return low + (high - low) * *inRange(0, 1000) / 999.0; }

/// The same scenes in every run, so many of each property; $RC_PARAMS asks for others.
const bool isConfigured = setenv("RC_PARAMS", "seed=20 max_success=30 verbose_progress=0", 0) == 0;

/// What stands in a scene, lengths in units of 1; written for any unit.
struct RandomScene {
  struct Thing {
    int kind = 0;
    std::array<double, 3> place{}, size{};
    double angle = 0, extinction = 0, albedo = 0, anisotropy = 0, ior = 1;
    int priority = 0;
    const char* distance = "auto";
  };
  std::vector<Thing> things;
  std::array<double, 3> camera{};
  bool hasPoint = false, hasSun = false, hasGround = false;
  std::array<double, 3> light{};
  double aperture = 0;

  static RandomScene make(bool skyAlone) {
    RandomScene scene;
    const int count = *inRange(1, 6);
    for (int i = 0; i < count; ++i) {
      Thing thing;
      thing.kind = *inRange(0, 5);
      for (double& x : thing.place) x = between(-1, 1);
      for (double& x : thing.size) x = between(0.2, 1.2);
      thing.angle = between(0, 90);
      thing.extinction = *element(0.0, 0.1, 1.0, 5.0, 40.0);
      thing.albedo = *element(0.0, 0.5, 0.95, 1.0);
      thing.anisotropy = *element(-0.9, 0.0, 0.6, 0.99);
      thing.ior = *element(1.0, 1.33, 1.5);
      thing.priority = *inRange(0, 3);
      thing.distance = *element("marching", "null");
      scene.things.push_back(thing);
    }
    for (double& x : scene.camera) x = between(-4, 4);
    scene.hasPoint = !skyAlone && *rc::gen::arbitrary<bool>();
    scene.hasSun = !skyAlone && *rc::gen::arbitrary<bool>();
    scene.hasGround = *rc::gen::arbitrary<bool>();
    for (double& x : scene.light) x = between(-3, 3);
    scene.aperture = *element(0.0, 0.0, 0.05, 0.4);
    return scene;
  }

  static std::string triple(const std::array<double, 3>& p, double unit) {
    return fmt::format("{:.9g}, {:.9g}, {:.9g}", p[0] * unit, p[1] * unit, p[2] * unit);
  }

  std::string describe(const Thing& t, double unit) const {
    const std::string place = fmt::format(
        R"(<transform name="to_world"><scale x="{:.9g}" y="{:.9g}" z="{:.9g}"/><rotate x="0.3" y="1" z="0.2" angle="{:.9g}"/>
        <translate x="{:.9g}" y="{:.9g}" z="{:.9g}"/></transform>)",
        t.size[0] * unit, t.size[1] * unit, t.size[2] * unit, t.angle, t.place[0] * unit, t.place[1] * unit,
        t.place[2] * unit);
    const std::string constant = fmt::format(
        R"(<medium type="homogeneous"><rgb name="sigma_t" value="{:.9g}, {:.9g}, {:.9g}"/><rgb name="albedo" value="{:.9g}"/>
        <float name="g" value="{:.9g}"/></medium>)",
        t.extinction / unit, 0.5 * t.extinction / unit, t.extinction / unit, t.albedo, t.anisotropy);
    const std::string varying = fmt::format(
        R"(<medium type="ramp"><string name="distance" value="{}"/><float name="step_size" value="{:.9g}"/>
        <float name="at_zero" value="{:.9g}"/><float name="slope" value="{:.9g}"/><float name="most" value="{:.9g}"/>
        <rgb name="albedo" value="{:.9g}"/><float name="g" value="{:.9g}"/></medium>)",
        t.distance, 0.1 * unit, t.extinction / unit, t.extinction / unit / unit, 5 * (t.extinction + 0.01) / unit,
        t.albedo, t.anisotropy);
    switch (t.kind) {
      case 0:
        return fmt::format("<volume type=\"sphere\">{}{}</volume>\n", place, constant);
      case 1:
        return fmt::format("<volume type=\"box\">{}{}</volume>\n", place, varying);
      case 2:
        return fmt::format("<volume type=\"cylinder\">{}{}</volume>\n", place, varying);
      case 3:
        return fmt::format(R"(<shape type="cube">{}<bsdf type="dielectric"><float name="ior" value="{}"/>
            <integer name="priority" value="{}"/></bsdf></shape>)",
                           place, t.ior, t.priority);
      default:
        return fmt::format(
            R"(<shape type="sphere">{}<bsdf type="diffuse"><rgb name="reflectance" value="{}"/></bsdf></shape>)", place,
            t.albedo);
    }
  }

  TestScene load(double unit, const SceneOptions& options = {}) const {
    std::string content = R"(<emitter type="constant"/>)";
    if (hasPoint) {
      content += fmt::format(
          R"(<emitter type="point"><point name="position" value="{}"/><rgb name="intensity" value="{:.9g}"/></emitter>)",
          triple(light, unit), 4 * unit * unit);
    }
    if (hasSun) content += R"(<emitter type="directional"><vector name="direction" x="0.3" y="-1" z="0.4"/></emitter>)";
    if (hasGround) {
      content += fmt::format(
          R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="{0:.9g}"/>
          <translate x="0" y="{1:.9g}" z="0"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf></shape>)",
          30 * unit, -2.5 * unit);
    }
    for (const Thing& thing : things) content += describe(thing, unit);
    TestSensor sensor{.origin = triple(camera, unit), .target = "0, 0, 0", .fov = 50, .width = 6, .height = 5};
    sensor.nearClip *= unit;
    sensor.farClip *= unit;
    if (aperture > 0) {
      sensor.type = "thinlens";
      sensor.medium =
          fmt::format(R"(<float name="aperture_radius" value="{:.9g}"/><float name="focus_distance" value="{:.9g}"/>)",
                      aperture * unit, 3 * unit);
    }
    return loadScene(R"(<integer name="max_depth" value="30"/><integer name="rr_depth" value="8"/>)", sensor, content,
                     options);
  }
};

/// Means and their errors, all pixels and colours together.
struct Brightness {
  double mean = 0, variance = 0;

  explicit Brightness(const render::Film& film) {
    const auto count = 3 * static_cast<double>(film.area().pixelCount());
    for (int y = 0; y < film.area().y1; ++y) {
      for (int x = 0; x < film.area().x1; ++x) {
        const render::PixelEstimate e = film.estimate(x, y);
        // Colours share their paths: their errors add up as they are.
        double error = 0;
        for (int c = 0; c < 3; ++c) {
          mean += static_cast<double>(e.color[c]) / count;
          error += static_cast<double>(e.standardError[c]) / count;
        }
        variance += error * error;
      }
    }
  }
};

TEST(RandomScenes, AreFiniteAndNotNegativeAndTheSameForThreadsAndWidths) {
  ASSERT_TRUE(isConfigured);
  const bool ok = rc::check("finite, not negative, the same bits", [] {
    const RandomScene random = RandomScene::make(false);
    const TestScene scene = random.load(1), narrow = random.load(1, {.width = 4, .isa = "avx2"});
    RC_ASSERT(scene.scene() && narrow.scene());
    const auto film = scene.render(32);
    RC_ASSERT(film->droppedCount() == 0u);
    for (int y = 0; y < film->area().y1; ++y) {
      for (int x = 0; x < film->area().x1; ++x) {
        const render::PixelEstimate e = film->estimate(x, y);
        for (int c = 0; c < 3; ++c) {
          RC_ASSERT(std::isfinite(e.color[c]));
          RC_ASSERT(e.color[c] >= -4 * e.standardError[c]);
        }
      }
    }
    auto other = narrow.film();
    narrow.renderInto(*other, {.threads = 2, .endSample = 32, .pathsInFlight = 37, .batchSize = 40});
    RC_ASSERT(identical(*film, *other));
  });
  EXPECT_TRUE(ok);
}

TEST(RandomScenes, UnitsDoNotMatter) {
  const bool ok = rc::check("scene times 2^k and 10^k", [] {
    const RandomScene random = RandomScene::make(false);
    const double unit = *element(0.0078125, 1024.0, 1e-3, 1e4);
    const TestScene scene = random.load(1), scaled = random.load(unit);
    RC_ASSERT(scene.scene() && scaled.scene());
    // The same random numbers: most paths are the same, so errors of both together are an upper bound.
    const Brightness a(*scene.render(48)), b(*scaled.render(48));
    RC_ASSERT(std::fabs(a.mean - b.mean) <= 5 * std::sqrt(a.variance + b.variance) + 1e-4 * std::fabs(a.mean));
  });
  EXPECT_TRUE(ok);
}

TEST(RandomScenes, UnderASkyOfOneNothingIsBrighter) {
  const bool ok = rc::check("energy is bounded", [] {
    const RandomScene random = RandomScene::make(true);
    const TestScene scene = random.load(1);
    RC_ASSERT(scene.scene());
    const auto film = scene.render(64);
    // A camera inside of an index n sees n² times as much.
    const double n = static_cast<double>(scene.scene()->nestsMedia ? scene.scene()->initialMedia.ior() : 1.0f);
    const Brightness whole(*film);
    RC_ASSERT(whole.mean <= n * n * (1 + 1e-5) + 5 * std::sqrt(whole.variance));
  });
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace aerosol::test
