#include "core/render/film_archive.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/base/hash.h"

namespace aerosol::render {

namespace {

/// Changes with the layout.
constexpr std::uint64_t magic = 0x336d6c69466f7265;  // "eroFilm3"

template <class A>
void describe(A& archive, PixelRect& rect) {
  archive(rect.x0, rect.y0, rect.x1, rect.y1);
}

Diagnostic damaged() { return {Severity::error, {}, "the sums of samples in this file are damaged", {}, {}}; }

/// Reads what was gathered of one pixel: the same samples as its picture has.
bool readAovs(ArchiveReader& archive, Film& film, int x, int y) {
  AovSum::Content content;
  archive(content);
  const std::size_t width = film.layout().width, mattes = film.layout().mattes.size();
  for (const auto& node : content.nodes) {
    if (!node.sums.values.empty() && node.sums.values.size() != width) return false;
    if (node.sums.mattes.size() != (node.sums.values.empty() ? 0 : mattes)) return false;
  }
  for (const auto& open : content.open) {
    if (open.sample.values.size() != width || open.sample.mattes.size() != mattes) return false;
  }
  auto sum = AovSum::fromContent(content);
  const PixelSum& pixel = film.pixel(x, y);
  if (!sum || sum->count() != pixel.count() || sum->ranges() != pixel.ranges()) return false;
  film.restore(x, y, std::move(*sum));
  return true;
}

/// Reads the pixels of the parts into the film. False when they cannot be right.
bool readParts(ArchiveReader& archive, Film& film) {
  for (;;) {
    PixelRect part;
    describe(archive, part);
    if (part == PixelRect{}) return true;
    if (part.x0 >= part.x1 || part.y0 >= part.y1 || !film.area().contains(part)) return false;
    for (int y = part.y0; y < part.y1; ++y) {
      for (int x = part.x0; x < part.x1; ++x) {
        PixelSum::Content content;
        archive(content);
        auto sum = PixelSum::fromContent(content);
        if (!sum) return false;
        film.restore(x, y, std::move(*sum));
        if (!film.layout().isEmpty() && !readAovs(archive, film, x, y)) return false;
      }
    }
  }
}

}  // namespace

FilmWriter::FilmWriter(const Film& film) {
  std::uint64_t first = magic;
  PixelRect rect = film.area();
  AovLayout layout = film.layout();
  bool isScrambled = film.isScrambled();
  archive_(first);
  describe(archive_, rect);
  archive_(layout, isScrambled);
}

void FilmWriter::add(const Film& film, const PixelRect& part) {
  PixelRect rect = part;
  describe(archive_, rect);
  for (int y = part.y0; y < part.y1; ++y) {
    for (int x = part.x0; x < part.x1; ++x) {
      PixelSum::Content content = film.pixel(x, y).content();
      archive_(content);
      if (film.layout().isEmpty()) continue;
      AovSum::Content aovs = film.aovs(x, y).content();
      archive_(aovs);
    }
  }
}

std::string FilmWriter::finish(const Film& film) {
  PixelRect end;
  describe(archive_, end);
  std::vector<DroppedSample> dropped = film.copyFirstDropped();
  archive_(dropped);
  std::string bytes = archive_.take();
  const std::uint64_t check = hashString(bytes);
  bytes.append(reinterpret_cast<const char*>(&check), sizeof check);
  return bytes;
}

std::string encodeFilm(const Film& film) {
  FilmWriter writer(film);
  writer.add(film, film.area());
  return writer.finish(film);
}

Result<std::unique_ptr<Film>> decodeFilm(std::string_view bytes) {
  std::uint64_t check = 0, first = 0;
  if (bytes.size() < 2 * sizeof check + sizeof(PixelRect)) return damaged();
  std::memcpy(&check, bytes.data() + bytes.size() - sizeof check, sizeof check);
  bytes.remove_suffix(sizeof check);
  if (hashString(bytes) != check) return damaged();
  ArchiveReader archive(bytes);
  PixelRect area;
  archive(first);
  describe(archive, area);
  AovLayout layout;
  bool isScrambled = false;
  archive(layout, isScrambled);
  constexpr int largest = 1 << 24;
  const bool isArea = area.x0 < area.x1 && area.y0 < area.y1 && area.x0 >= -largest && area.y0 >= -largest &&
                      area.x1 <= largest && area.y1 <= largest;
  constexpr std::size_t leastBytes = 12;  // Of a pixel.
  if (first != magic || !isArea || area.pixelCount() > bytes.size() / leastBytes) return damaged();
  if (!layout.isSound()) return damaged();
  auto film = std::make_unique<Film>(area, std::move(layout));
  film->setScrambled(isScrambled);
  if (!readParts(archive, *film)) return damaged();
  std::vector<DroppedSample> dropped;
  archive(dropped);
  if (!archive.succeeded()) return damaged();
  film->recordDropped(std::move(dropped));
  return film;
}

}  // namespace aerosol::render
