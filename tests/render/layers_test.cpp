#include <fmt/format.h>

#include "tests/render/film_checks.h"

// Shaders made of layers, on volumes and surfaces, against closed forms.

namespace aerosol::test {
namespace {

constexpr const char* sky = R"(<emitter type="constant"><rgb name="radiance" value="1, 2, 0.5"/></emitter>)";
const Color skyColor(1, 2, 0.5f);

/// A box across the view, from z = -1 to z = 1.
std::string slab(const std::string& medium) {
  return fmt::format(
      R"(<volume type="box"><transform name="to_world"><scale x="50" y="50" z="1"/></transform>{}</volume>)", medium);
}

double slabLength(const Ray<World>& ray) { return 2 / static_cast<double>(ray.direction.z); }

/// A wall at z = 0 that faces the camera.
std::string wall(const std::string& bsdf, const std::string& more = "") {
  return fmt::format(R"({}<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/>
      <scale value="50"/></transform>{}</shape>)",
                     more, bsdf);
}

bool isLeft(const Ray<World>& ray) { return ray.direction.x < 0; }

/// ∫ (a + b z) dz over the slab is 2 a.
Color rampTransmittance(const Ray<World>& ray) {
  return skyColor * exp(Color(1.0f) * static_cast<float>(-0.6 * slabLength(ray)));
}

TEST(Layers, ATextureFeedsAMedium) {
  const TestScene scene = loadScene("", {.fov = 60}, std::string(sky) + slab(R"(<medium type="homogeneous">
      <rgb name="albedo" value="0"/><float name="density_bound" value="1.2"/><string name="distance" value="null"/>
      <texture name="sigma_t" type="line" output="value"><float name="at_zero" value="0.6"/><float name="slope" value="0.5"/></texture>
      </medium>)"));
  const auto film = scene.render(1024);
  EXPECT_TRUE(shows(scene, *film, rampTransmittance));
}

TEST(Layers, AGroupOfTextIsAMedium) {
  const TestScene scene = loadScene("", {.fov = 60}, std::string(sky) + slab(R"(<medium type="osl">
      <float name="density_bound" value="1.2"/><float name="ramp.slope" value="0.5"/><string name="distance" value="null"/>
      <group><![CDATA[
        param float at_zero 0.6 ;
        shader line ramp ;
        param color albedo 0 ;
        shader homogeneous fog ;
        connect ramp.value fog.sigma_t ;
      ]]></group></medium>)"));
  const auto film = scene.render(1024);
  EXPECT_TRUE(shows(scene, *film, rampTransmittance));
}

TEST(Layers, ASourceInTheSceneIsAMedium) {
  const TestScene scene = loadScene("", {.fov = 60}, std::string(sky) + slab(R"(<medium type="osl">
      <float name="density_bound" value="1.2"/><float name="slope" value="0.5"/><string name="distance" value="null"/>
      <source><![CDATA[
        volume inline_ramp(float slope = 0) {
          Ci = anisotropic_vdf(0, color(0.6 + slope * P[2]), 0);
        }
      ]]></source></medium>)"));
  const auto film = scene.render(1024);
  EXPECT_TRUE(shows(scene, *film, rampTransmittance));
}

TEST(Layers, ATextureFeedsASurface) {
  const TestScene scene = loadScene("", {.fov = 40},
                                    wall(R"(<bsdf type="diffuse">
      <texture name="reflectance" type="line"/></bsdf>)",
                                         sky));
  const auto film = scene.render(256);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    return skyColor * (isLeft(ray) ? Color(0.1f, 0.6f, 0.3f) : Color(0.8f, 0.2f, 0.4f));
  }));
}

TEST(Layers, OneLayerFeedsPartsOfSeveralShaders) {
  // Red of one material and green of another, both from one texture.
  const TestScene scene = loadScene("", {.fov = 40},
                                    wall(R"(<bsdf type="blend"><float name="weight" value="0.25"/>
      <bsdf name="first" type="diffuse"><rgb name="reflectance" value="0"/>
        <ref id="sides" name="reflectance.r" output="sides[0]"/></bsdf>
      <bsdf name="second" type="diffuse"><rgb name="reflectance" value="0"/>
        <ref id="sides" name="reflectance.g" output="sides.g"/></bsdf></bsdf>)",
                                         std::string(sky) + R"(<texture id="sides" type="line"/>)"));
  const auto film = scene.render(256);
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    return skyColor * (isLeft(ray) ? Color(0.75f * 0.1f, 0.25f * 0.6f, 0) : Color(0.75f * 0.8f, 0.25f * 0.2f, 0));
  }));
}

TEST(Layers, InstancesOfOneStructureShareKernels) {
  std::string shapes;
  for (int i = 0; i < 4; ++i) {
    shapes += fmt::format(R"(<shape type="sphere"><bsdf type="diffuse"><texture name="reflectance" type="line">
        <rgb name="left" value="0.{}"/></texture></bsdf></shape>)",
                          i + 1);
  }
  const TestScene scene = loadScene("", {}, std::string(sky) + shapes);
  ASSERT_NE(scene.scene(), nullptr);
  EXPECT_EQ(scene.scene()->shading.families().size(), 1u);
}

/// A material by a shader of `count` parts, each of them `part` with its number for $.
std::string partsShader(const std::string& parameters, const std::string& before, const std::string& part, int count) {
  std::string text = fmt::format(R"(<bsdf type="osl"><source><![CDATA[surface parts({}) {{ {})", parameters, before);
  for (int i = 0; i < count; ++i) {
    for (const char c : part) text += c == '$' ? std::to_string(i) : std::string(1, c);
    text += '\n';
  }
  return text + "}]]></source></bsdf>";
}

TEST(Layers, AMaterialMayHaveManyClosures) {
  const TestScene scene = loadScene(R"(<integer name="max_depth" value="2"/>)", {.fov = 40},
                                    wall(partsShader("", "", "Ci += color(0.5, 0.25, 1) / 40 * diffuse(N);", 40), sky));
  ASSERT_TRUE(scene.scene()) << scene.warnings();
  EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>&) { return skyColor * Color(0.5f, 0.25f, 1); }));
}

/// More than are allowed, and copies below layers, none of which has a weight.
TEST(Layers, WhatAnInstanceLeavesOutDoesNotCount) {
  const std::string sums =
      partsShader("float coat = 0", "Ci = 0.5 * diffuse(N);", "Ci += coat * phong(N, 1 + $);", 300);
  const std::string coats = partsShader("float coat = 0", "Ci = 0.5 * diffuse(N);",
                                        "Ci = layer(coat * phong(N, 1 + $), Ci) + coat * reflection(N);", 9);
  for (const std::string& material : {sums, coats}) {
    const TestScene scene = loadScene(R"(<integer name="max_depth" value="2"/>)", {.fov = 40}, wall(material, sky));
    ASSERT_TRUE(scene.scene()) << scene.warnings();
    EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>&) { return skyColor * 0.5f; }));
  }
}

/// As MaterialX writes materials: alone, and fed by a layer before it.
TEST(Layers, TheOnlyOutputThatIsAClosureStandsForCi) {
  const std::string direct = R"(<bsdf type="osl"><source><![CDATA[
      shader material(color tint = 0.5, output closure color out = 0) { out = tint * diffuse(N); }]]></source></bsdf>)";
  const std::string several = R"(<bsdf type="osl"><source><![CDATA[
      shader material(output closure color out = 0, output closure color other = 0) { out = diffuse(N); }]]></source></bsdf>)";
  const std::string group = R"(<bsdf type="osl"><group><![CDATA[
      param float at_zero 0.25 ; param float slope 0 ; shader line ramp ; shader closure_out material ;
      connect ramp.value material.tint ; ]]></group></bsdf>)";
  for (const auto& [material, part] : {std::pair{direct, 0.5f}, {several, 0.0f}, {group, 0.25f}}) {
    const TestScene scene = loadScene(R"(<integer name="max_depth" value="2"/>)", {.fov = 40}, wall(material, sky));
    ASSERT_TRUE(scene.scene()) << scene.warnings();
    EXPECT_TRUE(shows(scene, *scene.render(256), [&](const Ray<World>&) { return skyColor * part; }));
  }
}

/// Two materials with different numbers of closures, met by the same paths.
TEST(Layers, MaterialsWithManyAndFewClosuresStandTogether) {
  const std::string many = partsShader("", "", "Ci += 0.5 / 40 * oren_nayar(N, 0);", 40);
  const std::string few = R"(<bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf>)";
  const std::string half = R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/>
      <translate x="{}"/><scale value="50"/></transform>{}</shape>)";
  const TestScene scene =
      loadScene(R"(<integer name="max_depth" value="2"/>)", {.fov = 40},
                sky + fmt::format(fmt::runtime(half), -1, many) + fmt::format(fmt::runtime(half), 1, few));
  ASSERT_TRUE(scene.scene()) << scene.warnings();
  EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>&) { return skyColor * 0.5f; }));
}

}  // namespace
}  // namespace aerosol::test
