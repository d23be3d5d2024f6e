#include "core/render/film_error.h"

#include <algorithm>
#include <cmath>

#include "core/render/pixel_error.h"

namespace aerosol::render {

void FilmError::add(const Film& film, const PixelRect& part) {
  for (int y = part.y0; y < part.y1; ++y) {
    for (int x = part.x0; x < part.x1; ++x) {
      const PixelSum& pixel = film.pixel(x, y);
      ++pixels_;
      const double n = pixel.count();
      samples_ += n;
      if (n < 2) continue;
      ++known_;
      const SampleSums total = pixel.total();
      const std::array<double, 3> squares = squaredErrors(pixel, total, film.isScrambled(), 2);
      for (std::size_t c = 0; c < 3; ++c) {
        values_ += std::fabs(total.color[c] / n);
        squares_ += squares[c];
      }
    }
  }
}

double FilmError::relative() const {
  if (known_ == 0 || !(values_ > 0)) return 0;
  const double terms = 3 * static_cast<double>(known_);
  return std::sqrt(squares_ / terms) / (values_ / terms);
}

double relativeError(const Film& film) {
  FilmError error;
  error.add(film, film.area());
  return error.relative();
}

std::uint32_t nextDecision(std::uint32_t count) {
  std::uint32_t power = 1;
  while (power <= count / 2) power *= 2;
  if (count < 1) return 1;
  const std::uint32_t middle = power + power / 2;
  return count < middle ? middle : 2 * power;
}

std::uint32_t firstErrorDecision(std::uint64_t pixels) {
  constexpr std::uint64_t leastSamples = 1u << 16;
  constexpr std::uint32_t leastCount = 16;
  std::uint32_t count = leastCount;
  while (count * pixels < leastSamples) count = nextDecision(count);
  return count;
}

}  // namespace aerosol::render
