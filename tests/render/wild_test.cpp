// Scene files as exporters and people write them: each says in a comment what its picture is in the mean.

#include <fstream>
#include <sstream>

#include "tests/render/film_checks.h"

namespace aerosol::test {
namespace {

namespace fs = std::filesystem;

fs::path folder() { return AEROSOL_SOURCE_DIR "/tests/render/wild"; }

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder())) {
    if (entry.path().extension() == ".xml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

struct Expectation {
  Color mean;
  float tolerance = 0;  ///< Relative, and at least as much in absolute terms of a thousandth.
};

/// From `mean: R G B within N%`.
Expectation expectationOf(const std::string& text) {
  Expectation expected;
  const std::size_t at = text.find("mean: ");
  if (at == std::string::npos) return expected;
  std::istringstream stream(text.substr(at + 6));
  std::string within;
  stream >> expected.mean.r >> expected.mean.g >> expected.mean.b >> within >> expected.tolerance;
  expected.tolerance /= 100;
  return expected;
}

class Wild : public ::testing::TestWithParam<std::string> {};

TEST_P(Wild, HasTheMeanThatItSays) {
  std::ifstream stream(folder() / (GetParam() + ".xml"));
  std::stringstream text;
  text << stream.rdbuf();
  const Expectation expected = expectationOf(text.str());
  ASSERT_GT(expected.tolerance, 0) << "it does not say its mean";
  const TestScene scene(text.str(), {.shaderFolder = folder(), .mayWarn = true});
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(static_cast<std::uint32_t>(scene.description().sampler.sampleCount));
  const render::PixelRect area = film->area();
  ASSERT_LE(area.pixelCount(), 64u) << "small pictures are enough";
  Color mean, variance;
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const render::PixelEstimate pixel = film->estimate(x, y);
      mean += pixel.color / static_cast<float>(area.pixelCount());
      variance += pixel.standardError * pixel.standardError;
    }
  }
  for (int c = 0; c < 3; ++c) {
    const float error = std::sqrt(variance[c]) / static_cast<float>(area.pixelCount());
    EXPECT_LE(error, std::max(0.005f * expected.mean[c], 1e-6f)) << "resolves nothing";
    EXPECT_NEAR(mean[c], expected.mean[c], expected.tolerance * std::max(expected.mean[c], 1e-3f) + 4 * error)
        << "channel " << c;
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Wild, ::testing::ValuesIn(sceneNames()), [](const auto& file) { return file.param; });

TEST(WildScenes, AreThirtyAtLeast) { EXPECT_GE(sceneNames().size(), 30u); }

}  // namespace
}  // namespace aerosol::test
