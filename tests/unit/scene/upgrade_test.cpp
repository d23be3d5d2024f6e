// Scenes in the names of versions before 2.

#include <gtest/gtest.h>

#include "tests/unit/scene/scene_test_support.h"

namespace aerosol::scene {
namespace {

SceneDescription readOld(const std::string& body) {
  Diagnostics warnings;
  auto scene = loadString("<scene version=\"0.6.0\">" + body + "</scene>", "old.xml", {}, {}, warnings);
  EXPECT_TRUE(scene) << format(scene.errors());
  EXPECT_EQ(format(warnings), "");
  return scene ? *scene : SceneDescription{};
}

TEST(Upgrade, NamesGetUnderscores) {
  const SceneDescription scene = readOld(R"(
      <default name="myDepth" value="7"/>
      <integrator type="path"><integer name="maxDepth" value="$myDepth"/><integer name="rrDepth" value="9"/></integrator>
      <sensor type="perspective">
        <float name="nearClip" value="0.5"/><float name="farClip" value="50"/><string name="fovAxis" value="smaller"/>
        <float name="fov" value="30"/>
        <transform name="toWorld"><lookAt origin="0, 0, -4" target="0, 0, 0" up="0, 1, 0"/></transform>
      </sensor>
      <shape type="sphere"><boolean name="flipNormals" value="true"/>
        <bsdf type="dielectric"><float name="intIOR" value="1.4"/><float name="extIOR" value="1.1"/></bsdf></shape>)");
  EXPECT_EQ(scene.integrator.maxDepth, 7);
  EXPECT_EQ(scene.integrator.rrDepth, 9);
  EXPECT_FLOAT_EQ(scene.sensor.nearClip, 0.5f);
  EXPECT_EQ(scene.sensor.fieldOfView().axis, FovAxis::smaller);
  EXPECT_DOUBLE_EQ(scene.sensor.toWorld.matrix()[2][3], -4);
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_TRUE(scene.shapes[0].flipNormals);
  EXPECT_TRUE(scene.materials[0].find("int_ior"));
  EXPECT_TRUE(scene.materials[0].find("ext_ior"));
}

TEST(Upgrade, MaterialsAndTexturesGetTheirNewParameters) {
  const SceneDescription scene = readOld(R"(<sensor type="perspective"/><shape type="sphere">
      <bsdf type="diffuse"><texture type="checkerboard" name="diffuseReflectance">
        <float name="uoffset" value="2"/><float name="voffset" value="3"/>
        <float name="uscale" value="10"/><float name="vscale" value="20"/></texture></bsdf></shape>)");
  ASSERT_EQ(scene.materials.size(), 1u);
  ASSERT_EQ(scene.materials[0].inputs.size(), 1u);
  EXPECT_EQ(scene.materials[0].inputs[0].parameter, "reflectance");
  ASSERT_EQ(scene.layers.size(), 1u);
  const ShaderParameter* place = scene.layers[0].find("to_uv");
  ASSERT_TRUE(place);
  const Matrix4& m = std::get<Matrix4>(place->value);
  EXPECT_DOUBLE_EQ(m[0][0], 10);
  EXPECT_DOUBLE_EQ(m[0][3], 20);
  EXPECT_DOUBLE_EQ(m[1][1], 20);
  EXPECT_DOUBLE_EQ(m[1][3], 60);
}

TEST(Upgrade, FiltersGammaAndEncodedColoursGetTheirNewForms) {
  const SceneDescription scene = readOld(R"(<sensor type="perspective"/><shape type="sphere">
      <bsdf type="plastic"><texture type="bitmap" name="diffuseReflectance"><string name="filename" value="a.png"/>
        <string name="filterType" value="ewa"/><float name="gamma" value="1.0"/></texture>
        <srgb name="specularReflectance" value="0.5, 1, 0"/></bsdf></shape>)");
  ASSERT_EQ(scene.layers.size(), 1u);
  const ShaderParameter* filter = scene.layers[0].find("filter_type");
  ASSERT_TRUE(filter);
  EXPECT_EQ(std::get<std::string>(filter->value), "bilinear");
  EXPECT_TRUE(scene.layers[0].find("raw"));
  const ShaderParameter* tint = scene.materials[0].find("specular_reflectance");
  ASSERT_TRUE(tint);
  const Color color = std::get<Color>(tint->value);
  EXPECT_NEAR(color.r, 0.2140411f, 1e-5f);
  EXPECT_NEAR(color.g, 1, 1e-6f);
  EXPECT_EQ(color.b, 0);
}

TEST(Upgrade, FilmsForDisplaysAreFilms) {
  Diagnostics warnings;
  const auto scene = loadString(R"(<scene version="0.6.0"><sensor type="perspective"><film type="ldrfilm">
      <integer name="width" value="64"/><string name="fileFormat" value="png"/><float name="gamma" value="2.2"/>
      <string name="pixelFormat" value="luminanceAlpha"/></film></sensor></scene>)",
                                "old.xml", {}, {}, warnings);
  EXPECT_FALSE(scene);
  const auto good = loadString(R"(<scene version="0.6.0"><sensor type="perspective"><film type="ldrfilm">
      <integer name="width" value="64"/><string name="fileFormat" value="png"/><float name="gamma" value="2.2"/>
      <string name="pixelFormat" value="luminance_alpha"/></film></sensor></scene>)",
                               "old.xml", {}, {}, warnings);
  ASSERT_TRUE(good) << format(good.errors());
  EXPECT_EQ(good->film.width, 64);
  EXPECT_EQ(good->film.pixelFormat, PixelFormat::luminanceAlpha);
  EXPECT_NE(format(warnings).find("gamma"), std::string::npos);
}

TEST(Upgrade, VoxelMediaGetTheirNewNamesAndStandWhereTheirFileSays) {
  const SceneDescription scene = readOld(R"(<sensor type="perspective"/><shape type="cube"><bsdf type="null"/>
      <medium name="interior" type="heterogeneous"><string name="method" value="woodcock"/>
        <float name="densityMultiplier" value="7"/>
        <volume name="density" type="gridvolume"><string name="filename" value="smoke.vol"/>
          <boolean name="sendData" value="false"/></volume>
        <volume name="albedo" type="constvolume"><spectrum name="value" value="0.9"/></volume></medium></shape>)");
  ASSERT_EQ(scene.media.size(), 1u);
  const ShaderUse& medium = scene.media[0].shader;
  EXPECT_FALSE(medium.find("method"));
  ASSERT_TRUE(medium.find("scale"));
  EXPECT_EQ(std::get<float>(medium.find("scale")->value), 7);
  ASSERT_EQ(medium.inputs.size(), 2u);
  EXPECT_EQ(medium.inputs[0].parameter, "sigma_t");
  const ShaderUse& voxels = scene.layers.at(medium.inputs[0].layer);
  ASSERT_TRUE(voxels.find("use_grid_bbox"));
  EXPECT_TRUE(std::get<bool>(voxels.find("use_grid_bbox")->value));
  EXPECT_FALSE(voxels.find("send_data"));
}

TEST(Upgrade, IntegratorsThatAreImitatedKeepTheirDepth) {
  for (const char* type : {"bdpt", "pssmlt", "mlt", "erpt", "photonmapper", "ppm", "sppm", "vpl"}) {
    Diagnostics warnings;
    const auto scene =
        loadString(std::string("<scene version=\"0.6.0\"><integrator type=\"") + type +
                       R"("><integer name="maxDepth" value="9"/><integer name="directSamples" value="16"/>
      <float name="pLarge" value="0.3"/></integrator><sensor type="perspective"/></scene>)",
                   "old.xml", {}, {}, warnings);
    ASSERT_TRUE(scene) << type << format(scene.errors());
    EXPECT_EQ(scene->integrator.maxDepth, 9) << type;
    EXPECT_NE(format(warnings).find("'path' is used, whose picture has the same mean"), std::string::npos) << type;
  }
}

TEST(Upgrade, NewFilesAreReadAsTheyAre) {
  EXPECT_NE(readErrors(R"(<sensor type="perspective"><float name="nearClip" value="1"/></sensor>)").find("nearClip"),
            std::string::npos);
}

TEST(Upgrade, ErrorsTellThePlaceInTheFile) {
  Diagnostics warnings;
  const auto scene = loadString(
      "<scene version=\"0.5.0\">\n<sensor type=\"perspective\">\n  <float name=\"nearClipp\" "
      "value=\"1\"/></sensor>\n</scene>",
      "old.xml", {}, {}, warnings);
  ASSERT_FALSE(scene);
  EXPECT_NE(format(scene.errors()).find("old.xml:3:16: error: sensor 'perspective' has no parameter 'near_clipp'"),
            std::string::npos)
      << format(scene.errors());
}

}  // namespace
}  // namespace aerosol::scene
