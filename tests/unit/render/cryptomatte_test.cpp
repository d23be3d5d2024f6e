#include "core/render/aov/cryptomatte.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "core/render/aov/aov_pixels.h"

namespace aerosol::render {
namespace {

/// Values that the hash's author and others publish, and those of the specification's example.
TEST(Cryptomatte, HashesAsOthersDo) {
  EXPECT_EQ(murmurHash3(""), 0u);
  EXPECT_EQ(murmurHash3("", 1), 0x514e28b7u);
  EXPECT_EQ(murmurHash3("hello"), 0x248bfa47u);
  EXPECT_EQ(murmurHash3("hello, world"), 0x149bbb7fu);
  EXPECT_EQ(murmurHash3("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
  EXPECT_EQ(matteId("bunny"), 0x13851a76u);
  EXPECT_EQ(matteId("default"), 0x42c9679fu);
}

TEST(Cryptomatte, IdsAreNormalFloats) {
  int changed = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::string name = "thing_" + std::to_string(i);
    const auto value = std::bit_cast<float>(matteId(name));
    EXPECT_TRUE(std::isnormal(value)) << name;
    changed += matteId(name) != murmurHash3(name);
    EXPECT_EQ((matteId(name) ^ murmurHash3(name)) & ~(1u << 23), 0u);
  }
  EXPECT_GT(changed, 2);
  EXPECT_LT(changed, 40);
}

TEST(Cryptomatte, DescribesItselfInTheFile) {
  const std::vector<MatteName> names = {{"bunny", 0x13851a76u}, {"a \"b\"\\\n", 0x0000beefu}};
  const auto metadata = matteMetadata("CryptoObject", names);
  ASSERT_EQ(metadata.size(), 4u);
  EXPECT_EQ(metadata[0].key, "cryptomatte/3ae39a5/name");
  EXPECT_EQ(metadata[0].value, "CryptoObject");
  EXPECT_EQ(metadata[1].value, "MurmurHash3_32");
  EXPECT_EQ(metadata[2].value, "uint32_to_float32");
  EXPECT_EQ(metadata[3].key, "cryptomatte/3ae39a5/manifest");
  EXPECT_EQ(metadata[3].value, R"({"bunny":"13851a76","a \"b\"\\\u000a":"0000beef"})");
}

TEST(Cryptomatte, SharesAddUpByThing) {
  MatteShares shares;
  for (const auto& [id, weight] : {std::pair{7u, 1.0}, {3u, 0.5}, {7u, 2.0}, {9u, 0.25}})
    addMatteShare(shares, {id, weight});
  const MatteShares expected = {{3, 0.5}, {7, 3}, {9, 0.25}};
  EXPECT_EQ(shares, expected);
  const MatteShares both = {{3, 1}, {7, 6}, {9, 0.5}};
  EXPECT_EQ(shares + shares, both);
}

/// More things in a pixel than layers have room: the largest are shown, and none is lost before the end.
TEST(Cryptomatte, RanksThingsByCoverage) {
  AovLayout layout;
  layout.width = 2;
  layout.mattes.push_back({"CryptoObject", 0, 1, {}});
  for (std::uint32_t part = 0; part < 2; ++part)
    layout.layers.push_back({"CryptoObject0" + std::to_string(part),
                             "crypto_object",
                             {"R", "G", "B", "A"},
                             AovFinish::matte,
                             2 * part,
                             0,
                             true});
  ASSERT_TRUE(layout.isSound());
  Film film({0, 0, 1, 1}, layout);
  const auto add = [&](std::uint32_t first, const std::vector<std::uint32_t>& ids) {
    const auto end = first + static_cast<std::uint32_t>(ids.size());
    FilmTile tile({0, 0, 1, 1}, first, end, layout.width);
    for (std::uint32_t i = first; i < end; ++i)
      tile.add(0, 0, i, Color(1), 1, std::array{std::bit_cast<float>(ids[i - first]), 1.0f});
    film.commit(tile);
  };
  // Five things in ten samples; the last sample sees nothing.
  add(0, {0x40000001, 0x40000002, 0x40000002, 0x40000003, 0x40000005});
  add(5, {0x40000004, 0x40000003, 0x40000002, 0x40000003, 0});
  const std::vector<float> first = layerPixels(film, film.layout().layers[0]);
  const std::vector<float> second = layerPixels(film, film.layout().layers[1]);
  // Equal coverage by the smaller id first.
  EXPECT_EQ(std::bit_cast<std::uint32_t>(first[0]), 0x40000002u);
  EXPECT_FLOAT_EQ(first[1], 0.3f);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(first[2]), 0x40000003u);
  EXPECT_FLOAT_EQ(first[3], 0.3f);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(second[0]), 0x40000001u);
  EXPECT_FLOAT_EQ(second[1], 0.1f);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(second[2]), 0x40000004u);
}

}  // namespace
}  // namespace aerosol::render
