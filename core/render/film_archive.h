// Films as bytes: all that is kept of every pixel's samples, so that a render can be carried on elsewhere or later.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/base/archive.h"
#include "core/base/result.h"
#include "core/render/film.h"

namespace aerosol::render {

/// Writes a film part by part, so that parts which are being rendered can be locked one at a time. Each pixel is
/// consistent by itself: the film that is read back can be carried on.
class FilmWriter {
 public:
  explicit FilmWriter(const Film& film);

  /// Every pixel of the film once, in rectangular parts.
  void add(const Film& film, const PixelRect& part);
  /// The bytes. To be called once.
  std::string finish(const Film& film);

 private:
  ArchiveWriter archive_;
};

/// The whole film.
std::string encodeFilm(const Film& film);

/// Refuses bytes that are not complete and unharmed; the error has no place.
Result<std::unique_ptr<Film>> decodeFilm(std::string_view bytes);

}  // namespace aerosol::render
