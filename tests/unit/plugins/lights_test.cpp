#include <gtest/gtest.h>

#include <numbers>

#include "core/render/registry.h"
#include "plugins/registration.h"

namespace aerosol::render {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

class LightsTest : public ::testing::Test {
 protected:
  LightsTest() { registerPlugins(registry_); }
  std::unique_ptr<const Light> make(scene::EmitterType type, Color emitted, Vector<World> where = {}) {
    scene::Emitter emitter;
    emitter.type = type;
    emitter.emitted = emitted;
    emitter.position = Point<World>() + where;
    if (type == scene::EmitterType::directional) emitter.direction = where;
    std::shared_ptr<const LightSurface> surface;
    if (type == scene::EmitterType::area) surface = makeDiskLight({}, false);
    auto light = makeLight(registry_, emitter, surface);
    EXPECT_TRUE(light);
    return light ? std::move(*light) : nullptr;
  }

  Registry registry_;
};

TEST_F(LightsTest, PointLightFallsOffWithTheSquare) {
  const auto light = make(scene::EmitterType::point, {18, 9, 0}, {1, 2, 3});
  const auto s = light->sample({1, 2, 0}, {});
  ASSERT_TRUE(s);
  EXPECT_EQ(s->value, Color(2, 1, 0));
  EXPECT_EQ(s->direction, Vector<World>(0, 0, 1));
  EXPECT_EQ(s->distance, 3);
  EXPECT_EQ(s->point, Point<World>(1, 2, 3));
  EXPECT_TRUE(s->isDelta);
  EXPECT_FLOAT_EQ(light->power(1).r, 18 * 4 * pi);
}

TEST_F(LightsTest, APointLightDoesNotReachItself) {
  const auto light = make(scene::EmitterType::point, Color(1), {1, 2, 3});
  EXPECT_FALSE(light->sample({1, 2, 3}, {}));
}

TEST_F(LightsTest, DirectionalLightComesFromWhereItTravels) {
  const auto light = make(scene::EmitterType::directional, {5, 6, 7}, {0, -2, 0});
  const auto s = light->sample({100, 2, 3}, {});
  ASSERT_TRUE(s);
  EXPECT_EQ(s->direction, Vector<World>(0, 1, 0));
  EXPECT_EQ(s->value, Color(5, 6, 7));
  EXPECT_TRUE(s->isDelta && light->isInfinite() && std::isinf(s->distance));
  EXPECT_FLOAT_EQ(light->power(3).g, 6 * 9 * pi);
}

TEST_F(LightsTest, ConstantLightIsTheSameAllAround) {
  const auto light = make(scene::EmitterType::constant, {1, 2, 3});
  EXPECT_EQ(light->escaped({0, 1, 0}), Color(1, 2, 3));
  EXPECT_FLOAT_EQ(light->pdfEscaped({}, {0, 1, 0}), 1 / (4 * pi));
  EXPECT_FLOAT_EQ(light->power(2).r, 16 * pi * pi);
}

TEST_F(LightsTest, AreaLightShinesOnTheSideOfItsNormal) {
  const auto light = make(scene::EmitterType::area, {1, 2, 3});
  EXPECT_EQ(light->emitted({{}, {0, 0, 1}, {0, 0, -1}}), Color(1, 2, 3));
  EXPECT_EQ(light->emitted({{}, {0, 0, 1}, {0, 0, 1}}), Color());
  EXPECT_FLOAT_EQ(light->power(1).r, pi * pi);
  EXPECT_FALSE(light->sample({0, 0, -1}, {}));
  EXPECT_TRUE(light->sample({0, 0, 1}, {}));
}

std::string errorsOf(const Result<std::unique_ptr<const Light>>& light) { return light ? "" : format(light.errors()); }

TEST_F(LightsTest, WhatIsWrongIsSaidAtItsPlace) {
  const SourceLocation place{"scene.xml", 7, 3};
  const std::string unknownType = errorsOf(makeLight(registry_, "pont", {}, nullptr, place));
  EXPECT_NE(unknownType.find("scene.xml:7:3: error: there is no light of type 'pont'"), std::string::npos);
  EXPECT_NE(unknownType.find("did you mean 'point'"), std::string::npos);
  EXPECT_NE(unknownType.find("known are area, constant, directional, envmap, point, projector, spot, sunsky"),
            std::string::npos);
  const std::string unknownName = errorsOf(makeLight(registry_, "point", {{"intensty", Color(1)}}, nullptr, place));
  EXPECT_NE(unknownName.find("'intensty'"), std::string::npos);
  EXPECT_NE(unknownName.find("did you mean 'intensity'"), std::string::npos);
  const std::string wrongType =
      errorsOf(makeLight(registry_, "point", {{"intensity", std::string("red")}}, nullptr, place));
  EXPECT_NE(wrongType.find("'intensity' is a rgb, not a string"), std::string::npos);
  EXPECT_NE(errorsOf(makeLight(registry_, "area", {}, nullptr, place)).find("needs a shape"), std::string::npos);
  EXPECT_EQ(errorsOf(makeLight(registry_, "point", {{"intensity", 2.0f}}, nullptr, place)), "") << "a number is grey";
}

}  // namespace
}  // namespace aerosol::render
