#include <fmt/format.h>

#include "core/render/subsurface_body.h"
#include "tests/render/film_checks.h"

// Whole renders of subsurface scattering: white bodies in even light, and the same body as a medium inside of a sheet.

namespace aerosol::test {
namespace {

constexpr const char* sky = R"(<emitter type="constant"/>)";

TEST(Subsurface, WhiteBodiesKeepAllLight) {
  for (const char* bsdf :
       {R"(<bsdf type="subsurface"><rgb name="albedo" value="1"/><rgb name="radius" value="0.5, 1, 3"/></bsdf>)",
        R"(<bsdf type="subsurface"><rgb name="albedo" value="1"/><float name="g" value="0.7"/>
           <rgb name="radius" value="0.3"/></bsdf>)",
        R"(<bsdf type="polished_body"><rgb name="albedo" value="1"/><rgb name="mfp" value="0.5, 1, 2"/></bsdf>)"}) {
    SCOPED_TRACE(bsdf);
    const TestScene scene = loadScene("", {.fov = 25}, fmt::format("{}<shape type=\"sphere\">{}</shape>", sky, bsdf));
    ASSERT_TRUE(scene.scene());
    EXPECT_TRUE(shows(scene, *scene.render(512), [](const Ray<World>&) { return Color(1); }));
  }
}

/// A thick body in even light reflects the colour that it was given: that is what the colour means.
TEST(Subsurface, ThickBodiesReflectTheirColour) {
  const Color albedo(0.9f, 0.5f, 0.1f);
  const TestScene scene = loadScene("", {.fov = 0.1, .width = 4, .height = 4},
                                    std::string(sky) + R"(<shape type="sphere"><float name="radius" value="100"/>
      <point name="center" x="0" y="0" z="110"/><bsdf type="subsurface"><rgb name="albedo" value="0.9, 0.5, 0.1"/>
      <rgb name="radius" value="0.05, 0.1, 0.2"/></bsdf></shape>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(8192);
  Color mean, variance;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      const auto estimate = film->estimate(x, y);
      mean += estimate.color * (1.0f / 16);
      variance += estimate.standardError * estimate.standardError * (1.0f / 256);
    }
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_LT(std::sqrt(variance[c]), 0.01f) << "channel " << c;
    EXPECT_NEAR(mean[c], albedo[c], 0.002f + 4 * std::sqrt(variance[c])) << "channel " << c;
  }
}

/// A homogeneous medium inside of a sheet that scatters what crosses it evenly: path by path the same light.
TEST(Subsurface, IsAMediumInsideOfAMatteSheet) {
  const Color albedo(0.8f, 0.6f, 0.3f), radius(0.8f, 0.4f, 0.2f);
  for (const float g : {0.0f, 0.6f, -0.4f}) {
    SCOPED_TRACE(g);
    const render::SubsurfaceBody body = render::bodyThatReflects(albedo, radius, g);
    const std::string light =
        R"(<emitter type="constant"><rgb name="radiance" value="0.2"/></emitter>
           <emitter type="directional"><vector name="direction" x="1" y="-1" z="0.2"/></emitter>)";
    const auto scene = [&](const std::string& content) {
      return loadScene("", {.fov = 26}, light + fmt::format("<shape type=\"sphere\">{}</shape>", content));
    };
    const TestScene walked = scene(fmt::format(R"(<bsdf type="subsurface"><rgb name="albedo" value="{} {} {}"/>
        <rgb name="radius" value="{} {} {}"/><float name="g" value="{}"/></bsdf>)",
                                               albedo.r, albedo.g, albedo.b, radius.r, radius.g, radius.b, g));
    const TestScene nested = scene(fmt::format(R"(<bsdf type="sheet"/><medium name="interior" type="homogeneous">
        <rgb name="sigma_t" value="{} {} {}"/><rgb name="albedo" value="{} {} {}"/>
        <phase type="hg"><float name="g" value="{}"/></phase></medium>)",
                                               body.extinction.r, body.extinction.g, body.extinction.b, body.albedo.r,
                                               body.albedo.g, body.albedo.b, g));
    ASSERT_TRUE(walked.scene() && nested.scene());
    EXPECT_TRUE(showTheSame(*walked.render(512), *nested.render(1024), 0.005));
  }
}

}  // namespace
}  // namespace aerosol::test
