#include "core/scene/loader.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/unit/scene/scene_test_support.h"

namespace aerosol::scene {
namespace {

/// A folder that lives as long as one test.
class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("aerosol_scene_" + testName())) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

 private:
  static std::string testName() { return testing::UnitTest::GetInstance()->current_test_info()->name(); }
  std::filesystem::path path_;
};

TEST(Loader, AnEmptySceneHasDefaults) {
  const SceneDescription scene = read("");
  EXPECT_EQ(scene.integrator.maxDepth, -1);
  EXPECT_EQ(scene.integrator.rrDepth, 5);
  EXPECT_EQ(scene.film.width, 768);
  EXPECT_EQ(scene.film.croppedHeight(), 576);
  EXPECT_EQ(scene.film.filter.type, FilterType::gaussian);
  EXPECT_FLOAT_EQ(scene.film.filter.radius, 2);
  EXPECT_EQ(scene.sampler.type, SamplerType::sobol);
  EXPECT_EQ(scene.sensor.fieldOfView().axis, FovAxis::diagonal);
  EXPECT_NEAR(scene.sensor.fieldOfView().degrees, 46.7930f, 1e-3f);
  EXPECT_TRUE(scene.shapes.empty());
  EXPECT_EQ(scene.searchPath, std::vector<std::filesystem::path>{"."});
}

TEST(Loader, ReadsCameraAndFilm) {
  const SceneDescription scene = read(R"(
    <integrator type="volpath">
      <integer name="max_depth" value="64"/> <integer name="rr_depth" value="32"/>
      <boolean name="hide_emitters" value="true"/>
      <string name="distance" value="null"/> <float name="step_scale" value="0.5"/>
      <string name="transmittance" value="unbiased"/> <boolean name="equiangular" value="false"/>
    </integrator>
    <sensor type="thinlens" id="camera">
      <transform name="to_world"><lookat origin="0 1 -5" target="0 1 0" up="0 1 0"/></transform>
      <float name="fov" value="35"/> <string name="fov_axis" value="smaller"/>
      <float name="near_clip" value="0.1"/> <float name="far_clip" value="100"/>
      <float name="aperture_radius" value="0.05"/> <float name="focus_distance" value="5"/>
      <film type="hdrfilm">
        <integer name="width" value="320"/> <integer name="height" value="240"/>
        <integer name="crop_offset_x" value="10"/> <integer name="crop_offset_y" value="20"/>
        <integer name="crop_width" value="310"/>
        <string name="pixel_format" value="rgba"/> <string name="component_format" value="float16"/>
        <rfilter type="gaussian"><float name="stddev" value="0.4"/></rfilter>
      </film>
      <sampler type="independent"><integer name="sample_count" value="128"/><integer name="seed" value="7"/></sampler>
      <medium type="homogeneous"/>
    </sensor>)");
  EXPECT_EQ(scene.integrator.maxDepth, 64);
  EXPECT_EQ(scene.integrator.rrDepth, 32);
  EXPECT_TRUE(scene.integrator.hideEmitters);
  EXPECT_EQ(scene.integrator.distance, DistanceSampling::nullScattering);
  EXPECT_EQ(scene.integrator.stepScale, 0.5f);
  EXPECT_EQ(scene.integrator.transmittance, TransmittanceSampling::unbiased);
  EXPECT_FALSE(scene.integrator.equiangular);
  EXPECT_EQ(scene.sensor.type, SensorType::thinlens);
  EXPECT_EQ(scene.sensor.origin.id, "camera");
  EXPECT_EQ(scene.sensor.toWorld(Point<Camera>(0, 0, 0)), Point<World>(0, 1, -5));
  EXPECT_EQ(scene.sensor.fieldOfView().degrees, 35);
  EXPECT_EQ(scene.sensor.fieldOfView().axis, FovAxis::smaller);
  EXPECT_EQ(scene.sensor.nearClip, 0.1f);
  EXPECT_EQ(scene.sensor.farClip, 100);
  EXPECT_EQ(scene.sensor.apertureRadius, 0.05f);
  EXPECT_EQ(scene.sensor.focusDistance, 5.0f);
  ASSERT_TRUE(scene.sensor.medium);
  EXPECT_EQ(scene.media[*scene.sensor.medium].shader.name, "homogeneous");
  EXPECT_EQ(scene.film.croppedWidth(), 310);
  EXPECT_EQ(scene.film.croppedHeight(), 220);
  EXPECT_EQ(scene.film.pixelFormat, PixelFormat::rgba);
  EXPECT_EQ(scene.film.componentFormat, ComponentFormat::float16);
  EXPECT_FLOAT_EQ(scene.film.filter.radius, 1.6f);
  EXPECT_EQ(scene.sampler.type, SamplerType::independent);
  EXPECT_EQ(scene.sampler.sampleCount, 128);
  EXPECT_EQ(scene.sampler.seed, 7);
}

TEST(Loader, FocalLengthGivesTheDiagonalAngle) {
  const SceneDescription scene =
      read("<sensor type=\"perspective\"><string name=\"focal_length\" value=\"21.6333 mm\"/></sensor>");
  EXPECT_NEAR(scene.sensor.fieldOfView().degrees, 90.0f, 1e-3f);
}

TEST(Loader, FiltersHaveRadiiOfTheirOwn) {
  const auto filter = [](const std::string& text) {
    return read("<sensor type=\"perspective\"><film type=\"hdrfilm\">" + text + "</film></sensor>").film.filter;
  };
  EXPECT_EQ(filter("<rfilter type=\"box\"/>").radius, 0.5f);
  EXPECT_EQ(filter("<rfilter type=\"tent\"/>").radius, 1.0f);
  EXPECT_EQ(filter("<rfilter type=\"tent\"><float name=\"radius\" value=\"2\"/></rfilter>").radius, 2.0f);
  EXPECT_EQ(filter("<rfilter type=\"tent\"/>").type, FilterType::tent);
}

TEST(Loader, ReadsShaderParametersOfEveryType) {
  const SceneDescription scene = read(R"(<volume type="box">
      <medium type="cumulus" id="cloud">
        <float name="density" value="1.5"/> <integer name="octaves" value="6"/> <boolean name="wispy" value="true"/>
        <string name="noise" value="perlin"/> <rgb name="albedo" value="0.9, 0.8, 0.7"/>
        <spectrum name="tint" value="0.5"/> <point name="origin" x="1" z="3"/> <vector name="wind" value="1 0 0"/>
        <transform name="space"><scale value="2"/></transform>
        <float name="step_size" value="0.25"/>
      </medium></volume>)");
  ASSERT_EQ(scene.media.size(), 1u);
  const ShaderUse& shader = scene.media[0].shader;
  EXPECT_EQ(shader.name, "cumulus");
  EXPECT_EQ(shader.origin.id, "cloud");
  EXPECT_EQ(shader.parameters.size(), 9u);
  EXPECT_EQ(shader.find("density")->value, Value(1.5f));
  EXPECT_EQ(shader.find("octaves")->value, Value(6));
  EXPECT_EQ(shader.find("octaves")->convertTo(ValueType::number), Value(6.0f));
  EXPECT_EQ(shader.find("wispy")->convertTo(ValueType::integer), Value(1));
  EXPECT_EQ(shader.find("noise")->value, Value(std::string("perlin")));
  EXPECT_EQ(shader.find("albedo")->value, Value(Color(0.9f, 0.8f, 0.7f)));
  EXPECT_EQ(shader.find("tint")->value, Value(Color(0.5f)));
  EXPECT_EQ(shader.find("origin")->value, Value(Point<Unplaced>(1, 0, 3)));
  EXPECT_EQ(shader.find("wind")->value, Value(Vector<Unplaced>(1, 0, 0)));
  EXPECT_EQ(std::get<Matrix4>(shader.find("space")->value)[1][1], 2);
  EXPECT_EQ(shader.find("step_size"), nullptr);
  EXPECT_EQ(scene.media[0].sampling.stepSize, 0.25f);
}

TEST(Loader, KeepsThePlacesOfObjectsAndParameters) {
  const SceneDescription scene =
      read("<volume type=\"box\">\n  <medium type=\"fog\"><float name=\"a\" value=\"1\"/></medium>\n</volume>");
  const ShaderUse& shader = scene.media[0].shader;
  EXPECT_EQ(scene.volumes[0].origin.location, (SourceLocation{"test.xml", 2, 1}));
  EXPECT_EQ(shader.origin.location, (SourceLocation{"test.xml", 3, 3}));
  EXPECT_EQ(shader.nameLocation, (SourceLocation{"test.xml", 3, 17}));
  EXPECT_EQ(shader.parameters[0].location, (SourceLocation{"test.xml", 3, 35}));
  EXPECT_EQ(shader.parameters[0].valueLocation, (SourceLocation{"test.xml", 3, 45}));
  EXPECT_EQ(shader.origin.of("a"), shader.parameters[0].valueLocation);
  EXPECT_EQ(shader.origin.of("b"), shader.origin.location);
  Diagnostics later;
  later.error(shader.parameters[0].location, "no such parameter");
  scene.sources->annotate(later);
  EXPECT_NE(later.entries()[0].sourceLine.find("<medium type=\"fog\">"), std::string::npos);
}

TEST(Loader, VolumesAddAndTheirSamplingGoesFirst) {
  const SceneDescription scene = read(R"(
    <medium type="homogeneous" id="fog"><float name="step_size" value="1"/><float name="density_bound" value="9"/></medium>
    <volume type="sphere"><point name="center" value="1 2 3"/><ref id="fog"/>
      <float name="step_size" value="0.1"/><string name="distance" value="marching"/></volume>
    <volume type="box"><transform name="to_world"><translate x="5"/></transform><ref id="fog"/></volume>)");
  ASSERT_EQ(scene.volumes.size(), 2u);
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_EQ(scene.volumes[0].medium, scene.volumes[1].medium);
  EXPECT_EQ(scene.volumes[0].get<Point<Unplaced>>("center"), Point<Unplaced>(1, 2, 3));
  EXPECT_EQ(scene.volumes[0].get<float>("radius"), 1.0f);
  EXPECT_EQ(scene.volumes[1].find("radius"), nullptr);
  EXPECT_EQ(scene.volumes[1].toWorld(Point<Object>(0, 0, 0)), Point<World>(5, 0, 0));
  const MediumSampling first = scene.samplingOf(scene.volumes[0]);
  EXPECT_EQ(first.stepSize, 0.1f);
  EXPECT_EQ(first.densityBound, 9.0f);
  EXPECT_EQ(first.distance, DistanceSampling::marching);
  EXPECT_EQ(scene.samplingOf(scene.volumes[1]).stepSize, 1.0f);
}

TEST(Loader, PluginsAddVolumeTypes) {
  LoadOptions options;
  options.knownTypes.volumes.push_back(
      {.type = "torus",
       .doc = "a ring",
       .parameters = {{.name = "thickness", .doc = "of the ring", .required = true, .range = Range::positive()},
                      {.name = "side",
                       .type = ValueType::string,
                       .defaultValue = std::string("both"),
                       .choices = {"both", "one"}}}});
  const std::string medium = "<medium type=\"fog\"/></volume>";
  const SceneDescription scene =
      read("<volume type=\"torus\"><integer name=\"thickness\" value=\"2\"/>" + medium, options);
  EXPECT_EQ(scene.volumes[0].get<float>("thickness"), 2.0f);
  EXPECT_EQ(scene.volumes[0].get<std::string>("side"), "both");
  EXPECT_NE(readErrors("<volume type=\"torus\">" + medium, options).find("lacks its parameter 'thickness'"),
            std::string::npos);
  EXPECT_NE(readErrors("<volume type=\"torus\"><float name=\"thickness\" value=\"0\"/>" + medium, options)
                .find("has to be > 0"),
            std::string::npos);
}

TEST(Loader, ShapesHaveMaterialsMediaAndLights) {
  const SceneDescription scene = read(R"(
    <shape type="sphere">
      <ref id="glass"/> <ref name="interior" id="fog"/> <medium name="exterior" type="air"/>
      <float name="radius" value="2"/> <point name="center" value="0 1 0"/> <boolean name="flip_normals" value="true"/>
    </shape>
    <shape type="rectangle"><emitter type="area"><rgb name="radiance" value="5"/></emitter></shape>
    <shape type="disk"/> <shape type="cube"/>
    <bsdf type="null" id="clear"/> <alias id="clear" as="glass"/> <medium type="homogeneous" id="fog"/>)");
  ASSERT_EQ(scene.shapes.size(), 4u);
  const Shape& ball = scene.shapes[0];
  EXPECT_EQ(ball.type, ShapeType::sphere);
  EXPECT_EQ(scene.materials[ball.material].name, "null");
  EXPECT_EQ(scene.media[ball.interior.value()].shader.name, "homogeneous");
  EXPECT_EQ(scene.media[ball.exterior.value()].shader.name, "air");
  EXPECT_EQ(ball.radius, 2);
  EXPECT_EQ(ball.center, Point<Object>(0, 1, 0));
  EXPECT_TRUE(ball.flipNormals);
  const Shape& lamp = scene.shapes[1];
  ASSERT_TRUE(lamp.emitter);
  EXPECT_EQ(lamp.emitter->emitted, Color(5));
  EXPECT_EQ(scene.materials[lamp.material].name, "diffuse");
  EXPECT_EQ(scene.materials[lamp.material].find("reflectance")->value, Value(Color(0)));
  EXPECT_EQ(scene.materials[scene.shapes[2].material].find("reflectance"), nullptr);
  EXPECT_EQ(scene.shapes[2].material, scene.shapes[3].material);
}

/// As Mitsuba's integrators of these names do.
TEST(Loader, ShadowsAreTransparentByTheIntegratorsName) {
  const auto transparent = [](const std::string& type, const std::string& more = {}) {
    return read("<integrator type=\"" + type + "\">" + more + "</integrator>").integrator.transparentShadows;
  };
  EXPECT_FALSE(transparent("path"));
  EXPECT_TRUE(transparent("volpath"));
  EXPECT_TRUE(transparent("volpathmis"));
  EXPECT_TRUE(transparent("path", R"(<boolean name="transparent_shadows" value="true"/>)"));
  EXPECT_FALSE(transparent("volpath", R"(<boolean name="transparent_shadows" value="false"/>)"));
}

TEST(Loader, ReadsLights) {
  const SceneDescription scene = read(R"(
    <emitter type="point"><point name="position" value="1 2 3"/><rgb name="intensity" value="#ffffff"/></emitter>
    <emitter type="point"><transform name="to_world"><translate z="4"/></transform><float name="intensity" value="3"/></emitter>
    <emitter type="directional"><vector name="direction" value="0 -2 0"/><spectrum name="irradiance" value="2"/></emitter>
    <emitter type="directional"><transform name="to_world"><rotate x="1" angle="90"/><scale value="3"/></transform></emitter>
    <emitter type="constant"><rgb name="radiance" value="0.1 0.2 0.3"/></emitter>)");
  ASSERT_EQ(scene.emitters.size(), 5u);
  EXPECT_EQ(scene.emitters[0].position, Point<World>(1, 2, 3));
  EXPECT_EQ(scene.emitters[0].emitted, Color(1));
  EXPECT_EQ(scene.emitters[1].position, Point<World>(0, 0, 4));
  EXPECT_EQ(scene.emitters[1].emitted, Color(3));
  EXPECT_EQ(scene.emitters[2].direction, Vector<World>(0, -1, 0));
  EXPECT_EQ(scene.emitters[3].direction, Vector<World>(0, -1, 0));
  EXPECT_EQ(scene.emitters[4].type, EmitterType::constant);
  EXPECT_EQ(scene.emitters[4].emitted, Color(0.1f, 0.2f, 0.3f));
}

TEST(Loader, APhaseFunctionGivesTheMediumItsG) {
  const SceneDescription scene = read(R"(
    <volume type="box"><medium type="a"><phase type="hg"><float name="g" value="0.8"/></phase></medium></volume>
    <volume type="box"><medium type="b"><phase type="isotropic"/></medium></volume>
    <volume type="box"><medium type="c"/></volume>)");
  EXPECT_EQ(scene.media[0].shader.find("g")->value, Value(0.8f));
  EXPECT_EQ(scene.media[1].shader.find("g")->value, Value(0.0f));
  EXPECT_EQ(scene.media[2].shader.find("g"), nullptr);
}

TEST(Loader, ConstantsReplaceNamesInEveryAttribute) {
  const std::string body = R"(<default name="kind" value="sphere"/><default name="r" value="2"/>
    <default name="name" value="radius"/><default name="twice" value="$r$r"/>
    <shape type="$kind" id="ball$r"><float name="$name" value="$twice"/></shape>)";
  const SceneDescription scene = read(body);
  EXPECT_EQ(scene.shapes[0].radius, 22);
  EXPECT_EQ(scene.shapes[0].origin.id, "ball2");
  EXPECT_EQ(read(body, {.defines = {{"r", "3"}}, .overrides = {}, .knownTypes = {}}).shapes[0].radius, 33);
}

TEST(Loader, WarnsOfWhatHasNoEffect) {
  Diagnostics warnings;
  read(R"(<default name="idle" value="1"/><bsdf type="diffuse" id="unused"/><medium type="fog"/>
    <sensor type="perspective"><sampler type="multijitter"><boolean name="jitter" value="true"/></sampler></sensor>)",
       {}, &warnings);
  const std::string text = format(warnings);
  EXPECT_EQ(warnings.entries().size(), 5u) << text;
  for (const char* part :
       {"the default 'idle' is never used", "bsdf 'unused' is never referred to", "medium 'fog' has no id",
        "the low-discrepancy sampler 'sobol' is used", "parameter 'jitter' has no effect"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(warnings.errorCount(), 0);
}

TEST(Loader, OfSeveralSensorsOneIsTaken) {
  const std::string body = R"(<sensor type="perspective"><float name="fov" value="30"/>
      <film type="hdrfilm"><integer name="width" value="100"/></film></sensor>
    <sensor type="thinlens" id="close"><float name="fov" value="60"/><float name="aperture_radius" value="0.1"/></sensor>
    <sensor type="orthographic" id="0"/>)";
  const auto taken = [&](const std::string& wanted, std::size_t warnings) {
    Diagnostics told;
    LoadOptions options;
    options.sensor = wanted;
    SceneDescription scene = read(body, options, &told);
    EXPECT_EQ(told.entries().size(), warnings) << format(told);
    return scene;
  };
  // The first one where nobody says, with the others named; an id comes before a number.
  EXPECT_EQ(taken("", 1).film.width, 100);
  EXPECT_EQ(taken("close", 0).sensor.type, SensorType::thinlens);
  EXPECT_EQ(taken("1", 0).sensor.type, SensorType::thinlens);
  EXPECT_NE(taken("1", 0).film.width, 100) << "the film of another sensor";
  EXPECT_EQ(taken("0", 0).sensor.type, SensorType::orthographic);
}

TEST(Loader, FindsFilesBesideTheirSceneAndOnThePath) {
  const Folder folder;
  folder.write("meshes/a.ply", "ply");
  folder.write("parts/b.obj", "v 0 0 0");
  folder.write(
      "parts/part.xml",
      "<scene version=\"3.0.0\"><shape type=\"obj\"><string name=\"filename\" value=\"b.obj\"/></shape></scene>");
  folder.write("lamp.xml", "<emitter type=\"area\" version=\"3.0.0\"/>");
  const auto file = folder.write("scene.xml", wrap(R"(<path value="meshes"/><include filename="parts/part.xml"/>
    <shape type="ply"><string name="filename" value="a.ply"/><boolean name="face_normals" value="true"/><include filename="lamp.xml"/></shape>)"));
  Diagnostics warnings;
  const auto scene = load(file, {}, warnings);
  ASSERT_TRUE(scene) << format(scene.errors());
  ASSERT_EQ(scene->shapes.size(), 2u);
  EXPECT_EQ(scene->shapes[0].file, file.parent_path() / "parts/b.obj");
  EXPECT_EQ(scene->shapes[0].origin.location.file, (file.parent_path() / "parts/part.xml").string());
  EXPECT_EQ(scene->shapes[1].file, file.parent_path() / "meshes/a.ply");
  EXPECT_TRUE(scene->shapes[1].faceNormals);
  EXPECT_TRUE(scene->shapes[1].emitter);
  ASSERT_EQ(scene->searchPath.size(), 2u);
  EXPECT_EQ(scene->searchPath[1], file.parent_path() / "meshes");
}

TEST(Loader, IncludesThatMultiplyEndInAnError) {
  const Folder folder;
  for (int i = 0; i < 40; ++i) {
    const std::string next = "<include filename=\"" + std::to_string(i + 1) + ".xml\"/>";
    folder.write(std::to_string(i) + ".xml", "<scene version=\"3.0.0\">" + next + next + "</scene>");
  }
  const auto last = folder.write("40.xml", "<scene version=\"3.0.0\"><shape type=\"cube\"/></scene>");
  Diagnostics warnings;
  const auto scene = load(last.parent_path() / "0.xml", {}, warnings);
  ASSERT_FALSE(scene);
  EXPECT_NE(format(scene.errors()).find("more than 10000 files are included"), std::string::npos);
}

TEST(Loader, AMissingFileIsAnError) {
  Diagnostics warnings;
  const auto scene = load("/no/such/scene.xml", {}, warnings);
  ASSERT_FALSE(scene);
  EXPECT_EQ(format(scene.errors()), "/no/such/scene.xml: error: the scene cannot be read: it does not exist\n");
  EXPECT_FALSE(load("/", {}, warnings));
}

TEST(Loader, StopsAfterAHundredErrors) {
  std::string body;
  for (int i = 0; i < 500; ++i) body += "<bogus/>\n";
  Diagnostics warnings;
  const auto scene = loadString(wrap(body), "test.xml", {}, {}, warnings);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.errors().entries().size(), 101u);
  EXPECT_NE(scene.errors().entries().back().message.find("too many errors"), std::string::npos);
}

TEST(Loader, MergedShapesStayWhatTheyAre) {
  Diagnostics warnings;
  const auto scene =
      loadString(R"(<scene version="3.0.0"><sensor type="perspective"/><shape type="merge"><shape type="cube"/>
      <shape type="merge"><shape type="sphere"/></shape></shape><shape type="shapegroup" id="g"><shape type="merge">
      <shape type="disk"/></shape></shape><shape type="instance"><ref id="g"/></shape></scene>)",
                 "merge.xml", {}, {}, warnings);
  ASSERT_TRUE(scene) << format(scene.errors());
  ASSERT_EQ(scene->shapes.size(), 3u);
  EXPECT_EQ(scene->shapes[1].type, ShapeType::sphere);
  EXPECT_EQ(scene->shapes[2].type, ShapeType::disk);
}

TEST(Loader, EmittersMayNameTheirMedium) {
  Diagnostics warnings;
  const auto scene =
      loadString(R"(<scene version="3.0.0"><sensor type="perspective"/><medium type="homogeneous" id="fog"/>
      <emitter type="point"><ref id="fog" name="medium"/></emitter></scene>)",
                 "medium.xml", {}, {}, warnings);
  ASSERT_TRUE(scene) << format(scene.errors());
  EXPECT_EQ(format(warnings), "");
}

}  // namespace
}  // namespace aerosol::scene
