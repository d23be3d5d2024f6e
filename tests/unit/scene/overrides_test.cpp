#include "core/scene/overrides.h"

#include <gtest/gtest.h>

#include "tests/unit/scene/scene_test_support.h"

namespace aerosol::scene {
namespace {

const char* const body = R"(
  <integrator type="path"/>
  <sensor type="perspective" id="camera"><float name="fov" value="40"/>
    <film type="hdrfilm"><rfilter type="gaussian"/></film></sensor>
  <medium type="cumulus" id="cloud"><float name="density" value="1"/><integer name="octaves" value="4"/></medium>
  <medium type="cumulus" id="veil"/>
  <volume type="sphere" id="ball"><ref id="cloud"/></volume>
  <volume type="box"><ref id="veil"/></volume>
  <shape type="sphere"><bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf></shape>
  <emitter type="constant"/>)";

SceneDescription readSet(std::vector<std::string> overrides) {
  return read(body, {.defines = {}, .overrides = std::move(overrides), .knownTypes = {}});
}

std::string setErrors(const std::string& assignment) {
  return readErrors(body, {.defines = {}, .overrides = {assignment}, .knownTypes = {}});
}

TEST(Overrides, ReachObjectsByIdTypeAndKind) {
  EXPECT_EQ(readSet({"camera.fov=60"}).sensor.fov, 60.0f);
  EXPECT_EQ(readSet({"film.width=100", "hdrfilm.height=50"}).film.height, 50);
  EXPECT_EQ(readSet({"integrator.max_depth=3"}).integrator.maxDepth, 3);
  EXPECT_EQ(readSet({"sampler.sample_count=9"}).sampler.sampleCount, 9);
  EXPECT_EQ(readSet({"emitter.radiance=1 2 3"}).emitters[0].emitted, Color(1, 2, 3));
  EXPECT_EQ(readSet({"ball.radius=3"}).volumes[0].get<float>("radius"), 3);
  EXPECT_EQ(readSet({"ball.step_size=0.5"}).volumes[0].sampling.stepSize, 0.5f);
}

TEST(Overrides, ATypeReachesAllObjectsThatKnowTheParameter) {
  const SceneDescription scene = readSet({"sphere.radius=4"});
  EXPECT_EQ(scene.volumes[0].get<float>("radius"), 4);
  EXPECT_EQ(scene.shapes[0].radius, 4);
}

TEST(Overrides, SetShaderParametersOfOneOrAllUses) {
  const SceneDescription one = readSet({"cloud.density=2"});
  EXPECT_EQ(one.media[0].shader.find("density")->value, Value(2.0f));
  EXPECT_FALSE(one.media[0].shader.find("density")->untyped);
  EXPECT_EQ(one.media[1].shader.find("density"), nullptr);
  const SceneDescription all = readSet({"cumulus.density=2"});
  EXPECT_EQ(all.media[0].shader.find("density")->value, Value(2.0f));
  EXPECT_EQ(all.media[1].shader.find("density")->value, Value(2));
  EXPECT_EQ(all.media[1].shader.find("density")->convertTo(ValueType::number), Value(2.0f));
  EXPECT_TRUE(all.media[1].shader.find("density")->untyped);
  EXPECT_EQ(all.media[1].shader.find("density")->location.file, "--set cumulus.density=2");
  EXPECT_EQ(readSet({"diffuse.reflectance=#000000"}).materials[0].find("reflectance")->value, Value(Color(0)));
}

TEST(Overrides, AnIntegerMayBecomeANumber) {
  EXPECT_EQ(readSet({"cloud.octaves=4.5"}).media[0].shader.find("octaves")->value, Value(4.5f));
}

TEST(Overrides, AStarReachesAllThatKnowOrWriteTheParameter) {
  EXPECT_EQ(readSet({"*.step_scale=2"}).integrator.stepScale, 2);
  const SceneDescription scene = readSet({"*.density=3"});
  EXPECT_EQ(scene.media[0].shader.find("density")->value, Value(3.0f));
  EXPECT_EQ(scene.media[1].shader.find("density"), nullptr);
  EXPECT_EQ(readSet({"*.step_size=3"}).media[1].sampling.stepSize, 3.0f);
}

TEST(Overrides, LaterOnesWin) {
  EXPECT_EQ(readSet({"film.width=1", "film.width=2"}).film.width, 2);
  EXPECT_EQ(readSet({"veil.a=1", "veil.a=two"}).media[1].shader.find("a")->value, Value(std::string("two")));
}

TEST(Overrides, AValueMayHoldDotsAndEqualSigns) {
  EXPECT_EQ(readSet({"veil.text=a=b.c"}).media[1].shader.find("text")->value, Value(std::string("a=b.c")));
}

TEST(Overrides, DerivedDefaultsFollow) {
  EXPECT_FLOAT_EQ(readSet({"rfilter.stddev=1"}).film.filter.radius, 4);
  EXPECT_EQ(readSet({"camera.focal_length=20mm"}).sensor.fieldOfView().axis, FovAxis::diagonal);
}

TEST(Overrides, NameTheirTargetsWhenNothingMatches) {
  EXPECT_EQ(
      setErrors("clod.density=1"),
      "--set clod.density=1: error: nothing in the scene is called 'clod'\n"
      "  note: did you mean 'cloud'?\n"
      "  note: targets: *, ball, box, bsdf, camera, cloud, constant, cumulus, diffuse, emitter, film, gaussian, "
      "hdrfilm, integrator, medium, path, perspective, rfilter, sampler, sensor, shape, sobol, sphere, veil, volume\n");
  EXPECT_EQ(
      setErrors("film.widht=1"),
      "--set film.widht=1: error: 'film' has no parameter 'widht'\n"
      "  note: did you mean 'width'?\n"
      "  note: its parameters: component_format, crop_height, crop_offset_x, crop_offset_y, crop_width, file_format, "
      "height, pixel_format, width\n");
  EXPECT_NE(setErrors("*.nothing=1").find("'*' has no parameter 'nothing'"), std::string::npos);
}

TEST(Overrides, RefuseWrongValues) {
  for (const char* wrong :
       {"film.width=abc", "film.width=0", "film.width=", "sensor.fov=nan", "integrator.distance=fast", "ball.radius=-1",
        "cloud.density=thick", "film.crop_width=9999", "camera.near_clip=1e9", "cloud.step_size=0",
        "volume.to_world=0 0 0 0 0 0 0 0 0", "camera.focal_length=wide"}) {
    const std::string errors = setErrors(wrong);
    EXPECT_EQ(errors.find(std::string("--set ") + wrong + ": error: "), 0u) << errors;
  }
  for (const char* wrong : {"", "film", "film.width", "width=3", ".width=3", "film.=3", "=", "."}) {
    EXPECT_NE(setErrors(wrong).find("target.parameter=value"), std::string::npos) << wrong;
  }
}

}  // namespace
}  // namespace aerosol::scene
