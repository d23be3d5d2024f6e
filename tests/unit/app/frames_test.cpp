#include "core/app/frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aerosol::app {
namespace {

using testing::ElementsAre;

TEST(Frames, ReadsLists) {
  EXPECT_THAT(*parseFrames("7"), ElementsAre(7));
  EXPECT_THAT(*parseFrames("1-4"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(*parseFrames("1-10x4,2,9"), ElementsAre(1, 5, 9, 2));
  EXPECT_THAT(*parseFrames("-3--1"), ElementsAre(-3, -2, -1));
  EXPECT_EQ(parseFrames("1-1000000")->size(), 1000000u);
}

TEST(Frames, RefusesWhatIsNone) {
  for (const char* text :
       {"", "a", "1-", "1,", ",1", "3-1", "1-5x0", "1-5x-1", "1.5", "1 2", "1-9999999", "99999999999"}) {
    EXPECT_FALSE(parseFrames(text)) << text;
  }
}

TEST(Frames, PutsNumbersIntoNames) {
  EXPECT_EQ(nameOfFrame("a.%04d.exr", 12), "a.0012.exr");
  EXPECT_EQ(nameOfFrame("a%d.exr", -3), "a-3.exr");
  EXPECT_EQ(nameOfFrame("50%/a.%3d.png", 7), "50%/a.007.png");
  EXPECT_TRUE(hasFramePlace("a.%04d.exr"));
  EXPECT_FALSE(hasFramePlace("a.%04.exr"));
  EXPECT_FALSE(hasFramePlace("a.exr"));
}

}  // namespace
}  // namespace aerosol::app
