#include "core/render/sampling_plan.h"

#include <gtest/gtest.h>

#include "core/scene/field.h"

namespace aerosol::render {
namespace {

using scene::DistanceSampling;
using scene::TransmittanceSampling;
using volume::DistanceMethod;
using volume::TransmittanceMethod;

TEST(SamplingPlanTest, ComesBackFromItsText) {
  SamplingPlan plan;
  for (std::size_t d = 0; d < scene::Words<DistanceSampling>::words.size(); ++d) {
    for (std::size_t t = 0; t < scene::Words<TransmittanceSampling>::words.size(); ++t) {
      SamplingChoice choice{"a: distance b, c", {}};
      choice.sampling.distance = static_cast<DistanceSampling>(d);
      choice.sampling.transmittance = static_cast<TransmittanceSampling>(t);
      choice.sampling.stepSize = 0.1f / static_cast<float>(1 + d + 7 * t);
      plan.push_back(choice);
    }
  }
  const auto back = parseSamplingPlan(toText(plan), "file");
  ASSERT_TRUE(back) << format(back.errors());
  EXPECT_EQ(*back, plan);
}

TEST(SamplingPlanTest, NamesWhatWasDecided) {
  volume::Medium medium;
  medium.method = DistanceMethod::nullScattering;
  medium.transmittance = TransmittanceMethod::ratioTracking;
  const auto distance = [&] { return *choiceOf("fog", medium, 0.5f).sampling.distance; };
  EXPECT_EQ(distance(), DistanceSampling::nullScattering);
  EXPECT_EQ(*choiceOf("fog", medium, 0.5f).sampling.transmittance, TransmittanceSampling::ratio);
  medium.relaxesBound = true;
  EXPECT_EQ(distance(), DistanceSampling::relaxed);
  medium.collisions = volume::Collisions::analogue;
  EXPECT_EQ(distance(), DistanceSampling::delta);
  medium.collisions = volume::Collisions::decomposed;
  EXPECT_EQ(distance(), DistanceSampling::decomposition);
  medium.collisions = volume::Collisions::listed;
  EXPECT_EQ(distance(), DistanceSampling::candidates);
  medium.method = DistanceMethod::analytic;
  medium.transmittance = TransmittanceMethod::analytic;
  EXPECT_EQ(distance(), DistanceSampling::analytic);
  // It follows from the distances.
  EXPECT_EQ(*choiceOf("fog", medium, 0.5f).sampling.transmittance, TransmittanceSampling::automatic);
  EXPECT_EQ(toText({choiceOf("fog", medium, 0.5f)}), "fog: distance analytic, transmittance auto, step 0.5\n");
}

TEST(SamplingPlanTest, LinesThatSayNothing) {
  for (const char* line :
       {"", "fog", "fog: distance null", "fog: distance nul, transmittance ratio, step 1",
        "fog: distance null, transmittance ratio, step 0", "fog: distance null, transmittance ratio, step 1x",
        "fog: distance null, transmittance ratio, step 1, more"}) {
    const auto plan =
        parseSamplingPlan(std::string("fog: distance null, transmittance ratio, step 1\n") + line + "\n", "p");
    ASSERT_FALSE(plan) << line;
    EXPECT_EQ(plan.errors().entries().front().location, (SourceLocation{"p", 2, 1}));
  }
}

TEST(SamplingPlanTest, IsForTheSceneItWasMadeOf) {
  const auto plan = parseSamplingPlan("a: distance null, transmittance ratio, step 1\n", "p");
  ASSERT_TRUE(plan);
  EXPECT_EQ(whyNotFor(*plan, {"a"}), "");
  EXPECT_NE(whyNotFor(*plan, {"b"}), "");
  EXPECT_NE(whyNotFor(*plan, {"a", "a"}), "");
}

}  // namespace
}  // namespace aerosol::render
