// How far a film may still be from the image that it estimates.
#pragma once

#include <cstdint>

#include "core/render/film.h"

namespace aerosol::render {

/// Sums over pixels and channels, added up part by part.
class FilmError {
 public:
  void add(const Film& film, const PixelRect& part);

  /// The root mean square over pixels and channels of the standard error, as a part of the mean value of the image; 0
  /// where nothing is known: fewer than two samples, or a black image.
  ///
  /// Each pixel's error comes from what its samples scatter: independent ones one by one, those of a low-discrepancy
  /// sampler scramble by scramble. From 16 samples on a pixel has two scrambles, so even the smallest image at which a
  /// decision is made (firstErrorDecision) has thousands. With fewer samples it is a bound.
  double relative() const;
  /// Samples of a pixel, in the mean.
  double meanSamples() const { return pixels_ > 0 ? samples_ / static_cast<double>(pixels_) : 0; }

 private:
  double squares_ = 0;  ///< Of standard errors.
  double values_ = 0;   ///< Magnitudes of means.
  double samples_ = 0;
  std::uint64_t pixels_ = 0, known_ = 0;
};

double relativeError(const Film& film);

/// The counts at which a render decides whether it goes on: 1, 2, 3, 4, 6, 8, 12 … . From 64 on they are multiples of
/// 32. The smallest that is greater than `count`.
std::uint32_t nextDecision(std::uint32_t count);

/// The first count at which a target error may end a render. Decisions see the samples that enter the image, so a rare
/// bright sample that has not been met ends a render early: the image is too dark in the mean over many renders. With
/// so many samples of the whole film an event of probability 1e-3 has been met some sixty times, and the bias is small
/// against the target (measured in tests).
std::uint32_t firstErrorDecision(std::uint64_t pixels);

}  // namespace aerosol::render
