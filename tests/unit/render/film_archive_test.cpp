#include "core/render/film_archive.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "core/base/hash.h"

namespace aerosol::render {
namespace {

constexpr PixelRect area{3, 2, 10, 7};

/// Something that no two samples share.
PixelSample sampleOf(int x, int y, std::uint32_t i) {
  const auto value = static_cast<float>(std::sin(x + 7.3 * y + 0.37 * i));
  return {Color(value, 2 * value, -value), value * value};
}

void addRange(Film& film, std::uint32_t first, std::uint32_t end) {
  for (std::uint32_t i = first; i < end; i += FilmTile::maximumSamples) {
    const std::uint32_t last = std::min(end, i + FilmTile::maximumSamples);
    FilmTile tile(film.area(), i, last);
    for (int y = area.y0; y < area.y1; ++y) {
      for (int x = area.x0; x < area.x1; ++x) {
        for (std::uint32_t s = i; s < last; ++s) {
          const PixelSample sample = sampleOf(x, y, s);
          tile.add(x, y, s, sample.color, sample.alpha);
        }
      }
    }
    film.commit(tile);
  }
}

bool areEqual(const Film& a, const Film& b) {
  if (!(a.area() == b.area())) return false;
  for (int y = a.area().y0; y < a.area().y1; ++y) {
    for (int x = a.area().x0; x < a.area().x1; ++x) {
      if (!(a.pixel(x, y) == b.pixel(x, y))) return false;
    }
  }
  return true;
}

TEST(FilmArchive, GivesBackWhatItWasGiven) {
  for (const auto& [first, end] : {std::pair{0u, 0u}, {0u, 7u}, {7u, 100u}, {100u, 256u}, {0u, 1000u}}) {
    Film film(area);
    addRange(film, first, end);
    const auto read = decodeFilm(encodeFilm(film));
    ASSERT_TRUE(read) << format(read.errors());
    EXPECT_TRUE(areEqual(film, **read)) << first << ':' << end;
  }
}

/// The sums of parts that were written and read, joined in any order, are those of the whole.
TEST(FilmArchive, PartsThatWereReadJoinToTheWhole) {
  Film whole(area);
  addRange(whole, 0, 256);
  std::array<std::string, 3> bytes;
  std::size_t i = 0;
  for (const auto& [first, end] : {std::pair{0u, 7u}, {7u, 100u}, {100u, 256u}}) {
    Film part(area);
    addRange(part, first, end);
    bytes[i++] = encodeFilm(part);
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  do {
    Film merged(area);
    for (const std::size_t k : order) EXPECT_FALSE(merged.merge(**decodeFilm(bytes[k])).hasErrors());
    EXPECT_TRUE(areEqual(whole, merged)) << order[0] << order[1] << order[2];
  } while (std::next_permutation(order.begin(), order.end()));
}

/// A sum that was read is carried on as if it had never been away.
TEST(FilmArchive, WhatWasReadIsCarriedOn) {
  Film whole(area), part(area);
  addRange(whole, 0, 300);
  addRange(part, 0, 70);
  const auto read = decodeFilm(encodeFilm(part));
  ASSERT_TRUE(read);
  addRange(**read, 70, 300);
  EXPECT_TRUE(areEqual(whole, **read));
  EXPECT_EQ((*read)->bytes(), whole.bytes());
}

TEST(FilmArchive, KeepsDroppedSamplesAndTheirPlaces) {
  Film film(area);
  FilmTile tile(area, 5, 6);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) tile.add(x, y, 5, x == 4 && y == 3 ? Color(1, nan, 1) : Color(1.0f), 1);
  }
  film.commit(tile);
  const auto read = decodeFilm(encodeFilm(film));
  ASSERT_TRUE(read);
  EXPECT_EQ((*read)->droppedCount(), 1u);
  ASSERT_EQ((*read)->firstDropped().size(), 1u);
  EXPECT_EQ((*read)->firstDropped()[0].x, 4);
  EXPECT_EQ((*read)->firstDropped()[0].sample, 5u);
  EXPECT_TRUE(areEqual(film, **read));
}

TEST(FilmArchive, RefusesDamage) {
  Film film(area);
  addRange(film, 7, 100);
  const std::string good = encodeFilm(film);
  for (std::size_t length = 0; length < good.size(); length += 1 + good.size() / 97) {
    EXPECT_FALSE(decodeFilm(std::string_view(good).substr(0, length))) << length;
  }
  for (std::size_t at = 0; at < good.size(); at += 1 + good.size() / 97) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    EXPECT_FALSE(decodeFilm(bad)) << at;
  }
  EXPECT_FALSE(decodeFilm(good + "x"));
}

/// Bytes with a right checksum may still be no film: nothing is read beyond them, and no invariant is broken.
TEST(FilmArchive, RefusesNonsenseWithARightChecksum) {
  Film film(area);
  addRange(film, 7, 100);
  const std::string good = encodeFilm(film);
  int accepted = 0;
  for (std::size_t at = 0; at + 8 < good.size(); at += 3) {
    std::string bad = good.substr(0, good.size() - 8);
    bad[at] = static_cast<char>(bad[at] ^ 0x55);
    const std::uint64_t check = hashString(bad);
    bad.append(reinterpret_cast<const char*>(&check), sizeof check);
    if (const auto read = decodeFilm(bad)) {
      ++accepted;  // Another value of a sum: nobody can tell.
      EXPECT_TRUE((*read)->area() == area);
      EXPECT_LE((*read)->sampleCount(), 35u * 1000000u);
    }
  }
  EXPECT_GT(accepted, 0);
}

TEST(FilmArchive, ContentThatNoSumHas) {
  using Node = PixelSum::Node;
  const auto isRefused = [](std::vector<Node> nodes, std::vector<PixelSum::OpenSample> open = {},
                            std::uint32_t dropped = 0) {
    return !PixelSum::fromContent({std::move(nodes), std::move(open), dropped});
  };
  EXPECT_FALSE(isRefused({Node{.block = 0, .level = 1}, Node{.block = 2, .prefix = 3}}));
  EXPECT_TRUE(isRefused({Node{.block = 1, .level = 1}})) << "a subtree that does not begin where one may";
  EXPECT_TRUE(isRefused({Node{.block = 0, .level = 1}, Node{.block = 1}})) << "overlap";
  EXPECT_TRUE(isRefused({Node{.block = 2}, Node{.block = 0}})) << "order";
  EXPECT_TRUE(isRefused({Node{.block = 0, .prefix = 64}}));
  EXPECT_TRUE(isRefused({Node{.block = 0, .level = 1, .prefix = 3}}));
  EXPECT_TRUE(isRefused({Node{.block = 0, .level = 40}}));
  EXPECT_TRUE(isRefused({Node{.block = 0}}, {{.index = 5, .sample = {}}})) << "twice";
  EXPECT_TRUE(isRefused({Node{.block = 0, .prefix = 3}}, {}, 4)) << "more dropped than there are";
  EXPECT_TRUE(isRefused({Node{.block = 1u << 26}}));
}

}  // namespace
}  // namespace aerosol::render
