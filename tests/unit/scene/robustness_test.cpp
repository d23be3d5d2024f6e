// Damaged scenes: whatever is done to the text, reading ends with a scene or with located messages.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "tests/unit/scene/scene_test_support.h"

namespace aerosol::scene {
namespace {

std::string sound() {
  return wrap(R"(<default name="r" value="2"/>
  <integrator type="path"><integer name="max_depth" value="5"/></integrator>
  <sensor type="perspective">
    <transform name="to_world"><lookat origin="0 0 -5" target="0 0 0" up="0 1 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="64"/><rfilter type="box"/></film>
  </sensor>
  <medium type="fog" id="fog"><rgb name="albedo" value="0.9, 0.8, 0.7"/><phase type="hg"/></medium>
  <volume type="sphere"><float name="radius" value="$r"/><ref id="fog"/></volume>
  <shape type="cube"><ref name="interior" id="fog"/><bsdf type="null"/></shape>
  <emitter type="constant"><rgb name="radiance" value="#80ff00"/></emitter>)");
}

void expectSceneOrPlaces(const std::string& text) {
  Diagnostics warnings;
  const LoadOptions options{.defines = {}, .overrides = {"*.step_scale=2"}, .knownTypes = {}};
  const auto scene = loadString(text, "test.xml", {}, options, warnings);
  if (scene) return;
  ASSERT_TRUE(scene.errors().hasErrors());
  for (const Diagnostic& d : scene.errors().entries()) {
    EXPECT_GE(d.location.line, 1) << d.message << "\n" << text;
    EXPECT_GE(d.location.column, 1) << d.message;
    EXPECT_FALSE(d.message.empty());
  }
}

TEST(Robustness, TheSoundSceneIsRead) {
  Diagnostics warnings;
  const auto scene = loadString(sound(), "test.xml", {}, {}, warnings);
  EXPECT_TRUE(scene) << format(scene.errors());
}

TEST(Robustness, EveryTruncationIsAnError) {
  const std::string text = sound();
  for (std::size_t length = 0; length + 1 < text.size(); ++length) {
    Diagnostics warnings;
    const auto scene = loadString(text.substr(0, length), "test.xml", {}, {}, warnings);
    EXPECT_FALSE(scene) << length;
    expectSceneOrPlaces(text.substr(0, length));
  }
}

TEST(Robustness, EveryByteMayBeWrong) {
  const std::string text = sound();
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (const char c : {'<', '>', '"', '$', '#', '/', '\0', '\xff', '9', '-', '.', ' '}) {
      std::string damaged = text;
      damaged[i] = c;
      expectSceneOrPlaces(damaged);
    }
  }
}

TEST(Robustness, PiecesMayMove) {
  const std::string text = sound();
  std::mt19937 random(20240607);
  for (int i = 0; i < 3000; ++i) {
    std::string damaged = text;
    for (std::uint32_t edits = 1 + random() % 4; edits > 0; --edits) {
      const std::size_t from = random() % damaged.size();
      const std::size_t length = random() % 60;
      const std::string piece = damaged.substr(from, length);
      if (random() % 2 == 0) damaged.erase(from, length);
      if (damaged.empty()) damaged = "<";
      damaged.insert(random() % damaged.size(), piece);
    }
    expectSceneOrPlaces(damaged);
  }
}

TEST(Robustness, LongValuesAndManyElements) {
  expectSceneOrPlaces(wrap("<shape type=\"" + std::string(1 << 20, 'x') + "\"/>"));
  expectSceneOrPlaces(
      wrap("<shape type=\"sphere\"><float name=\"radius\" value=\"" + std::string(1 << 20, '1') + "\"/></shape>"));
  std::string many;
  for (int i = 0; i < 20000; ++i) many += "<shape type=\"cube\"/>\n";
  EXPECT_EQ(read(many).shapes.size(), 20000u);
}

}  // namespace
}  // namespace aerosol::scene
