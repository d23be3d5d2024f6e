#include "core/app/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aerosol::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

template <class T>
T parsed(const std::vector<std::string>& arguments, std::string_view shaderPath = {}) {
  const auto result = parseCommandLine(arguments, shaderPath);
  if (const Reply* reply = std::get_if<Reply>(&result)) {
    ADD_FAILURE() << reply->text;
    return {};
  }
  return std::get<T>(std::get<Arguments>(result));
}

RenderArguments render(std::vector<std::string> options) {
  options.insert(options.begin(), {"render", "cloud.xml"});
  return parsed<RenderArguments>(options);
}

/// The message with which a command line is refused.
std::string refusal(const std::vector<std::string>& arguments) {
  const auto result = parseCommandLine(arguments);
  const Reply* const reply = std::get_if<Reply>(&result);
  if (!reply) return "accepted";
  EXPECT_EQ(reply->code, ExitCode::usage);
  return reply->text;
}

TEST(CommandLine, LeavesToTheSceneWhatIsNotGiven) {
  const RenderArguments arguments = render({});
  EXPECT_EQ(arguments.scene, "cloud.xml");
  EXPECT_TRUE(arguments.outputs.empty());
  EXPECT_TRUE(arguments.defines.empty());
  EXPECT_TRUE(arguments.overrides.empty());
  EXPECT_FALSE(arguments.samplesPerPixel);
  EXPECT_FALSE(arguments.seed);
  EXPECT_FALSE(arguments.crop);
  EXPECT_FALSE(arguments.distance);
  EXPECT_FALSE(arguments.stepScale);
  EXPECT_FALSE(arguments.transmittance);
  EXPECT_FALSE(arguments.noEquiangular);
  EXPECT_EQ(arguments.threads, 0);
  EXPECT_FALSE(arguments.quiet);
  EXPECT_FALSE(arguments.statistics);
  EXPECT_FALSE(arguments.countLanes);
  EXPECT_FALSE(arguments.kernels.width);
  EXPECT_EQ(arguments.kernels.isa, "");
  EXPECT_TRUE(arguments.kernels.useCache);
}

TEST(CommandLine, ReadsListsOfAovs) {
  const RenderArguments arguments =
      render({"--aov", "direct, albedo", "--aov", "first=C<RD>[LO],far=C.{2,3}L,key=C.*<L.'a b'>"});
  std::vector<std::pair<std::string, std::string>> found;
  for (const scene::AovRequest& request : arguments.aovs) found.emplace_back(request.name, request.quantity);
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"direct", "direct"}, {"albedo", "albedo"}, {"first", "C<RD>[LO]"}, {"far", "C.{2,3}L"}, {"key", "C.*<L.'a b'>"}};
  EXPECT_EQ(found, expected);
  EXPECT_THAT(refusal({"render", "a.xml", "--aov", "a="}), HasSubstr("'a=' is not NAME or NAME=EXPRESSION"));
}

TEST(CommandLine, ReadsPartsGoalsAndStatistics) {
  const RenderArguments arguments =
      render({"--samples", "7:100",          "--frames",  "1-3",     "--keep-sums", "--checkpoint", "2m",
              "--resume",  "--target-error", "1%",        "--time",  "90s",         "--aov",        "error",
              "--aov",     "cost",           "--without", "volumes", "--stats",     "a.json",       "--explain-cost"});
  EXPECT_EQ(arguments.samples, (SampleRange{7, 100}));
  EXPECT_THAT(arguments.frames, ElementsAre(1, 2, 3));
  EXPECT_TRUE(arguments.keepSums && arguments.resume && arguments.explainCost);
  EXPECT_EQ(arguments.checkpointSeconds, 120);
  EXPECT_NEAR(arguments.targetError, 0.01, 1e-9);
  EXPECT_EQ(arguments.timeLimit, 90);
  ASSERT_EQ(arguments.aovs.size(), 2u);
  EXPECT_EQ(arguments.aovs[1].name, "cost");
  EXPECT_THAT(arguments.without, ElementsAre("volumes"));
  EXPECT_EQ(arguments.statisticsFile, "a.json");
  EXPECT_FALSE(arguments.statistics);
  EXPECT_TRUE(render({"--stats"}).statistics);
  EXPECT_EQ(render({"--stats=b.json"}).statisticsFile, "b.json");
  EXPECT_NEAR(render({"--target-error", "0.02"}).targetError, 0.02, 1e-9);
  for (const char* samples : {"", "7", "7:7", "-1:3", "a:b", "1:2:3"}) {
    EXPECT_THAT(refusal({"render", "a.xml", "--samples", samples}), HasSubstr("--samples")) << samples;
  }
  EXPECT_THAT(refusal({"render", "a.xml", "--target-error", "0"}), HasSubstr("is not an error such as 1%"));
  EXPECT_THAT(refusal({"render", "a.xml", "--time", "soon"}), HasSubstr("is not a time such as"));
}

TEST(CommandLine, ReadsMergeAndStudy) {
  const auto merge = parsed<MergeArguments>({"merge", "a.exr", "b.exr", "-o", "c.exr", "--mixed"});
  EXPECT_THAT(merge.parts, ElementsAre("a.exr", "b.exr"));
  EXPECT_THAT(merge.outputs, ElementsAre("c.exr"));
  EXPECT_TRUE(merge.mixed);
  const auto study =
      parsed<StudyArguments>({"study", "a.xml", "-o", "out", "--vary", "cumulus.octaves=3,5", "--budget", "10m"});
  ASSERT_EQ(study.axes.size(), 1u);
  EXPECT_EQ(study.axes[0].parameter, "cumulus.octaves");
  EXPECT_THAT(study.axes[0].values, ElementsAre("3", "5"));
  EXPECT_EQ(study.budget, 600);
  EXPECT_THAT(refusal({"study", "a.xml", "-o", "b", "--vary", "a=1,,2"}), HasSubstr("is not PARAMETER=VALUE"));
  EXPECT_EQ(parsed<PlanArguments>({"plan", "a.xml"}).render.scene, "a.xml");
  EXPECT_EQ(parsed<DoctorArguments>({"doctor", "a.xml"}).render.scene, "a.xml");
}

TEST(CommandLine, ReadsEveryRenderOption) {
  const RenderArguments arguments =
      render({"--spp", "64", "--seed=7", "--crop", "1,2,30,40", "--distance", "null", "--step-scale", "0.5",
              "--threads", "3", "--width", "4", "--isa", "avx2", "--no-cache", "-q", "--stats", "--count-lanes"});
  EXPECT_EQ(arguments.samplesPerPixel, 64);
  EXPECT_EQ(arguments.seed, 7);
  EXPECT_EQ(arguments.crop, (Crop{1, 2, 30, 40}));
  EXPECT_EQ(arguments.distance, scene::DistanceSampling::nullScattering);
  const RenderArguments other = render({"--distance", "relaxed", "--transmittance", "two_combs", "--no-equiangular",
                                        "--joint-lights", "--plan", "a.exr"});
  EXPECT_EQ(other.distance, scene::DistanceSampling::relaxed);
  EXPECT_EQ(other.transmittance, scene::TransmittanceSampling::twoCombs);
  EXPECT_TRUE(other.noEquiangular);
  EXPECT_TRUE(other.jointLights);
  EXPECT_EQ(other.plan, "a.exr");
  EXPECT_EQ(arguments.stepScale, 0.5f);
  EXPECT_EQ(arguments.threads, 3);
  EXPECT_EQ(arguments.kernels.width, 4);
  EXPECT_EQ(arguments.kernels.isa, "avx2");
  EXPECT_FALSE(arguments.kernels.useCache);
  EXPECT_TRUE(arguments.quiet);
  EXPECT_TRUE(arguments.statistics);
  EXPECT_TRUE(arguments.countLanes);
}

TEST(CommandLine, RepeatedOptionsTakeOneValueEach) {
  const auto arguments = parsed<RenderArguments>({"render", "-o", "a.exr", "-o", "b.png", "--set", "cloud.density=2",
                                                  "--set", "film.width=8", "-D", "sun=1=2", "-Dsky=", "cloud.xml"});
  EXPECT_EQ(arguments.scene, "cloud.xml");
  EXPECT_THAT(arguments.outputs, ElementsAre("a.exr", "b.png"));
  EXPECT_THAT(arguments.overrides, ElementsAre("cloud.density=2", "film.width=8"));
  EXPECT_THAT(arguments.defines, ElementsAre(Pair("sky", ""), Pair("sun", "1=2")));
}

TEST(CommandLine, SearchesFoldersOfOptionsBeforeThoseOfTheEnvironment) {
  const auto arguments =
      parsed<RenderArguments>({"render", "a.xml", "--shader-path", "x", "--shader-path", "y"}, ":/one::/two:");
  EXPECT_THAT(arguments.kernels.shaderPath, ElementsAre("x", "y", "/one", "/two"));
  EXPECT_THAT(parsed<ToolArguments>({"compile", "a.osl"}, "/one").shaderPath, ElementsAre("/one"));
}

TEST(CommandLine, KnowsHelpAndVersion) {
  EXPECT_EQ(parsed<HelpArguments>({"help"}).topic, "");
  EXPECT_EQ(parsed<HelpArguments>({"help", "medium"}).topic, "medium");
  parsed<VersionArguments>({"--version"});
  for (const std::string& command : commandNames()) {
    const auto result = parseCommandLine({command, "--help"});
    ASSERT_TRUE(std::holds_alternative<Reply>(result)) << command;
    EXPECT_EQ(std::get<Reply>(result).code, ExitCode::success);
    EXPECT_EQ(std::get<Reply>(result).text, commandHelp(command));
  }
}

TEST(CommandLine, HelpNamesEveryOptionOnce) {
  const std::string help = commandHelp("render");
  for (const char* option :
       {"--output",       "--define",   "--set",         "--spp",        "--threads",       "--crop",
        "--seed",         "--quiet",    "--shader-path", "--width",      "--isa",           "--stats",
        "--count-lanes",  "--no-cache", "--distance",    "--step-scale", "--transmittance", "--no-equiangular",
        "--joint-lights", "--plan"}) {
    EXPECT_THAT(help, HasSubstr(option));
  }
  EXPECT_THAT(commandHelp(""), HasSubstr("Exit codes"));
  EXPECT_THAT(commandHelp("compile"), testing::Not(HasSubstr("Exit codes")));
}

TEST(CommandLine, ReadsEveryBakeOption) {
  const auto parsed =
      parseCommandLine({"bake",       "puff.osl", "--bounds",  "-1,-2,-3,1,2,3", "--voxel",    "0.25",   "-o",
                        "a.avt",      "--set",    "density=3", "--set",          "tint=1,2,3", "--time", "0.5,2,4",
                        "--temporal", "--error",  "0.125",     "--half",         "--threads",  "3",      "-q"},
                       "");
  ASSERT_TRUE(std::holds_alternative<Arguments>(parsed));
  const auto& bake = std::get<BakeArguments>(std::get<Arguments>(parsed));
  EXPECT_EQ(bake.shader, "puff.osl");
  EXPECT_EQ(bake.bounds, (std::array<float, 6>{-1, -2, -3, 1, 2, 3}));
  EXPECT_EQ(bake.voxelSize, 0.25);
  EXPECT_EQ(bake.values.size(), 2u);
  EXPECT_EQ(bake.time.times(), (std::vector<float>{0.5f, 1, 1.5f, 2}));
  EXPECT_TRUE(bake.temporal && bake.asHalf && bake.quiet);
  EXPECT_EQ(bake.error, 0.125f);
  EXPECT_EQ(bake.threads, 3);
}

TEST(CommandLine, RefusesWithAHint) {
  EXPECT_EQ(refusal({"render", "a.xml", "--sp", "4"}),
            "aerosol: error: unknown option '--sp'\n  note: did you mean '--spp', '--isa' or '--set'?\n");
  EXPECT_EQ(refusal({"rendr", "a.xml"}), "aerosol: error: unknown command 'rendr'\n  note: did you mean 'render'?\n");
  EXPECT_EQ(
      refusal({"paint"}),
      "aerosol: error: unknown command 'paint'\n  note: commands are render, bake, merge, denoise, study, plan, check, "
      "doctor, submit, "
      "compile, info, shade, help\n");
  EXPECT_EQ(refusal({"render", "a.xml", "b.xml"}),
            "aerosol: error: unexpected argument 'b.xml'\n  note: see: aerosol help render\n");
  EXPECT_THAT(refusal({"render"}), HasSubstr("scene is required"));
  EXPECT_THAT(refusal({}), HasSubstr("Usage: aerosol"));
}

TEST(CommandLine, RefusesWrongValues) {
  const auto refused = [](std::vector<std::string> options) {
    options.insert(options.begin(), {"render", "a.xml"});
    return refusal(options);
  };
  EXPECT_THAT(refused({"--spp", "0"}), HasSubstr("--spp: must be at least 1, not 0"));
  EXPECT_THAT(refused({"--spp", "4x"}), HasSubstr("--spp: '4x' is not an integer"));
  EXPECT_THAT(refused({"--spp", "0x10"}), HasSubstr("--spp: '0x10' is not an integer"));
  EXPECT_THAT(refused({"--spp", "99999999999"}), HasSubstr("--spp: "));
  EXPECT_THAT(refused({"--spp"}), HasSubstr("--spp needs a value"));
  EXPECT_THAT(refused({"--spp", "1", "--spp", "2"}), HasSubstr("--spp is given more than once"));
  EXPECT_THAT(refused({"--seed", "-1"}), HasSubstr("--seed: must be at least 0, not -1"));
  EXPECT_THAT(refused({"--threads", "0"}), HasSubstr("--threads: must be at least 1"));
  EXPECT_THAT(refused({"--width", "9"}), HasSubstr("--width: '9' is not one of 16, 8, 4, 1"));
  EXPECT_THAT(refused({"--isa", "sse"}), HasSubstr("--isa: 'sse' is not one of avx2, avx512"));
  EXPECT_THAT(refused({"--distance", "both"}), HasSubstr("--distance: 'both' is not one of auto, marching, null"));
  EXPECT_THAT(refused({"--transmittance", "exact"}),
              HasSubstr("--transmittance: 'exact' is not one of auto, marching, ratio, two_combs, unbiased"));
  EXPECT_THAT(refused({"--step-scale", "0"}), HasSubstr("--step-scale: must be greater than 0"));
  EXPECT_THAT(refused({"--step-scale", "nan"}), HasSubstr("--step-scale: 'nan' is not a number"));
  EXPECT_THAT(refused({"-D", "x"}), HasSubstr("-D: 'x' is not NAME=VALUE"));
  EXPECT_THAT(refused({"-D", "=x"}), HasSubstr("-D: '=x' is not NAME=VALUE"));
  EXPECT_THAT(refused({"-D", "x=1", "-D", "x=2"}), HasSubstr("-D: 'x' is given twice"));
}

TEST(CommandLine, ReadsCropsStrictly) {
  EXPECT_EQ(parseCrop("0,0,1,1"), (Crop{0, 0, 1, 1}));
  EXPECT_EQ(parseCrop("10,20,300,400"), (Crop{10, 20, 300, 400}));
  for (const char* wrong : {"", "1,2,3", "1,2,3,4,5", "1,2,3,4,", ",1,2,3", "-1,0,4,4", "0,0,0,4", "0,0,4,0", "a,b,c,d",
                            "0,0,1.5,2", "0 0 1 1"}) {
    EXPECT_FALSE(parseCrop(wrong)) << wrong;
    EXPECT_THAT(refusal({"render", "a.xml", "--crop", wrong}), HasSubstr("--crop")) << wrong;
  }
}

}  // namespace
}  // namespace aerosol::app
