// Voxel data: lookups against OpenVDB's own, ranges against dense sampling, damaged files.

#include "core/grid/grid_file.h"
#include "tests/support/scratch_folder.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

namespace aerosol::grid {

namespace {

namespace fs = std::filesystem;
using openvdb::Vec3d;

class Grids : public testing::Test {
 protected:
  void SetUp() override { openvdb::initialize(); }

  std::string write(const openvdb::GridCPtrVec& grids, const std::string& name = "a.vdb") {
    const std::string path = (folder_ / name).string();
    openvdb::io::File file(path);
    file.write(grids);
    file.close();
    return path;
  }

  static std::shared_ptr<const VoxelFile> read(const std::string& path) {
    auto file = readGrids(path);
    EXPECT_TRUE(file) << format(file.errors());
    return file ? *file : nullptr;
  }

  test::ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
};

/// Blobs of leaves, single voxels and tiles around the origin, on both sides of 0.
template <class GridT>
typename GridT::Ptr makeNoise(std::uint32_t seed) {
  using Value = typename GridT::ValueType;
  auto grid = GridT::create(Value(0.25f));
  grid->setName("noise");
  std::mt19937 random(seed);
  const auto value = [&] {
    const auto one = [&] { return static_cast<double>(random() % 10000) / 1000 - 3; };
    if constexpr (requires(Value v) { v.x(); }) {
      return Value(static_cast<typename Value::ValueType>(one()), static_cast<typename Value::ValueType>(one()),
                   static_cast<typename Value::ValueType>(one()));
    } else {
      return static_cast<Value>(one());
    }
  };
  auto accessor = grid->getAccessor();
  for (int i = -21; i < 30; ++i)
    for (int j = -17; j < 20; ++j)
      for (int k = -33; k < 9; ++k) accessor.setValue({i, j, k}, value());
  for (int n = 0; n < 200; ++n) {
    accessor.setValue({int(random() % 600) - 300, int(random() % 600) - 300, int(random() % 600) - 300}, value());
  }
  grid->tree().addTile(1, {64, 64, 64}, value(), true);    // 8^3
  grid->tree().addTile(2, {-256, 128, 0}, value(), true);  // 128^3
  grid->tree().addTile(1, {80, 64, 64}, value(), false);   // inactive
  return grid;
}

openvdb::math::Transform::Ptr skewed() {
  const openvdb::math::Mat4d m(0.11, 0.02, -0.01, 0.0, 0.03, -0.2, 0.015, 0.0, 0.0, 0.04, 0.17, 0.0, 1.3, -2.7, 0.4,
                               1.0);
  return openvdb::math::Transform::createLinearTransform(m);
}

struct Points {
  std::vector<float> x, y, z;
  std::size_t size() const { return x.size(); }
  Vec3d operator[](std::size_t i) const {
    return {static_cast<double>(x[i]), static_cast<double>(y[i]), static_cast<double>(z[i])};
  }
};

/// Points whose index-space positions fill [-350, 350]^3, more of them near the middle.
Points pointsAround(const openvdb::math::Transform& transform, std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const double size = i % 4 == 0 ? 350 : 36;
    const Vec3d p =
        transform.indexToWorld(Vec3d(size * uniform(random), size * uniform(random), size * uniform(random)));
    points.x.push_back(static_cast<float>(p.x()));
    points.y.push_back(static_cast<float>(p.y()));
    points.z.push_back(static_cast<float>(p.z()));
  }
  return points;
}

double component(double value, std::size_t) { return value; }
double component(const openvdb::Vec3d& value, std::size_t c) { return value[static_cast<int>(c)]; }

/// The same values in double, so that OpenVDB interpolates in double.
template <class TreeT, class GridT>
typename openvdb::Grid<TreeT>::Ptr inDouble(const GridT& grid) {
  using Value = typename TreeT::ValueType;
  auto result = openvdb::Grid<TreeT>::create(Value(grid.background()));
  result->setTransform(grid.transform().copy());
  for (auto i = grid.cbeginValueAll(); i; ++i) {
    if (i.isVoxelValue()) {
      result->tree().setValueOn(i.getCoord(), Value(*i));
    } else if (i.isValueOn() || *i != grid.background()) {
      result->tree().addTile(i.getLevel(), i.getCoord(), Value(*i), true);
    }
  }
  return result;
}

/// Sum of the 64 voxels around, weighted by the cubic B-spline's pieces, in double.
template <class GridT>
typename GridT::ValueType splineSample(const GridT& grid, const Vec3d& world) {
  const Vec3d p = grid.worldToIndex(world);
  const auto accessor = grid.getConstAccessor();
  const openvdb::Coord base = openvdb::Coord::floor(p);
  const auto b = [](double d) {
    d = std::abs(d);
    return d >= 2 ? 0.0 : d >= 1 ? (2 - d) * (2 - d) * (2 - d) / 6 : (4 - 6 * d * d + 3 * d * d * d) / 6;
  };
  typename GridT::ValueType sum(0.0);
  for (int i = -1; i <= 2; ++i)
    for (int j = -1; j <= 2; ++j)
      for (int k = -1; k <= 2; ++k) {
        const openvdb::Coord c = base.offsetBy(i, j, k);
        sum += accessor.getValue(c) * (b(p.x() - c.x()) * b(p.y() - c.y()) * b(p.z() - c.z()));
      }
  return sum;
}

template <class DoubleTree, class GridT>
void compareWithOpenVdb(const GridT& original, const VoxelGrid& grid) {
  const auto reference = inDouble<DoubleTree>(original);
  const Points points = pointsAround(original.transform(), 20001);
  const std::size_t channels = static_cast<std::size_t>(grid.info().channels);
  std::vector<float> results(channels * points.size());
  double scale = 0;
  for (std::size_t c = 0; c < channels; ++c)
    scale = std::max({scale, -double(grid.info().least[c]), double(grid.info().greatest[c])});
  for (const auto interpolation :
       {VoxelInterpolation::nearest, VoxelInterpolation::trilinear, VoxelInterpolation::tricubic}) {
    grid.sample(interpolation, points.size(), points.x.data(), points.y.data(), points.z.data(), results.data());
    for (std::size_t i = 0; i < points.size(); ++i) {
      using openvdb::tools::BoxSampler;
      const auto expected =
          interpolation == VoxelInterpolation::nearest
              ? openvdb::tools::PointSampler::sample(reference->constTree(), reference->worldToIndex(points[i]))
          : interpolation == VoxelInterpolation::trilinear
              ? BoxSampler::sample(reference->constTree(), reference->worldToIndex(points[i]))
              : splineSample(*reference, points[i]);
      for (std::size_t c = 0; c < channels; ++c) {
        const double value = static_cast<double>(results[c * points.size() + i]);
        ASSERT_NEAR(value, component(expected, c), interpolation == VoxelInterpolation::nearest ? 0 : 1e-6 * scale)
            << "interpolation " << static_cast<int>(interpolation) << " at " << points[i];
      }
    }
  }
}

TEST_F(Grids, FloatsAsOpenVdbReadsThem) {
  const auto original = makeNoise<openvdb::FloatGrid>(1);
  original->setTransform(skewed());
  const auto file = read(write({original}));
  ASSERT_TRUE(file);
  compareWithOpenVdb<openvdb::DoubleTree>(*original, *file->grids()[0]);
}

TEST_F(Grids, VectorsAsOpenVdbReadsThem) {
  const auto original = makeNoise<openvdb::Vec3SGrid>(2);
  original->setTransform(openvdb::math::Transform::createLinearTransform(0.125));
  const auto file = read(write({original}));
  ASSERT_TRUE(file);
  ASSERT_EQ(file->grids()[0]->info().channels, 3);
  compareWithOpenVdb<openvdb::Vec3DTree>(*original, *file->grids()[0]);
}

TEST_F(Grids, ExtentBeyondAnyTable) {
  auto original = openvdb::FloatGrid::create(0.5f);
  auto accessor = original->getAccessor();
  for (int i = -12; i < 12; ++i)
    for (int j = -12; j < 12; ++j)
      for (int k = -12; k < 12; ++k) accessor.setValue({i, j, k}, static_cast<float>(i * j - k));
  accessor.setValue({1000000000, -1000000000, 1000000000}, 3.0f);
  accessor.setValue({-1000000000, 1000000000, -1000000000}, 4.0f);
  const auto file = read(write({original}));
  ASSERT_TRUE(file);
  compareWithOpenVdb<openvdb::DoubleTree>(*original, *file->grids()[0]);
  const float x[2] = {1e9f, -1e9f}, y[2] = {-1e9f, 1e9f}, z[2] = {1e9f, -1e9f};
  float results[2];
  file->grids()[0]->sample(VoxelInterpolation::nearest, 2, x, y, z, results);
  EXPECT_EQ(results[0], 3);
  EXPECT_EQ(results[1], 4);
}

TEST_F(Grids, OtherTypesBecomeFloats) {
  const auto ints = makeNoise<openvdb::Int32Grid>(3);
  const auto longs = makeNoise<openvdb::Int64Grid>(4);
  const auto doubles = makeNoise<openvdb::DoubleGrid>(5);
  auto half = makeNoise<openvdb::FloatGrid>(6);
  half->setSaveFloatAsHalf(true);
  auto flags = openvdb::BoolGrid::create(false);
  ints->setName("ints");
  longs->setName("longs");
  doubles->setName("doubles");
  half->setName("half");
  flags->setName("flags");
  flags->tree().setValueOn({1, 2, 3}, true);
  const auto file = read(write({ints, longs, doubles, half, flags}));
  ASSERT_TRUE(file);
  ASSERT_EQ(file->grids().size(), 5u);
  EXPECT_EQ(file->find("ints")->info().type, "int32");
  compareWithOpenVdb<openvdb::DoubleTree>(*ints, *file->find("ints"));
  compareWithOpenVdb<openvdb::DoubleTree>(*longs, *file->find("longs"));
  compareWithOpenVdb<openvdb::DoubleTree>(*inDouble<openvdb::FloatTree>(*doubles), *file->find("doubles"));
  EXPECT_EQ(file->find("half")->info().type, "half");
  const float x = 3.0f;
  float value;
  file->find("half")->sample(VoxelInterpolation::nearest, 1, &x, &x, &x, &value);
  EXPECT_NEAR(value, half->tree().getValue({3, 3, 3}), 0.004f);
  EXPECT_EQ(file->find("flags")->info().channels, 0);
  EXPECT_NE(file->find("flags")->info().problem.find("bool"), std::string::npos);
  EXPECT_EQ(file->find("none"), nullptr);
}

TEST_F(Grids, OneAndManyPointsGiveTheSameBits) {
  const auto original = makeNoise<openvdb::FloatGrid>(8);
  original->setTransform(skewed());
  const auto file = read(write({original}));
  ASSERT_TRUE(file);
  const VoxelGrid& grid = *file->grids()[0];
  const Points points = pointsAround(original->transform(), 999);
  std::vector<float> together(points.size());
  for (const auto interpolation : {VoxelInterpolation::trilinear, VoxelInterpolation::tricubic}) {
    grid.sample(interpolation, points.size(), points.x.data(), points.y.data(), points.z.data(), together.data());
    for (std::size_t i = 0; i < points.size(); ++i) {
      float alone;
      grid.sample(interpolation, 1, &points.x[i], &points.y[i], &points.z[i], &alone);
      ASSERT_EQ(alone, together[i]);
    }
  }
}

TEST_F(Grids, OutsideStandsTheBackground) {
  const auto original = makeNoise<openvdb::FloatGrid>(9);
  const auto file = read(write({original}));
  ASSERT_TRUE(file);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const float far : {1e4f, -1e9f, 3e38f, infinity, -infinity, std::numeric_limits<float>::quiet_NaN()}) {
    for (const auto interpolation :
         {VoxelInterpolation::nearest, VoxelInterpolation::trilinear, VoxelInterpolation::tricubic}) {
      const float zero = 0;
      float value;
      file->grids()[0]->sample(interpolation, 1, &zero, &far, &zero, &value);
      EXPECT_NEAR(value, 0.25f, interpolation == VoxelInterpolation::tricubic ? 1e-6f : 0) << far;
    }
  }
}

TEST_F(Grids, RangesHoldEveryLookup) {
  auto original = makeNoise<openvdb::FloatGrid>(10);
  original->setTransform(skewed());
  const auto file = read(write({original}));
  ASSERT_TRUE(file);
  const VoxelGrid& grid = *file->grids()[0];
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  double tightness = 0;
  int tight = 0;
  for (int n = 0; n < 400; ++n) {
    const Vec3d at = original->transform().indexToWorld(
        Vec3d(80 * uniform(random) - 40, 80 * uniform(random) - 40, 80 * uniform(random) - 40));
    const double size = std::exp(8 * uniform(random) - 5);
    const std::array<double, 3> lower = {at.x(), at.y(), at.z()};
    const std::array<double, 3> upper = {at.x() + size * uniform(random), at.y() + size * uniform(random),
                                         at.z() + size * uniform(random)};
    for (const auto interpolation :
         {VoxelInterpolation::nearest, VoxelInterpolation::trilinear, VoxelInterpolation::tricubic}) {
      const VoxelRange range = grid.range(interpolation, lower, upper, 0);
      EXPECT_FALSE(range.hasNan);
      float least = std::numeric_limits<float>::infinity(), greatest = -least;
      for (int k = 0; k < 500; ++k) {
        const auto inside = [&](std::size_t r) {
          // Rounding to float may not leave the box.
          const double p = lower[r] + (upper[r] - lower[r]) * (0.001 + 0.998 * uniform(random));
          const float f = static_cast<float>(p);
          return std::clamp(static_cast<double>(f), lower[r], upper[r]) == static_cast<double>(f) ? f : std::nanf("");
        };
        const float x = inside(0), y = inside(1), z = inside(2);
        if (std::isnan(x + y + z)) continue;
        float value;
        grid.sample(interpolation, 1, &x, &y, &z, &value);
        ASSERT_GE(value, range.least);
        ASSERT_LE(value, range.greatest);
        least = std::min(least, value);
        greatest = std::max(greatest, value);
      }
      if (interpolation == VoxelInterpolation::nearest && greatest > least) {
        tightness += static_cast<double>((range.greatest - range.least) / (greatest - least));
        ++tight;
      }
    }
  }
  EXPECT_LT(tightness / tight, 1.3);  // Boxes are turned against the voxels, and samples miss some.
  // All there is, and what is nowhere near anything stored.
  const VoxelRange all = grid.range(VoxelInterpolation::nearest, {-1e30, -1e30, -1e30}, {1e30, 1e30, 1e30}, 0);
  EXPECT_NEAR(all.greatest, 6.999, 1e-3);
  const VoxelRange nothing = grid.range(VoxelInterpolation::trilinear, {5e3, 5e3, 5e3}, {6e3, 6e3, 6e3}, 0);
  EXPECT_EQ(nothing.least, 0.25f);
  EXPECT_EQ(nothing.greatest, 0.25f);
}

TEST_F(Grids, NanAndInfinityAreCounted) {
  auto original = openvdb::FloatGrid::create(0.0f);
  original->setName("broken");
  original->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  auto accessor = original->getAccessor();
  for (int i = 0; i < 4; ++i) accessor.setValue({i, 0, 0}, static_cast<float>(i + 1));
  accessor.setValue({4, 0, 0}, std::numeric_limits<float>::quiet_NaN());
  accessor.setValue({5, 0, 0}, std::numeric_limits<float>::infinity());
  accessor.setValueOff({6, 0, 0}, std::numeric_limits<float>::quiet_NaN());
  const auto file = read(write({original}));
  ASSERT_TRUE(file);
  const VoxelGridInfo& info = file->grids()[0]->info();
  EXPECT_EQ(info.name, "broken");
  EXPECT_EQ(info.nanValues, 2u);
  EXPECT_EQ(info.infiniteValues, 1u);
  EXPECT_EQ(info.least[0], 1);
  EXPECT_EQ(info.greatest[0], 4);
  EXPECT_EQ(info.activeVoxels, 6u);
  EXPECT_EQ(info.indexBounds, (std::array<std::int32_t, 6>{0, 0, 0, 5, 0, 0}));
  EXPECT_EQ(info.bounds, (std::array<double, 6>{-0.25, -0.25, -0.25, 2.75, 0.25, 0.25}));
  EXPECT_EQ(info.voxelSize, (std::array<double, 3>{0.5, 0.5, 0.5}));
  EXPECT_TRUE(file->grids()[0]->range(VoxelInterpolation::trilinear, {0, 0, 0}, {9, 9, 9}, 0).hasNan);
  EXPECT_FALSE(file->grids()[0]->range(VoxelInterpolation::trilinear, {0, 0, 0}, {0.9, 9, 9}, 0).hasNan);
}

TEST_F(Grids, EmptyGrid) {
  auto original = openvdb::FloatGrid::create(2.0f);
  original->setName("empty");
  const auto file = read(write({original}));
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->grids()[0]->info().isEmpty);
  const float x = 0.3f;
  float value;
  file->grids()[0]->sample(VoxelInterpolation::trilinear, 1, &x, &x, &x, &value);
  EXPECT_EQ(value, 2);
}

TEST_F(Grids, MissingAndDamagedFiles) {
  const auto none = readGrids((folder_ / "none.vdb").string());
  ASSERT_FALSE(none);
  EXPECT_NE(format(none.errors()).find("none.vdb"), std::string::npos);

  const auto original = makeNoise<openvdb::FloatGrid>(12);
  const std::string whole = write({original});
  std::ifstream in(whole, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const std::string path = (folder_ / "cut.vdb").string();
  const auto tryBytes = [&](const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
    return readGrids(path);
  };
  for (const std::size_t kept : {std::size_t{0}, std::size_t{3}, std::size_t{20}, std::size_t{200}, bytes.size() / 3,
                                 bytes.size() / 2, bytes.size() - 1}) {
    const auto cut = tryBytes(bytes.substr(0, kept));
    ASSERT_FALSE(cut) << kept;
    EXPECT_EQ(cut.errors().entries()[0].location.file, path);
  }
  EXPECT_FALSE(tryBytes(std::string(5000, 'x')));
}

/// OpenVDB writes beyond its buffer where a block says that it is longer; the walk through the file refuses it before.
/// Coarse voxels hold what was there, and a constant stays one.
TEST_F(Grids, CoarserLevelsKeepTheSum) {
  auto grid = openvdb::FloatGrid::create(0.0f);
  grid->setName("density");
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  grid->denseFill(openvdb::CoordBBox(openvdb::Coord(-16, 0, 8), openvdb::Coord(15, 23, 39)), 1.0f);
  std::mt19937 random(7);
  for (auto i = grid->beginValueOn(); i; ++i) i.setValue(static_cast<float>(random() % 1000) / 1000);
  auto even = openvdb::FloatGrid::create(0.0f);
  even->setName("even");
  even->denseFill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(31)), 3.0f);
  const std::string path = write({grid, even});
  double sum = 0;
  for (auto i = grid->cbeginValueOn(); i; ++i) sum += static_cast<double>(*i);
  for (const int level : {1, 2, 3}) {
    const auto file = read(coarseName(path, level));
    ASSERT_TRUE(file);
    const VoxelGrid* const coarse = file->find("density");
    ASSERT_TRUE(coarse);
    const double size = 0.5 * (1 << level);
    EXPECT_DOUBLE_EQ(coarse->info().voxelSize[0], size);
    double total = 0;
    const auto& box = coarse->info().indexBounds;
    for (std::int32_t x = box[0]; x <= box[3]; ++x)
      for (std::int32_t y = box[1]; y <= box[4]; ++y)
        for (std::int32_t z = box[2]; z <= box[5]; ++z) {
          const float px = static_cast<float>(x * size), py = static_cast<float>(y * size);
          const float pz = static_cast<float>(z * size);
          float value = 0;
          coarse->sample(VoxelInterpolation::nearest, 1, &px, &py, &pz, &value);
          total += static_cast<double>(value) * (1 << 3 * level);
        }
    EXPECT_NEAR(total / sum, 1, 1e-4) << level;
    const float middle = 16;
    float value = 0;
    file->find("even")->sample(VoxelInterpolation::nearest, 1, &middle, &middle, &middle, &value);
    EXPECT_FLOAT_EQ(value, 3) << level;
  }
}

/// Requests in a name come in any order.
TEST_F(Grids, NamesMayAskForSeveralThings) {
  auto grid = openvdb::FloatGrid::create(0.0f);
  grid->denseFill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(15)), 1.0f);
  const std::string path = write({grid});
  for (const std::string& name :
       {coarseName(path, 1) + std::string(unitCubeSuffix), coarseName(path + std::string(unitCubeSuffix), 1)}) {
    const auto file = read(name);
    ASSERT_TRUE(file);
    EXPECT_TRUE(isGridFile(name));
    EXPECT_EQ(fileOfName(name), path);
    EXPECT_DOUBLE_EQ(file->grids()[0]->info().voxelSize[1], 2.0 / 16);
  }
}

TEST_F(Grids, SizesThatLieAreRefused) {
  auto grid = openvdb::FloatGrid::create();
  std::mt19937 random(13);
  auto accessor = grid->getAccessor();
  // No compression makes these any shorter: the block is kept as it is, with its negative size before it.
  for (int i = 0; i < 512; ++i)
    accessor.setValue({i / 64, i / 8 % 8, i % 8},
                      std::bit_cast<float>(static_cast<std::uint32_t>(random()) & 0xbfffffffu));
  const std::string path = (folder_ / "lies.vdb").string();
  openvdb::io::File file(path);
  file.setCompression(openvdb::io::COMPRESS_ZIP);
  file.write({grid});
  file.close();
  ASSERT_TRUE(readGrids(path));
  std::ifstream in(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const auto asBytes = [](std::int64_t size) {
    std::string text(sizeof size, '\0');
    std::memcpy(text.data(), &size, sizeof size);
    return text;
  };
  const std::size_t at = bytes.rfind(asBytes(-2048));
  ASSERT_NE(at, std::string::npos);
  const auto tryBytes = [&](const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
    return readGrids(path);
  };
  for (const std::int64_t size : {std::int64_t{-4096}, std::int64_t{-1}, std::int64_t{1} << 40, INT64_MIN}) {
    const auto lying = tryBytes(std::string(bytes).replace(at, 8, asBytes(size)));
    ASSERT_FALSE(lying) << size;
    EXPECT_EQ(lying.errors().entries()[0].location.file, path);
  }
  // Whatever byte before the values is another one: grids or an error.
  for (std::size_t i = 0; i < at; i += i < 1200 ? 5 : 97) {
    for (const char value : {'\0', '\x7f', '\xff'}) {
      const auto read = tryBytes(std::string(bytes).replace(i, 1, 1, value));
      if (!read) EXPECT_FALSE(format(read.errors()).empty());
    }
  }
}

}  // namespace

}  // namespace aerosol::grid
