#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <regex>
#include <sstream>

#include "core/image/deep_image.h"
#include "core/image/image.h"
#include "tests/support/program.h"

// What accuracy costs: goals, studies, plans, examinations and jobs of the program as a process.

namespace aerosol::test {
namespace {

using namespace std::chrono_literals;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

std::string sceneOf(int fov, int width, int height, const std::string& content) {
  return fmt::format(R"(<scene version="3.0.0">
  <sensor type="perspective">
    <float name="fov" value="{}"/>
    <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="{}"/><integer name="height" value="{}"/></film>
    <sampler type="sobol"><integer name="sample_count" value="16"/></sampler>
  </sensor>
  {}
</scene>)",
                     fov, width, height, content);
}

class Accuracy : public testing::Test {
 protected:
  Accuracy() {
    folder_.write("wisps.xml", sceneOf(30, 32, 24, R"(<emitter type="constant"/>
  <volume type="sphere"><medium type="wisps"/></volume>)"));
  }

  Outcome run(const std::vector<std::string>& words, int expected = 0) const {
    Outcome outcome = folder_.run(words);
    EXPECT_EQ(outcome.code, expected) << outcome.err;
    return outcome;
  }
  image::ImageBuffer picture(const std::string& name) const { return folder_.picture(name); }
  int samplesOf(const std::string& name) const {
    for (const image::Metadata& entry : picture(name).metadata) {
      if (entry.key == "aerosol:endSample") return std::get<std::int32_t>(entry.value);
    }
    return -1;
  }

  ProgramFolder folder_;
};

TEST_F(Accuracy, ATargetErrorIsReachedAndItsCountGivesTheSameBits) {
  const Outcome outcome = run({"render", "wisps.xml", "-o", "a.exr", "--target-error", "1%"});
  EXPECT_THAT(outcome.err, ContainsRegex("[0-9]+ samples a pixel, error 0\\.[0-9]+%"));
  const int samples = samplesOf("a.exr");
  EXPECT_GE(samples, 86) << "65536 samples of the film at least";
  run({"render", "wisps.xml", "-o", "b.exr", "--spp", std::to_string(samples)});
  EXPECT_EQ(picture("a.exr").pixels, picture("b.exr").pixels);
  const Outcome capped = run({"render", "wisps.xml", "-o", "c.exr", "--target-error", "0.001%", "--spp", "8"});
  EXPECT_THAT(capped.err, HasSubstr("0.001% is not reached"));
  EXPECT_EQ(samplesOf("c.exr"), 8);
}

double numberOf(const image::ImageBuffer& picture, const std::string& key) {
  for (const image::Metadata& entry : picture.metadata) {
    if (entry.key != key) continue;
    if (const auto* number = std::get_if<double>(&entry.value)) return *number;
    if (const auto* whole = std::get_if<std::int32_t>(&entry.value)) return *whole;
  }
  return -1;
}

TEST_F(Accuracy, AdaptiveSamplesGoWhereTheErrorIs) {
  folder_.write("small.xml",
                sceneOf(60, 96, 64, R"(<emitter type="directional"><rgb name="irradiance" value="20"/></emitter>
  <volume type="sphere"><transform name="to_world"><scale value="0.6"/></transform>
    <medium type="homogeneous"><rgb name="sigma_t" value="4"/><rgb name="albedo" value="0.9"/></medium></volume>)"));
  const auto rmse = [&](const std::string& name) {
    const image::ImageBuffer image = picture(name);
    double sum = 0;
    for (const float error : image.layers.at(0).pixels) {
      sum += static_cast<double>(error) * static_cast<double>(error);
    }
    return std::sqrt(sum);
  };
  const auto render = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words{"render", "small.xml", "-o", name, "-q", "--aov", "error"};
    words.insert(words.end(), more.begin(), more.end());
    run(words);
  };
  render("even.exr", {"--spp", "64"});
  render("adaptive.exr", {"--spp", "64", "--adaptive"});
  const image::ImageBuffer adaptive = picture("adaptive.exr");
  EXPECT_EQ(numberOf(adaptive, "aerosol:adaptive"), 1);
  EXPECT_NEAR(numberOf(adaptive, "aerosol:spp"), 64, 8);
  EXPECT_LE(numberOf(adaptive, "aerosol:sppMinimum"), 32);
  // The ball covers a twentieth of the picture: many more samples are there, with half the error or less.
  EXPECT_LT(rmse("adaptive.exr"), 0.6 * rmse("even.exr"));
  render("again.exr", {"--spp", "64", "--adaptive", "--threads", "1", "--width", "4"});
  EXPECT_EQ(picture("again.exr").pixels, adaptive.pixels);
  EXPECT_NE(picture("even.exr").pixels, adaptive.pixels);
}

TEST_F(Accuracy, ATargetErrorMakesTheStepsFineEnough) {
  folder_.write("coarse.xml", sceneOf(30, 24, 16, R"(<emitter type="constant"/>
  <volume type="sphere"><medium type="wisps"><rgb name="albedo" value="0"/>
    <float name="density" value="30"/><string name="distance" value="marching"/><float name="step_size" value="0.5"/>
  </medium></volume>)"));
  const Outcome outcome = run({"render", "coarse.xml", "-o", "a.exr", "--target-error", "2%"});
  EXPECT_THAT(outcome.err,
              ContainsRegex("steps of marching x 0\\.[0-9]+: their bias is [0-9.]+% of the image, and would"));
  const double scale = numberOf(picture("a.exr"), "aerosol:stepScale");
  EXPECT_LT(scale, 0.6);
  const int samples = samplesOf("a.exr");
  run({"render", "coarse.xml", "-o", "b.exr", "-q", "--spp", std::to_string(samples), "--step-scale",
       std::to_string(scale)});
  EXPECT_EQ(picture("a.exr").pixels, picture("b.exr").pixels);
  run({"render", "coarse.xml", "-o", "exact.exr", "-q", "--spp", "512", "--distance", "null"});
  run({"render", "coarse.xml", "-o", "coarse.exr", "-q", "--spp", "512"});
  run({"render", "coarse.xml", "-o", "fine.exr", "-q", "--spp", "512", "--step-scale", std::to_string(scale)});
  const auto mean = [&](const std::string& name) {
    const std::vector<float> pixels = picture(name).pixels;
    return std::accumulate(pixels.begin(), pixels.end(), 0.0) / static_cast<double>(pixels.size());
  };
  EXPECT_GT(std::fabs(mean("coarse.exr") / mean("exact.exr") - 1), 0.02);
  EXPECT_LT(std::fabs(mean("fine.exr") / mean("exact.exr") - 1), 0.02);
  // What the scene asks for by hand is kept.
  EXPECT_THAT(run({"render", "coarse.xml", "-o", "c.exr", "--target-error", "20%", "--step-scale", "1"}).err,
              Not(HasSubstr("steps of marching")));
}

TEST_F(Accuracy, AnAdaptiveRenderIsCarriedOn) {
  std::vector<std::string> words{"render", "wisps.xml", "-o", "whole.exr", "--spp", "1500", "--adaptive"};
  words.insert(words.end(), {"--aov", "direct,indirect,depth,error,samples,cost", "-q"});
  run(words);
  words[3] = "a.exr";
  words.insert(words.end(), {"--checkpoint", "0.02"});
  EXPECT_FALSE(folder_.runUntil("a.checkpoint.exr", words).code) << "it ended before there was a checkpoint";
  words.insert(words.end(), {"--resume", "--threads", "1", "--width", "4"});
  std::erase(words, "-q");
  EXPECT_THAT(run(words).err, HasSubstr("going on from a.checkpoint.exr"));
  const image::ImageBuffer whole = picture("whole.exr"), carriedOn = picture("a.exr");
  EXPECT_EQ(carriedOn.pixels, whole.pixels);
  ASSERT_EQ(carriedOn.layers.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(carriedOn.layers[i].pixels, whole.layers[i].pixels) << i;
  // Layers are means over the samples that each pixel has: direct and indirect light make the picture.
  const std::vector<float>&direct = whole.layers[0].pixels, &indirect = whole.layers[1].pixels,
        &samples = whole.layers[4].pixels;
  for (std::size_t i = 0; i < direct.size(); ++i) {
    EXPECT_NEAR(direct[i] + indirect[i], whole.pixels[i / 3 * whole.channels.size() + i % 3], 1e-5) << i;
  }
  EXPECT_NE(*std::ranges::min_element(samples), *std::ranges::max_element(samples));
  const double all = std::accumulate(samples.begin(), samples.end(), 0.0);
  EXPECT_NEAR(all / static_cast<double>(samples.size()), numberOf(whole, "aerosol:spp"), 1e-3);
  EXPECT_THAT(run({"render", "wisps.xml", "-o", "b.exr", "--adaptive", "--samples", "0:8"}, 2).err,
              HasSubstr("--adaptive does not"));
}

TEST_F(Accuracy, ATimeIsKept) {
  // Without the limit this took days. How close the end comes to it, a busy machine has a say in.
  run({"render", "wisps.xml", "-o", "a.exr", "--time", "0.5s", "--spp", "1000000"});
  const int samples = samplesOf("a.exr");
  EXPECT_GE(samples, 1);
  EXPECT_LT(samples, 1000000);
  run({"render", "wisps.xml", "-o", "b.exr", "--spp", std::to_string(samples)});
  EXPECT_EQ(picture("a.exr").pixels, picture("b.exr").pixels);
  EXPECT_THAT(run({"render", "wisps.xml", "-o", "a.exr", "--time", "1s", "--samples", "0:3"}, 2).err,
              HasSubstr("--samples says how many samples there are"));
}

TEST_F(Accuracy, CostIsExplainedAndWritten) {
  const Outcome outcome = run({"render", "wisps.xml", "-o", "a.exr", "--spp", "256", "--explain-cost", "--stats",
                               "a.json", "--aov", "cost", "--aov", "error", "--aov", "samples"});
  EXPECT_THAT(outcome.err, HasSubstr("ns/point"));
  EXPECT_THAT(outcome.err, ContainsRegex("wisps (coefficients|extinction) +[0-9.]+ %"));
  EXPECT_THAT(outcome.err, HasSubstr("rays against surfaces and volume primitives"));
  // The lines of all work add up to it.
  const std::string all = outcome.err.substr(outcome.err.find("  all work\n"));
  static const std::regex line("\n    \\w+ +([0-9.]+) %");
  double sum = 0;
  int lines = 0;
  for (std::sregex_iterator at(all.begin(), all.end(), line), end; at != end; ++at, ++lines) sum += std::stod((*at)[1]);
  EXPECT_EQ(lines, 7);
  EXPECT_NEAR(sum, 100, 0.4) << all;
  const std::string json = folder_.read("a.json");
  EXPECT_THAT(json, HasSubstr("\"shader\": \"wisps\""));
  EXPECT_THAT(json, HasSubstr("\"samples\": 196608"));
  EXPECT_THAT(json, HasSubstr("\"method\": \"null scattering\""));
  const image::ImageBuffer a = picture("a.exr");
  ASSERT_EQ(a.layers.size(), 3u);
  const image::ImageLayer &cost = a.layers[0], &error = a.layers[1], &samples = a.layers[2];
  EXPECT_EQ(cost.channels, (std::vector<std::string>{"cost.N"}));
  EXPECT_EQ(error.channels, (std::vector<std::string>{"error.R", "error.G", "error.B"}));
  EXPECT_EQ(samples.name, "samples");
  // A corner sees no medium: it costs nothing.
  EXPECT_EQ(cost.pixels[0], 0);
  EXPECT_EQ(samples.pixels[0], 256);
  const std::size_t centre = 12 * 32 + 16;
  EXPECT_GT(cost.pixels[centre], 1);
  EXPECT_GT(error.pixels[3 * centre], 0);
  // The map is the same for any number of threads.
  run({"render", "wisps.xml", "-o", "b.exr", "--spp", "256", "--aov", "cost", "--threads", "1", "-q"});
  const image::ImageBuffer b = picture("b.exr");
  EXPECT_EQ(cost.pixels, b.layers.at(0).pixels);
}

TEST_F(Accuracy, AStudyIsKilledAndCarriedOn) {
  const std::vector<std::string> words{"study", "wisps.xml", "-o", "study", "--budget", "2s", "--size", "16"};
  EXPECT_FALSE(folder_.runUntil("study/study.csv", words).code) << "the first of nine cases is done, and no more";
  const Outcome outcome = run(words);
  EXPECT_THAT(outcome.err, ContainsRegex("going on with [1-8] finished case"));
  for (const char* file : {"study.html", "study.json", "study.csv", "error.png", "parts.png", "reference.png"}) {
    EXPECT_TRUE(folder_.has(std::string("study/") + file)) << file;
  }
  EXPECT_THAT(outcome.out, HasSubstr("has the smallest error"));
  const std::string page = folder_.read("study/study.html");
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,"));
  EXPECT_THAT(page, Not(HasSubstr("src=\"http")));
  EXPECT_THAT(page, HasSubstr("null scattering"));
  EXPECT_THAT(page, HasSubstr("marching, steps x 8"));
  EXPECT_THAT(page, HasSubstr("null scattering, relaxed"));
  EXPECT_THAT(page, HasSubstr("marching, unbiased to lights"));
  EXPECT_TRUE(image::readImage(folder_.path("study/error.png")));
  // All is there: nothing is rendered again.
  const Outcome again = run(words);
  EXPECT_THAT(again.err, HasSubstr("going on with 9 finished cases"));
  EXPECT_EQ(folder_.read("study/study.html"), page);
  const Outcome other =
      run({"study", "wisps.xml", "-o", "study", "--budget", "1s", "--size", "8", "--vary", "wisps.density=1,2"});
  EXPECT_THAT(other.err, HasSubstr("holds another study"));
  EXPECT_THAT(folder_.read("study/study.csv"), HasSubstr("\"wisps.density = 2\""));
}

TEST_F(Accuracy, APlanNamesEffectsWithTheirPlaces) {
  const Outcome outcome = run({"plan", "wisps.xml", "--size", "16", "--without", "constant-light"});
  EXPECT_THAT(outcome.out, ContainsRegex("heterogeneity +V8 H6 +on +[0-9.]+ % +wisps .wisps.xml:9:25"));
  EXPECT_THAT(outcome.out, ContainsRegex("depth-of-field +E1 +off +the camera has no lens"));
  EXPECT_THAT(outcome.out, ContainsRegex("constant-light +S2 +off"));
  EXPECT_THAT(outcome.out, HasSubstr("constant environments are black"));
  EXPECT_THAT(outcome.out, HasSubstr("measured: the pilot is 100 % darker in the mean"));
  EXPECT_THAT(run({"help", "effects"}).out, ContainsRegex("S5 +many lights, in a hierarchy\n +light-hierarchy"));
  EXPECT_THAT(run({"plan", "wisps.xml", "--without", "motoin"}, 1).err, HasSubstr("there is no such effect"));
  const Outcome deep =
      run({"plan", "wisps.xml", "--size", "16", "--deep", "a.exr", "--deep-slices", "9", "--aov", "depth"});
  EXPECT_THAT(deep.out, ContainsRegex("deep-output +E5 +on +[0-9.]+ % +9 slices"));
  EXPECT_THAT(deep.out, ContainsRegex("layers +E5 +on +[0-9.]+ % +depth"));
  EXPECT_FALSE(folder_.has("a.exr"));
  const Outcome without = run({"plan", "wisps.xml", "--size", "16", "--deep", "a.exr", "--without", "deep-output"});
  EXPECT_THAT(without.out, ContainsRegex("deep-output +E5 +off"));
  EXPECT_THAT(run({"render", "wisps.xml", "-o", "a.exr", "--deep", "b.exr", "--without", "deep-output"}, 2).err,
              HasSubstr("--without deep-output leaves out what --deep asks for"));
}

/// Whether every finding has a place and a note.
testing::AssertionResult hasPlacesAndRemedies(const std::string& text) {
  static const std::regex finding("(warning|error): "), place("^[^ ]+:[0-9]+:[0-9]+: (warning|error): ");
  std::istringstream lines(text);
  std::string last;
  bool hasNote = true;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("  note: ")) hasNote = true;
    if (line.starts_with(" ") || !std::regex_search(line, finding)) continue;
    if (!hasNote) return testing::AssertionFailure() << "no remedy: " << last;
    if (!std::regex_search(line, place)) return testing::AssertionFailure() << "no place: " << line;
    last = line;
    hasNote = false;
  }
  if (!hasNote) return testing::AssertionFailure() << "no remedy: " << last;
  return testing::AssertionSuccess() << last;
}

TEST_F(Accuracy, ADoctorFindsWhatIsWrong) {
  EXPECT_THAT(run({"doctor", "wisps.xml"}).out, HasSubstr("nothing found"));
  folder_.write("bad.osl", R"(volume bad [[ string extinction_bound = "most" ]] (float most = 1) {
    float x = P[0] > 0.3 ? sqrt(-1.0 - P[1] * P[1]) / 0.0 * 1e30 * 1e30 : 2.0 + P[0];
    Ci = (x - (P[0] > 0.5 ? 10.0 : 0.0)) * anisotropic_vdf(color(0.5), color(1), 0);
})");
  // A tetrahedron without its fourth face.
  folder_.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  folder_.write("ill.xml", R"(<scene version="3.0.0">
  <sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="24"/></film></sensor>
  <emitter type="constant"/>
  <volume type="sphere"><medium type="bad"/></volume>
  <volume type="box"><transform name="to_world"><translate x="1" y="0" z="0"/></transform>
    <medium type="wisps"><string name="distance" value="marching"/><float name="step_size" value="1e-5"/></medium></volume>
  <shape type="obj"><string name="filename" value="open.obj"/><bsdf type="null"/>
    <medium name="interior" type="homogeneous"/></shape>
  <shape type="cube"><bsdf type="null"/><medium name="interior" type="homogeneous"/></shape>
  <shape type="cube"><transform name="to_world"><translate x="2" y="0" z="0"/></transform><bsdf type="null"/>
    <medium name="interior" type="homogeneous"/></shape>
</scene>)");
  const Outcome outcome = run({"doctor", "ill.xml", "--size", "16"}, 1);
  EXPECT_THAT(outcome.err, HasSubstr("this mesh bounds a medium and has holes: 3 edges with one triangle alone"));
  EXPECT_THAT(outcome.err, HasSubstr("ill.xml:12:3: warning: this surface coincides with another one"));
  EXPECT_THAT(outcome.err, ContainsRegex("marching through 'wisps' takes [0-9.]+ k steps a ray"));
  EXPECT_THAT(outcome.err, HasSubstr("volume shader 'bad' gave"));
  EXPECT_THAT(outcome.err, HasSubstr("world point ("));
  EXPECT_THAT(outcome.err, HasSubstr("was above its bound of"));
  EXPECT_THAT(outcome.out, ContainsRegex("ill.xml: [0-9]+ findings"));
  EXPECT_TRUE(hasPlacesAndRemedies(outcome.err));
  // What cannot be read, and what nothing uses.
  folder_.write("inputs.xml", sceneOf(30, 8, 8, R"(<emitter type="constant"/><medium type="homogeneous" id="fog"/>
  <shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
    <string name="filename" value="none.png"/></texture></bsdf></shape>)"));
  const Outcome inputs = run({"doctor", "inputs.xml", "--size", "8"}, 1);
  EXPECT_THAT(inputs.err, ContainsRegex("inputs.xml:8:[0-9]+: warning: medium 'fog' is never referred to"));
  EXPECT_THAT(inputs.err,
              ContainsRegex("inputs.xml:10:36: warning: \"none.png\" of shader 'bitmap' cannot be read: there "
                            "is no such file"));
  EXPECT_THAT(inputs.err, HasSubstr("correct the name, or put the file where it is looked for"));
  EXPECT_THAT(inputs.out, HasSubstr("inputs.xml: 2 findings"));
  EXPECT_TRUE(hasPlacesAndRemedies(inputs.err));
  EXPECT_FALSE(hasPlacesAndRemedies("warning: a\n  note: b\n"));
  EXPECT_FALSE(hasPlacesAndRemedies("a.xml:1:2: warning: a\n"));
  EXPECT_THAT(run({"check", "inputs.xml"}).out, HasSubstr("inputs.xml: no errors, 2 warnings"));
}

/// The doctor itself comes to an end, and a render says so before it begins.
TEST_F(Accuracy, StepsThatWillNotFinishAreToldBeforeTheyAreTaken) {
  folder_.write("endless.xml", R"(<scene version="3.0.0">
  <sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 0, -8" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="48"/><integer name="height" value="48"/>
      <rfilter type="box"/></film></sensor>
  <emitter type="constant"/>
  <volume type="sphere">
    <medium type="wisps"><string name="distance" value="marching"/><float name="step_size" value="1e-8"/></medium></volume>
</scene>)");
  const char* const finding = "endless.xml:8:5: warning: marching through 'wisps' takes [0-9.]+ M steps a ray";
  const Outcome outcome = run({"doctor", "endless.xml"}, 1);
  EXPECT_THAT(outcome.err, ContainsRegex(finding));
  EXPECT_THAT(outcome.out, HasSubstr("endless.xml: 1 finding"));
  EXPECT_TRUE(hasPlacesAndRemedies(outcome.err));
  // A corner that sees nothing of it.
  const Outcome render = run({"render", "endless.xml", "-o", "a.exr", "--spp", "1", "--crop", "0,0,1,1", "-q"});
  EXPECT_THAT(render.err, ContainsRegex(finding));
  EXPECT_EQ(run({"render", "endless.xml", "-o", "a.exr", "--spp", "1", "--crop", "0,0,1,1", "-q", "--set",
                 "wisps.step_size=0.1"})
                .err,
            "");
}

/// What only shows when rays go there, or is nobody's in particular.
TEST_F(Accuracy, ADoctorFindsWhatRaysMeet) {
  folder_.write("broken.png", "no picture");
  folder_.write("open.obj", "v -1 -1 -1\nv 1 -1 -1\nv 0 1 0\nv 0 -1 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  folder_.write("rays.xml", sceneOf(30, 16, 16, R"(
  <default name="idle" value="1"/><bsdf type="diffuse" id="spare"/>
  <volume type="mesh"><string name="filename" value="open.obj"/><medium type="homogeneous"/></volume>
  <volume type="box"><medium type="wisps"><string name="distance" value="marching"/><float name="step_size" value="3"/>
    </medium></volume>
  <volume type="box"><medium type="wisps"><float name="density" value="1e7"/><string name="distance" value="null"/>
    </medium></volume>
  <shape type="sphere"><float name="radius" value="0.5"/><bsdf type="osl"><source>surface s() {
    warning("seen"); Ci = log(u - u - 1) / 1e-30 * 1e30 * diffuse(N) + diffuse(N); }</source></bsdf></shape>
  <shape type="cube"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
    <string name="filename" value="broken.png"/></texture></bsdf></shape>)"));
  const Outcome outcome = run({"doctor", "rays.xml", "--size", "16"}, 1);
  for (const char* part : {"the default 'idle' is never used", "'spare' is never referred to",
                           "'./open.obj' is not closed", "one step of marching", "tentative collisions a ray",
                           "\"broken.png\" of shader 'bitmap'", "write the file anew", "the scene has no light"}) {
    EXPECT_THAT(outcome.err, HasSubstr(part));
  }
  EXPECT_TRUE(hasPlacesAndRemedies(outcome.err)) << outcome.err;
}

/// Faces that fit are a finding only where nothing says which medium holds.
TEST_F(Accuracy, ADoctorKnowsThatFacesWithPrioritiesMayCoincide) {
  const auto cubes = [&](int first, int second) {
    return sceneOf(30, 8, 8,
                   fmt::format(R"(<emitter type="constant"/>
  <shape type="cube"><bsdf type="dielectric"><integer name="priority" value="{}"/></bsdf></shape>
  <shape type="cube"><transform name="to_world"><translate x="2" y="0" z="0"/></transform>
    <bsdf type="dielectric"><integer name="priority" value="{}"/></bsdf></shape>)",
                               first, second));
  };
  folder_.write("decided.xml", cubes(1, 2));
  folder_.write("equal.xml", cubes(1, 1));
  EXPECT_THAT(run({"doctor", "decided.xml", "--size", "8"}).out, HasSubstr("nothing found"));
  const Outcome equal = run({"doctor", "equal.xml", "--size", "8"}, 1);
  EXPECT_THAT(equal.err, HasSubstr("coincides with another one"));
  EXPECT_TRUE(hasPlacesAndRemedies(equal.err));
}

/// A colour given as albedo that is too bright: told of before, while and after it is rendered.
TEST_F(Accuracy, AlbedosAboveOneAreToldOf) {
  folder_.write("bright.xml", R"(<scene version="3.0.0"><sensor type="perspective">
      <transform name="to_world"><translate z="-5"/></transform><film type="hdrfilm"><integer name="width" value="8"/>
      <integer name="height" value="8"/></film></sensor><emitter type="constant"/>
      <volume type="box"><medium type="osl"><source><![CDATA[volume v() { Ci = anisotropic_vdf(2, 1, 0); }]]></source>
      </medium></volume></scene>)");
  const std::string said = "scatters more light than it takes from rays";
  const Outcome check = run({"check", "bright.xml"});
  EXPECT_THAT(check.err, HasSubstr(said));
  EXPECT_THAT(check.err, HasSubstr("everywhere: scattering (2, 2, 2), extinction (1, 1, 1)"));
  EXPECT_THAT(run({"render", "bright.xml", "--spp", "1", "-o", "bright.exr"}).err, HasSubstr(said));
  const Outcome doctor = run({"doctor", "bright.xml", "--size", "8"}, 1);
  EXPECT_THAT(doctor.err, HasSubstr(said));
  EXPECT_TRUE(hasPlacesAndRemedies(doctor.err));
}

TEST_F(Accuracy, ACheckTellsEverythingAtOnce) {
  EXPECT_THAT(run({"check", "wisps.xml"}).out, HasSubstr("wisps.xml: no errors, "));
  folder_.write("broken.ply", "ply\nformat ascii 1.0\nelement vertex many\n");
  folder_.write("broken.osl", "surface broken() { Ci = diffuse(M); }");
  const std::string wrong = R"(<scene version="3.0.0">
  <sensor type="perspective"/>
  <shape type="ply"><string name="filename" value="broken.ply"/></shape>
  <shape type="cube"><bsdf type="diffuse"><rgb name="reflectence" value="0.5"/></bsdf></shape>
  <shape type="cube"><bsdf type="broken"/></shape>
  <volume type="sphere"><medium type="wisps"><float name="no_such" value="1"/></medium></volume>
)";
  // Errors of reading do not hide those of the rest.
  folder_.write("unread.xml", wrong + "  <shape type=\"cube\"><float name=\"radius\" value=\"1\"/></shape>\n" +
                                  "  <shape type=\"obj\"><string name=\"filename\" value=\"none.obj\"/></shape>\n" +
                                  "  <volume type=\"mesh\"><medium type=\"wisps\"/></volume></scene>");
  const std::vector<std::string> parts = {"broken.ply:3:16: error", "shader 'diffuse' has no parameter 'reflectence'",
                                          "unknown name 'M'", "shader 'wisps' has no parameter 'no_such'"};
  const Outcome unread = run({"check", "unread.xml"}, 1);
  for (const std::string& part : parts) EXPECT_THAT(unread.err, HasSubstr(part));
  EXPECT_THAT(unread.err, HasSubstr("'radius'"));
  EXPECT_THAT(unread.err, HasSubstr("there is no file 'none.obj'"));
  EXPECT_THAT(unread.out, HasSubstr("unread.xml: 7 errors"));
  folder_.write("unprepared.xml", wrong + "</scene>");
  const Outcome unprepared = run({"check", "unprepared.xml"}, 1);
  for (const std::string& part : parts) EXPECT_THAT(unprepared.err, HasSubstr(part));
  EXPECT_THAT(unprepared.out, HasSubstr("unprepared.xml: 4 errors"));
  EXPECT_THAT(run({"check", "nowhere.xml"}, 1).err, HasSubstr("the scene cannot be read"));
}

/// The tasks of a job, run by a shell one after the other as a queue would, and their merge.
TEST_F(Accuracy, AJobOfTasksIsTheWholeImage) {
  run({"submit", "wisps.xml", "-o", "whole.exr", "--spp", "20", "--tasks", "3", "--folder", "job", "--set",
       "wisps.density=2"});
  for (const char* file : {"tasks.sh", "merges.sh", "render.sbatch", "merge.sbatch", "parallel.sh", "opencue.py"}) {
    EXPECT_TRUE(folder_.has(std::string("job/") + file)) << file;
  }
  EXPECT_THAT(folder_.read("job/render.sbatch"), HasSubstr("#SBATCH --array=0-2"));
  const auto shell = [&](const std::string& command) {
    return std::system(("cd " + folder_.path("") + " && " + command + " >/dev/null 2>&1").c_str());
  };
  EXPECT_EQ(shell("sh job/tasks.sh 2"), 0);
  EXPECT_EQ(shell("sh job/tasks.sh 0"), 0);
  EXPECT_NE(shell("sh job/merges.sh 0"), 0) << "a task is lost";
  EXPECT_EQ(shell("sh job/tasks.sh 1"), 0);
  EXPECT_EQ(shell("sh job/merges.sh 0"), 0);
  EXPECT_NE(shell("sh job/tasks.sh 3"), 0);
  run({"render", "wisps.xml", "-o", "one.exr", "--spp", "20", "--isa", "avx2", "--set", "wisps.density=2", "-q"});
  EXPECT_EQ(picture("whole.exr").pixels, picture("one.exr").pixels);
}

/// Layers and deep images are gathered by all tasks and joined by the merge.
TEST_F(Accuracy, AJobCarriesLayersAndDeepImages) {
  run({"submit", "wisps.xml", "-o", "whole.exr", "--spp", "12", "--tasks", "2", "--aov", "direct,depth", "--deep",
       "whole.deep.exr", "--deep-slices", "8"});
  const std::string shell =
      "cd " + folder_.path("") + " && for i in 0 1; do sh whole.job/tasks.sh $i; done && sh " + "whole.job/merges.sh 0";
  EXPECT_EQ(std::system((shell + " >/dev/null 2>&1").c_str()), 0);
  run({"render", "wisps.xml", "-o", "one.exr", "--spp", "12", "--isa", "avx2", "--aov", "direct,depth", "--deep",
       "one.deep.exr", "--deep-slices", "8", "-q"});
  EXPECT_EQ(picture("whole.exr").pixels, picture("one.exr").pixels);
  ASSERT_EQ(picture("whole.exr").layers.size(), 2u);
  EXPECT_EQ(picture("whole.exr").layers[1].pixels, picture("one.exr").layers[1].pixels);
  const auto deep = image::readDeepImage(folder_.path("whole.deep.exr")),
             other = image::readDeepImage(folder_.path("one.deep.exr"));
  ASSERT_TRUE(deep && other);
  EXPECT_EQ(deep->counts, other->counts);
  EXPECT_EQ(deep->values, other->values);
}

/// An sbatch that keeps what it is given: the merge depends on the renders.
TEST_F(Accuracy, ASlurmJobMergesAfterItsRenders) {
  folder_.write("sbatch",
                "#!/bin/sh\necho \"$@\" >> \"$(dirname \"$0\")/calls\"\nwc -l < \"$(dirname \"$0\")/calls\"\n");
  std::filesystem::permissions(folder_.path("sbatch"), std::filesystem::perms::all);
  const std::string before = std::getenv("PATH");
  setenv("PATH", (folder_.path("") + ":" + before).c_str(), 1);
  const Outcome outcome = run({"submit", "wisps.xml", "-o", "a.%04d.exr", "--frames", "1-3", "--tasks", "2", "--spp",
                               "200", "-D", "x=1", "--slurm"},
                              1);
  EXPECT_THAT(outcome.err, HasSubstr("the scene never uses '$x'"));
  const Outcome good =
      run({"submit", "wisps.xml", "-o", "a.%04d.exr", "--frames", "1-3", "--tasks", "2", "--spp", "200", "--slurm"});
  setenv("PATH", before.c_str(), 1);
  EXPECT_THAT(good.out, HasSubstr("merge job 2"));
  const std::string calls = folder_.read("calls");
  EXPECT_THAT(calls, HasSubstr("--parsable --dependency=afterany:1 "));
  EXPECT_THAT(folder_.read("a.job/render.sbatch"), HasSubstr("--array=0-5"));
  EXPECT_THAT(folder_.read("a.job/tasks.sh"), HasSubstr("--samples 0:128"));
}

}  // namespace
}  // namespace aerosol::test
