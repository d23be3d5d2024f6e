// Which samples a film still lacks.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/render/film.h"

namespace aerosol::app {

/// Pixels that all lack the same samples.
struct MissingSamples {
  render::PixelRect area;
  std::vector<render::PixelSum::Range> samples;
};

/// Everything that the pixels lack of the samples 0 ≤ i < `sampleCount`, as rectangles.
std::vector<MissingSamples> findMissing(const render::Film& film, std::uint64_t sampleCount);

/// "samples 7:100 of the pixels 0,0,64,32 (x,y,w,h)".
std::string describe(const MissingSamples& missing);

/// "0:7 100:256".
std::string formatRanges(const std::vector<render::PixelSum::Range>& ranges);

}  // namespace aerosol::app
