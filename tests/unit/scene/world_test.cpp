// Scenes of OSL's testrender.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/scene/loader.h"
#include "tests/support/scratch_folder.h"

namespace aerosol::scene {
namespace {

SceneDescription readWorldScene(const std::string& body, Diagnostics* warnings = nullptr) {
  Diagnostics own;
  auto scene = loadString("<World>\n" + body + "\n</World>\n", "world.xml", {}, {}, warnings ? *warnings : own);
  EXPECT_TRUE(scene) << format(scene.errors());
  EXPECT_EQ(format(own), "");
  return scene ? *scene : SceneDescription{};
}

std::string worldErrors(const std::string& body) {
  Diagnostics warnings;
  const auto scene = loadString("<World>\n" + body + "\n</World>\n", "world.xml", {}, {}, warnings);
  EXPECT_FALSE(scene);
  return format(scene.errors());
}

constexpr const char* group = R"(<ShaderGroup>shader matte layer1;</ShaderGroup>)";

TEST(World, HasTheDefaultsOfTestrender) {
  const SceneDescription scene = readWorldScene("");
  EXPECT_EQ(scene.film.width, 640);
  EXPECT_EQ(scene.film.height, 480);
  EXPECT_EQ(scene.film.filter.type, FilterType::tent);
  EXPECT_EQ(scene.sampler.sampleCount, 1);
  EXPECT_EQ(scene.sensor.fieldOfView().axis, FovAxis::y);
  EXPECT_FLOAT_EQ(scene.sensor.fieldOfView().degrees, 90);
  EXPECT_EQ(scene.integrator.maxDepth, -1);
  EXPECT_TRUE(scene.integrator.lowerPriorityWins);
  // Looks along -z from the origin.
  EXPECT_DOUBLE_EQ(scene.sensor.toWorld.matrix()[2][2], -1);
}

TEST(World, PlacesTheCamera) {
  const SceneDescription scene = readWorldScene(R"(<Camera eye="1, 2, 3" look_at="1, 2, -5" fov="40"/>
      <Option max_bounces="int 3" rr_depth="int 7" aa="int 4"/>)");
  const Matrix4& m = scene.sensor.toWorld.matrix();
  EXPECT_DOUBLE_EQ(m[0][3], 1);
  EXPECT_DOUBLE_EQ(m[2][3], 3);
  EXPECT_NEAR(m[2][2], -1, 1e-12);
  EXPECT_NEAR(m[0][0], -1, 1e-12) << "+x of the camera lies to the left, which is -x";
  EXPECT_FLOAT_EQ(scene.sensor.fieldOfView().degrees, 40);
  EXPECT_EQ(scene.integrator.maxDepth, 4);
  EXPECT_EQ(scene.integrator.rrDepth, 7);
  EXPECT_EQ(scene.sampler.sampleCount, 16);
}

/// Older scenes say which shapes are lights; here what emits is one.
TEST(World, ShapesMaySayThatTheyAreLights) {
  const SceneDescription scene = readWorldScene(std::string(group) + R"(
      <Sphere center="1,2,3" radius="0.5" is_light="no"/>
      <Quad corner="-1, 0, 1" edge_x="2, 0, 0" edge_y="0, 0, -4" is_light="yes"/>)");
  EXPECT_EQ(scene.shapes.size(), 2u);
}

TEST(World, ShapesHaveTheGroupBeforeThem) {
  const SceneDescription scene = readWorldScene(std::string(group) + R"(
      <Sphere center="1,2,3" radius="0.5"/>
      <ShaderGroup commands="param float Kd 0.5; shader shiny top;"/>
      <Quad corner="-1, 0, 1" edge_x="2, 0, 0" edge_y="0, 0, -4"/>
      <Background resolution="32"/>)");
  ASSERT_EQ(scene.shapes.size(), 2u);
  EXPECT_EQ(scene.shapes[0].type, ShapeType::sphere);
  EXPECT_FLOAT_EQ(scene.shapes[0].radius, 0.5f);
  EXPECT_TRUE(scene.shapes[0].facesViewer);
  EXPECT_EQ(scene.materials[scene.shapes[0].material].code->text, "shader matte layer1;");
  EXPECT_EQ(scene.materials[scene.shapes[1].material].code->text, "param float Kd 0.5; shader shiny top;");
  // Corners of the rectangle: (-1, -1) and (1, 1) before its transform.
  const Transform<World, Object>& place = scene.shapes[1].toWorld;
  const Point<aerosol::World> first = place(Point<Object>(-1, -1, 0)), last = place(Point<Object>(1, 1, 0));
  EXPECT_FLOAT_EQ(first.x, -1);
  EXPECT_FLOAT_EQ(first.z, 1);
  EXPECT_FLOAT_EQ(last.x, 1);
  EXPECT_FLOAT_EQ(last.z, -3);
  EXPECT_GT(place(Normal<Object>(0, 0, 1)).y, 0) << "edge_x × edge_y";
  ASSERT_EQ(scene.emitters.size(), 1u);
  EXPECT_EQ(scene.emitters[0].type, EmitterType::background);
  EXPECT_EQ(scene.emitters[0].texture, scene.shapes[1].material);
}

TEST(World, GroupsMayBeElements) {
  const SceneDescription scene = readWorldScene(R"(<ShaderGroup>
      <Parameter Kd="float 0.5" Cs="color 1 0.5 0.25" n="int 3" name="a &quot;b&quot;"/>
      <Shader type="surface" name="pattern" layer="one"/>
      <Shader type="surface" name="matte" layer="two"/>
      <ConnectShaders srclayer="one" srcparam="Cout" dstlayer="two" dstparam="Cs"/>
    </ShaderGroup><Sphere center="0 0 0" radius="1"/>)");
  EXPECT_EQ(scene.materials[scene.shapes[0].material].code->text,
            "param float Kd 0.5;\nparam color Cs 1 0.5 0.25;\nparam int n 3;\nparam string name \"a \\\"b\\\"\";\n"
            "shader pattern one;\nshader matte two;\nconnect one.Cout two.Cs;\n");
}

TEST(World, FacesOfModelsFindTheGroupsThatTheirMaterialsName) {
  const test::ScratchFolder scratch;
  const std::filesystem::path folder = scratch.path();
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  std::ofstream(folder / "materials.obj") << corners << "o lid\nusemtl gold\nf 1 2 3\nusemtl other\nf 1 2 3\n";
  std::ofstream(folder / "objects.obj") << corners << "o lid\nf 1 2 3\no gold\nf 1 2 3\n";
  const auto read = [&](const std::string& file) {
    Diagnostics warnings;
    const auto scene =
        loadString("<World>" + std::string(group) + R"(<ShaderGroup name="gold" commands="shader gold g;"/>
        <ShaderGroup name="lid" commands="shader lid l;"/><ShaderGroup commands="shader last z;"/><Model filename=")" +
                       file + "\"/></World>",
                   "world.xml", folder, {}, warnings);
    EXPECT_TRUE(scene) << (scene ? "" : format(scene.errors()));
    std::vector<std::pair<std::string, std::string>> found;
    for (const Shape& shape : scene ? scene->shapes : std::vector<Shape>())
      found.emplace_back(shape.faces, scene->materials[shape.material].code->text);
    return found;
  };
  using Found = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(read("materials.obj"), (Found{{"not usemtl gold", "shader last z;"}, {"usemtl gold", "shader gold g;"}}));
  EXPECT_EQ(read("objects.obj"), (Found{{"o lid", "shader lid l;"}, {"o gold", "shader gold g;"}}));
}

TEST(World, TellsWhatIsWrong) {
  EXPECT_NE(
      worldErrors("<Sphere center=\"0,0,0\" radius=\"1\"/>").find("world.xml:2:1: error: no <ShaderGroup> stands"),
      std::string::npos);
  EXPECT_NE(worldErrors("<Sphere2/>").find("unknown element <Sphere2> in <World>"), std::string::npos);
  EXPECT_NE(
      worldErrors(std::string(group) + "<Quad corner=\"0,0,0\" edge_x=\"1,0,0\" edge_y=\"2,0,0\"/>").find("no area"),
      std::string::npos);
  EXPECT_NE(worldErrors("<Camera eye=\"0,0\"/>").find("'eye' of <Camera> needs 3 numbers, not 2"), std::string::npos);
  EXPECT_NE(worldErrors("<Camera dir=\"0,1,0\"/>").find("looks along its 'up'"), std::string::npos);
  EXPECT_NE(worldErrors("<ShaderGroup type=\"displacement\">shader a b;</ShaderGroup>").find("not supported"),
            std::string::npos);
  Diagnostics warnings;
  readWorldScene("<Option show_globals=\"int 1\"/>", &warnings);
  EXPECT_NE(format(warnings).find("the option 'show_globals' has no effect"), std::string::npos);
}

}  // namespace
}  // namespace aerosol::scene
