#include <fmt/format.h>

#include "tests/render/film_checks.h"

// What bounds of shaders must find out by value: that a medium is constant, that space is empty.

namespace aerosol::test {
namespace {

constexpr const char* lit = R"(<emitter type="constant"><rgb name="radiance" value="0.5, 0.6, 0.8"/></emitter>
    <emitter type="directional"><vector name="direction" x="1" y="-2" z="1"/><rgb name="irradiance" value="3"/></emitter>)";
const TestSensor sensor{.fov = 30, .width = 12, .height = 10};
constexpr const char* shortPaths = R"(<integer name="max_depth" value="6"/>)";

TestScene sceneOf(const std::string& medium, const char* volume = "sphere") {
  return loadScene(shortPaths, sensor, fmt::format(R"({}<volume type="{}">{}</volume>)", lit, volume, medium));
}

/// A noise of weight 0 or 1e-12 makes no difference: the same image, bit by bit, as of the constant, and the same work.
TEST(NearlyConstant, IsTreatedAsConstant) {
  const TestScene constant = sceneOf(R"(<medium type="homogeneous"><rgb name="sigma_t" value="1"/>
      <rgb name="albedo" value="0.8"/><float name="g" value="0.3"/></medium>)");
  const auto expected = constant.film();
  const render::RenderReport expectedWork = constant.renderInto(*expected, {.threads = 1, .endSample = 16});
  for (const char* weight : {"0", "1e-12"}) {
    const TestScene scene =
        sceneOf(fmt::format(R"(<medium type="nearly_constant"><float name="weight" value="{}"/></medium>)", weight));
    const auto film = scene.film();
    const render::RenderReport work = scene.renderInto(*film, {.threads = 1, .endSample = 16});
    EXPECT_TRUE(identical(*expected, *film)) << weight;
    EXPECT_EQ(work.statistics.kernelPoints, expectedWork.statistics.kernelPoints) << weight;
    EXPECT_EQ(work.statistics.trackers.points, 0u) << weight;
    EXPECT_EQ(work.statistics.pathVertices, expectedWork.statistics.pathVertices) << weight;
  }
}

TEST(NearlyConstant, AVisibleNoiseIsNotConstant) {
  const TestScene scene = sceneOf(R"(<medium type="nearly_constant"><float name="weight" value="1e-3"/></medium>)");
  const auto film = scene.film();
  EXPECT_GT(scene.renderInto(*film, {.threads = 1, .endSample = 4}).statistics.trackers.points, 0u);
}

/// Every volume of the library: bounds leave the mean where one bound for all of it has it, and save points.
TEST(TreesOfBounds, LeaveTheMeanAndSavePoints) {
  for (const char* shader : {"cumulus", "wisps", "pyroclastic"}) {
    const std::string content = fmt::format(R"({}<volume type="box"><medium type="{}"/></volume>)", lit, shader);
    const std::string one = std::string(shortPaths) + R"(<integer name="bound_boxes" value="0"/>)";
    const TestScene coarse = loadScene(one, sensor, content), fine = loadScene(shortPaths, sensor, content);
    const auto a = coarse.film(), b = fine.film();
    const auto work = coarse.renderInto(*a, {.endSample = 256}).statistics;
    const auto lessWork = fine.renderInto(*b, {.endSample = 256}).statistics;
    EXPECT_EQ(work.trackers.boundViolations + lessWork.trackers.boundViolations, 0u) << shader;
    EXPECT_LT(static_cast<double>(lessWork.trackers.points), 0.75 * static_cast<double>(work.trackers.points))
        << shader;
    double difference = 0, variance = 0;
    for (int y = 0; y < 10; ++y) {
      for (int x = 0; x < 12; ++x) {
        const render::PixelEstimate p = a->estimate(x, y), q = b->estimate(x, y);
        difference += static_cast<double>(p.color.g) - static_cast<double>(q.color.g);
        variance +=
            std::pow(static_cast<double>(p.standardError.g), 2) + std::pow(static_cast<double>(q.standardError.g), 2);
      }
    }
    EXPECT_LT(std::fabs(difference), 4 * std::sqrt(variance)) << shader;
  }
}

}  // namespace
}  // namespace aerosol::test
