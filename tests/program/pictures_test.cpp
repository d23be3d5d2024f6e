#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/image/image.h"
#include "tests/support/program.h"

// Layers, mattes, displays and noise, as a user of the program meets them.

namespace aerosol::test {
namespace {

using testing::HasSubstr;

constexpr const char* ballScene = R"(<scene version="3.0.0">
  <integrator type="aov"><string name="aovs" value="dd.y:depth,nn:sh_normal"/>
    <integrator type="path" name="my_image"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="30"/>
    <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="30"/>
      <string name="pixel_format" value="rgba"/><rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="24"/></sampler>
  </sensor>
  <emitter type="constant"><rgb name="radiance" value="0.5"/></emitter>
  <emitter type="point"><point name="position" x="2" y="3" z="-3"/><rgb name="intensity" value="20"/></emitter>
  <shape type="sphere" id="ball"><bsdf type="diffuse" id="paint"/></shape>
</scene>)";

class Pictures : public testing::Test {
 protected:
  Pictures() { folder_.write("ball.xml", ballScene); }

  Outcome run(const std::vector<std::string>& words, int expected = 0) {
    const Outcome outcome = folder_.run(words);
    EXPECT_EQ(outcome.code, expected) << outcome.err;
    return outcome;
  }
  image::ImageBuffer picture(const std::string& name) const { return folder_.picture(name); }

  ProgramFolder folder_;
};

const image::ImageLayer& layer(const image::ImageBuffer& picture, const std::string& name) {
  static const image::ImageLayer none;
  for (const image::ImageLayer& each : picture.layers) {
    if (each.name == name) return each;
  }
  ADD_FAILURE() << "no layer " << name;
  return none;
}

std::string note(const std::vector<image::Metadata>& metadata, const std::string& key) {
  for (const image::Metadata& entry : metadata) {
    if (entry.key == key) return std::get<std::string>(entry.value);
  }
  return {};
}

TEST_F(Pictures, HaveMitsubasChannels) {
  run({"render", "ball.xml", "-o", "a.exr", "-q"});
  const image::ImageBuffer a = picture("a.exr");
  EXPECT_EQ(layer(a, "dd.y").channels, (std::vector<std::string>{"dd.y.T"}));
  EXPECT_EQ(layer(a, "nn").channels.size(), 3u);
  const image::ImageLayer& mine = layer(a, "my_image");
  EXPECT_EQ(mine.channels, (std::vector<std::string>{"my_image.R", "my_image.G", "my_image.B", "my_image.A"}));
  EXPECT_EQ(mine.pixels, a.pixels);
  const std::size_t centre = 15 * 40 + 20;
  EXPECT_NEAR(layer(a, "dd.y").pixels[centre], 4, 0.05);
  EXPECT_EQ(layer(a, "dd.y").pixels[0], 0);
  // A picture without room for layers says so.
  EXPECT_THAT(run({"render", "ball.xml", "-o", "a.png", "--spp", "1", "-q"}).err,
              HasSubstr("no EXR file is written: the AOVs of the scene are lost"));
}

TEST_F(Pictures, AreMattesWithTheirNames) {
  run({"render", "ball.xml", "-o", "a.exr", "-q", "--aov", "crypto_object,crypto_material"});
  const image::ImageBuffer a = picture("a.exr");
  const image::ImageLayer& matte = layer(a, "CryptoObject00");
  EXPECT_EQ(note(matte.metadata, "cryptomatte/3ae39a5/name"), "CryptoObject");
  EXPECT_THAT(note(matte.metadata, "cryptomatte/3ae39a5/manifest"), HasSubstr("\"ball\":\""));
  EXPECT_EQ(matte.pixels[4 * (15 * 40 + 20) + 1], 1);
  EXPECT_EQ(matte.pixels[1], 0);
  EXPECT_THAT(note(layer(a, "CryptoMaterial02").metadata, "cryptomatte/" + std::string("3ae39a5") + "/name"),
              testing::IsEmpty());
}

TEST_F(Pictures, LoseTheirNoise) {
  // Which of two lamps is sampled makes noise.
  std::string scene = ballScene;
  scene.insert(scene.find("<shape"), R"(<emitter type="point"><point name="position" x="-3" y="-1" z="-4"/>
    <rgb name="intensity" value="15"/></emitter>)");
  folder_.write("lamps.xml", scene);
  run({"render", "lamps.xml", "-o", "noisy.exr", "-q", "--aov", "denoise"});
  run({"render", "lamps.xml", "-o", "clean.exr", "-q", "--spp", "1024"});
  const Outcome outcome = run({"denoise", "noisy.exr", "-o", "denoised.exr", "-o", "denoised.png"});
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, testing::MatchesRegex("wrote denoised.exr[^\n]*\nwrote denoised.png[^\n]*\n"));
  const image::ImageBuffer noisy = picture("noisy.exr"), clean = picture("clean.exr"),
                           denoised = picture("denoised.exr");
  ASSERT_EQ(denoised.pixels.size(), clean.pixels.size());
  // Of pixels that the ball fills: at its edge samples miss it or not, which features cannot tell either.
  double before = 0, after = 0;
  for (std::size_t i = 0; i < clean.pixels.size(); i += 4) {
    const double x = static_cast<double>(i / 4 % 40) - 19.5, y = static_cast<double>(i / 4 / 40) - 14.5;
    if (std::hypot(x, y) > 13) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      before += std::pow(static_cast<double>(noisy.pixels[i + c] - clean.pixels[i + c]), 2);
      after += std::pow(static_cast<double>(denoised.pixels[i + c] - clean.pixels[i + c]), 2);
    }
  }
  EXPECT_LT(after, before / 3);
  EXPECT_EQ(denoised.layers.size(), noisy.layers.size());
  EXPECT_FALSE(note(denoised.metadata, "aerosol:denoised").empty());
  EXPECT_THAT(run({"denoise", "clean.exr", "-o", "x.exr"}, 1).err, HasSubstr("render it with --aov denoise"));
  EXPECT_THAT(run({"denoise", "none.exr", "-o", "x.exr"}, 1).err, HasSubstr("none.exr"));
  EXPECT_FALSE(folder_.has("x.exr"));
}

TEST_F(Pictures, AreShownAsTheConfigSays) {
  const std::string config = AEROSOL_SOURCE_DIR "/core/image/aerosol.ocio";
  const std::vector<std::string> render = {"render", "ball.xml", "--spp", "4", "-q"};
  const auto rendered = [&](const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> words = render;
    words.insert(words.end(), {"-o", name});
    words.insert(words.end(), options.begin(), options.end());
    run(words);
    return picture(name).pixels;
  };
  const std::vector<float> plain = rendered("a.png", {});
  EXPECT_EQ(plain, rendered("b.png", {"--ocio", config, "--view", "sRGB"}));
  const std::vector<float> aces = rendered("c.png", {"--view", "ACES 1.0 SDR"});
  EXPECT_NE(plain, aces);
  EXPECT_EQ(aces, rendered("d.png", {"--ocio", config, "--display", "sRGB", "--view", "ACES 1.0 SDR"}));
  EXPECT_NE(plain, rendered("e.png", {"--exposure", "-2"}));
  std::vector<std::string> wrong = render;
  wrong.insert(wrong.end(), {"-o", "x.png", "--view", "Filmic"});
  EXPECT_THAT(run(wrong, 1).err, HasSubstr("has no view 'Filmic'"));
  EXPECT_FALSE(folder_.has("x.png"));
}

/// Also where no file shows how: the next one will.
TEST_F(Pictures, WhatIsAskedOfTheirDisplayHasToBeThere) {
  const auto refused = [&](const std::string& option, const std::string& value) {
    const std::string said = run({"render", "ball.xml", "--spp", "1", "-q", "-o", "y.exr", option, value}, 1).err;
    EXPECT_FALSE(folder_.has("y.exr")) << option;
    return said;
  };
  EXPECT_THAT(refused("--ocio", "nope.ocio"), HasSubstr("nope.ocio"));
  EXPECT_THAT(refused("--view", "Filmic"), HasSubstr("has no view 'Filmic'"));
  EXPECT_THAT(refused("--display", "paper"), HasSubstr("paper"));
  EXPECT_THAT(refused("--working-space", "foo"), HasSubstr("foo"));
  run({"render", "ball.xml", "--spp", "1", "-q", "-o", "z.exr", "--view", "Raw"});
  EXPECT_TRUE(folder_.has("z.exr"));
  EXPECT_FALSE(folder_.has("z.png"));
}

TEST_F(Pictures, NobodyLooks) {
  EXPECT_THAT(run({"render", "ball.xml", "-o", "a.exr", "--tev", "127.0.0.1:1"}, 1).err,
              HasSubstr("nobody answers at 127.0.0.1:1"));
}

}  // namespace
}  // namespace aerosol::test
