#include <fmt/format.h>

#include "tests/render/film_checks.h"

// Light that comes through a medium in a straight line: slabs, ramps, overlaps, both spellings of a medium's place.

namespace aerosol::test {
namespace {

constexpr const char* whiteSky = R"(<emitter type="constant"><rgb name="radiance" value="1, 2, 0.5"/></emitter>)";
const Color sky(1, 2, 0.5f);

/// A box across the view, from z = -1 to z = 1.
std::string slab(const std::string& medium) {
  return fmt::format(
      R"(<volume type="box"><transform name="to_world"><scale x="50" y="50" z="1"/></transform>{}</volume>)", medium);
}

/// Length of the camera ray's way through the slab.
double slabLength(const Ray<World>& ray) { return 2 / static_cast<double>(ray.direction.z); }

class Slab : public ::testing::TestWithParam<const char*> {
 protected:
  /// `medium` with the sampling of this test.
  std::string medium(const std::string& type, const std::string& parameters) const {
    return fmt::format(R"(<medium type="{}">{}{}</medium>)", type, GetParam(), parameters);
  }
};

/// The finer step makes the bias of marching vanish beside the resolution.
INSTANTIATE_TEST_SUITE_P(
    Both, Slab,
    ::testing::Values(R"(<string name="distance" value="marching"/><float name="step_size" value="0.01"/>)",
                      R"(<string name="distance" value="null"/>)"),
    [](const auto& info) { return info.index == 0 ? "marching" : "nullScattering"; });

TEST(HomogeneousSlab, TransmittanceIsExponential) {
  const TestScene scene = loadScene("", {.fov = 60}, std::string(whiteSky) + slab(R"(<medium type="homogeneous">
      <rgb name="sigma_t" value="0.1, 0.5, 1"/><rgb name="albedo" value="0"/></medium>)"));
  const auto film = scene.render(1024);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    return sky * exp(Color(0.1f, 0.5f, 1) * static_cast<float>(-slabLength(ray)));
  }));
}

TEST(HomogeneousSlab, EmissionAlone) {
  const TestScene scene = loadScene("", {.fov = 60}, slab(R"(<medium type="homogeneous">
      <rgb name="sigma_t" value="0"/><rgb name="emission" value="0.5, 1, 2"/></medium>)"));
  const auto film = scene.render(16);
  EXPECT_TRUE(shows(scene, *film,
                    [](const Ray<World>& ray) { return Color(0.5f, 1, 2) * static_cast<float>(slabLength(ray)); }));
}

TEST(HomogeneousSlab, EmissionAndAbsorption) {
  const TestScene scene = loadScene("", {.fov = 60}, std::string(whiteSky) + slab(R"(<medium type="homogeneous">
      <rgb name="sigma_t" value="0.2, 1, 1.5"/><rgb name="albedo" value="0"/><rgb name="emission" value="0.5, 1, 2"/>
      </medium>)"));
  const auto film = scene.render(1024);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    const Color sigma(0.2f, 1, 1.5f), transmittance = exp(sigma * static_cast<float>(-slabLength(ray)));
    const Color emitted = (Color(1.0f) - transmittance) * Color(0.5f / 0.2f, 1, 2 / 1.5f);
    return sky * transmittance + emitted;
  }));
}

/// ∫ (a + b z) dz over the slab is 2 a, along a slanted ray 2 a / cos.
TEST_P(Slab, ScriptedDensityWithAKnownIntegral) {
  const TestScene scene =
      loadScene("", {.fov = 60}, std::string(whiteSky) + slab(medium("ramp", R"(<float name="at_zero" value="0.6"/>
      <float name="slope" value="0.5"/><float name="most" value="1.1"/><rgb name="tint" value="0.2, 0.6, 1"/>)")));
  const auto film = scene.render(1024);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    return sky * exp(Color(0.2f, 0.6f, 1) * static_cast<float>(-0.6 * slabLength(ray)));
  }));
}

TEST_P(Slab, ScriptedDensityThatEndsInside) {
  // max(0, 2 z): nothing in the front half, ∫ = 1 in the other one.
  const TestScene scene =
      loadScene("", {.fov = 60}, std::string(whiteSky) + slab(medium("ramp", R"(<float name="at_zero" value="0"/>
      <float name="slope" value="2"/><float name="most" value="2"/>)")));
  const auto film = scene.render(1024);
  EXPECT_TRUE(shows(scene, *film,
                    [](const Ray<World>& ray) { return sky * static_cast<float>(std::exp(-0.5 * slabLength(ray))); }));
}

TEST_P(Slab, ScriptedEmissionWithoutExtinction) {
  const TestScene scene =
      loadScene("", {.fov = 60}, slab(medium("ramp", R"(<float name="at_zero" value="0"/><float name="slope" value="0"/>
      <float name="most" value="1"/><rgb name="glow" value="1, 2, 3"/><float name="glow_slope" value="0.9"/>)")));
  const auto film = scene.render(1024);
  EXPECT_TRUE(
      shows(scene, *film, [](const Ray<World>& ray) { return Color(1, 2, 3) * static_cast<float>(slabLength(ray)); }));
}

TEST_P(Slab, ScriptedEmissionUnderABoundOfZero) {
  const TestScene scene =
      loadScene("", {.fov = 60}, slab(medium("ramp", R"(<float name="at_zero" value="0"/><float name="slope" value="0"/>
      <float name="most" value="0"/><rgb name="glow" value="1, 2, 3"/><float name="glow_slope" value="0.9"/>)")));
  const auto film = scene.render(1024);
  EXPECT_TRUE(
      shows(scene, *film, [](const Ray<World>& ray) { return Color(1, 2, 3) * static_cast<float>(slabLength(ray)); }));
}

TEST_P(Slab, ScriptedEmissionAndAbsorption) {
  const TestScene scene = loadScene("", {.fov = 60}, slab(medium("ramp", R"(<float name="at_zero" value="0.8"/>
      <float name="slope" value="0.5"/><float name="most" value="1.3"/><rgb name="glow" value="1, 2, 3"/>
      <float name="glow_slope" value="0.3"/>)")));
  const auto film = scene.render(1024);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    const double slant = slabLength(ray) / 2;
    const auto depth = [&](double z) { return slant * (0.8 * (z + 1) + 0.25 * (z * z - 1)); };
    const double emitted = integrate([&](double z) { return slant * (1 + 0.3 * z) * std::exp(-depth(z)); }, -1, 1, 20);
    return Color(1, 2, 3) * static_cast<float>(emitted);
  }));
}

/// One medium of density 2 d or two of density d in one place; with all that comes after the first collision.
TEST_P(Slab, TwoEqualOverlapsAreOneDoubled) {
  const auto content = [&](const std::string& density, int copies) {
    std::string text = R"(<emitter type="constant"><rgb name="radiance" value="1, 0.5, 0.25"/></emitter>
        <emitter type="point"><point name="position" x="0" y="2" z="-2"/><rgb name="intensity" value="10"/></emitter>)";
    for (int i = 0; i < copies; ++i) {
      text += fmt::format(R"(<volume type="sphere">{}</volume>)",
                          medium("ramp", density + R"(<rgb name="albedo" value="0.9, 0.6, 0.3"/>
                                                      <float name="g" value="0.4"/>)"));
    }
    return text;
  };
  const std::string depth = R"(<integer name="max_depth" value="4"/>)";
  const TestScene doubled = loadScene(depth, {.width = 12, .height = 12},
                                      content(R"(<float name="at_zero" value="1.6"/>
      <float name="slope" value="1.2"/><float name="most" value="2.8"/>)",
                                              1));
  const TestScene twice = loadScene(depth, {.width = 12, .height = 12, .seed = 1},
                                    content(R"(<float name="at_zero" value="0.8"/>
      <float name="slope" value="0.6"/><float name="most" value="1.4"/>)",
                                            2));
  EXPECT_TRUE(showTheSame(*doubled.render(2048), *twice.render(2048)));
}

TEST(HomogeneousOverlap, TwoEqualOverlapsAreOneDoubled) {
  const auto content = [](const char* sigma, int copies) {
    std::string text = R"(<emitter type="constant"/>
        <emitter type="directional"><vector name="direction" x="1" y="-1" z="1"/></emitter>)";
    for (int i = 0; i < copies; ++i) {
      text += fmt::format(R"(<volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="{}"/>
          <rgb name="albedo" value="0.9, 0.6, 0.3"/><float name="g" value="0.4"/></medium></volume>)",
                          sigma);
    }
    return text;
  };
  const std::string depth = R"(<integer name="max_depth" value="5"/>)";
  const TestScene doubled = loadScene(depth, {}, content("0.5, 1, 2", 1));
  const TestScene twice = loadScene(depth, {.seed = 1}, content("0.25, 0.5, 1", 2));
  EXPECT_TRUE(showTheSame(*doubled.render(2048), *twice.render(2048)));
}

/// Partial overlap of constant and scripted media of both methods: the depths add up.
TEST_P(Slab, MixedOverlapsAddUp) {
  const TestScene scene = loadScene(
      "", {.fov = 30},
      std::string(whiteSky) +
          slab(medium("ramp", R"(<float name="at_zero" value="0.5"/><float name="slope" value="0.4"/>
          <float name="most" value="0.9"/>)")) +
          R"(<volume type="box"><transform name="to_world"><scale x="50" y="50" z="0.5"/><translate x="0" y="0" z="0.75"/></transform>
          <medium type="homogeneous"><rgb name="sigma_t" value="0.7"/><rgb name="albedo" value="0"/></medium></volume>)");
  const auto film = scene.render(2048);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    const double slant = slabLength(ray) / 2;
    return sky * static_cast<float>(std::exp(-slant * (0.5 * 2 + 0.7 * 1)));
  }));
}

/// The same medium as a volume primitive, and inside a shape with a null surface, scattering included.
TEST(BothSpellings, InteriorOfANullShapeIsTheVolumePrimitive) {
  const std::string lights = R"(<emitter type="constant"><rgb name="radiance" value="0.5"/></emitter>
      <emitter type="point"><point name="position" x="0" y="2" z="-2"/><rgb name="intensity" value="10"/></emitter>
      <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/>
      <translate x="0" y="-1.5" z="0"/></transform><bsdf type="diffuse"/></shape>)";
  const std::string medium = R"(<medium type="homogeneous" {}><rgb name="sigma_t" value="0.5, 1, 2"/>
      <rgb name="albedo" value="0.9, 0.6, 0.3"/><float name="g" value="0.4"/></medium>)";
  const std::string depth = R"(<integer name="max_depth" value="6"/>)";
  const TestScene primitive =
      loadScene(depth, {}, lights + R"(<volume type="sphere">)" + fmt::format(fmt::runtime(medium), "") + "</volume>");
  const TestScene interior = loadScene(depth, {.seed = 1},
                                       lights + R"(<shape type="sphere"><bsdf type="null"/>)" +
                                           fmt::format(fmt::runtime(medium), R"(name="interior")") + "</shape>");
  EXPECT_TRUE(showTheSame(*primitive.render(1024), *interior.render(1024)));
}

TEST(BothSpellings, ScriptedInteriorOfANullCubeIsABox) {
  const std::string light = R"(<emitter type="constant"/>)";
  const std::string medium = R"(<medium type="ramp" {}><string name="distance" value="null"/>
      <float name="at_zero" value="1"/><float name="slope" value="0.8"/><float name="most" value="1.8"/>
      <rgb name="albedo" value="0.9, 0.6, 0.3"/></medium>)";
  const std::string turned = R"(<transform name="to_world"><rotate x="1" y="2" z="0.5" angle="30"/></transform>)";
  const std::string depth = R"(<integer name="max_depth" value="4"/>)";
  const TestScene primitive =
      loadScene(depth, {.fov = 30},
                light + R"(<volume type="box">)" + turned + fmt::format(fmt::runtime(medium), "") + "</volume>");
  const TestScene interior = loadScene(depth, {.fov = 30, .seed = 1},
                                       light + R"(<shape type="cube"><bsdf type="null"/>)" + turned +
                                           fmt::format(fmt::runtime(medium), R"(name="interior")") + "</shape>");
  EXPECT_TRUE(showTheSame(*primitive.render(1024), *interior.render(1024)));
}

/// Surface-defined media exclude each other: in the inner ball there is the inner medium alone.
TEST(BothSpellings, InnerShapesExcludeOuterMedia) {
  const TestScene scene = loadScene("", {.fov = 8}, std::string(whiteSky) + R"(
      <medium type="homogeneous" id="outer"><rgb name="sigma_t" value="0.2"/><rgb name="albedo" value="0"/></medium>
      <shape type="sphere"><float name="radius" value="2"/><bsdf type="null"/><ref name="interior" id="outer"/></shape>
      <shape type="sphere"><bsdf type="null"/><ref name="exterior" id="outer"/><medium type="homogeneous" name="interior">
          <rgb name="sigma_t" value="1"/><rgb name="albedo" value="0"/></medium></shape>)");
  const auto film = scene.render(4096);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    const std::array<double, 2> outer = throughSphere(ray, 2), inner = throughSphere(ray, 1);
    const double inside = inner[1] - inner[0];
    return sky * static_cast<float>(std::exp(-0.2 * (outer[1] - outer[0] - inside) - inside));
  }));
}

TEST(CameraInMedia, InsideAVolumeAndInItsOwnMedium) {
  const TestScene inside = loadScene("", {.origin = "0, 0, -0.5", .fov = 60}, std::string(whiteSky) + R"(
      <volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="0.3, 0.6, 0.9"/>
      <rgb name="albedo" value="0"/></medium></volume>)");
  EXPECT_TRUE(shows(inside, *inside.render(1024), [](const Ray<World>& ray) {
    const double nearClip = static_cast<double>(ray.tMin);
    return sky * exp(Color(0.3f, 0.6f, 0.9f) * static_cast<float>(nearClip - throughSphere(ray, 1)[1]));
  }));
  // Fog everywhere up to the null sphere around the camera, clear outside.
  const TestScene fog =
      loadScene("", {.origin = "0, 0, -0.5", .fov = 60, .medium = R"(<ref id="fog"/>)"}, std::string(whiteSky) + R"(
      <medium type="homogeneous" id="fog"><rgb name="sigma_t" value="0.3, 0.6, 0.9"/><rgb name="albedo" value="0"/></medium>
      <shape type="sphere"><bsdf type="null"/><ref name="interior" id="fog"/></shape>)");
  EXPECT_TRUE(shows(fog, *fog.render(1024), [](const Ray<World>& ray) {
    const double nearClip = static_cast<double>(ray.tMin);
    return sky * exp(Color(0.3f, 0.6f, 0.9f) * static_cast<float>(nearClip - throughSphere(ray, 1)[1]));
  }));
}

/// Nothing is seen of a sky behind fog without end, and the fog's own light is emission / extinction.
TEST(CameraInMedia, EndlessFog) {
  const TestScene scene = loadScene("", {.medium = R"(<ref id="fog"/>)"}, std::string(whiteSky) + R"(
      <medium type="homogeneous" id="fog"><rgb name="sigma_t" value="0.5, 1, 2"/><rgb name="albedo" value="0"/>
      <rgb name="emission" value="0.5"/></medium>)");
  EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>&) { return Color(1, 0.5f, 0.25f); }));
}

/// A fault of 2% is found.
TEST(RenderSelfTest, ASlabOfTheWrongThickness) {
  const TestScene scene = loadScene("", {.fov = 60}, std::string(whiteSky) + slab(R"(<medium type="homogeneous">
      <rgb name="sigma_t" value="0.1, 0.5, 1"/><rgb name="albedo" value="0"/></medium>)"));
  const auto film = scene.render(1024);
  const auto expected = [](float fault) {
    return [fault](const Ray<World>& ray) {
      return sky * exp(Color(0.1f, 0.5f, 1) * static_cast<float>(-slabLength(ray))) * fault;
    };
  };
  EXPECT_TRUE(shows(scene, *film, expected(1)));
  EXPECT_FALSE(shows(scene, *film, expected(1.02f)));
  EXPECT_FALSE(shows(scene, *film, expected(0.98f)));
}

}  // namespace
}  // namespace aerosol::test
