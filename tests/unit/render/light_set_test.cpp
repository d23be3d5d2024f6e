#include "core/render/light_set.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aerosol::render {
namespace {

class FakeLight final : public Light {
 public:
  explicit FakeLight(float power, bool isInfinite = false) : power_(power), isInfinite_(isInfinite) {}
  std::optional<LightSample> sample(Point<World>, const LightUniforms&) const override {
    return LightSample{.direction = {0, 0, 1}, .value = Color(power_), .pdf = 2, .point = {}, .normal = {}};
  }
  float pdf(Point<World>, const LightHit&) const override { return 2; }
  float pdfEscaped(Point<World>, Vector<World>) const override { return 3; }
  Color power(float sceneRadius) const override { return Color(isInfinite_ ? power_ * sceneRadius : power_); }
  float importance(Point<World> at) const override { return std::fabs(power_) / (isInfinite_ ? 1 : 1 + at.x * at.x); }
  bool isDelta() const override { return false; }
  bool isInfinite() const override { return isInfinite_; }

 private:
  float power_;
  bool isInfinite_;
};

LightSet makeSet(std::initializer_list<float> powers) {
  std::vector<std::unique_ptr<const Light>> lights;
  for (const float power : powers) lights.push_back(std::make_unique<FakeLight>(power));
  return {std::move(lights), 1};
}

TEST(LightSet, ASingleLightIsCertain) {
  const LightSet set = makeSet({0.01f});
  for (const float u : {0.0f, 0.5f, 0x1.fffffep-1f}) {
    ASSERT_TRUE(set.choose({}, u));
    EXPECT_EQ(set.choose({}, u)->index, 0u);
    EXPECT_EQ(set.choose({}, u)->probability, 1);
  }
}

TEST(LightSet, ImportanceWithAnEqualShare) {
  const LightSet set = makeSet({3, 0, -1});
  EXPECT_FLOAT_EQ(set.probability(0, {}), 0.9f * 0.75f + 0.05f);
  EXPECT_EQ(set.probability(1, {}), 0);
  EXPECT_FLOAT_EQ(set.probability(2, {}), 0.9f * 0.25f + 0.05f);
  EXPECT_EQ(set.choose({}, 0)->index, 0u);
  EXPECT_EQ(set.choose({}, 0.72f)->index, 0u);
  EXPECT_EQ(set.choose({}, 0.73f)->index, 2u);
  EXPECT_EQ(set.choose({}, 0x1.fffffep-1f)->index, 2u);
}

TEST(LightSet, LastLightsWithoutPowerAreNeverChosen) {
  const LightSet set = makeSet({1, 2, 0, 0});
  EXPECT_EQ(set.choose({}, 0x1.fffffep-1f)->index, 1u);
}

TEST(LightSet, DarkScenesHaveNothingToChoose) {
  EXPECT_FALSE(makeSet({}).choose({}, 0.5f));
  EXPECT_FALSE(makeSet({0, 0}).choose({}, 0.5f));
  EXPECT_FALSE(makeSet({0, 0}).sample({}, 0.5f, {}));
  EXPECT_EQ(makeSet({0}).probability(0, {}), 0);
  EXPECT_FALSE(LightSet().choose({}, 0.5f));
}

TEST(LightSet, PdfsContainTheChoice) {
  const LightSet set = makeSet({3, 1});
  const auto sample = set.sample({}, 0.1f, {});
  ASSERT_TRUE(sample);
  EXPECT_FLOAT_EQ(sample->pdf, 2 * set.probability(0, {}));
  EXPECT_FLOAT_EQ(set.pdf(1, {}, {}), 2 * set.probability(1, {}));
  EXPECT_FLOAT_EQ(set.pdfEscaped(1, {}, {}), 3 * set.probability(1, {}));
}

TEST(LightSet, TheChoiceDependsOnThePoint) {
  std::vector<std::unique_ptr<const Light>> lights;
  lights.push_back(std::make_unique<FakeLight>(1.0f, false));
  lights.push_back(std::make_unique<FakeLight>(1.0f, true));
  const LightSet set(std::move(lights), 1);
  EXPECT_FLOAT_EQ(set.probability(0, {}), 0.5f);
  EXPECT_FLOAT_EQ(set.probability(1, {3, 0, 0}), 0.9f * 10 / 11 + 0.05f);
  EXPECT_EQ(set.choose({3, 0, 0}, 0.2f)->index, 1u);
  ASSERT_EQ(set.infinite().size(), 1u);
  EXPECT_EQ(set.infinite()[0], 1u);
}

}  // namespace
}  // namespace aerosol::render
