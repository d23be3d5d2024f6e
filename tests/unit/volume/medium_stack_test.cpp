#include "core/volume/medium_stack.h"

#include <gtest/gtest.h>

#include <map>

namespace aerosol::volume {
namespace {

Interior make(std::uint32_t object, std::optional<int> priority, float ior) {
  Interior interior;
  interior.object = object;
  interior.priority = priority;
  interior.ior = ior;
  return interior;
}

struct MediumStackTest : testing::Test {
  MediumStack stack;
  StackStatistics statistics;

  Crossing cross(const Interior& interior, bool entering) {
    const Crossing crossing = stack.judge(interior, entering);
    stack.cross(interior, entering, statistics);
    return crossing;
  }
};

TEST_F(MediumStackTest, waterInGlassRefractsBetweenTheTwo) {
  const Interior glass = make(1, 20, 1.5f), water = make(2, 10, 1.33f);
  // The water is modelled into the glass: glass wins.
  Crossing c = cross(glass, true);
  EXPECT_TRUE(c.isHit);
  EXPECT_EQ(c.iorBefore, 1);
  EXPECT_EQ(c.iorAfter, 1.5f);
  EXPECT_FALSE(cross(water, true).isHit);
  c = cross(glass, false);
  EXPECT_TRUE(c.isHit);
  EXPECT_EQ(c.iorBefore, 1.5f);
  EXPECT_EQ(c.iorAfter, 1.33f);
  c = cross(glass, true);
  EXPECT_EQ(c.iorBefore, 1.33f);
  EXPECT_EQ(c.iorAfter, 1.5f);
  EXPECT_FALSE(cross(water, false).isHit);
  c = cross(glass, false);
  EXPECT_EQ(c.iorAfter, 1);
  EXPECT_TRUE(stack.empty());
  EXPECT_EQ(statistics.rejectedHits, 2u);
}

TEST_F(MediumStackTest, lowerWinsWhereTheSceneSaysSo) {
  stack = MediumStack(PriorityOrder::lowerWins);
  cross(make(1, 20, 1.5f), true);
  const Crossing c = cross(make(2, 10, 1.33f), true);
  EXPECT_TRUE(c.isHit);
  EXPECT_EQ(c.iorAfter, 1.33f);
}

TEST_F(MediumStackTest, equalPrioritiesMergeUntilTheLastExit) {
  const Interior a = make(1, 5, 1.2f), b = make(2, 5, 1.4f);
  EXPECT_TRUE(cross(a, true).isHit);
  EXPECT_FALSE(cross(b, true).isHit);
  EXPECT_EQ(stack.ior(), 1.2f);
  EXPECT_FALSE(cross(a, false).isHit);
  EXPECT_EQ(stack.ior(), 1.2f);
  const Crossing c = cross(b, false);
  EXPECT_TRUE(c.isHit);
  EXPECT_EQ(c.iorBefore, 1.2f);
  EXPECT_EQ(c.iorAfter, 1);
}

TEST_F(MediumStackTest, offIsAlwaysHitAndSuppliesTheMediumWhereNothingElseDoes) {
  const Interior glass = make(1, 5, 1.5f), first = make(2, {}, 1.1f), second = make(3, {}, 1.2f);
  EXPECT_EQ(cross(first, true).iorAfter, 1.1f);
  EXPECT_EQ(cross(second, true).iorBefore, 1.1f);
  EXPECT_EQ(stack.ior(), 1.2f);
  Crossing c = cross(glass, true);
  EXPECT_TRUE(c.isHit);
  EXPECT_EQ(c.iorBefore, 1.2f);
  EXPECT_EQ(c.iorAfter, 1.5f);
  c = cross(second, false);
  EXPECT_TRUE(c.isHit);
  EXPECT_EQ(c.iorBefore, 1.5f);
  EXPECT_EQ(c.iorAfter, 1.5f);
  EXPECT_EQ(cross(glass, false).iorAfter, 1.1f);
}

TEST_F(MediumStackTest, countsWhatClosedSurfacesNeverDo) {
  const Interior glass = make(1, 5, 1.5f);
  Crossing c = cross(glass, false);
  EXPECT_TRUE(c.isHit);
  EXPECT_EQ(c.iorBefore, 1.5f);
  EXPECT_EQ(c.iorAfter, 1);
  EXPECT_TRUE(stack.empty());
  EXPECT_EQ(statistics.exitsWithoutEntry, 1u);
  EXPECT_TRUE(cross(glass, true).isHit);
  EXPECT_FALSE(cross(glass, true).isHit);
  EXPECT_EQ(statistics.repeatedEntries, 1u);
  EXPECT_FALSE(cross(glass, false).isHit);
  EXPECT_TRUE(cross(glass, false).isHit);
  EXPECT_TRUE(stack.empty());
}

TEST_F(MediumStackTest, aClippingMediumOfHighPriorityEmptiesWhatItCovers) {
  static Medium fog;
  Interior water = make(1, 1, 1.33f), clip = make(2, 100, 1);
  water.scene = &fog;
  cross(water, true);
  EXPECT_EQ(stack.medium(), &fog);
  const Crossing c = cross(clip, true);
  EXPECT_TRUE(c.isHit);
  EXPECT_EQ(c.iorBefore, 1.33f);
  EXPECT_EQ(c.iorAfter, 1);
  EXPECT_EQ(stack.medium(), nullptr);
}

TEST_F(MediumStackTest, holdsSixtyFourNestedInteriors) {
  for (int i = 0; i < 64; ++i) {
    EXPECT_TRUE(cross(make(static_cast<std::uint32_t>(i), i, 1 + 0.01f * static_cast<float>(i)), true).isHit);
  }
  for (int i = 63; i >= 0; --i) {
    EXPECT_FLOAT_EQ(stack.ior(), 1 + 0.01f * static_cast<float>(i));
    EXPECT_TRUE(cross(make(static_cast<std::uint32_t>(i), i, 1 + 0.01f * static_cast<float>(i)), false).isHit);
  }
  EXPECT_TRUE(stack.empty());
}

/// Any order of entering and leaving the same set of distinct priorities gives the same ruler, and hits join up: the
/// index behind one hit is the index before the next one.
TEST_F(MediumStackTest, indicesJoinUpAlongRandomLines) {
  std::uint64_t state = 12345;
  const auto random = [&](std::uint32_t n) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<std::uint32_t>((state >> 33) % n);
  };
  // Objects up to 2 are off.
  const auto priorityOf = [](std::uint32_t object) {
    return object <= 2 ? std::nullopt : std::optional<int>(static_cast<int>(object));
  };
  const auto iorOf = [](std::uint32_t object) { return 1.1f + 0.1f * static_cast<float>(object); };
  int offExits = 0;
  for (int line = 0; line < 2000; ++line) {
    stack.clear();
    std::vector<std::uint32_t> inside;  // In the order of entering.
    float last = 1;
    for (int step = 0; step < 40; ++step) {
      const std::uint32_t object = random(6);
      const auto at = std::ranges::find(inside, object);
      const bool entering = at == inside.end();
      const Crossing c = cross(make(object, priorityOf(object), iorOf(object)), entering);
      offExits += !entering && object <= 2 && at + 1 != inside.end();
      if (entering) {
        inside.push_back(object);
      } else {
        inside.erase(at);
      }
      EXPECT_TRUE(c.isHit || priorityOf(object));
      if (!c.isHit) continue;
      EXPECT_EQ(c.iorBefore, last);
      last = c.iorAfter;
      float expected = inside.empty() ? 1 : iorOf(inside.back());
      std::optional<int> strongest;
      for (const std::uint32_t other : inside) {
        const auto priority = priorityOf(other);
        if (!priority || priority < strongest) continue;
        strongest = priority;
        expected = iorOf(other);
      }
      if (strongest.has_value() || inside.empty() || priorityOf(inside.back()) == std::nullopt) {
        EXPECT_EQ(last, expected);
      }
      EXPECT_EQ(stack.ior(), last);
    }
  }
  EXPECT_GT(offExits, 1000);
}

}  // namespace
}  // namespace aerosol::volume
