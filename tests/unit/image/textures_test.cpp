#include "core/image/textures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "core/image/image.h"
#include "tests/support/scratch_folder.h"

namespace aerosol::image {

namespace {

namespace fs = std::filesystem;

class Textures : public testing::Test {
 protected:
  void SetUp() override { open({}); }
  void TearDown() override {
    session_.reset();
    source_.reset();
  }

  void open(const TextureSettings& settings) {
    session_.reset();
    auto source = openTextures(settings);
    ASSERT_TRUE(source) << format(source.errors());
    source_ = std::move(*source);
    session_ = source_->openSession();
  }

  /// An image of floats whose channel c at texel (x, y) is value(x, y, c).
  template <class Value>
  std::string write(const std::string& name, int width, int height, std::vector<std::string> channels, Value&& value) {
    ImageBuffer image;
    image.width = width;
    image.height = height;
    image.channels = std::move(channels);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (std::size_t c = 0; c < image.channels.size(); ++c)
          image.pixels.push_back(value(x, y, static_cast<int>(c)));
    WriteOptions options;
    options.pixelType = PixelType::float32;
    const std::string path = (folder_ / name).string();
    const auto report = writeImage(path, image, options);
    EXPECT_TRUE(report) << format(report.errors());
    return path;
  }

  std::vector<float> look(const std::string& file, const TexturePoint& point, int channels,
                          TextureKind kind = TextureKind::plane) {
    std::vector<float> result(static_cast<std::size_t>(channels));
    failures_.clear();
    session_->lookup(kind, file, {&point, 1}, channels, result.data(), failures_);
    return result;
  }

  static TexturePoint at(float s, float t, TextureInterpolation interpolation = TextureInterpolation::closest) {
    TexturePoint point;
    point.at[0] = s;
    point.at[1] = t;
    point.interpolation = interpolation;
    return point;
  }

  test::ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
  std::unique_ptr<TextureSource> source_;
  std::unique_ptr<TextureSession> session_;
  std::vector<TextureFailure> failures_;
};

float texelValue(int x, int y, int c) { return static_cast<float>(x + 100 * y) + 0.25f * static_cast<float>(c); }

TEST_F(Textures, ClosestReadsTexels) {
  const auto file = write("a.exr", 8, 4, {"R", "G", "B"}, texelValue);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      const auto value = look(file, at((static_cast<float>(x) + 0.5f) / 8, (static_cast<float>(y) + 0.5f) / 4), 3);
      for (int c = 0; c < 3; ++c) EXPECT_EQ(value[static_cast<std::size_t>(c)], texelValue(x, y, c));
    }
  }
  EXPECT_TRUE(failures_.empty());
}

TEST_F(Textures, LinearInterpolatesBetweenTexels) {
  const auto file = write("a.exr", 8, 4, {"Y"}, texelValue);
  // Texel centres are at (x + 0.5) / 8: s = 0.25 lies in the middle between texels 1 and 2.
  const float t = 1.5f / 4;
  EXPECT_FLOAT_EQ(look(file, at(0.25f, t, TextureInterpolation::linear), 1)[0], 101.5f);
  EXPECT_FLOAT_EQ(look(file, at(1.75f / 8, t, TextureInterpolation::linear), 1)[0], 101.25f);
}

TEST_F(Textures, ColorSpacesAreConvertedBeforeTexelsAreFiltered) {
  const auto decode = [](double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); };
  const auto file = write("encoded.exr", 4, 4, {"R", "G", "B", "A"}, [](int x, int, int c) {
    const float alpha = x < 2 ? 1.0f : 0.5f;
    return c == 3 ? alpha : alpha * (x % 2 == 0 ? 0.2f : 0.8f);
  });
  TexturePoint texel = at(0.125f, 0.125f);
  texel.colorSpace = "sRGB";
  EXPECT_NEAR(look(file, texel, 3)[1], decode(0.2), 1e-6);
  TexturePoint between = at(0.25f, 0.375f, TextureInterpolation::linear);
  between.colorSpace = "sRGB";
  EXPECT_NEAR(look(file, between, 3)[2], (decode(0.2) + decode(0.8)) / 2, 1e-6);
  // Colours are not multiplied by alpha while they are converted, and alpha is no colour.
  TexturePoint thin = at(0.875f, 0.375f);
  thin.colorSpace = "sRGB";
  EXPECT_NEAR(look(file, thin, 4)[0], 0.5 * decode(0.8), 1e-6);
  EXPECT_EQ(look(file, thin, 4)[3], 0.5f);
  // The same file as it is, beside that; and its range where it is converted.
  EXPECT_NEAR(look(file, at(0.125f, 0.125f), 3)[1], 0.2f, 1e-7);
  const auto range = session_->range(file, "sRGB");
  ASSERT_TRUE(range.has_value());
  EXPECT_NEAR(range->greatest[0], decode(0.8), 1e-5);
  EXPECT_TRUE(failures_.empty());
  // "rgb" is the space of the render; a name that nobody knows is a failure that says so.
  TexturePoint linear = at(0.125f, 0.125f);
  linear.colorSpace = "rgb";
  EXPECT_NEAR(look(file, linear, 3)[0], 0.2f, 1e-7);
  linear.colorSpace = "no such space";
  look(file, linear, 3);
  ASSERT_EQ(failures_.size(), 1u);
  EXPECT_NE(failures_[0].message.find("unknown colour space \"no such space\""), std::string::npos)
      << failures_[0].message;
}

TEST_F(Textures, WrapModes) {
  const auto file = write("a.exr", 4, 4, {"Y"}, [](int x, int y, int) { return static_cast<float>(1 + x + 10 * y); });
  const auto wrapped = [&](float s, TextureWrap wrap) {
    TexturePoint point = at(s, 0.125f);
    point.wrap[0] = wrap;
    point.wrap[1] = TextureWrap::clamp;
    return look(file, point, 1)[0];
  };
  // Texel 0 to 3 of the first row hold 1 to 4.
  EXPECT_EQ(wrapped(1.375f, TextureWrap::periodic), 2);
  EXPECT_EQ(wrapped(-0.125f, TextureWrap::periodic), 4);
  EXPECT_EQ(wrapped(1.375f, TextureWrap::clamp), 4);
  EXPECT_EQ(wrapped(-3.0f, TextureWrap::clamp), 1);
  EXPECT_EQ(wrapped(1.375f, TextureWrap::mirror), 3);
  EXPECT_EQ(wrapped(-0.125f, TextureWrap::mirror), 1);
  EXPECT_EQ(wrapped(1.375f, TextureWrap::black), 0);
  EXPECT_EQ(wrapped(0.375f, TextureWrap::black), 2);
  // Far away the side and the phase are kept, as far as a float has one.
  EXPECT_EQ(wrapped(1e30f, TextureWrap::clamp), 4);
  EXPECT_EQ(wrapped(-1e30f, TextureWrap::clamp), 1);
  EXPECT_EQ(wrapped(std::numeric_limits<float>::infinity(), TextureWrap::black), 0);
  EXPECT_EQ(wrapped(65537.375f, TextureWrap::periodic), 2);
  EXPECT_TRUE(std::isfinite(wrapped(std::numeric_limits<float>::quiet_NaN(), TextureWrap::periodic)));
}

TEST_F(Textures, DerivativesChooseTheLevel) {
  // A checkerboard of single texels: level 0 alternates, every other level is the mean.
  const auto file = write("c.exr", 64, 64, {"Y"}, [](int x, int y, int) { return (x + y) % 2 ? 1.0f : 0.0f; });
  TexturePoint sharp = at(0.5f / 64, 0.5f / 64);
  EXPECT_EQ(look(file, sharp, 1)[0], 0);
  TexturePoint wide = at(0.3f, 0.3f, TextureInterpolation::linear);
  wide.dx[0] = wide.dy[1] = 16.0f / 64;
  EXPECT_NEAR(look(file, wide, 1)[0], 0.5, 1e-3);
  wide.width[0] = wide.width[1] = 0;  // No filter after all.
  wide.at[0] = wide.at[1] = 0.5f / 64;
  EXPECT_NEAR(look(file, wide, 1)[0], 0, 1e-6);
  TexturePoint blurred = at(32.5f / 64, 32.5f / 64, TextureInterpolation::linear);
  blurred.blur[0] = blurred.blur[1] = 0.25f;
  EXPECT_NEAR(look(file, blurred, 1)[0], 0.5, 1e-3);
}

TEST_F(Textures, ConstantStaysConstantUnderAnyFilter) {
  const auto file = write("k.exr", 32, 16, {"R", "G", "B"}, [](int, int, int c) { return static_cast<float>(c + 1); });
  for (const auto interpolation : {TextureInterpolation::closest, TextureInterpolation::linear,
                                   TextureInterpolation::cubic, TextureInterpolation::smartCubic}) {
    TexturePoint point = at(0.37f, 0.61f, interpolation);
    point.dx[0] = 0.1f;
    point.dy[1] = 0.02f;
    const auto value = look(file, point, 3);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[static_cast<std::size_t>(c)], c + 1, 1e-5 * (c + 1));
  }
}

TEST_F(Textures, ChannelsAndFill) {
  const auto file = write("a.exr", 4, 4, {"R", "G", "B"}, texelValue);
  TexturePoint point = at(0.125f, 0.125f);
  point.firstChannel = 1;
  point.fill = 7;
  const auto value = look(file, point, 4);
  EXPECT_EQ(value, (std::vector<float>{0.25f, 0.5f, 7, 7}));
  EXPECT_TRUE(failures_.empty());
}

TEST_F(Textures, ChannelsAndSubimagesThatAFileDoesNotHave) {
  const std::string file = write("three.exr", 4, 4, {"R", "G", "B"}, [](int, int, int) { return 0.25f; });
  for (const int first : {3, 4, 100, std::numeric_limits<int>::max()}) {
    for (const float place : {0.0f, 0.125f, 0.999f, 1.0f}) {
      const TexturePoint point{.at = {place, place, 0}, .firstChannel = first, .fill = 0.75f};
      EXPECT_EQ(look(file, point, 3), (std::vector{0.75f, 0.75f, 0.75f})) << first << ' ' << place;
      EXPECT_TRUE(failures_.empty());
    }
  }
  for (const int subimage : {1, 7, -1, std::numeric_limits<int>::min()}) {
    const TexturePoint point{.at = {0.5f, 0.5f, 0}, .subimage = subimage, .fill = 0.5f};
    EXPECT_EQ(look(file, point, 3), (std::vector{0.5f, 0.5f, 0.5f})) << subimage;
    ASSERT_EQ(failures_.size(), 1u);
    EXPECT_NE(failures_[0].message.find("has no subimage " + std::to_string(subimage)), std::string::npos);
  }
}

/// Parallel axes, one without length, points, and what is next to them.
TEST_F(Textures, BlursFootprintsWithoutArea) {
  const std::string file = write("even.exr", 64, 64, {"R", "G", "B"}, [](int, int, int) { return 0.25f; });
  for (const float blur : {1e-6f, 0.01f, 1.0f, 1e6f}) {
    for (const float scale : {0.0f, 1e-30f, 1e-12f, 1e-6f, 1e-3f, 1.0f, 1e6f}) {
      for (const float lean : {0.0f, 1e-7f, 1e-3f}) {
        for (const auto& [x, y] : {std::pair{1.0f, 1.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}, {-0.3f, 0.7f}}) {
          TexturePoint point{.at = {0.3f, 0.7f, 0},
                             .blur = {blur, blur, 0},
                             .wrap = {TextureWrap::periodic, TextureWrap::periodic, TextureWrap::periodic}};
          point.dx[0] = scale * x, point.dx[1] = scale * y;
          for (const float second : {0.0f, 1.0f, -2.0f}) {
            point.dy[0] = second * scale * (x + lean), point.dy[1] = second * scale * y;
            for (const float width : {1.0f, 0.0f}) {
              point.width[0] = width;
              for (const float c : look(file, point, 3))
                EXPECT_NEAR(c, 0.25f, 1e-4f) << blur << " " << scale << " " << x;
            }
          }
        }
      }
    }
  }
}

TEST_F(Textures, MissingFiles) {
  const std::string file = (folder_ / "none.exr").string();
  TexturePoint point = at(0.5f, 0.5f);
  point.fill = 3;
  EXPECT_EQ(look(file, point, 3), (std::vector<float>{3, 3, 3}));
  ASSERT_EQ(failures_.size(), 1u);
  EXPECT_NE(failures_[0].message.find(file), std::string::npos);
  const std::string first = failures_[0].message;
  const auto other = source_->openSession();
  for (int again = 0; again < 300; ++again) {  // The message is always the same, also for another thread.
    float results[3];
    failures_.clear();
    other->lookup(TextureKind::plane, file, {&point, 1}, 3, results, failures_);
    ASSERT_EQ(failures_.size(), 1u);
    ASSERT_EQ(failures_[0].message, first);
  }
  point.hasMissing = true;
  point.missing[0] = 1;
  point.missing[2] = 0.5f;
  point.missing[3] = 0.125f;
  EXPECT_EQ(look(file, point, 4), (std::vector<float>{1, 0, 0.5f, 0.125f}));
  EXPECT_TRUE(failures_.empty());
}

TEST_F(Textures, BrokenFiles) {
  const auto whole = write("whole.exr", 64, 64, {"R", "G", "B"}, texelValue);
  const auto size = fs::file_size(whole);
  for (const std::uintmax_t kept : {std::uintmax_t{0}, std::uintmax_t{40}, size / 2}) {
    const std::string name = (folder_ / ("cut" + std::to_string(kept) + ".exr")).string();
    fs::copy_file(whole, name);
    fs::resize_file(name, kept);
    const auto value = look(name, at(0.9f, 0.9f), 3);
    ASSERT_EQ(failures_.size(), 1u) << kept;
    EXPECT_NE(failures_[0].message.find(name), std::string::npos);
    for (const float v : value) EXPECT_TRUE(std::isfinite(v));
  }
}

TEST_F(Textures, UdimTiles) {
  for (const int tile : {1001, 1002, 1011}) {
    write("tile." + std::to_string(tile) + ".exr", 8, 8, {"Y"},
          [&](int, int, int) { return static_cast<float>(tile); });
  }
  const std::string file = (folder_ / "tile.<UDIM>.exr").string();
  EXPECT_EQ(look(file, at(0.5f, 0.5f), 1)[0], 1001);
  EXPECT_EQ(look(file, at(1.5f, 0.5f), 1)[0], 1002);
  EXPECT_EQ(look(file, at(0.5f, 1.5f), 1)[0], 1011);
  EXPECT_TRUE(failures_.empty());
  look(file, at(5.5f, 0.5f), 1);
  EXPECT_EQ(failures_.size(), 1u);
  const auto range = session_->range(file, {});
  ASSERT_TRUE(range);
  EXPECT_EQ(range->least, (std::vector<float>{1001}));
  EXPECT_EQ(range->greatest, (std::vector<float>{1011}));
}

TEST_F(Textures, Information) {
  const auto file = write("a.exr", 8, 4, {"R", "G", "B"}, texelValue);
  using Base = TextureInfoType::Base;
  const auto resolution = session_->info(file, nullptr, "resolution", {.base = Base::integer, .arrayLength = 2});
  ASSERT_TRUE(resolution);
  EXPECT_EQ(resolution->integers, (std::vector<std::int32_t>{8, 4}));
  const auto channels = session_->info(file, nullptr, "channels", {});
  ASSERT_TRUE(channels);
  EXPECT_EQ(channels->integers, (std::vector<std::int32_t>{3}));
  const auto type = session_->info(file, nullptr, "type", {.base = Base::string});
  ASSERT_TRUE(type);
  EXPECT_EQ(type->strings, (std::vector<std::string>{"Plain Texture"}));
  EXPECT_FALSE(session_->info(file, nullptr, "channels", {.base = Base::string}));
  EXPECT_FALSE(session_->info(file, nullptr, "no such entry", {}));
  EXPECT_EQ(session_->info(file, nullptr, "exists", {})->integers[0], 1);
  EXPECT_EQ(session_->info("none.exr", nullptr, "exists", {})->integers[0], 0);
  EXPECT_FALSE(session_->info("none.exr", nullptr, "channels", {}));
}

TEST_F(Textures, SearchPath) {
  write("found.exr", 4, 4, {"Y"}, [](int, int, int) { return 5.0f; });
  open({.searchPath = {folder_.string()}});
  EXPECT_EQ(look("found.exr", at(0.5f, 0.5f), 1)[0], 5);
  EXPECT_TRUE(failures_.empty());
}

TEST_F(Textures, RangeHoldsEveryFilteredValue) {
  const auto file = write("n.exr", 40, 24, {"Y"}, [](int x, int y, int) { return std::sin(float(x * x + 7 * y * y)); });
  const auto range = session_->range(file, {});
  ASSERT_TRUE(range);
  EXPECT_FALSE(range->hasNan);
  for (int i = 0; i < 4000; ++i) {
    const auto f = static_cast<float>(i);
    TexturePoint point =
        at(std::fmod(f * 0.61803f, 1.0f), std::fmod(f * 0.7548f, 1.0f), static_cast<TextureInterpolation>(i % 4));
    point.wrap[0] = point.wrap[1] = TextureWrap::periodic;
    point.dx[0] = std::fmod(f * 0.013f, 0.1f);
    point.dy[1] = std::fmod(f * 0.017f, 0.1f);
    const float value = look(file, point, 1)[0];
    EXPECT_GE(value, range->least[0] - 1e-5f);
    EXPECT_LE(value, range->greatest[0] + 1e-5f);
  }
}

TEST_F(Textures, EnvironmentByDirection) {
  // A map of latitude and longitude: the upper half (towards the up axis) is 1.
  const auto file = write("sky.exr", 64, 32, {"Y"}, [](int, int y, int) { return y < 16 ? 1.0f : 0.0f; });
  TexturePoint point;
  point.at[1] = 1;
  const float up = look(file, point, 1, TextureKind::environment)[0];
  point.at[1] = -1;
  const float down = look(file, point, 1, TextureKind::environment)[0];
  EXPECT_NEAR(up, 1, 1e-5);
  EXPECT_NEAR(down, 0, 1e-5);
}

TEST_F(Textures, ThreadsSeeTheSameValues) {
  const auto file = write("n.exr", 256, 256, {"R", "G", "B"},
                          [](int x, int y, int c) { return std::sin(static_cast<float>(3 * x + 5 * y * y + c)); });
  open({.searchPath = {}, .memory_MB = 16});
  const auto run = [&](std::vector<float>& values) {
    const auto session = source_->openSession();
    std::vector<TextureFailure> failures;
    for (int i = 0; i < 2000; ++i) {
      const auto f = static_cast<float>(i);
      TexturePoint point =
          at(std::fmod(f * 0.61803f, 1.0f), std::fmod(f * 0.7548f, 1.0f), TextureInterpolation::smartCubic);
      point.dx[0] = 0.01f;
      point.dy[1] = std::fmod(f * 0.017f, 0.1f);
      values.resize(values.size() + 3);
      session->lookup(TextureKind::plane, file, {&point, 1}, 3, values.data() + values.size() - 3, failures);
    }
  };
  std::vector<float> values[4];
  std::vector<std::thread> threads;
  for (auto& each : values) threads.emplace_back([&run, &each] { run(each); });
  for (auto& thread : threads) thread.join();
  for (const auto& each : values) EXPECT_EQ(each, values[0]);
}

}  // namespace

}  // namespace aerosol::image
