// Image files: what is written is read back, displays get the right values, and nothing half-written is left behind.

#include "core/image/image.h"
#include "tests/support/scratch_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

namespace aerosol::image {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, removed afterwards; $OCIO unset.
class Image : public testing::Test {
 protected:
  void SetUp() override { unsetenv("OCIO"); }
  void TearDown() override { unsetenv("OCIO"); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t fileCount() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  test::ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
};

ImageBuffer picture(int width, int height, std::vector<std::string> channels) {
  ImageBuffer image;
  image.width = width;
  image.height = height;
  image.channels = std::move(channels);
  image.pixels.resize(static_cast<std::size_t>(width * height) * image.channels.size());
  return image;
}

/// Values over the whole range of floats, with the special ones.
void fillWithAnything(ImageBuffer& image) {
  std::uint32_t state = 1;
  for (float& value : image.pixels) {
    state = state * 1664525u + 1013904223u;
    value = std::bit_cast<float>(state);
    if (std::isnan(value)) value = std::numeric_limits<float>::infinity();
  }
  image.pixels[0] = -0.0f;
  image.pixels[1] = std::numeric_limits<float>::denorm_min();
  image.pixels[2] = std::numeric_limits<float>::quiet_NaN();
}

std::string messageOf(const Diagnostics& errors) { return format(errors); }

template <class T>
const T* find(const ImageBuffer& image, const std::string& key) {
  for (const Metadata& entry : image.metadata) {
    if (entry.key == key) return std::get_if<T>(&entry.value);
  }
  return nullptr;
}

TEST_F(Image, ExrKeepsEveryBitAndTheMetadata) {
  ImageBuffer image = picture(37, 21, {"R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B", "depth.Z"});
  fillWithAnything(image);
  image.metadata = {{"aerosol:samples", std::int32_t{64}},
                    {"aerosol:scene", std::string("first_light.xml, \"quoted\"\nsecond line")},
                    {"aerosol:seconds", 0.1}};
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    WriteOptions options;
    options.compression = compression;
    const auto report = writeImage(path("a.exr"), image, options);
    ASSERT_TRUE(report) << messageOf(report.errors());
    EXPECT_EQ(report->nonFinite, 0u);
    const auto back = readImage(path("a.exr"));
    ASSERT_TRUE(back) << messageOf(back.errors());
    EXPECT_EQ(back->width, 37);
    EXPECT_EQ(back->height, 21);
    EXPECT_EQ(back->channels, image.channels);
    ASSERT_EQ(back->pixels.size(), image.pixels.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      different += std::bit_cast<std::uint32_t>(back->pixels[i]) != std::bit_cast<std::uint32_t>(image.pixels[i]);
    }
    EXPECT_EQ(different, 0u) << compression;
    for (const Metadata& entry : image.metadata) {
      EXPECT_NE(std::ranges::find(back->metadata, entry), back->metadata.end()) << entry.key;
    }
  }
  EXPECT_EQ(fileCount(), 1u);
}

/// The time of writing is kept in the file, unless the image has one.
TEST_F(Image, TheSameImageGivesTheSameFile) {
  ImageBuffer image = picture(40, 30, {"R", "G", "B"});
  image.metadata.push_back({"DateTime", std::string("2020:01:02 03:04:05")});
  fillWithAnything(image);
  std::string content[2];
  for (std::string& bytes : content) {
    ASSERT_TRUE(writeImage(path("a.exr"), image));
    std::ifstream file(path("a.exr"), std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
  }
  EXPECT_NE(content[0].find("2020:01:02 03:04:05"), std::string::npos);
  EXPECT_EQ(content[0], content[1]);
}

TEST_F(Image, ExrRemembersTheCrop) {
  ImageBuffer image = picture(4, 3, {"R", "G", "B"});
  image.originX = 10;
  image.originY = 20;
  image.fullWidth = 64;
  image.fullHeight = 48;
  ASSERT_TRUE(writeImage(path("crop.exr"), image));
  const auto back = readImage(path("crop.exr"));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->originX, 10);
  EXPECT_EQ(back->originY, 20);
  EXPECT_EQ(back->fullWidth, 64);
  EXPECT_EQ(back->fullHeight, 48);
}

TEST_F(Image, HalfRoundsAndSaturates) {
  ImageBuffer image = picture(4, 1, {"Y"});
  image.pixels = {1 + 0x1p-11f + 0x1p-20f, 1e6f, -1e30f, std::numeric_limits<float>::infinity()};
  WriteOptions options;
  options.pixelType = PixelType::float16;
  ASSERT_TRUE(writeImage(path("half.exr"), image, options));
  const auto back = readImage(path("half.exr"));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->pixels, (std::vector<float>{1 + 0x1p-10f, 65504, -65504, std::numeric_limits<float>::infinity()}));
}

double srgbEncode(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

TEST_F(Image, PngIsSrgb) {
  for (const auto type : {PixelType::uint8, PixelType::uint16}) {
    ImageBuffer image = picture(1024, 1, {"R", "G", "B"});
    for (std::size_t x = 0; x < 1024; ++x) {
      const float value = static_cast<float>(std::pow(static_cast<double>(x) / 1023, 3));
      image.pixels[3 * x] = value;
      image.pixels[3 * x + 1] = 2 * value;
      image.pixels[3 * x + 2] = value - 0.5f;
    }
    WriteOptions options;
    options.pixelType = type;
    const auto report = writeImage(path("ramp.png"), image, options);
    ASSERT_TRUE(report) << messageOf(report.errors());
    const auto back = readImage(path("ramp.png"));
    ASSERT_TRUE(back);
    ASSERT_EQ(back->pixels.size(), image.pixels.size());
    const double levels = type == PixelType::uint8 ? 255 : 65535;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      const double expected = srgbEncode(std::clamp(static_cast<double>(image.pixels[i]), 0.0, 1.0)) * levels;
      EXPECT_NEAR(static_cast<double>(back->pixels[i]) * levels, expected, type == PixelType::uint8 ? 0.51 : 2.0);
    }
  }
}

TEST_F(Image, ExposureDoublesTheLight) {
  ImageBuffer image = picture(1, 1, {"R", "G", "B"});
  image.pixels = {0.05f, 0.1f, 0.2f};
  WriteOptions options;
  options.pixelType = PixelType::uint16;
  options.display.exposure = 2;
  ASSERT_TRUE(writeImage(path("a.png"), image, options));
  const auto back = readImage(path("a.png"));
  ASSERT_TRUE(back);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(back->pixels[i], srgbEncode(4 * static_cast<double>(image.pixels[i])), 3e-5);
}

TEST_F(Image, AlphaIsKeptInPngAndLeftOutOfJpeg) {
  ImageBuffer image = picture(2, 1, {"R", "G", "B", "A"});
  image.pixels = {0.25f, 0.125f, 0, 0.5f, 0.5f, 0.5f, 0.5f, 0};
  ASSERT_TRUE(writeImage(path("a.png"), image));
  const auto png = readImage(path("a.png"));
  ASSERT_TRUE(png);
  ASSERT_EQ(png->channels.size(), 4u);
  EXPECT_NEAR(png->pixels[0], srgbEncode(0.5), 0.002);  // divided by alpha
  EXPECT_NEAR(png->pixels[1], srgbEncode(0.25), 0.002);
  EXPECT_NEAR(png->pixels[3], 0.5, 0.002);
  EXPECT_EQ(png->pixels[7], 0);
  ASSERT_TRUE(writeImage(path("a.jpg"), image));
  const auto jpeg = readImage(path("a.jpg"));
  ASSERT_TRUE(jpeg);
  EXPECT_EQ(jpeg->channels.size(), 3u);
}

TEST_F(Image, ChannelsAreFoundByNameAndGreyStaysGrey) {
  ImageBuffer image = picture(1, 1, {"depth.Z", "B", "G", "R"});
  image.pixels = {7, 0, 0.25f, 1};
  ASSERT_TRUE(writeImage(path("a.png"), image));
  auto back = readImage(path("a.png"));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->channels, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_EQ(back->pixels[0], 1);
  EXPECT_EQ(back->pixels[2], 0);
  image = picture(1, 1, {"Y"});
  image.pixels = {1};
  ASSERT_TRUE(writeImage(path("a.png"), image));
  back = readImage(path("a.png"));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->channels.size(), 1u);
  image = picture(1, 1, {"depth.Z"});
  const auto none = writeImage(path("b.png"), image);
  ASSERT_FALSE(none);
  EXPECT_NE(messageOf(none.errors()).find("R, G and B"), std::string::npos);
  EXPECT_EQ(fileCount(), 1u);
}

TEST_F(Image, NonFiniteValuesAreShownAndCounted) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const char* view : {"sRGB", "ACES 1.0 SDR"}) {
    ImageBuffer image = picture(3, 1, {"R", "G", "B"});
    image.pixels = {std::nanf(""), 0, 0, infinity, infinity, infinity, -infinity, 0, 3e38f};
    WriteOptions options;
    options.display.view = view;
    options.display.exposure = 3;
    const auto report = writeImage(path("a.png"), image, options);
    ASSERT_TRUE(report) << messageOf(report.errors());
    EXPECT_EQ(report->nonFinite, 5u);
    const auto back = readImage(path("a.png"));
    ASSERT_TRUE(back);
    EXPECT_LT(back->pixels[0], 0.02f);
    for (std::size_t i = 3; i < 6; ++i) EXPECT_GT(back->pixels[i], 0.98f) << view;
  }
}

TEST_F(Image, AcesViewMapsGreyAndWhiteAsPublished) {
  // The ACES 1.0 SDR output transform shows scene grey 0.18 at 0.10 of the display's white, and keeps neutrals neutral.
  ImageBuffer image = picture(2, 1, {"R", "G", "B"});
  image.pixels = {0.18f, 0.18f, 0.18f, 16.0f, 16.0f, 16.0f};
  WriteOptions options;
  options.pixelType = PixelType::uint16;
  options.display.view = "ACES 1.0 SDR";
  ASSERT_TRUE(writeImage(path("a.png"), image, options));
  const auto back = readImage(path("a.png"));
  ASSERT_TRUE(back);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(back->pixels[i], srgbEncode(0.1), 0.01);
    EXPECT_NEAR(back->pixels[3 + i], 1, 0.01);
  }
}

TEST_F(Image, WorkingSpaceIsRespected) {
  // Pure Rec.709 red in ACEScg components comes out as display red.
  ImageBuffer image = picture(1, 1, {"R", "G", "B"});
  image.pixels = {0.61309732f, 0.07019422f, 0.02061560f};
  WriteOptions options;
  options.display.workingSpace = "ACEScg";
  ASSERT_TRUE(writeImage(path("a.png"), image, options));
  const auto back = readImage(path("a.png"));
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->pixels[0], 1, 0.005);
  EXPECT_NEAR(back->pixels[1], 0, 0.02);
  EXPECT_NEAR(back->pixels[2], 0, 0.02);
}

constexpr const char* testConfig = R"(ocio_profile_version: 1
roles:
  default: linear
  scene_linear: linear
displays:
  Test:
    - !<View> {name: Inverted, colorspace: inverted}
    - !<View> {name: Plain, colorspace: linear}
colorspaces:
  - !<ColorSpace>
    name: linear
  - !<ColorSpace>
    name: inverted
    from_reference: !<MatrixTransform> {matrix: [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1], offset: [1, 1, 1, 0]}
)";

/// The file that other programs are given says what the built-in config says.
TEST_F(Image, ShippedConfigIsTheBuiltInOne) {
  ImageBuffer image = picture(4, 1, {"R", "G", "B"});
  image.pixels = {0.18f, 0.3f, 0.1f, 1, 0, 0, 4, 5, 6, 0.001f, 0, 0.02f};
  for (const char* space : {"lin_rec709", "ACEScg"}) {
    for (const char* view : {"sRGB", "ACES 1.0 SDR", "Raw"}) {
      WriteOptions options;
      options.pixelType = PixelType::uint16;
      options.display.view = view;
      options.display.workingSpace = space;
      ASSERT_TRUE(writeImage(path("a.png"), image, options));
      options.display.config = AEROSOL_SOURCE_DIR "/core/image/aerosol.ocio";
      const auto report = writeImage(path("b.png"), image, options);
      ASSERT_TRUE(report) << messageOf(report.errors());
      EXPECT_EQ(readImage(path("a.png"))->pixels, readImage(path("b.png"))->pixels) << space << ' ' << view;
    }
  }
}

/// Layers keep their names, their precision and their notes; the picture may have less.
TEST_F(Image, LayersArePartsOfTheFile) {
  ImageBuffer image = picture(2, 1, {"R", "G", "B"});
  image.layers.push_back({"direct", {"direct.R", "direct.G", "direct.B"}, {1.0001f, 2, 1e6f, 3, 4, 5}, false, {}});
  image.layers.push_back({"depth", {"depth.T"}, {1.00001f, 1e7f}, true, {{"about", std::string("metres")}}});
  image.attachment = "bytes";
  WriteOptions options;
  options.pixelType = PixelType::float16;
  ASSERT_TRUE(writeImage(path("a.exr"), image, options));
  const auto back = readImage(path("a.exr"));
  ASSERT_TRUE(back) << messageOf(back.errors());
  EXPECT_EQ(back->channels, image.channels);
  EXPECT_EQ(back->attachment, "bytes");
  ASSERT_EQ(back->layers.size(), 2u);
  EXPECT_EQ(back->layers[0].name, "direct");
  EXPECT_EQ(back->layers[0].channels, image.layers[0].channels);
  EXPECT_EQ(back->layers[0].pixels, (std::vector<float>{1, 2, 65504, 3, 4, 5}));
  EXPECT_EQ(back->layers[1].pixels, image.layers[1].pixels);
  bool isNoted = false;
  for (const Metadata& entry : back->layers[1].metadata) isNoted = isNoted || entry == image.layers[1].metadata[0];
  EXPECT_TRUE(isNoted);
  image.layers[0].pixels.pop_back();
  EXPECT_FALSE(writeImage(path("b.exr"), image));
}

TEST_F(Image, OwnConfigIsUsedFromOptionOrEnvironment) {
  std::ofstream(path("config.ocio")) << testConfig;
  ImageBuffer image = picture(1, 1, {"R", "G", "B"});
  image.pixels = {0.2f, 0.4f, 1};
  WriteOptions options;
  for (const bool fromEnvironment : {false, true}) {
    options.display.config = fromEnvironment ? "" : path("config.ocio");
    if (fromEnvironment) setenv("OCIO", path("config.ocio").c_str(), 1);
    const auto report = writeImage(path("a.png"), image, options);
    ASSERT_TRUE(report) << messageOf(report.errors());
    const auto back = readImage(path("a.png"));
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->pixels[0], 0.8, 0.003);
    EXPECT_NEAR(back->pixels[2], 0, 0.003);
  }
  unsetenv("OCIO");
  options.display = {};
  options.display.view = "Filmic";
  auto failed = writeImage(path("b.png"), image, options);
  ASSERT_FALSE(failed);
  EXPECT_NE(messageOf(failed.errors()).find("no view 'Filmic'; it has 'sRGB', 'ACES 1.0 SDR', 'Raw'"),
            std::string::npos)
      << messageOf(failed.errors());
  options.display = {};
  options.display.display = "Projector";
  failed = writeImage(path("b.png"), image, options);
  ASSERT_FALSE(failed);
  EXPECT_NE(messageOf(failed.errors()).find("no display 'Projector'; it has 'sRGB'"), std::string::npos);
  options.display = {};
  options.display.workingSpace = "lin_p3";
  failed = writeImage(path("b.png"), image, options);
  ASSERT_FALSE(failed);
  EXPECT_NE(messageOf(failed.errors()).find("'lin_p3'; it has 'lin_rec709', 'ACEScg'"), std::string::npos);
  options.display = {};
  options.display.config = path("none.ocio");
  failed = writeImage(path("b.png"), image, options);
  ASSERT_FALSE(failed);
  EXPECT_NE(messageOf(failed.errors()).find("none.ocio"), std::string::npos);
  EXPECT_EQ(fileCount(), 2u);
}

TEST_F(Image, PngKeepsMetadataAsText) {
  ImageBuffer image = picture(1, 1, {"R", "G", "B"});
  image.metadata = {{"aerosol:samples", std::int32_t{16}}, {"aerosol:seconds", 0.5}};
  ASSERT_TRUE(writeImage(path("a.png"), image));
  const auto back = readImage(path("a.png"));
  ASSERT_TRUE(back);
  ASSERT_NE(find<std::string>(*back, "aerosol:samples"), nullptr);
  EXPECT_EQ(*find<std::string>(*back, "aerosol:samples"), "16");
  ASSERT_NE(find<std::string>(*back, "aerosol:seconds"), nullptr);
  EXPECT_EQ(*find<std::string>(*back, "aerosol:seconds"), "0.5");
}

TEST_F(Image, MistakesAreNamedAndLeaveNoFile) {
  const ImageBuffer image = picture(2, 2, {"R", "G", "B"});
  const auto expect = [&](const std::string& name, const std::string& part, const WriteOptions& options = {}) {
    const auto failed = writeImage(name, image, options);
    ASSERT_FALSE(failed) << name;
    EXPECT_EQ(failed.errors().entries()[0].location.file, name);
    EXPECT_NE(messageOf(failed.errors()).find(part), std::string::npos) << messageOf(failed.errors());
    EXPECT_EQ(fileCount(), 0u);
  };
  expect(path("missing/a.exr"), "No such file or directory");
  expect("/proc/aerosol.exr", "cannot write in the folder '/proc'");
  expect(path("a.xyz"), "cannot write .xyz files");
  expect(path("a"), "no extension");
  WriteOptions options;
  options.pixelType = PixelType::uint8;
  expect(path("a.exr"), "type of pixel", options);
  options.pixelType = PixelType::float32;
  expect(path("a.png"), "type of pixel", options);
  options = {};
  options.compression = "lzma";
  expect(path("a.exr"), "'lzma' is not a compression", options);
  options = {};
  options.jpegQuality = 0;
  expect(path("a.jpg"), "quality", options);
  ImageBuffer damaged = image;
  damaged.pixels.pop_back();
  EXPECT_FALSE(writeImage(path("a.exr"), damaged));
  EXPECT_FALSE(writeImage(path("a.exr"), ImageBuffer()));
  EXPECT_EQ(fileCount(), 0u);
}

TEST_F(Image, AFailedWriteKeepsTheOldFile) {
  ImageBuffer image = picture(2, 2, {"R", "G", "B"});
  ASSERT_TRUE(writeImage(path("a.png"), image));
  const auto size = fs::file_size(path("a.png"));
  WriteOptions options;
  options.display.view = "no such view";
  EXPECT_FALSE(writeImage(path("a.png"), picture(50, 50, {"R", "G", "B"}), options));
  EXPECT_EQ(fs::file_size(path("a.png")), size);
  EXPECT_EQ(fileCount(), 1u);
  fs::create_directory(path("folder.exr"));
  const auto failed = writeImage(path("folder.exr"), image);
  ASSERT_FALSE(failed);
  EXPECT_NE(messageOf(failed.errors()).find("not a regular file"), std::string::npos);
  EXPECT_EQ(fileCount(), 2u);
}

/// Root may write anywhere, so it is somebody else for a while.
class WithoutRoot {
 public:
  WithoutRoot() {
    if (isRoot_) EXPECT_EQ(seteuid(65534), 0);
  }
  ~WithoutRoot() {
    if (isRoot_) EXPECT_EQ(seteuid(0), 0);
  }
  WithoutRoot(const WithoutRoot&) = delete;
  WithoutRoot& operator=(const WithoutRoot&) = delete;

 private:
  bool isRoot_ = geteuid() == 0;
};

TEST_F(Image, ReadOnlyFoldersAndFilesAreRefused) {
  const ImageBuffer image = picture(2, 2, {"R", "G", "B"});
  ASSERT_TRUE(writeImage(path("a.exr"), image));
  fs::permissions(path("a.exr"), fs::perms::owner_read | fs::perms::others_read);
  fs::permissions(folder_, fs::perms::all);
  const auto refusal = [&](const char* name) {
    const WithoutRoot guard;
    const auto failed = writeImage(path(name), image);
    return failed ? std::string("it was written") : messageOf(failed.errors());
  };
  EXPECT_NE(refusal("a.exr").find("cannot replace this file: Permission denied"), std::string::npos);
  EXPECT_EQ(refusal("b.exr"), "it was written");
  fs::permissions(folder_,
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  EXPECT_NE(refusal("c.exr").find("cannot write in the folder"), std::string::npos);
  EXPECT_NE(refusal("c.exr").find("Permission denied"), std::string::npos);
  EXPECT_EQ(fileCount(), 2u);
}

TEST_F(Image, LinksAndPermissionsStay) {
  const ImageBuffer image = picture(2, 2, {"R", "G", "B"});
  ASSERT_TRUE(writeImage(path("real.exr"), image));
  fs::permissions(path("real.exr"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("real.exr", path("link.exr"));
  ASSERT_TRUE(writeImage(path("link.exr"), picture(3, 3, {"R", "G", "B"})));
  EXPECT_TRUE(fs::is_symlink(path("link.exr")));
  const auto back = readImage(path("real.exr"));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->width, 3);
  EXPECT_EQ(fs::status(path("real.exr")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(Image, UnreadableFilesAreErrors) {
  EXPECT_FALSE(readImage(path("none.exr")));
  std::ofstream(path("text.exr")) << "this is no picture";
  const auto failed = readImage(path("text.exr"));
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.errors().entries()[0].location.file, path("text.exr"));
  const ImageBuffer image = picture(200, 200, {"R", "G", "B"});
  ASSERT_TRUE(writeImage(path("cut.exr"), image));
  fs::resize_file(path("cut.exr"), fs::file_size(path("cut.exr")) / 2);
  EXPECT_FALSE(readImage(path("cut.exr")));
}

TEST_F(Image, LibrariesTellTheirVersions) {
  const auto versions = libraryVersions();
  ASSERT_TRUE(versions) << messageOf(versions.errors());
  ASSERT_EQ(versions->size(), 3u);
  EXPECT_TRUE((*versions)[0].starts_with("OpenImageIO 2.")) << (*versions)[0];
  EXPECT_TRUE((*versions)[1].starts_with("OpenColorIO 2.")) << (*versions)[1];
  EXPECT_TRUE((*versions)[2].starts_with("OpenEXR 3.")) << (*versions)[2];
}

}  // namespace
}  // namespace aerosol::image
