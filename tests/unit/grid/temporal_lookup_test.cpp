// Lookups of many points and times at once in curves of any shape, against the format's own words, in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "core/grid/grid_file.h"
#include "core/grid/temporal_file.h"
#include "tests/support/scratch_folder.h"

namespace aerosol::grid {
namespace {

constexpr std::size_t voxels = 512;

/// Scattered blocks, some beside each other; curves of 0 to 255 knots at uneven times.
TemporalCurves someCurves(int channels) {
  TemporalCurves curves;
  curves.name = "any";
  curves.channels = channels;
  curves.indexToFile = {0.5, 0.1, 0, 1, 0, 0.5, 0, 2, 0.05, 0, 0.5, 3, 0, 0, 0, 1};
  float time = -1;
  for (std::uint32_t t = 0; t < 255; ++t) curves.times.push_back(time += 0.002f + 0.02f * randomFloat(1, 0, t));
  curves.origins = {{0, 0, 0}, {8, 0, 0}, {-8, 8, 0}, {0, 8, 8}, {16, -8, 0}};
  for (std::uint32_t c = 0; c < curves.origins.size() * voxels * static_cast<std::size_t>(channels); ++c) {
    const auto u = [&](std::uint32_t k) { return randomFloat(2, k, c); };
    const float kind = u(0);
    const std::uint32_t wanted = kind < 0.3f    ? 0
                                 : kind < 0.5f  ? 1
                                 : kind < 0.95f ? 2 + static_cast<std::uint32_t>(11 * u(1))
                                                : 100 + static_cast<std::uint32_t>(155 * u(1));
    std::uint8_t count = 0;
    for (std::uint32_t t = 0; t < 255 && count < wanted; ++t) {
      const bool mustTake = 255 - t == wanted - count;
      if (!mustTake && randomFloat(3, t, c) * 255 > static_cast<float>(wanted)) continue;
      curves.knots.push_back(static_cast<std::uint8_t>(t));
      curves.values.push_back(4 * randomFloat(4, t, c) - 1);
      ++count;
    }
    curves.counts.push_back(count);
  }
  return curves;
}

/// By the format's description.
class Reference {
 public:
  explicit Reference(const TemporalCurves& curves) : curves_(curves) {
    std::size_t knot = 0;
    for (const std::uint8_t count : curves.counts) {
      begins_.push_back(knot);
      knot += count;
    }
  }

  double voxel(int channel, int x, int y, int z, double time) const {
    for (std::size_t b = 0; b < curves_.origins.size(); ++b) {
      const auto& o = curves_.origins[b];
      const int i = x - o[0], j = y - o[1], k = z - o[2];
      if (std::min({i, j, k}) < 0 || std::max({i, j, k}) > 7) continue;
      const std::size_t curve =
          (b * static_cast<std::size_t>(curves_.channels) + static_cast<std::size_t>(channel)) * voxels +
          static_cast<std::size_t>((i * 8 + j) * 8 + k);
      return along(begins_[curve], curves_.counts[curve], time);
    }
    return 0;
  }

  double lookUp(VoxelInterpolation interpolation, int channel, const std::array<double, 3>& at, double time) const {
    const int from = interpolation == VoxelInterpolation::tricubic ? -1 : 0;
    const int to = interpolation == VoxelInterpolation::tricubic ? 2 : 1;
    std::array<double, 3> low{}, part{};
    for (std::size_t r = 0; r < 3; ++r) {
      if (interpolation == VoxelInterpolation::nearest) {
        low[r] = std::floor(at[r] + 0.5);
      } else {
        low[r] = std::floor(at[r]);
        part[r] = at[r] - low[r];
      }
    }
    double sum = 0;
    for (int i = from; i <= to; ++i) {
      for (int j = from; j <= to; ++j) {
        for (int k = from; k <= to; ++k) {
          const double weight = weightOf(interpolation, i, part[0]) * weightOf(interpolation, j, part[1]) *
                                weightOf(interpolation, k, part[2]);
          if (weight != 0)
            sum += weight * voxel(channel, static_cast<int>(low[0]) + i, static_cast<int>(low[1]) + j,
                                  static_cast<int>(low[2]) + k, time);
        }
      }
    }
    return sum;
  }

 private:
  double along(std::size_t begin, std::size_t count, double time) const {
    if (count == 0) return 0;
    const auto timeOf = [&](std::size_t k) { return static_cast<double>(curves_.times[curves_.knots[begin + k]]); };
    const auto valueOf = [&](std::size_t k) { return static_cast<double>(curves_.values[begin + k]); };
    if (time <= timeOf(0)) return valueOf(0);
    for (std::size_t k = 1; k < count; ++k) {
      if (time <= timeOf(k))
        return valueOf(k - 1) + (time - timeOf(k - 1)) / (timeOf(k) - timeOf(k - 1)) * (valueOf(k) - valueOf(k - 1));
    }
    return valueOf(count - 1);
  }

  /// Of the hat, and of the uniform cubic B-spline, centred at a voxel that is `steps` from the one below the point.
  static double weightOf(VoxelInterpolation interpolation, int steps, double part) {
    if (interpolation == VoxelInterpolation::nearest) return steps == 0 ? 1 : 0;
    const double d = std::fabs(part - steps);
    if (interpolation == VoxelInterpolation::trilinear) return std::max(0.0, 1 - d);
    return d < 1 ? (4 - 6 * d * d + 3 * d * d * d) / 6 : d < 2 ? (2 - d) * (2 - d) * (2 - d) / 6 : 0;
  }

  const TemporalCurves& curves_;
  std::vector<std::size_t> begins_;
};

struct Points {
  std::vector<float> at[3], times;
  std::vector<std::array<double, 3>> index;  ///< The same in index space, in double.
};

Points somePoints(std::size_t count) {
  Points points;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto u = [&](std::uint32_t k) { return static_cast<double>(randomFloat(7, k, i)); };
    const double x = 36 * u(0) - 10, y = 28 * u(1) - 10, z = 20 * u(2) - 2;
    points.at[0].push_back(static_cast<float>(0.5 * x + 0.1 * y + 1));
    points.at[1].push_back(static_cast<float>(0.5 * y + 2));
    points.at[2].push_back(static_cast<float>(0.05 * x + 0.5 * z + 3));
    // What the rounded point is in index space.
    const double py = (static_cast<double>(points.at[1][i]) - 2) / 0.5;
    const double px = (static_cast<double>(points.at[0][i]) - 1 - 0.1 * py) / 0.5;
    points.index.push_back({px, py, (static_cast<double>(points.at[2][i]) - 3 - 0.05 * px) / 0.5});
    points.times.push_back(static_cast<float>(-1.5 + 4.5 * u(3)));
  }
  return points;
}

class TemporalLookups : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    const std::string path = (scratch_.path() / "any.avt").string();
    ASSERT_FALSE(writeTemporal(path, {&curves_, 1}).hasErrors());
    auto file = readGrids(path);
    ASSERT_TRUE(file) << format(file.errors());
    file_ = *file;
  }

  const VoxelGrid& grid() const { return *file_->grids()[0]; }

  test::ScratchFolder scratch_;
  TemporalCurves curves_ = someCurves(GetParam());
  std::shared_ptr<const VoxelFile> file_;
};

TEST_P(TemporalLookups, AreWhatTheFormatSays) {
  constexpr std::size_t count = 3000;
  const Points points = somePoints(count);
  const Reference reference(curves_);
  std::vector<float> values(count * static_cast<std::size_t>(GetParam()));
  for (const auto interpolation :
       {VoxelInterpolation::nearest, VoxelInterpolation::trilinear, VoxelInterpolation::tricubic}) {
    grid().sampleAt(interpolation, count, points.at[0].data(), points.at[1].data(), points.at[2].data(),
                    points.times.data(), values.data());
    int stored = 0;
    for (std::size_t i = 0; i < count; ++i) {
      for (int c = 0; c < GetParam(); ++c) {
        const double expected =
            reference.lookUp(interpolation, c, points.index[i], static_cast<double>(points.times[i]));
        stored += expected != 0;
        ASSERT_NEAR(static_cast<double>(values[static_cast<std::size_t>(c) * count + i]), expected, 2e-5) << i;
      }
    }
    EXPECT_GT(stored, 200);
  }
}

TEST_P(TemporalLookups, DoNotDependOnWhatElseIsAsked) {
  constexpr std::size_t count = 203;
  const Points points = somePoints(count);
  const auto channels = static_cast<std::size_t>(GetParam());
  std::vector<float> all(count * channels), one(channels);
  for (const auto interpolation : {VoxelInterpolation::trilinear, VoxelInterpolation::tricubic}) {
    grid().sampleAt(interpolation, count, points.at[0].data(), points.at[1].data(), points.at[2].data(),
                    points.times.data(), all.data());
    for (std::size_t i = 0; i < count; ++i) {
      grid().sampleAt(interpolation, 1, &points.at[0][i], &points.at[1][i], &points.at[2][i], &points.times[i],
                      one.data());
      for (std::size_t c = 0; c < channels; ++c) ASSERT_EQ(one[c], all[c * count + i]) << i;
    }
  }
}

TEST_P(TemporalLookups, GiveNothingAtPlacesAndTheFirstValueAtTimesThatAreNone) {
  constexpr float none = std::numeric_limits<float>::quiet_NaN(), far = std::numeric_limits<float>::infinity();
  const Reference reference(curves_);
  const float x[] = {none, far, -far, 1e30f, 3}, y[] = {3, 3, none, 3, 3}, z[] = {5, 5, 5, -1e30f, 5};
  const float times[] = {0, 0, 0, 0, none};
  std::vector<float> values(5 * static_cast<std::size_t>(GetParam()));
  grid().sampleAt(VoxelInterpolation::trilinear, 5, x, y, z, times, values.data());
  for (int i = 0; i < 4; ++i) EXPECT_EQ(values[static_cast<std::size_t>(i)], 0) << i;
  const double py = (3 - 2) / 0.5, px = (3 - 1 - 0.1 * py) / 0.5;
  const double first = reference.lookUp(VoxelInterpolation::trilinear, 0, {px, py, (5 - 3 - 0.05 * px) / 0.5}, -100);
  EXPECT_NEAR(static_cast<double>(values[4]), first, 2e-5);
}

INSTANTIATE_TEST_SUITE_P(Channels, TemporalLookups, testing::Values(1, 3));

TEST(TemporalLookup, OfAGridWithoutBlocksIsZero) {
  TemporalCurves curves;
  curves.name = "empty";
  curves.indexToFile = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  curves.times = {0};
  const test::ScratchFolder scratch;
  const std::string path = (scratch.path() / "empty.avt").string();
  ASSERT_FALSE(writeTemporal(path, {&curves, 1}).hasErrors());
  const auto file = readGrids(path);
  ASSERT_TRUE(file) << format(file.errors());
  const float at = 0.5f;
  float value = 1;
  (*file)->grids()[0]->sampleAt(VoxelInterpolation::tricubic, 1, &at, &at, &at, &at, &value);
  EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace aerosol::grid
