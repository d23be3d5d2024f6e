#include <fmt/format.h>

#include "core/render/prepared_scene.h"
#include "tests/render/film_checks.h"

// Voxels that are solved in closed form show what null scattering shows, alone, where they overlap other media, moved,
// with a lamp beside the rays; and only what is voxels times constants is solved so.

namespace aerosol::test {
namespace {

using volume::DistanceMethod;

const std::string file = AEROSOL_SOURCE_DIR "/scenes/cloud.vdb";

std::string cloud(const std::string& parameters = "", const std::string& type = "grid") {
  return fmt::format(R"(<volume type="grid"><string name="filename" value="{0}"/><medium type="{1}">
      <string name="filename" value="{0}"/><float name="density" value="3"/>{2}</medium></volume>)",
                     file, type, parameters);
}
constexpr const char* sky = R"(<emitter type="constant"/>)";
constexpr const char* lamp = R"(<emitter type="point"><point name="position" x="0.2" y="0.9" z="-0.3"/>
    <rgb name="intensity" value="1, 2, 3"/></emitter>)";

std::string distance(const char* method) { return fmt::format(R"(<string name="distance" value="{}"/>)", method); }

TestSensor seen(int seed) { return {.fov = 22, .width = 12, .height = 12, .seed = seed}; }

DistanceMethod methodOf(const TestScene& scene) { return scene.scene()->media.front().method; }

/// The closed form and null scattering, with independent samples.
::testing::AssertionResult bothShowTheSame(const std::string& content, std::uint32_t samples, double resolution,
                                           int maxDepth = 3) {
  const std::string depth = fmt::format(R"(<integer name="max_depth" value="{}"/>)", maxDepth);
  const TestScene closed = loadScene(depth, seen(1), content);
  const TestScene tracked = loadScene(depth + distance("null"), seen(2), content);
  if (!closed.scene() || !tracked.scene()) return ::testing::AssertionFailure() << "there is no scene";
  if (methodOf(closed) != DistanceMethod::analytic) return ::testing::AssertionFailure() << "not solved in closed form";
  if (methodOf(tracked) != DistanceMethod::nullScattering) return ::testing::AssertionFailure() << "not tracked";
  return showTheSame(*closed.render(samples), *tracked.render(samples), resolution);
}

TEST(VoxelClosedForm, ShowsWhatNullScatteringShows) { EXPECT_TRUE(bothShowTheSame(cloud() + sky, 256, 0.01)); }

TEST(VoxelClosedForm, WithALampBesideTheRays) {
  EXPECT_TRUE(bothShowTheSame(cloud(R"(<rgb name="albedo" value="0.9, 0.5, 0.2"/>)") + lamp, 1024, 0.02, 2));
}

TEST(VoxelClosedForm, BesideOtherMedia) {
  const std::string fog = R"(<volume type="sphere"><transform name="to_world"><scale value="0.5"/></transform>
      <medium type="homogeneous"><rgb name="sigma_t" value="1"/></medium></volume>)";
  EXPECT_TRUE(bothShowTheSame(cloud() + fog + sky, 256, 0.01));
}

TEST(VoxelClosedForm, NearestVoxels) {
  EXPECT_TRUE(bothShowTheSame(cloud(R"(<string name="interp" value="closest"/>)") + sky, 256, 0.01));
}

TEST(VoxelClosedForm, AFaultOfTwoPercentIsFound) {
  const std::string depth = R"(<integer name="max_depth" value="1"/>)";
  const TestScene right = loadScene(depth, seen(1), cloud() + sky);
  const std::string denser = cloud(R"(<float name="scale" value="0.9"/>)");
  const TestScene wrong = loadScene(depth, seen(2), denser + sky);
  EXPECT_FALSE(showTheSame(*right.render(256), *wrong.render(256), 0.01));
}

TEST(VoxelClosedForm, OnlyWhatHasOne) {
  const auto method = [](const std::string& parameters, const std::string& type) {
    return methodOf(loadScene("", seen(0), cloud(parameters, type) + sky));
  };
  EXPECT_EQ(method("", "grid"), DistanceMethod::analytic);
  EXPECT_EQ(method("", "baked"), DistanceMethod::analytic);
  EXPECT_EQ(method(distance("analytic"), "grid"), DistanceMethod::analytic);
  EXPECT_EQ(method(distance("null"), "grid"), DistanceMethod::nullScattering);
  // Splines have none; a value that is clamped is no multiple any more.
  EXPECT_NE(method(R"(<string name="interp" value="cubic"/>)", "grid"), DistanceMethod::analytic);
  EXPECT_NE(method(R"(<float name="scale" value="5"/>)", "grid"), DistanceMethod::analytic);
}

}  // namespace
}  // namespace aerosol::test
