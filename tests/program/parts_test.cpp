#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/image/deep_image.h"
#include "core/image/image.h"
#include "tests/support/program.h"

// Images in parts: sample ranges, crops, checkpoints, and what joins them.

namespace aerosol::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* fogScene = R"(<scene version="3.0.0">
  <default name="frame" value="0"/>
  <sensor type="perspective">
    <float name="fov" value="$fov"/>
    <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="20"/><integer name="height" value="18"/>
      <string name="pixel_format" value="rgba"/></film>
    <sampler type="sobol"><integer name="sample_count" value="256"/></sampler>
  </sensor>
  <emitter type="constant"><rgb name="radiance" value="1, 0.8, 0.5"/></emitter>
  <volume type="sphere"><transform name="to_world"><translate x="$frame" y="0" z="0"/></transform>
    <medium type="wisps"/></volume>
</scene>)";

class Parts : public testing::Test {
 protected:
  Parts() {
    std::string text = fogScene;
    text.replace(text.find("$fov"), 4, "30");
    folder_.write("fog.xml", text);
  }

  Outcome render(std::vector<std::string> options, int expected = 0) {
    options.insert(options.begin(), {"render", "fog.xml", "--quiet"});
    const Outcome outcome = folder_.run(options);
    EXPECT_EQ(outcome.code, expected) << outcome.err;
    return outcome;
  }
  Outcome merge(std::vector<std::string> options, int expected = 0) {
    options.insert(options.begin(), {"merge"});
    const Outcome outcome = folder_.run(options);
    EXPECT_EQ(outcome.code, expected) << outcome.err;
    return outcome;
  }
  image::ImageBuffer picture(const std::string& name) const { return folder_.picture(name); }
  bool samePixels(const std::string& a, const std::string& b) const {
    const image::ImageBuffer p = picture(a), q = picture(b);
    return p.width == q.width && p.height == q.height && p.originX == q.originX && p.originY == q.originY &&
           p.fullWidth == q.fullWidth && p.channels == q.channels && p.pixels == q.pixels && sameLayers(p, q);
  }
  static bool sameLayers(const image::ImageBuffer& a, const image::ImageBuffer& b) {
    return std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(),
                      [](const image::ImageLayer& p, const image::ImageLayer& q) {
                        return p.name == q.name && p.channels == q.channels && p.pixels == q.pixels;
                      });
  }
  std::string note(const std::string& file, const std::string& key) const {
    for (const image::Metadata& entry : picture(file).metadata) {
      if (entry.key != key) continue;
      if (const auto* integer = std::get_if<std::int32_t>(&entry.value)) return std::to_string(*integer);
      if (const auto* text = std::get_if<std::string>(&entry.value)) return *text;
    }
    return {};
  }

  ProgramFolder folder_;
};

TEST_F(Parts, UnevenSplitsMergedInAnyOrderAreTheWhole) {
  render({"-o", "whole.exr"});
  render({"--samples", "0:7", "-o", "a.exr"});
  render({"--samples", "7:100", "-o", "b.exr", "--threads", "1"});
  render({"--samples", "100:256", "-o", "c.exr"});
  std::vector<std::string> order{"a.exr", "b.exr", "c.exr"};
  do {
    std::vector<std::string> arguments = order;
    arguments.insert(arguments.end(), {"-o", "merged.exr", "-o", "merged.png"});
    merge(arguments);
    EXPECT_TRUE(samePixels("whole.exr", "merged.exr")) << testing::PrintToString(order);
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(note("merged.exr", "aerosol:sppMaximum"), "256");
  EXPECT_EQ(note("merged.exr", "aerosol:job"), note("whole.exr", "aerosol:job"));
  // A part shows the samples that it has.
  EXPECT_FALSE(samePixels("whole.exr", "a.exr"));
  EXPECT_EQ(note("b.exr", "aerosol:firstSample") + note("b.exr", "aerosol:endSample"), "7100");
}

TEST_F(Parts, CropsAndMergesOfMergesAreTheWhole) {
  render({"-o", "whole.exr", "--spp", "20"});
  for (const char* crop : {"0,0,20,7", "0,7,9,11", "9,7,11,11"}) {
    render({"--spp", "20", "--crop", crop, "--keep-sums", "-o", std::string(crop) + ".exr"});
  }
  const Outcome early = merge({"0,0,20,7.exr", "9,7,11,11.exr", "-o", "two.exr", "--allow-missing"});
  EXPECT_THAT(early.err, HasSubstr("samples 0:20 of the pixels 0,7,9,11"));
  merge({"0,7,9,11.exr", "two.exr", "-o", "merged.exr"});
  EXPECT_TRUE(samePixels("whole.exr", "merged.exr"));
  // One crop may be all that is wanted.
  merge({"9,7,11,11.exr", "--crop", "9,7,11,11", "-o", "corner.exr"});
  EXPECT_EQ(picture("corner.exr").width, 11);
}

TEST_F(Parts, AovsAreMergedAndCarriedOn) {
  const std::string aovs = "direct,volume,depth,denoise,cost,samples,error,first=CV[LOB]";
  const auto part = [&](std::vector<std::string> options) {
    options.insert(options.end(), {"--spp", "40", "--aov", aovs});
    return render(options);
  };
  part({"-o", "whole.exr"});
  ASSERT_EQ(picture("whole.exr").layers.size(), 15u);
  EXPECT_EQ(note("whole.exr", "aerosol:aovs").substr(0, 20), "direct, volume, dept");
  part({"--samples", "0:7", "-o", "a.exr", "--threads", "1"});
  part({"--samples", "7:40", "-o", "b.exr", "--crop", "0,0,20,5"});
  part({"--samples", "7:40", "-o", "c.exr", "--crop", "0,5,20,13"});
  merge({"c.exr", "a.exr", "b.exr", "-o", "merged.exr"});
  EXPECT_TRUE(samePixels("whole.exr", "merged.exr"));
  // Killed when there is a checkpoint, and carried on.
  const std::vector<std::string> whole{"render", "fog.xml", "--spp", "3000", "--aov", aovs, "-o", "3000.exr", "-q"};
  std::vector<std::string> killed = whole;
  killed[7] = "killed.exr";
  killed.insert(killed.end(), {"--checkpoint", "0.02s"});
  EXPECT_EQ(folder_.run(whole).code, 0);
  EXPECT_FALSE(folder_.runUntil("killed.checkpoint.exr", killed).code) << "it ended before there was a checkpoint";
  const Outcome other = folder_.run({"render", "fog.xml", "--spp", "3000", "-o", "killed.exr", "--resume", "-q"});
  EXPECT_THAT(other.err, HasSubstr("it has other AOVs"));
  killed.back() = "0";
  killed.insert(killed.end(), {"--resume", "--threads", "1", "--width", "4"});
  std::erase(killed, "-q");
  EXPECT_THAT(folder_.run(killed).err, HasSubstr("going on from killed.checkpoint.exr"));
  EXPECT_TRUE(samePixels("3000.exr", "killed.exr"));
  // Parts with other AOVs are no parts.
  render({"--samples", "7:40", "--spp", "40", "-o", "d.exr", "--aov", "direct"});
  const Outcome refused = merge({"a.exr", "d.exr", "-o", "x.exr"}, 1);
  EXPECT_THAT(refused.err, HasSubstr("this part has other AOVs than a.exr: direct, not direct, volume"));
  // A render that is done already is not when other layers are asked for.
  part({"-o", "whole.exr", "--resume"});
  render({"-o", "whole.exr", "--resume", "--spp", "40", "--aov", "depth"});
  EXPECT_EQ(picture("whole.exr").layers.size(), 1u);
}

/// Mattes and deep images keep all that samples met until all parts are there.
TEST_F(Parts, MattesAndDeepImagesAreJoined) {
  const auto part = [&](std::vector<std::string> options, const std::string& name) {
    options.insert(options.end(), {"--spp", "24", "--aov", "crypto_object,crypto_material", "--deep-slices", "6"});
    options.insert(options.end(), {"-o", name + ".exr", "--deep", name + ".deep.exr"});
    render(options);
  };
  part({}, "whole");
  part({"--samples", "0:7"}, "a");
  part({"--samples", "7:24", "--crop", "0,0,20,9"}, "b");
  part({"--samples", "7:24", "--crop", "0,9,20,9"}, "c");
  merge({"c.exr", "a.exr", "b.exr", "-o", "merged.exr", "--deep", "merged.deep.exr"});
  EXPECT_FALSE(picture("whole.exr").layers.empty());
  EXPECT_TRUE(samePixels("whole.exr", "merged.exr"));
  const auto whole = image::readDeepImage(folder_.path("whole.deep.exr")),
             merged = image::readDeepImage(folder_.path("merged.deep.exr"));
  ASSERT_TRUE(whole && merged);
  EXPECT_FALSE(whole->values.empty());
  EXPECT_EQ(whole->counts, merged->counts);
  EXPECT_EQ(whole->values, merged->values);
}

TEST_F(Parts, LostAndDoubledTasksAreNoticed) {
  const std::vector<std::string> small{"--spp", "16", "--crop", "0,0,4,4"};
  const auto part = [&](const char* samples, const std::string& name) {
    std::vector<std::string> options = small;
    options.insert(options.end(), {"--samples", samples, "-o", name});
    render(options);
  };
  part("0:7", "a.exr");
  part("5:16", "b.exr");
  part("9:16", "c.exr");
  const Outcome doubled = merge({"a.exr", "c.exr", "b.exr", "--crop", "0,0,4,4", "-o", "x.exr"}, 1);
  EXPECT_THAT(doubled.err, HasSubstr("b.exr: error: samples of this part are in a.exr too"));
  EXPECT_THAT(doubled.err, HasSubstr("it has 0:7, this one 5:16"));
  const Outcome lost = merge({"a.exr", "c.exr", "--crop", "0,0,4,4", "-o", "x.exr"}, 1);
  EXPECT_THAT(lost.err, HasSubstr("samples are missing, no image is written"));
  EXPECT_THAT(lost.err, HasSubstr("samples 7:9 of the pixels 0,0,4,4"));
  EXPECT_FALSE(folder_.has("x.exr"));
}

TEST_F(Parts, OtherImagesAreNoParts) {
  const auto part = [&](std::vector<std::string> options, const std::string& name) {
    options.insert(options.end(), {"--spp", "4", "--keep-sums", "-o", name});
    render(options);
  };
  part({"--crop", "0,0,20,9"}, "a.exr");
  part({"--crop", "0,9,20,9", "--seed", "1"}, "seed.exr");
  part({"--crop", "0,9,20,9", "--set", "wisps.density=2"}, "set.exr");
  part({"--crop", "0,9,20,9", "--isa", "avx2"}, "avx2.exr");
  render({"--spp", "4", "-o", "plain.exr"});
  for (const char* other : {"seed.exr", "set.exr"}) {
    EXPECT_THAT(merge({"a.exr", other, "-o", "x.exr"}, 1).err,
                HasSubstr("this is no part of the same image as a.exr: scene, shaders, seed or options differ"));
  }
  EXPECT_THAT(merge({"a.exr", "plain.exr", "-o", "x.exr"}, 1).err, HasSubstr("this image has no sums of samples"));
  EXPECT_THAT(merge({"missing.exr", "-o", "x.exr"}, 1).err, HasSubstr("missing.exr"));
  if (note("a.exr", "aerosol:embreeIsa") != note("avx2.exr", "aerosol:embreeIsa")) {
    EXPECT_THAT(merge({"a.exr", "avx2.exr", "-o", "x.exr"}, 1).err, HasSubstr("--mixed joins them all the same"));
    merge({"a.exr", "avx2.exr", "-o", "x.exr", "--mixed"});
    EXPECT_EQ(note("x.exr", "aerosol:embreeIsa"), "mixed");
  }
  EXPECT_THAT(render({"--samples", "0:1", "-o", "x.png"}, 2).err, HasSubstr("--samples needs an EXR file"));
  EXPECT_THAT(render({"--samples", "0:300", "-o", "x.exr"}, 1).err, HasSubstr("--spp 300"));
  EXPECT_THAT(merge({"a.exr"}, 2).err, HasSubstr("no output is given"));
}

/// A damaged part is refused, wherever the damage is.
TEST_F(Parts, DamagedPartsAreRefused) {
  render({"--samples", "0:7", "-o", "a.exr"});
  const std::string good = folder_.read("a.exr");
  ASSERT_GT(good.size(), 5000u);
  for (const std::size_t length : {good.size() / 3, good.size() / 2, good.size() - 50}) {
    folder_.write("cut.exr", good.substr(0, length));
    merge({"cut.exr", "--allow-missing", "-o", "x.exr"}, 1);
  }
}

/// Killed at random moments, again and again, the render comes to the same image; whatever stands under the name of
/// a file is complete.
TEST_F(Parts, KilledRendersAreCarriedOnToTheSameImage) {
  const std::vector<std::string> options{"--set", "sampler.sample_count=3000"};
  std::vector<std::string> whole = options, again = options;
  whole.insert(whole.end(), {"-o", "whole.exr"});
  again.insert(again.begin(), {"render", "fog.xml", "-o", "again.exr", "--resume", "--checkpoint", "0.02"});
  const auto start = std::chrono::steady_clock::now();
  render(whole);
  const auto wholeTime = std::chrono::steady_clock::now() - start;
  std::mt19937 random(20);
  EXPECT_FALSE(folder_.runUntil("again.checkpoint.exr", again).code) << "it ended before there was a checkpoint";
  int killed = 1, carriedOn = 0;
  for (int run = 0; run < 100; ++run) {
    const auto longest = std::chrono::duration_cast<std::chrono::milliseconds>(wholeTime) * 9 / 10;
    const auto after =
        100ms + std::chrono::milliseconds(random() % std::max<unsigned>(1, static_cast<unsigned>(longest.count())));
    const bool isLast = run >= 8;
    const Outcome outcome = folder_.run(again, isLast ? std::nullopt : std::optional(after));
    if (folder_.has("again.checkpoint.exr")) {
      EXPECT_TRUE(image::readImage(folder_.path("again.checkpoint.exr")));
    }
    carriedOn += outcome.err.find("going on from again.checkpoint.exr") != std::string::npos;
    if (outcome.code) {
      EXPECT_EQ(*outcome.code, 0) << outcome.err;
      break;
    }
    ++killed;
    EXPECT_FALSE(folder_.has("again.exr") && !image::readImage(folder_.path("again.exr")));
  }
  EXPECT_GE(killed, 1);
  EXPECT_GE(carriedOn, 1);
  EXPECT_TRUE(samePixels("whole.exr", "again.exr"));
  EXPECT_FALSE(folder_.has("again.checkpoint.exr"));
}

TEST_F(Parts, ACheckpointOfAnotherRenderIsRefused) {
  folder_.runUntil("a.checkpoint.exr",
                   {"render", "fog.xml", "-o", "a.exr", "--spp", "1000000", "--checkpoint", "0.02"});
  ASSERT_TRUE(folder_.has("a.checkpoint.exr"));
  EXPECT_THAT(render({"-o", "a.exr", "--seed", "5", "--resume"}, 1).err,
              HasSubstr("this checkpoint cannot be carried on: scene, shaders, seed or options differ"));
  EXPECT_THAT(render({"-o", "a.exr", "--spp", "1", "--resume"}, 1).err, HasSubstr("samples that are not asked for"));
}

TEST_F(Parts, FramesAreNumberedAndDiffer) {
  render({"--spp", "2", "--frames", "0-2x2", "-o", "f.%03d.exr"});
  EXPECT_TRUE(folder_.has("f.000.exr") && folder_.has("f.002.exr") && !folder_.has("f.001.exr"));
  EXPECT_FALSE(samePixels("f.000.exr", "f.002.exr"));
  render({"--spp", "2", "-D", "frame=2", "-o", "two.exr"});
  EXPECT_TRUE(samePixels("two.exr", "f.002.exr"));
  EXPECT_THAT(render({"--frames", "1-2", "-o", "f.exr"}, 2).err, HasSubstr("%04d"));
  // What is done already stays.
  const Outcome again =
      folder_.run({"render", "fog.xml", "--spp", "2", "--frames", "0-2", "-o", "f.%03d.exr", "--resume"});
  EXPECT_THAT(again.err, HasSubstr("f.000.exr is done already"));
  EXPECT_THAT(again.err, HasSubstr("wrote f.001.exr"));
}

}  // namespace
}  // namespace aerosol::test
