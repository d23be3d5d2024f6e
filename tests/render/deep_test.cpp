#include <cmath>

#include "core/render/aov/deep_pixels.h"
#include "tests/render/film_checks.h"

// Deep images: over each other their samples are the picture, and along depth they follow closed forms.

namespace aerosol::test {
namespace {

using render::DeepSample;

constexpr const char* sky = R"(<emitter type="constant"><rgb name="radiance" value="1, 0.8, 0.6"/></emitter>)";
constexpr const char* lamp = R"(<emitter type="point"><point name="position" x="1" y="2" z="-2"/>
    <rgb name="intensity" value="9, 7, 5"/></emitter>)";
constexpr const char* ball = R"(<shape type="sphere"><point name="center" x="0.3" y="0" z="0.5"/>
    <float name="radius" value="0.4"/></shape>)";

std::string fog(const std::string& sigma, const std::string& albedo, const std::string& type = "box") {
  return "<volume type=\"" + type + R"("><medium type="homogeneous"><rgb name="sigma_t" value=")" + sigma +
         R"("/><rgb name="albedo" value=")" + albedo + R"("/></medium></volume>)";
}

TestScene deepScene(const std::string& content, int slices = 24, TestSensor sensor = {},
                    const std::string& integrator = {}) {
  return loadScene(integrator, sensor, content, {.deepSlices = slices});
}

std::vector<DeepSample> pixelOf(const TestScene& scene, const render::Film& film, int x, int y, double error = 0) {
  return render::deepSamples(scene.scene()->aovs->layout.deep, film.aovs(x, y).total().values, film.pixel(x, y).count(),
                             error);
}

/// Over each other the samples of each pixel are the picture.
void expectComposes(const TestScene& scene, const render::Film& film, double error) {
  for (int y = 0; y < film.area().y1; ++y) {
    for (int x = 0; x < film.area().x1; ++x) {
      const DeepSample flat = flatten(pixelOf(scene, film, x, y, error));
      const Color color = film.estimate(x, y).color;
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(flat.light[c], color[c], 1e-4 * (1 + std::fabs(color[c]))) << x << ' ' << y;
    }
  }
}

float brightest(const render::Film& film) {
  float most = 0;
  for (int y = 0; y < film.area().y1; ++y) {
    for (int x = 0; x < film.area().x1; ++x) most = std::max(most, film.estimate(x, y).color.r);
  }
  return most;
}

TEST(Deep, OverEachOtherSamplesAreThePicture) {
  const std::string mist = R"(<volume type="sphere"><medium type="wisps"/></volume>)";
  const std::string fire = R"(<volume type="sphere"><medium type="osl"><source><![CDATA[
      volume fire() { Ci = 2 * exp(-4 * dot(P, P)) * (emission() + absorption()); }]]></source></medium></volume>)";
  const std::string glass =
      R"(<shape type="sphere"><float name="radius" value="0.7"/><bsdf type="dielectric"/></shape>)";
  const std::string between = R"(<shape type="cube"><transform name="to_world"><scale value="0.6"/></transform>
      <bsdf type="null"/><medium name="interior" type="homogeneous"><rgb name="sigma_t" value="2"/>
      <rgb name="albedo" value="0.5"/></medium></shape>)";
  const std::string contents[] = {sky + fog("0.4, 0.8, 1.6", "0.9") + ball,
                                  lamp + mist + ball,
                                  fire,
                                  sky + glass,
                                  lamp + between,
                                  std::string(lamp) + ball};
  for (const std::string& content : contents) {
    const TestScene scene = deepScene(content, 12, {.width = 6, .height = 6});
    ASSERT_TRUE(scene.scene()) << content;
    const auto film = scene.render(24);
    EXPECT_GT(brightest(*film), 0) << content;
    expectComposes(scene, *film, 0);
    expectComposes(scene, *film, 0.05);
  }
}

TEST(Deep, IsWalkedForWhereItIsAskedFor) {
  for (const int slices : {0, 4}) {
    const TestScene scene = loadScene("", {.width = 4, .height = 4}, std::string(sky) + ball, {.deepSlices = slices});
    ASSERT_TRUE(scene.scene());
    auto film = scene.film();
    const auto statistics = scene.renderInto(*film, {.threads = 1, .endSample = 2}).statistics;
    EXPECT_EQ(statistics.work.of(render::Work::deep), slices > 0 ? 32u : 0u);
  }
}

TEST(Deep, ThePictureStaysTheSame) {
  const std::string content = sky + fog("0.5, 1, 2", "0.8") + ball;
  const TestScene deep = deepScene(content), plain = loadScene("", {}, content);
  ASSERT_TRUE(deep.scene() && plain.scene());
  const auto a = deep.render(8), b = plain.render(8);
  EXPECT_EQ(a->rgba(), b->rgba());
  EXPECT_TRUE(b->layout().isEmpty());
}

/// Transmittance of fog along the axis of the view: a closed form, slice by slice.
TEST(Deep, OpacityFollowsTheClosedForm) {
  const TestScene scene = deepScene(fog("0.5, 1, 2", "0"), 16, {.fov = 0.5, .width = 2, .height = 2});
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(4);
  const auto samples = pixelOf(scene, *film, 1, 1);
  ASSERT_GE(samples.size(), 16u);
  Color left(1.0f);
  for (const DeepSample& s : samples) {
    left *= Color(1.0f) - s.opacity;
    const float inside = std::clamp(s.back - 4, 0.0f, 2.0f);  // The box lies from 4 to 6.
    const Color sigma(0.5f, 1, 2);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(left[c], std::exp(-sigma[c] * inside), 2e-4) << s.back;
  }
}

/// Emission without extinction: light grows evenly with depth, and nothing covers what is behind.
TEST(Deep, EmissionIsWhereItComesFrom) {
  const std::string glow = R"(<volume type="box"><medium type="osl"><source><![CDATA[
      volume glow() { Ci = color(1, 2, 3) * (P[2] > 0 ? 1 : 0) * emission(); }]]></source></medium></volume>)";
  const TestScene scene = deepScene(glow, 8, {.fov = 0.5, .width = 2, .height = 2});
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(256);
  Color front, back;
  for (const DeepSample& s : pixelOf(scene, *film, 0, 0)) {
    EXPECT_EQ(maximum(s.opacity), 0);
    (s.back < 5 ? front : back) += s.light;
  }
  EXPECT_EQ(maximum(front), 0);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(back[c], static_cast<float>(c + 1), 0.05f * static_cast<float>(c + 1));
}

TEST(Deep, SurfacesAreAtTheirDepthAlongTheView) {
  const std::string wall =
      R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><scale value="9"/>
      <translate z="1"/></transform></shape>)";
  const TestScene scene =
      deepScene(std::string(sky) + wall + fog("0.1", "0.5"), 8, {.fov = 60, .width = 5, .height = 5});
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(16);
  for (const int x : {0, 2, 4}) {
    const auto samples = pixelOf(scene, *film, x, 1, 0.01);
    ASSERT_FALSE(samples.empty());
    EXPECT_NEAR(samples.back().front, 6, 1e-3);  // A plane, whatever the angle.
    EXPECT_NEAR(samples.back().opacity.g, 1, 1e-5);
  }
}

TEST(Deep, TheBackgroundComesLast) {
  const TestScene scene = deepScene(std::string(sky) + ball, 4);
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(4);
  const auto samples = pixelOf(scene, *film, 0, 0);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_EQ(samples[0].front, render::deepBackground);
  EXPECT_EQ(samples[0].opacity, Color(1.0f));
  EXPECT_EQ(samples[0].light, Color(1, 0.8f, 0.6f));
}

TEST(Deep, PartsJoinToTheSame) {
  const TestScene scene = deepScene(std::string(lamp) + fog("1", "0.9") + ball, 8, {.width = 4, .height = 4});
  ASSERT_TRUE(scene.scene());
  const auto whole = scene.render(128);
  auto joined = scene.film(), rest = scene.film();
  scene.renderInto(*joined, {.threads = 1, .firstSample = 0, .endSample = 40});
  scene.renderInto(*rest, {.threads = 1, .firstSample = 40, .endSample = 128});
  ASSERT_FALSE(joined->merge(*rest).hasErrors());
  EXPECT_TRUE(identical(*whole, *joined));
}

TEST(Deep, HoldoutsLeaveHoles) {
  const std::string hole = R"(<volume type="box"><boolean name="holdout" value="true"/><medium type="homogeneous">
      <rgb name="sigma_t" value="1"/><rgb name="albedo" value="1"/></medium></volume>)";
  const TestScene scene = deepScene(hole, 8, {.fov = 0.5, .width = 2, .height = 2});
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(8);
  EXPECT_EQ(maximum(flatten(pixelOf(scene, *film, 0, 0)).opacity), 0);
}

}  // namespace
}  // namespace aerosol::test
