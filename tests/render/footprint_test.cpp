#include <fmt/format.h>

#include <fstream>
#include <numbers>

#include "tests/render/film_checks.h"

// How the inputs of shaders change from pixel to pixel, against geometry.

namespace aerosol::test {
namespace {

constexpr const char* emitted = R"(<integer name="max_depth" value="6"/>)";
constexpr const char* shown = R"(<bsdf type="footprint"/>)";
/// Where the camera stands: at (0, 0, -5), looking along z.
constexpr double eye = 5;

struct Vec {
  double x = 0, y = 0, z = 0;
};
Vec operator*(Vec v, double s) { return {v.x * s, v.y * s, v.z * s}; }
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double length(Vec v) { return std::sqrt(dot(v, v)); }

/// The change of a ray's parameters x / z and y / z from pixel to pixel.
double pixelStep(const TestSensor& sensor) { return 2 * std::tan(sensor.fov * std::numbers::pi / 360) / sensor.width; }

Vec slopes(const Ray<World>& ray) {
  const auto z = static_cast<double>(ray.direction.z);
  return {static_cast<double>(ray.direction.x) / z, static_cast<double>(ray.direction.y) / z, 1};
}

/// Where the eye's ray with these slopes meets the plane n · p = c, p from the eye; its change by the slopes is exact.
struct OnPlane {
  Vec byX, byY;
  OnPlane(Vec slope, Vec n, double c) {
    const double d = dot(n, slope);
    byX = (Vec{1, 0, 0} * d - slope * n.x) * (c / (d * d));
    byY = (Vec{0, 1, 0} * d - slope * n.y) * (c / (d * d));
  }
};

/// A square of half side 20 whose middle is at z, turned about y from facing the camera.
std::string wall(double z, double turn, const std::string& bsdf) {
  return fmt::format(R"(<shape type="rectangle"><transform name="to_world"><scale value="20"/>
      <rotate y="1" angle="{}"/><translate z="{}"/></transform>{}</shape>)",
                     180 + turn, z, bsdf);
}

/// What `footprint` shows on such a wall, whose u runs along its x axis: 1 over 40 scene units.
Color expectedOnWall(const TestSensor& sensor, const Ray<World>& ray, double distance, double turn) {
  const double a = turn * std::numbers::pi / 180;
  const Vec n{-std::sin(a), 0, -std::cos(a)}, along{std::cos(a), 0, -std::sin(a)};
  const OnPlane p(slopes(ray), n, -std::cos(a) * distance);
  const double step = pixelStep(sensor);
  const double ux = dot(p.byX, along), uy = dot(p.byY, along);
  return {static_cast<float>(step * length(p.byX)), static_cast<float>(step * length(p.byY)),
          static_cast<float>(step * std::sqrt(ux * ux + uy * uy) / 40)};
}

TEST(Footprints, OfAPlaneSeenByAPerspectiveCamera) {
  const TestSensor sensor{.fov = 40};
  for (const double turn : {0.0, 35.0, -60.0}) {
    const TestScene scene = loadScene(emitted, sensor, wall(2, turn, shown));
    EXPECT_TRUE(shows(scene, *scene.render(64), [&](const Ray<World>& ray) {
      return expectedOnWall(sensor, ray, eye + 2, turn);
    })) << turn;
  }
}

TEST(Footprints, OfAPlaneInAMirror) {
  const TestSensor sensor{.fov = 40};
  const std::string mirror = wall(0, 0, R"(<bsdf type="bends"/>)");
  for (const double turn : {0.0, 25.0}) {
    const TestScene scene = loadScene(emitted, sensor, mirror + wall(-9, 180 - turn, shown));
    // The mirror shows a wall as far behind it.
    EXPECT_TRUE(shows(scene, *scene.render(64), [&](const Ray<World>& ray) {
      return expectedOnWall(sensor, ray, eye + 9, turn);
    })) << turn;
  }
}

/// One pixel that is so small that angles are their own sines.
const TestSensor needle{.fov = 0.02, .width = 1, .height = 1};

/// What the mean of the film shows, when `seen` of the light arrives, and what the paraxial change of position is: so
/// many scene units a radian.
void expectParaxial(const std::string& content, double perRadian, double seen = 1) {
  const TestScene scene = loadScene(emitted, needle, content);
  ASSERT_TRUE(scene.scene());
  const Color found = scene.render(64)->estimate(0, 0).color;
  const double expected = pixelStep(needle) * perRadian * seen;
  EXPECT_NEAR(static_cast<double>(found.r) / expected, 1, 2e-3);
  EXPECT_NEAR(static_cast<double>(found.g) / expected, 1, 2e-3);
}

TEST(Footprints, GrowBehindAMirrorBall) {
  // Reflected at distance 3 by radius 2: the angle grows by twice the turn of the normal.
  const std::string ball = R"(<shape type="sphere"><float name="radius" value="2"/><bsdf type="bends"/></shape>)";
  expectParaxial(ball + wall(-9, 180, shown), 3 + 7 * (1 + 2 * 3 / 2.0));
}

TEST(Footprints, GrowBehindAMeshWithSmoothNormals) {
  // A flat mirror with the normals of a ball of radius 4 at its corners, near to the axis as good as that ball.
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "bowl.ply";
  std::ofstream(file) << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                         "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                         "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
                         "-1 -1 0 -1 -1 -4\n-1 1 0 -1 1 -4\n1 1 0 1 1 -4\n1 -1 0 1 -1 -4\n3 0 1 2\n3 0 2 3\n";
  const std::string mesh = fmt::format(
      R"(<shape type="ply"><string name="filename" value="{}"/><bsdf type="bends"/></shape>)", file.string());
  expectParaxial(mesh + wall(-9, 180, shown), 5 + 9 * (1 + 2 * 5 / 4.0));
}

TEST(Footprints, AreBentByGlass) {
  const std::string glass = R"(<bsdf type="bends"><float name="eta" value="1.5"/></bsdf>)";
  // What is not reflected, and radiance by the square of the index.
  const double through = 0.96, into = through / (1.5 * 1.5);
  // Into a flat surface, and into a ball of radius 2: θ' = θ/n - x/R (1 - 1/n).
  expectParaxial(wall(0, 0, glass) + wall(3, 0, shown), 5 + 3 / 1.5, into);
  const std::string ball = R"(<shape type="sphere"><float name="radius" value="2"/>)" + glass + "</shape>";
  const double inside = 1 / 1.5 - 3 / 2.0 * (1 - 1 / 1.5);
  expectParaxial(ball + wall(1, 0, shown), 3 + 3 * inside, into);
  // Out of it again, at the same turn of the normal.
  const double x = 3 + 4 * inside, outside = 1.5 * inside - x / 2 * (1.5 - 1);
  expectParaxial(ball + wall(6, 0, shown), std::fabs(x + 4 * outside), through * through);
}

TEST(Footprints, OfAnOrthographicCameraAreItsPixels) {
  const std::string content = fmt::format(
      R"(<scene version="3.0.0"><integrator type="path"/><sensor type="orthographic"><transform name="to_world">
      <scale x="2" y="2"/><lookat origin="0,0,-5" target="0,0,0" up="0,1,0"/></transform>
      <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/>
      <rfilter type="box"/></film></sensor>{}</scene>)",
      wall(0, 60, shown));
  const TestScene scene(content, {.shaderFolder = shaderFolder()});
  ASSERT_TRUE(scene.scene());
  const Color found = scene.render(4)->estimate(3, 3).color;
  EXPECT_NEAR(found.r, 0.5 / std::cos(std::numbers::pi / 3), 1e-5);
  EXPECT_NEAR(found.g, 0.5, 1e-5);
  EXPECT_NEAR(found.b, found.r / 40, 1e-6);
}

TEST(Footprints, InMediaAreAsWideAsTheRaysAround) {
  const TestSensor sensor{.fov = 40, .width = 8, .height = 8};
  const std::string box = R"(<volume type="box"><transform name="to_world"><scale x="9" y="9" z="1"/></transform>
      <medium type="footprint_haze"/></volume>)";
  const TestScene scene = loadScene(emitted, sensor, box);
  EXPECT_TRUE(shows(
      scene, *scene.render(256),
      [&](const Ray<World>& ray) {
        // In proportion to the distance: the one in the middle stands for all, over the way through the box.
        const Vec s = slopes(ray);
        const double l = length(s), way = 2 * l, distance = eye * l;
        const auto turn = [&](Vec by) { return length(by * (1 / l) - s * (dot(s, by) / (l * l * l))); };
        const double x = pixelStep(sensor) * turn({1, 0, 0}) * distance,
                     y = pixelStep(sensor) * turn({0, 1, 0}) * distance;
        return Color(static_cast<float>(way * x), static_cast<float>(way * y),
                     static_cast<float>(way * std::sqrt(x * y)));
      },
      0.01));
}

TEST(Footprints, ChooseHowFineAPictureIsSeen) {
  const TestSensor sensor{.fov = 40, .width = 8, .height = 8};
  const std::string file = (shaderFolder() / "tiles.ppm").string();
  const auto film = [&](double copies, double filtering) {
    const std::string bsdf = fmt::format(R"(<bsdf type="tiled"><string name="filename" value="{}"/>
        <float name="copies" value="{}"/><float name="filtering" value="{}"/></bsdf>)",
                                         file, copies, filtering);
    const TestScene scene = loadScene(emitted, sensor, wall(0, 0, bsdf));
    return scene.render(1);
  };
  // Some twenty copies a pixel: every sample shows the mean of the picture.
  const auto spread = [](const render::Film& f) {
    float least = 1, most = 0;
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        const float g = f.estimate(x, y).color.g;
        least = std::min(least, g);
        most = std::max(most, g);
      }
    }
    return most - least;
  };
  EXPECT_LT(spread(*film(2000, 1)), 0.03f);
  EXPECT_GT(spread(*film(2000, 0)), 0.5f);
  EXPECT_GT(spread(*film(4, 1)), 0.3f);
}

TEST(Footprints, NormalsFromPositionsLieOnTheSideOfN) {
  const std::string ball = R"(<shape type="sphere"><bsdf type="displaced_normal"/></shape>)";
  const std::string mirrored =
      R"(<shape type="sphere"><transform name="to_world"><scale x="-1" y="1" z="1"/></transform>
      <bsdf type="displaced_normal"/></shape>)";
  for (const std::string& content : {ball, mirrored}) {
    const TestScene scene = loadScene(emitted, {.fov = 10}, content);
    EXPECT_TRUE(shows(scene, *scene.render(4), [](const Ray<World>&) { return Color(1, 1, 1); })) << content;
  }
}

const TestSensor small{.fov = 40, .width = 12, .height = 12, .sampler = "sobol"};

/// A pattern seen directly, by way of a floor, and through a cloud, both of which have footprints of their own.
std::string everything() {
  return std::string(R"(<emitter type="constant"/><shape type="sphere"><bsdf type="mesh_pattern"/></shape>
      <volume type="sphere"><transform name="to_world"><translate x="1"/></transform>
      <medium type="footprint_cloud"><float name="most" value="3"/></medium></volume>)") +
         wall(3, 20, R"(<bsdf type="mesh_pattern"><float name="frequency" value="4"/></bsdf>)");
}

TEST(Footprints, AreThoseOfThePixelWhateverElseIsRendered) {
  const TestScene scene = loadScene(emitted, small, everything());
  ASSERT_TRUE(scene.scene());
  EXPECT_TRUE(scene.scene()->keepsFootprints);
  const auto whole = scene.film();
  const render::RenderReport report = scene.renderInto(*whole, {.threads = 2, .endSample = 8});
  EXPECT_GT(report.statistics.work.of(render::Work::footprint), 0u);
  const auto crop = scene.film(render::PixelRect{3, 2, 9, 11});
  scene.renderInto(*crop, {.threads = 1, .endSample = 8, .pathsInFlight = 13, .batchSize = 7});
  for (int y = 2; y < 11; ++y) {
    for (int x = 3; x < 9; ++x) {
      const Color a = whole->estimate(x, y).color, b = crop->estimate(x, y).color;
      EXPECT_EQ(a, b) << x << ' ' << y;
    }
  }
}

TEST(Footprints, OfMediaAreWithinTheirBounds) {
  const std::string cloud = R"(<volume type="sphere"><medium type="footprint_cloud"><float name="most" value="{}"/>
      <string name="distance" value="null"/></medium></volume><emitter type="constant"/>)";
  const TestScene scene = loadScene(emitted, small, fmt::format(fmt::runtime(cloud), 8));
  ASSERT_TRUE(scene.scene());
  // Pixels cover 0.3 scene units there: the density is up to 13 times that of a point, cut off at 8.
  ASSERT_TRUE(scene.scene()->media[0].bound.has_value());
  EXPECT_GE(scene.scene()->media[0].bound->value, 4.0f);
  const auto film = scene.film();
  const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = 16});
  EXPECT_LE(report.statistics.trackers.worstViolation, 2.0);
}

TEST(Footprints, AreNotKeptWhereNothingReadsThem) {
  const std::string content = R"(<emitter type="constant"/><shape type="sphere"><bsdf type="diffuse"/></shape>
      <volume type="sphere"><medium type="fbm"/></volume>)";
  const TestScene scene = loadScene(emitted, small, content);
  ASSERT_TRUE(scene.scene());
  EXPECT_FALSE(scene.scene()->keepsFootprints);
  const auto film = scene.film();
  EXPECT_EQ(scene.renderInto(*film, {.threads = 1, .endSample = 2}).statistics.work.of(render::Work::footprint), 0u);
}

TEST(Footprints, OfVoxelsAreNoDerivatives) {
  const TestScene scene = loadScene(emitted, small,
                                    fmt::format(R"(<emitter type="constant"/><volume type="box">
      <medium type="grid"><string name="filename" value="{}/scenes/cloud.vdb"/></medium></volume>)",
                                                AEROSOL_SOURCE_DIR));
  ASSERT_TRUE(scene.scene());
  EXPECT_FALSE(scene.scene()->keepsFootprints);
}

}  // namespace
}  // namespace aerosol::test
