#include "core/app/shader_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/app/shader_page.h"

namespace aerosol::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

render::Message message(std::uint32_t kind, int line, std::string text, int x = 1) {
  return {.path = {x, 2, 3}, .kind = kind, .location = {"a.osl", line, 5}, .text = std::move(text)};
}

TEST(ShaderReport, JoinsWhatIsPrinted) {
  const ShaderReport report =
      reportMessages({message(AEROSOL_MESSAGE_PRINT, 1, "one\n"), message(AEROSOL_MESSAGE_PRINT, 1, "two "),
                      message(AEROSOL_MESSAGE_PRINT, 2, "three\n"), message(AEROSOL_MESSAGE_PRINT, 1, "one\n")},
                     0);
  EXPECT_EQ(report.printed, "one\ntwo three\none\n");
  EXPECT_TRUE(report.messages.empty());
}

TEST(ShaderReport, LocatesWarningsAndErrorsInTheirOrder) {
  const ShaderReport report =
      reportMessages({message(AEROSOL_MESSAGE_ERROR, 7, "bad\n"), message(AEROSOL_MESSAGE_WARNING, 4, "odd"),
                      message(AEROSOL_REPORT_BUDGET, 9, "endless")},
                     0);
  ASSERT_EQ(report.messages.entries().size(), 3u);
  EXPECT_EQ(format(report.messages.entries()[0]), "a.osl:7:5: error: bad\n  note: at pixel (1, 2), sample 3\n");
  EXPECT_EQ(format(report.messages.entries()[1]), "a.osl:4:5: warning: odd\n  note: at pixel (1, 2), sample 3\n");
  EXPECT_EQ(report.messages.entries()[2].severity, Severity::warning);
}

TEST(ShaderReport, SaysOnceWhatWasSaidOften) {
  const ShaderReport report =
      reportMessages({message(AEROSOL_MESSAGE_WARNING, 4, "odd", 8), message(AEROSOL_MESSAGE_WARNING, 4, "even", 8),
                      message(AEROSOL_MESSAGE_WARNING, 4, "odd", 9), message(AEROSOL_MESSAGE_WARNING, 5, "odd", 9)},
                     12345);
  ASSERT_EQ(report.messages.entries().size(), 4u);
  EXPECT_THAT(report.messages.entries()[0].notes, ElementsAre("said 2 times, first at pixel (8, 2), sample 3"));
  EXPECT_THAT(report.messages.entries()[1].notes, ElementsAre("at pixel (8, 2), sample 3"));
  EXPECT_THAT(report.messages.entries()[2].notes, ElementsAre("at pixel (9, 2), sample 3"));
  EXPECT_THAT(report.messages.entries()[3].message, HasSubstr("12,345 further shader messages not kept"));
}

/// A scene with one medium, called 'fog'.
render::PreparedScene makeScene(float bound) {
  render::PreparedScene scene;
  volume::Medium& medium = scene.media.emplace_back();
  medium.method = volume::DistanceMethod::nullScattering;
  medium.bound = volume::ExtinctionBound{bound, volume::Provenance::declared};
  scene.mediumLocations.push_back({"scene.xml", 10, 3});
  scene.mediumNames.emplace_back("fog");
  return scene;
}

TEST(ShaderReport, ProposesTheCorrectedBound) {
  volume::TrackerStatistics trackers;
  EXPECT_TRUE(reportTrackers(makeScene(2), trackers).empty());
  trackers.boundViolations = 1200;
  trackers.worstViolation = 1.23456f;
  trackers.worstExtinction = 2.46912f;
  const Diagnostics warnings = reportTrackers(makeScene(2), trackers);
  ASSERT_EQ(warnings.entries().size(), 1u);
  const Diagnostic& warning = warnings.entries()[0];
  EXPECT_EQ(warning.severity, Severity::warning);
  EXPECT_EQ(warning.location, (SourceLocation{"scene.xml", 10, 3}));
  EXPECT_THAT(warning.message, HasSubstr("above its bound of 2 at 1,200 points"));
  EXPECT_THAT(warning.notes, ElementsAre(HasSubstr("density_bound\" value=\"2.47\"")));  // 2.46912 rounded up
}

TEST(ShaderReport, TellsOfSegmentsGivenUp) {
  volume::TrackerStatistics trackers;
  trackers.stepLimits = 3;
  EXPECT_EQ(reportTrackers(makeScene(2), trackers).entries().size(), 1u);
}

TEST(ShaderReport, SaysWhenABoundIsSoLowThatTheImageIsWrong) {
  volume::TrackerStatistics trackers;
  trackers.boundViolations = 3;
  trackers.worstExtinction = 4;
  trackers.worstViolation = 1.5f;
  const auto said = [&] { return reportTrackers(makeScene(2), trackers).entries().at(0).message; };
  EXPECT_THAT(said(), HasSubstr("the image is right but noisier"));
  trackers.worstViolation = 40;
  EXPECT_THAT(said(), HasSubstr("no usual number of samples comes near the right image"));
}

TEST(ShaderReport, PlacesAlbedosAboveOne) {
  const render::PreparedScene scene = makeScene(1);
  EXPECT_TRUE(reportAmplifyingMedia(scene).empty());
  volume::TrackerStatistics trackers;
  trackers.stepLimits = 3;
  EXPECT_THAT(reportTrackers(scene, trackers).entries().at(0).notes, ElementsAre(HasSubstr("bound is far above")));
  volume::Coefficients given;
  given.sigmaT = Color(1);
  given.sigmaS = Color(1, 2, 1);
  scene.messages->reportAmplifying(scene.media[0], {1, 2, 3}, given, {9, 8, 7});
  scene.messages->reportAmplifying(scene.media[0], {4, 5, 6}, given, {2, 1, 7});
  const Diagnostics warnings = reportAmplifyingMedia(scene);
  ASSERT_EQ(warnings.entries().size(), 1u);
  EXPECT_THAT(warnings.entries()[0].message, HasSubstr("'fog' scatters more light than it takes"));
  EXPECT_THAT(warnings.entries()[0].notes,
              ElementsAre("first at pixel (2, 1), sample 7, world point (4, 5, 6): scattering (1, 2, 1), extinction "
                          "(1, 1, 1); 2 results in all",
                          HasSubstr("keep every channel of the albedo at 1 or below")));
  EXPECT_THAT(reportTrackers(scene, trackers).entries().at(0).notes, ElementsAre(HasSubstr("do not die out")));
}

TEST(ShaderReport, PlacesInvalidResults) {
  const render::PreparedScene scene = makeScene(1);
  EXPECT_TRUE(reportInvalidCoefficients(scene).empty());
  volume::Coefficients given;
  given.sigmaT = Color(1);
  given.sigmaS = Color(1, -2, 1);
  scene.messages->reportInvalid(scene.media[0], {1, 2, 3}, given, {9, 8, 7});
  scene.messages->reportInvalid(scene.media[0], {4, 5, 6}, given, {2, 1, 7});
  const Diagnostics warnings = reportInvalidCoefficients(scene);
  ASSERT_EQ(warnings.entries().size(), 1u);
  EXPECT_THAT(warnings.entries()[0].message, HasSubstr("'fog' gave 2 results"));
  EXPECT_THAT(warnings.entries()[0].notes,
              ElementsAre("first at pixel (2, 1), sample 7, world point (4, 5, 6): scattering (1, -2, 1)"));
}

TEST(ShaderReport, ListsDroppedSamples) {
  const render::PixelRect area{0, 0, 1, 1};
  render::Film film(area);
  EXPECT_TRUE(reportDroppedSamples(film).empty());
  render::FilmTile tile(area, 0, 2);
  tile.add(0, 0, 0, Color(1), 1);
  tile.add(0, 0, 1, Color(std::numeric_limits<float>::infinity(), 0, 0), 1);
  film.commit(tile);
  const Diagnostics warnings = reportDroppedSamples(film);
  ASSERT_EQ(warnings.entries().size(), 1u);
  EXPECT_THAT(warnings.entries()[0].message, HasSubstr("1 sample not finite"));
  EXPECT_THAT(warnings.entries()[0].notes, ElementsAre("pixel (0, 0), sample 1: (inf, 0, 0)"));
}

TEST(ShaderPage, DescribesParametersByTheirMetadata) {
  lang::Program program;
  program.kind = "volume";
  program.name = "fog";
  program.metadata.push_back({"help", {}, std::vector<std::string>{"A fog"}});
  lang::Parameter density;
  density.name = "density";
  density.type.base = lang::BaseType::floating;
  density.defaultValue = std::vector<float>{2.5f};
  density.metadata = {{"label", {}, std::vector<std::string>{"Density"}},
                      {"help", {}, std::vector<std::string>{"how thick it is"}},
                      {"min", {}, std::vector<float>{0}},
                      {"max", {}, std::vector<float>{10}}};
  lang::Parameter seed;
  seed.name = "seed";
  seed.type.base = lang::BaseType::integer;
  seed.defaultValue = std::vector<std::int32_t>{1};
  lang::Parameter result;
  result.name = "result";
  result.isOutput = true;
  program.parameters = {density, seed, result};
  EXPECT_EQ(shaderPage(program),
            "volume fog  A fog\n"
            "  density  Density: how thick it is (float, 0 to 10; default: 2.5)\n"
            "  seed     (int; default: 1)\n");
}

}  // namespace
}  // namespace aerosol::app
