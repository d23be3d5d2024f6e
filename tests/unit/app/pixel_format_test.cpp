#include "core/app/pixel_format.h"

#include <gtest/gtest.h>

namespace aerosol::app {
namespace {

image::ImageBuffer picture() {
  image::ImageBuffer picture;
  picture.width = 2;
  picture.height = 1;
  picture.channels = {"R", "G", "B", "A"};
  picture.pixels = {1, 1, 1, 0.5f, 0, 2, 0, 1};
  return picture;
}

TEST(PixelFormat, LuminanceIsTheSecondOfTheThreeValues) {
  const image::ImageBuffer grey = inFormat(picture(), scene::PixelFormat::luminanceAlpha);
  EXPECT_EQ(grey.channels, (std::vector<std::string>{"Y", "A"}));
  ASSERT_EQ(grey.pixels.size(), 4u);
  EXPECT_NEAR(grey.pixels[0], 1, 1e-6f);
  EXPECT_EQ(grey.pixels[1], 0.5f);
  EXPECT_NEAR(grey.pixels[2], 2 * 0.7152f, 1e-6f);
  EXPECT_EQ(inFormat(picture(), scene::PixelFormat::luminance).pixels.size(), 2u);
}

TEST(PixelFormat, WhiteIsThatOfD65) {
  const image::ImageBuffer xyz = inFormat(picture(), scene::PixelFormat::xyz);
  EXPECT_EQ(xyz.channels, (std::vector<std::string>{"X", "Y", "Z"}));
  ASSERT_EQ(xyz.pixels.size(), 6u);
  const float sum = xyz.pixels[0] + xyz.pixels[1] + xyz.pixels[2];
  EXPECT_NEAR(xyz.pixels[0] / sum, 0.3127f, 1e-4f);
  EXPECT_NEAR(xyz.pixels[1] / sum, 0.3290f, 1e-4f);
  const image::ImageBuffer withAlpha = inFormat(picture(), scene::PixelFormat::xyza);
  ASSERT_EQ(withAlpha.pixels.size(), 8u);
  EXPECT_EQ(withAlpha.pixels[3], 0.5f);
}

}  // namespace
}  // namespace aerosol::app
