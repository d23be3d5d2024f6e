#include "core/app/picture.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/app/output_files.h"

namespace aerosol::app {
namespace {

/// A film of 2 x 2 pixels at (3, 1) of 6 x 4; pixel (x, y) has `x - 2` samples of the colour (x, y, 1).
std::unique_ptr<const render::Film> makeFilm() {
  const render::PixelRect area{3, 1, 5, 3};
  auto film = std::make_unique<render::Film>(area);
  render::FilmTile tile(area, 0, 2);
  for (int y = 1; y < 3; ++y) {
    for (int x = 3; x < 5; ++x) {
      for (int i = 0; i < x - 2; ++i) {
        tile.add(x, y, static_cast<std::uint32_t>(i), Color(static_cast<float>(x), static_cast<float>(y), 1), 0.5f);
      }
    }
  }
  film->commit(tile);
  return film;
}

scene::Film describedFilm(scene::PixelFormat format) {
  scene::Film described;
  described.width = 6;
  described.height = 4;
  described.cropOffsetX = 3;
  described.cropOffsetY = 1;
  described.cropWidth = described.cropHeight = 2;
  described.pixelFormat = format;
  return described;
}

TEST(Picture, HasTheCropWithinTheWholeFilm) {
  const auto film = makeFilm();
  const scene::Film described = describedFilm(scene::PixelFormat::rgba);
  EXPECT_EQ(cropOf(described), film->area());
  const image::ImageBuffer picture = makePicture(*film, described);
  EXPECT_EQ(picture.width, 2);
  EXPECT_EQ(picture.height, 2);
  EXPECT_EQ(picture.originX, 3);
  EXPECT_EQ(picture.originY, 1);
  EXPECT_EQ(picture.fullWidth, 6);
  EXPECT_EQ(picture.fullHeight, 4);
  EXPECT_EQ(picture.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
  EXPECT_EQ(picture.pixels, (std::vector<float>{3, 1, 1, 0.5f, 4, 1, 1, 0.5f, 3, 2, 1, 0.5f, 4, 2, 1, 0.5f}));
}

TEST(Picture, LeavesAlphaOutOfRgb) {
  const image::ImageBuffer picture = makePicture(*makeFilm(), describedFilm(scene::PixelFormat::rgb));
  EXPECT_EQ(picture.channels, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_EQ(picture.pixels, (std::vector<float>{3, 1, 1, 4, 1, 1, 3, 2, 1, 4, 2, 1}));
}

TEST(Picture, CountsSamples) {
  const SampleCounts counts = countSamples(*makeFilm());
  EXPECT_EQ(counts.total, 6u);
  EXPECT_EQ(counts.minimum, 1u);
  EXPECT_EQ(counts.maximum, 2u);
  EXPECT_EQ(counts.mean, 1.5);
}

TEST(OutputFiles, AreNamedAfterTheScene) {
  EXPECT_EQ(outputNames({}, "/some/where/my.cloud.xml"), (std::vector<std::string>{"my.cloud.png"}));
  EXPECT_EQ(outputNames({"a.exr"}, "cloud.xml"), (std::vector<std::string>{"a.exr"}));
}

TEST(OutputFiles, NeedAKnownExtension) {
  EXPECT_TRUE(checkOutputNames({"a.exr", "a.png", "b/a.JPG"}).empty());
  const Diagnostics errors = checkOutputNames({"a.exr", "a.gif", "a"});
  ASSERT_EQ(errors.errorCount(), 2);
  EXPECT_EQ(errors.entries()[0].location.file, "a.gif");
  EXPECT_EQ(errors.entries()[1].location.file, "a");
}

TEST(OutputFiles, AreNotGivenTwice) {
  EXPECT_EQ(checkOutputNames({"a.exr", "./a.exr"}).errorCount(), 1);
  EXPECT_EQ(checkOutputNames({"a.exr", "b/../a.exr"}).errorCount(), 1);
}

TEST(OutputFiles, NeedAFolder) {
  const Diagnostics errors = checkOutputPlaces({"/no/such/folder/a.exr"});
  ASSERT_EQ(errors.errorCount(), 1);
  EXPECT_EQ(errors.entries()[0].location.file, "/no/such/folder/a.exr");
}

}  // namespace
}  // namespace aerosol::app
