#include <fmt/format.h>

#include <charconv>

#include "tests/render/film_checks.h"

// What shaders say and do wrong: in one order whatever the order of work, and never in the way of the render.

namespace aerosol::test {
namespace {

using render::Message;

/// A way of working through a render.
struct Schedule {
  int threads = 1, pathsInFlight = 512, batchSize = 1024;
};

constexpr std::array schedules{Schedule{},
                               Schedule{.threads = 2},
                               Schedule{.pathsInFlight = 1},
                               Schedule{.pathsInFlight = 37, .batchSize = 5},
                               Schedule{.batchSize = 1},
                               Schedule{.threads = 2, .pathsInFlight = 100, .batchSize = 16}};

render::RenderOptions optionsOf(const Schedule& schedule, std::uint32_t samples) {
  return {.threads = schedule.threads,
          .endSample = samples,
          .pathsInFlight = schedule.pathsInFlight,
          .batchSize = schedule.batchSize};
}

/// Texts with where they belong.
std::vector<std::string> textsOf(const std::vector<Message>& messages) {
  std::vector<std::string> texts;
  for (const Message& m : messages) {
    texts.push_back(fmt::format("{} {} {} {}: {}", m.path.y, m.path.x, m.path.sample, m.question, m.text));
  }
  return texts;
}

/// Renders the same scene anew for each schedule, since a scene keeps its messages.
std::vector<std::vector<Message>> messagesOf(const std::string& integrator, const TestSensor& sensor,
                                             const std::string& content, std::uint32_t samples) {
  std::vector<std::vector<Message>> all;
  for (const Schedule& schedule : schedules) {
    const TestScene scene = loadScene(integrator, sensor, content);
    if (!scene.scene()) return {};
    const auto film = scene.film();
    scene.renderInto(*film, optionsOf(schedule, samples));
    EXPECT_EQ(scene.scene()->messages->dropped(), 0u);
    all.push_back(scene.scene()->messages->sorted());
  }
  return all;
}

constexpr const char* sky = R"(<emitter type="constant"/>)";
const TestSensor small{.width = 4, .height = 4};

/// One camera ray after the other, each from front to back, each point's lines in the order of the program.
TEST(Messages, ComeInTheOrderOfPixelSampleAndCall) {
  const auto all = messagesOf(R"(<integer name="max_depth" value="1"/>)", small,
                              std::string(sky) + R"(<volume type="box"><medium type="talkative">
      <string name="distance" value="marching"/><float name="step_size" value="0.1"/><float name="density" value="0.1"/>
      </medium></volume>)",
                              3);
  ASSERT_EQ(all.size(), schedules.size());
  const std::vector<Message>& messages = all[0];
  ASSERT_GT(messages.size(), 100u);
  double previous = 0;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const Message& m = messages[i];
    const bool isSamePath = i > 0 && m.path == messages[i - 1].path;
    if (i > 0) ASSERT_FALSE(m.path < messages[i - 1].path);
    if (m.text == "beyond\n") {
      ASSERT_TRUE(isSamePath);
      ASSERT_GT(previous, 0.5);
      ASSERT_EQ(m.call, 1u);
      continue;
    }
    double z = 0;
    const char* const number = m.text.data() + 3;
    ASSERT_TRUE(m.text.starts_with("at ") &&
                std::from_chars(number, m.text.data() + m.text.size(), z).ec == std::errc());
    if (isSamePath) ASSERT_GT(z, previous) << "not from front to back";
    previous = z;
  }
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_EQ(textsOf(all[i]), textsOf(all[0])) << "schedule " << i;
}

/// Whole paths with several bounces, shadow rays between them (which say nothing), and a surface that speaks.
TEST(Messages, AreTheSameForEverySchedule) {
  for (const char* distance : {"null", "marching"}) {
    const auto all = messagesOf(R"(<integer name="max_depth" value="4"/>)", small,
                                std::string(sky) + fmt::format(R"(
        <emitter type="point"><point name="position" x="0" y="3" z="0"/><rgb name="intensity" value="5"/></emitter>
        <volume type="sphere"><medium type="talkative"><string name="distance" value="{}"/>
        <float name="density" value="2"/><float name="step_size" value="0.3"/></medium></volume>
        <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="10"/>
        <translate x="0" y="-0.5" z="0"/></transform><bsdf type="spoken"/></shape>)",
                                                               distance),
                                3);
    ASSERT_EQ(all.size(), schedules.size());
    EXPECT_GT(all[0].size(), 50u);
    EXPECT_TRUE(
        std::any_of(all[0].begin(), all[0].end(), [](const Message& m) { return m.text.starts_with("surface"); }));
    for (std::size_t i = 1; i < all.size(); ++i) EXPECT_EQ(textsOf(all[i]), textsOf(all[0])) << "schedule " << i;
  }
}

TEST(Messages, HaveTheirPlaceInTheShader) {
  const auto all = messagesOf(R"(<integer name="max_depth" value="1"/>)", small,
                              std::string(sky) + R"(<volume type="box"><medium type="talkative"/></volume>)", 1);
  ASSERT_FALSE(all.empty());
  ASSERT_FALSE(all[0].empty());
  EXPECT_EQ(std::filesystem::path(all[0][0].location.file).filename(), "talkative.osl");
  EXPECT_EQ(all[0][0].location.line, 10);
}

// Results that no medium can have.

class InvalidResults : public ::testing::TestWithParam<const char*> {
 protected:
  std::string content(const char* distance) const {
    return std::string(sky) + fmt::format(R"(<volume type="sphere"><medium type="invalid">
        <string name="distance" value="{}"/><string name="kind" value="{}"/></medium></volume>)",
                                          distance, GetParam());
  }
};

TEST_P(InvalidResults, AreReportedOnceWithTheFirstPlaceAndTheRenderCompletes) {
  for (const char* distance : {"null", "marching"}) {
    std::vector<render::MessageLog::Invalid> reports;
    std::unique_ptr<render::Film> first;
    for (const Schedule& schedule : schedules) {
      const TestScene scene = loadScene(R"(<integer name="max_depth" value="3"/>)", small, content(distance));
      ASSERT_TRUE(scene.scene());
      auto film = scene.film();
      const render::RenderReport report = scene.renderInto(*film, optionsOf(schedule, 4));
      EXPECT_EQ(film->sampleCount(), 4u * 16) << "every sample is there";
      EXPECT_EQ(film->droppedCount(), 0u) << "results are mended before they reach the film";
      const auto invalid = scene.scene()->messages->invalid();
      ASSERT_EQ(invalid.size(), 1u);
      const render::MessageLog::Invalid& entry = invalid.begin()->second;
      EXPECT_EQ(invalid.begin()->first, 0u);
      EXPECT_GT(entry.point.x, 0) << "the shader is right where x is negative";
      EXPECT_GT(entry.count, 10u);
      EXPECT_EQ(entry.count, report.statistics.invalidCoefficients);
      reports.push_back(entry);
      if (!first) {
        first = std::move(film);
      } else {
        EXPECT_TRUE(identical(*first, *film));
      }
      EXPECT_EQ(entry.count, reports[0].count);
      EXPECT_EQ(entry.path, reports[0].path);
      EXPECT_EQ(entry.point, reports[0].point);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, InvalidResults, ::testing::Values("nan", "infinite", "negative", "colour", "anisotropy"),
                         [](const auto& info) { return std::string(info.param); });

/// What no medium can have, from a shader that reads nothing: it is asked once, when the scene is prepared.
TEST(InvalidConstants, AreZeroAndReportedOfEverywhere) {
  const TestScene scene = loadScene("", small, std::string(sky) + R"(<volume type="sphere"><medium type="osl">
      <source>volume below() { Ci = anisotropic_vdf(color(0.5), color(-1), 0); }</source></medium></volume>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(2);
  const auto invalid = scene.scene()->messages->invalid();
  ASSERT_EQ(invalid.size(), 1u);
  EXPECT_TRUE(invalid.begin()->second.isEverywhere);
  EXPECT_LT(minimum(invalid.begin()->second.given.sigmaT), 0);
  ASSERT_TRUE(scene.scene()->media[0].constant);
  EXPECT_TRUE(isBlack(scene.scene()->media[0].constant->sigmaT));
}

class InvalidClosures : public ::testing::TestWithParam<const char*> {};

TEST_P(InvalidClosures, AreLeftOutAndReportedOnceWithTheFirstPlace) {
  std::vector<render::MessageLog::InvalidSurface> reports;
  for (const Schedule& schedule : schedules) {
    const TestScene scene =
        loadScene(R"(<integer name="max_depth" value="3"/>)", small,
                  std::string(sky) + fmt::format(R"(<shape type="sphere"><bsdf type="invalid_closure">
                    <string name="kind" value="{}"/></bsdf></shape>)",
                                                 GetParam()));
    ASSERT_TRUE(scene.scene());
    auto film = scene.film();
    const render::RenderReport report = scene.renderInto(*film, optionsOf(schedule, 4));
    EXPECT_EQ(film->droppedCount(), 0u);
    const auto invalid = scene.scene()->messages->invalidSurfaces();
    ASSERT_EQ(invalid.size(), 1u);
    const render::MessageLog::InvalidSurface& entry = invalid.begin()->second;
    EXPECT_GT(entry.point.x, 0) << "the shader is right where x is negative";
    EXPECT_GT(entry.count, 5u);
    EXPECT_EQ(entry.count, report.statistics.invalidClosures);
    reports.push_back(entry);
    EXPECT_EQ(entry.count, reports[0].count);
    EXPECT_EQ(entry.path, reports[0].path);
    EXPECT_EQ(entry.point, reports[0].point);
  }
}

INSTANTIATE_TEST_SUITE_P(All, InvalidClosures, ::testing::Values("weight", "nan", "normal"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Bounds, AnExceededOneIsCountedAndTheMeanIsRight) {
  const TestScene scene = loadScene("", {.fov = 60}, R"(<emitter type="constant"/><volume type="box">
      <transform name="to_world"><scale x="50" y="50" z="1"/></transform><medium type="ramp">
      <string name="distance" value="null"/><float name="at_zero" value="0.5"/><float name="slope" value="0.3"/>
      <float name="most" value="0.5"/></medium></volume>)");
  const auto film = scene.film();
  const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = 2048});
  EXPECT_TRUE(shows(scene, *film, [](const Ray<World>& ray) {
    return Color(static_cast<float>(std::exp(-1 / static_cast<double>(ray.direction.z))));
  }));
  EXPECT_GT(report.statistics.trackers.boundViolations, 1000u);
  EXPECT_NEAR(report.statistics.trackers.worstViolation, 1.6, 0.01);
  EXPECT_EQ(report.statistics.trackers.worstMedium, 0u);
}

/// A shader that never ends is stopped by its budget; other volumes are unaffected.
TEST(Budgets, AnEndlessLoopIsStoppedAndReported) {
  const TestScene scene = loadScene(
      "", small, std::string(sky) + R"(<volume type="sphere"><medium type="endless"/></volume>)", {.loopBudget = 100});
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(2);
  EXPECT_EQ(film->sampleCount(), 32u);
  const std::vector<Message> messages = scene.scene()->messages->sorted();
  ASSERT_FALSE(messages.empty());
  EXPECT_EQ(messages[0].kind, static_cast<std::uint32_t>(AEROSOL_REPORT_BUDGET));
  EXPECT_EQ(messages[0].location.line, 5);
}

/// An albedo above 1 is what a medium can have and nobody wants: it is rendered as it is, and told of once a shader.
TEST(Messages, TellOfMediaThatScatterMoreThanTheyTake) {
  const auto amplifying = [](const std::string& coefficients) {
    const TestScene scene = loadScene(R"(<integer name="max_depth" value="3"/>)",
                                      small, std::string(sky) + R"(<volume type="box"><medium type="osl">
        <string name="distance" value="marching"/><source><![CDATA[
        volume v() { Ci = )" + coefficients + R"(; }]]></source></medium></volume>)");
    EXPECT_TRUE(scene.scene());
    auto film = scene.film();
    const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = 16});
    const auto found = scene.scene()->messages->amplifying();
    if (!found.empty() && !found.begin()->second.isEverywhere)
      EXPECT_EQ(found.begin()->second.count, report.statistics.amplifyingCoefficients);
    EXPECT_TRUE(scene.scene()->messages->invalid().empty());
    return found;
  };
  EXPECT_TRUE(amplifying("anisotropic_vdf(1, 1, 0)").empty());
  EXPECT_TRUE(amplifying("(1 + 0.5 * P[2]) * (anisotropic_vdf(1, 0.3, 0) + 0.7 * henyey_greenstein(0.5))").empty());
  const auto everywhere = amplifying("anisotropic_vdf(color(0.5, 2, 0.5), 1, 0)");
  ASSERT_EQ(everywhere.size(), 1u);
  EXPECT_TRUE(everywhere.begin()->second.isEverywhere);
  EXPECT_FLOAT_EQ(everywhere.begin()->second.given.sigmaS.g, 2);
  const auto varying = amplifying("(1 + 0.5 * P[2]) * anisotropic_vdf(1 + P[0], 1, 0)");
  ASSERT_EQ(varying.size(), 1u);
  EXPECT_FALSE(varying.begin()->second.isEverywhere);
  EXPECT_GT(varying.begin()->second.point.x, 0);
}

}  // namespace
}  // namespace aerosol::test
