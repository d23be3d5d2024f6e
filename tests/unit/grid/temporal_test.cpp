// Voxels in time: curves within their error, files there and back, lookups against the samples, damaged files.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/base/random.h"
#include "core/grid/grid_file.h"
#include "core/grid/temporal_curve.h"
#include "core/grid/temporal_file.h"
#include "tests/support/scratch_folder.h"

namespace aerosol::grid {
namespace {

namespace fs = std::filesystem;

float lineAt(const std::vector<float>& times, const std::vector<float>& values, const std::uint8_t* chosen,
             std::size_t count, float time) {
  if (time <= times[chosen[0]]) return values[chosen[0]];
  for (std::size_t k = 1; k < count; ++k) {
    const float t0 = times[chosen[k - 1]], t1 = times[chosen[k]];
    if (time <= t1)
      return values[chosen[k - 1]] + (time - t0) / (t1 - t0) * (values[chosen[k]] - values[chosen[k - 1]]);
  }
  return values[chosen[count - 1]];
}

TEST(FitCurve, PassesEverySampleWithinTheError) {
  for (std::uint32_t round = 0; round < 2000; ++round) {
    std::vector<float> times, values;
    const std::size_t count = 1 + static_cast<std::size_t>(254 * randomFloat(1, 0, round) * randomFloat(2, 0, round));
    float time = -3, value = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      time += 0.01f + randomFloat(3, round, i);
      value += randomFloat(4, round, i) < 0.3f ? 0 : randomFloat(5, round, i) - 0.5f;
      times.push_back(time);
      values.push_back(value);
    }
    const float error = 0.5f * randomFloat(6, 0, round);
    std::uint8_t chosen[256];
    const std::size_t kept = fitCurve(times, values, error, chosen);
    ASSERT_GE(kept, 1u);
    ASSERT_LE(kept, count);
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_NEAR(lineAt(times, values, chosen, kept, times[i]), values[i], error + 1e-5f) << round;
  }
}

TEST(FitCurve, KeepsNoMoreThanItNeeds) {
  std::vector<float> times, line, corner, still;
  for (int i = 0; i < 100; ++i) {
    times.push_back(static_cast<float>(i));
    line.push_back(static_cast<float>(2 * i));
    corner.push_back(static_cast<float>(std::abs(i - 40)));
    still.push_back(7);
  }
  std::uint8_t chosen[256];
  EXPECT_EQ(fitCurve(times, line, 1e-3f, chosen), 2u);
  EXPECT_EQ(fitCurve(times, corner, 1e-3f, chosen), 3u);
  EXPECT_EQ(chosen[1], 40);
  EXPECT_EQ(fitCurve(times, still, 0, chosen), 1u);
  EXPECT_EQ(fitCurve({times.data(), 1}, {line.data(), 1}, 0, chosen), 1u);
}

class TemporalFiles : public testing::Test {
 protected:
  static float valueAt(int channel, double x, double y, double z, double t) {
    const double r = std::hypot(x - 10 - 8 * t, y + 3, z - 5);
    return static_cast<float>(std::max(0.0, 6 - r) * (1 + channel));
  }

  /// A ball that moves along x, over 3 x 2 x 2 blocks.
  static TemporalCurves ball(int channels, float error, std::size_t times = 9) {
    TemporalCurves curves;
    curves.name = channels == 3 ? "colour" : "density";
    curves.channels = channels;
    curves.indexToFile = {0.5, 0, 0, 1, 0, 0.5, 0, 2, 0, 0, 0.5, 3, 0, 0, 0, 1};
    for (std::size_t t = 0; t < times; ++t)
      curves.times.push_back(static_cast<float>(t) / static_cast<float>(times - 1));
    for (int bx = 0; bx < 24; bx += 8) {
      for (int by = -16; by < 8; by += 8) {
        for (int bz = 0; bz < 16; bz += 8) {
          TemporalSamples samples{{bx, by, bz}, {}};
          for (const float t : curves.times) {
            for (int c = 0; c < channels; ++c) {
              for (int v = 0; v < 512; ++v)
                samples.values.push_back(valueAt(c, bx + v / 64, by + v / 8 % 8, bz + v % 8, static_cast<double>(t)));
            }
          }
          curves.add(samples, error);
        }
      }
    }
    return curves;
  }

  std::string write(const TemporalCurves& curves, const char* name = "a.avt") const {
    const std::string path = (folder_ / name).string();
    EXPECT_FALSE(writeTemporal(path, {&curves, 1}).hasErrors());
    return path;
  }

  test::ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
};

TEST_F(TemporalFiles, LookupsAreTheSamples) {
  for (const int channels : {1, 3}) {
    constexpr float error = 0.02f;
    const auto file = readGrids(write(ball(channels, error)));
    ASSERT_TRUE(file) << format(file.errors());
    const VoxelGrid& grid = *(*file)->grids()[0];
    EXPECT_EQ(grid.info().channels, channels);
    for (std::uint32_t i = 0; i < 4000; ++i) {
      const auto u = [&](std::uint32_t k) { return randomFloat(k, 0, i); };
      const int x = static_cast<int>(30 * u(1)) - 3, y = static_cast<int>(30 * u(2)) - 18,
                z = static_cast<int>(20 * u(3)) - 2;
      const int t = static_cast<int>(9 * u(4));
      const float px = 0.5f * static_cast<float>(x) + 1, py = 0.5f * static_cast<float>(y) + 2,
                  pz = 0.5f * static_cast<float>(z) + 3, time = static_cast<float>(t) / 8;
      const bool isStored = x >= 0 && x < 24 && y >= -16 && y < 8 && z >= 0 && z < 16;
      for (const auto interpolation : {VoxelInterpolation::nearest, VoxelInterpolation::trilinear}) {
        float found[3];
        grid.sampleAt(interpolation, 1, &px, &py, &pz, &time, found);
        for (int c = 0; c < channels; ++c)
          ASSERT_NEAR(found[c], isStored ? valueAt(c, x, y, z, static_cast<double>(time)) : 0, 1.01f * error);
      }
    }
  }
}

TEST_F(TemporalFiles, ValuesGoStraightBetweenTimesAndRestOutside) {
  const auto file = readGrids(write(ball(1, 0, 2)));
  ASSERT_TRUE(file);
  const VoxelGrid& grid = *(*file)->grids()[0];
  const float x = 0.5f * 12 + 1, y = 0.5f * -3 + 2, z = 0.5f * 5 + 3;
  const auto at = [&](float time) {
    float value;
    grid.sampleAt(VoxelInterpolation::trilinear, 1, &x, &y, &z, &time, &value);
    return value;
  };
  EXPECT_NEAR(at(0), 4, 1e-5);
  EXPECT_NEAR(at(-5), 4, 1e-5);
  EXPECT_NEAR(at(1), 0, 1e-5);
  EXPECT_NEAR(at(7), 0, 1e-5);
  EXPECT_NEAR(at(0.25f), 3, 1e-5);
  float value;
  grid.sample(VoxelInterpolation::trilinear, 1, &x, &y, &z, &value);
  EXPECT_EQ(value, at(0));
}

TEST_F(TemporalFiles, RangesHoldWhatLookupsGive) {
  const auto file = readGrids(write(ball(1, 0.05f)));
  ASSERT_TRUE(file);
  const VoxelGrid& grid = *(*file)->grids()[0];
  int empty = 0;
  for (std::uint32_t i = 0; i < 300; ++i) {
    std::array<double, 3> lower{}, upper{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      lower[k] = 20 * static_cast<double>(randomFloat(k, 1, i)) - 4;
      upper[k] = lower[k] + 3 * static_cast<double>(randomFloat(k, 2, i));
    }
    for (const auto interpolation :
         {VoxelInterpolation::nearest, VoxelInterpolation::trilinear, VoxelInterpolation::tricubic}) {
      const VoxelRange range = grid.range(interpolation, lower, upper, 0);
      empty += range.greatest == 0;
      for (std::uint32_t n = 0; n < 50; ++n) {
        float p[3], time = randomFloat(9, i, n), value;
        for (std::uint32_t k = 0; k < 3; ++k)
          p[k] = static_cast<float>(lower[k] + (upper[k] - lower[k]) * static_cast<double>(randomFloat(10 + k, i, n)));
        grid.sampleAt(interpolation, 1, p, p + 1, p + 2, &time, &value);
        ASSERT_GE(value, range.least);
        ASSERT_LE(value, range.greatest);
      }
    }
  }
  EXPECT_GT(empty, 50);
}

TEST_F(TemporalFiles, MoreErrorTakesLessRoom) {
  const auto sizeOf = [&](float error) { return fs::file_size(write(ball(1, error, 65))); };
  EXPECT_LT(sizeOf(0.05f), sizeOf(0.0f) / 2);
  EXPECT_LT(sizeOf(0.5f), sizeOf(0.05f));
}

TEST_F(TemporalFiles, DamagedFilesAreRefused) {
  const std::string path = write(ball(1, 0.05f));
  std::ifstream stream(path, std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(stream), {}};
  const auto reads = [&](const std::string& bytes) {
    const std::string other = (folder_ / "b.avt").string();
    std::ofstream(other, std::ios::binary) << bytes;
    return static_cast<bool>(readGrids(other));
  };
  EXPECT_TRUE(reads(good));
  EXPECT_FALSE(reads(good + "x"));
  EXPECT_FALSE(reads(""));
  for (std::size_t length = 1; length < good.size(); length = length * 5 / 4 + 1)
    EXPECT_FALSE(reads(good.substr(0, length)));
  // Any byte may be wrong: an error, or a file that can be looked up.
  for (std::uint32_t i = 0; i < 400; ++i) {
    std::string bad = good;
    const auto at =
        static_cast<std::size_t>(randomFloat(1, 0, i) * (i % 2 ? 400.0f : static_cast<float>(good.size() - 1)));
    bad[at] = static_cast<char>(static_cast<unsigned char>(randomFloat(2, 0, i) * 255));
    reads(bad);
  }
  EXPECT_FALSE(readGrids((folder_ / "none.avt").string()));
}

/// Two values at one time in a curve.
TEST_F(TemporalFiles, RepeatedTimesAreRefused) {
  TemporalCurves curves;
  curves.name = "d";
  curves.indexToFile = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  curves.times = {0, 1};
  curves.origins = {{0, 0, 0}};
  curves.counts.assign(512, 0);
  curves.counts[3] = 2;
  curves.knots = {1, 1};
  curves.values = {5, 6};
  const auto file = readGrids(write(curves));
  ASSERT_FALSE(file);
  EXPECT_NE(format(file.errors()).find("two values at one time"), std::string::npos);
  curves.knots = {0, 1};
  EXPECT_TRUE(readGrids(write(curves)));
  curves.times = {1, 1};
  EXPECT_FALSE(readGrids(write(curves)));
}

}  // namespace
}  // namespace aerosol::grid
