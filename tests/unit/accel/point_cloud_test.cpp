// Clouds of points: searches against all distances, files and what is wrong with them, clouds written and read again.

#include "core/accel/point_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "core/accel/point_writer.h"
#include "tests/support/scratch_folder.h"

namespace aerosol::accel {

namespace {

namespace fs = std::filesystem;

class PointFiles : public testing::Test {
 protected:
  Result<std::shared_ptr<const PointCloud>> read(const std::string& name, const std::string& content) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << content;
    return readPoints(path);
  }
  /// "line:column: message" of the first error.
  std::string problem(const std::string& name, const std::string& content) {
    const auto result = read(name, content);
    if (result) return "none";
    const Diagnostic& error = result.errors().entries()[0];
    return std::to_string(error.location.line) + ":" + std::to_string(error.location.column) + ": " + error.message;
  }

  test::ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
};

PointAttribute floats(const std::string& name, int components, std::vector<float> values) {
  PointAttribute attribute;
  attribute.name = name;
  attribute.components = components;
  attribute.floats = std::move(values);
  return attribute;
}

TEST(PointCloud, FindsWhatAllDistancesSay) {
  std::mt19937 random(5);
  std::vector<float> positions;
  // Points of a lattice: many distances are equal.
  for (int i = 0; i < 3000; ++i) positions.push_back(static_cast<float>(random() % 12));
  const auto cloud = makePointCloud({floats("position", 3, positions)});
  ASSERT_EQ(cloud->size(), 1000u);
  for (int n = 0; n < 300; ++n) {
    float at[3];
    for (float& x : at) x = n % 2 ? static_cast<float>(random() % 12) : static_cast<float>(random() % 1200) / 100;
    const float radius = static_cast<float>(random() % 50) / 10;
    const std::size_t most = n % 7 == 0 ? 2000 : random() % 40;
    std::vector<FoundPoint> all, found;
    for (std::uint32_t i = 0; i < 1000; ++i) {
      double d = 0;
      for (std::size_t r = 0; r < 3; ++r) {
        const double e = static_cast<double>(positions[3 * i + r]) - static_cast<double>(at[r]);
        d += e * e;
      }
      if (d <= static_cast<double>(radius) * static_cast<double>(radius)) all.push_back({d, i});
    }
    std::sort(all.begin(), all.end());
    if (all.size() > most) all.resize(most);
    cloud->search(at, radius, most, found);
    ASSERT_EQ(found.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(found[i].index, all[i].index);
      EXPECT_DOUBLE_EQ(found[i].distanceSquared, all[i].distanceSquared);
    }
  }
}

TEST(PointCloud, NothingIsFoundFromNowhere) {
  const auto cloud = makePointCloud({floats("position", 3, {0, 0, 0, 1, 1, 1})});
  std::vector<FoundPoint> found = {{}};
  const float nan[3] = {std::nanf(""), 0, 0}, zero[3] = {};
  cloud->search(nan, 10, 5, found);
  EXPECT_TRUE(found.empty());
  cloud->search(zero, std::nanf(""), 5, found);
  EXPECT_TRUE(found.empty());
  cloud->search(zero, -1, 5, found);
  EXPECT_TRUE(found.empty());
  cloud->search(zero, std::numeric_limits<float>::infinity(), 5, found);
  EXPECT_EQ(found.size(), 2u);
  const auto empty = makePointCloud({floats("position", 3, {})});
  empty->search(zero, 10, 5, found);
  EXPECT_TRUE(found.empty());
}

TEST_F(PointFiles, PlyInTextAndColoursInBytes) {
  const auto cloud =
      read("a.ply",
           "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int id\n"
           "property list uchar int links\nproperty float heat\nend_header\n"
           "1 2 3 255 0 51 7 2 5 6 0.5\n4 5 6 0 255 102 8 0 0.75\n");
  ASSERT_TRUE(cloud) << format(cloud.errors());
  ASSERT_EQ((*cloud)->size(), 2u);
  EXPECT_EQ((*cloud)->find("position")->floats, (std::vector<float>{1, 2, 3, 4, 5, 6}));
  const PointAttribute* color = (*cloud)->find("color");
  ASSERT_TRUE(color);
  EXPECT_EQ(color->components, 3);
  EXPECT_NEAR(color->floats[2], 0.2f, 1e-7);
  EXPECT_EQ((*cloud)->find("id")->integers, (std::vector<std::int32_t>{7, 8}));
  EXPECT_EQ((*cloud)->find("heat")->floats, (std::vector<float>{0.5f, 0.75f}));
}

TEST_F(PointFiles, WhatIsWrongIsLocated) {
  EXPECT_EQ(problem("a.csv", ""), "1:1: the file has no line of column names");
  EXPECT_EQ(problem("a.csv", "x,y,z\n1,2\n"), "2:1: the line has 2 fields and not 3, one for each column");
  EXPECT_EQ(problem("a.csv", "x,y,z\n1,2,3\n1, two,3\n"), "3:4: a coordinate is a finite number");
  EXPECT_EQ(problem("a.csv", "x,y,z,n\n1,2,3,\"open\n"), "2:7: the quoted field has no end");
  EXPECT_EQ(problem("a.csv", "x,y,z,n\n1,2,3,\"a\"b\n"), "2:10: expected a comma after the quoted field");
  EXPECT_NE(problem("a.csv", "a,b\n1,2\n").find("no position"), std::string::npos);
  EXPECT_NE(problem("a.txt", "x,y,z\n").find(".ply or .csv"), std::string::npos);
  EXPECT_NE(problem("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                    "property float z\nend_header\n1 2 3\n4 x 6\n")
                .find("9:3"),
            std::string::npos);
  EXPECT_NE(
      problem("a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 1000000\nproperty float x\nend_header\n")
          .find("too short"),
      std::string::npos);
}

TEST_F(PointFiles, WhatIsWrittenIsRead) {
  PointWriter forwards, backwards;
  std::string none;
  const auto point = [](int i) {
    const auto f = static_cast<float>(i);
    std::vector<PointAttribute> result = {floats("position", 3, {f, 2 * f, 0.1f}),
                                          floats("color", 3, {0.25f * f, 1, 0}), floats("w", 4, {f, 1, 2, 3})};
    PointAttribute id;
    id.name = "id";
    id.base = PointAttribute::Base::integer;
    id.integers = {i};
    result.push_back(id);
    return result;
  };
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(forwards.add(point(i), none));
    EXPECT_TRUE(backwards.add(point(19 - i), none));
  }
  std::string refused;
  EXPECT_FALSE(forwards.add({floats("position", 3, {0, 0, 0})}, refused));
  EXPECT_NE(refused, "");
  for (const char* extension : {".csv", ".ply"}) {
    const auto content = forwards.encode(extension, none);
    ASSERT_TRUE(content) << none;
    EXPECT_EQ(*content, *backwards.encode(extension, none));
    const auto cloud = read(std::string("a") + extension, *content);
    ASSERT_TRUE(cloud) << format(cloud.errors());
    ASSERT_EQ((*cloud)->size(), 20u);
    ASSERT_TRUE((*cloud)->find("color") && (*cloud)->find("w") && (*cloud)->find("id"));
    EXPECT_EQ((*cloud)->find("w")->components, 4);
    for (std::uint32_t i = 0; i < 20; ++i) {
      const auto f = static_cast<float>(i);
      EXPECT_EQ((*cloud)->find("position")->floats[3 * i + 1], 2 * f);
      EXPECT_EQ((*cloud)->find("color")->floats[3 * i], 0.25f * f);
      EXPECT_EQ((*cloud)->find("id")->integers[i], static_cast<std::int32_t>(i));
    }
  }
}

}  // namespace

}  // namespace aerosol::accel
