// Noise removed from a render with the help of what is known about its pixels.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace aerosol::image {

/// Values of pixels, row by row, channels interleaved.
struct Raster {
  int channels = 0;
  std::vector<float> values;
};

/// Something that follows the edges of the picture: albedo, normals, depth.
struct DenoiseFeature {
  Raster mean;
  Raster variance;  ///< Of the means; no values: there is no noise in it.
};

struct DenoiseInput {
  int width = 0, height = 0;
  Raster halfA, halfB;  ///< The picture by two halves of its samples, three channels each.
  Raster variance;      ///< Of the mean of both.
  std::vector<DenoiseFeature> features;
};

struct DenoiseOptions {
  int threads = 1;
  int windowRadius = 9;   ///< Pixels: how far away others may be that are averaged.
  int patchRadius = 3;    ///< Pixels around two that have to look alike.
  float strength = 0.5f;  ///< Standard deviations by which they may differ.
};

/// The picture without noise, three channels. Pixels of which nothing is like them stay as they are. The same for any
/// number of threads.
Raster denoise(const DenoiseInput& input, const DenoiseOptions& options);

}  // namespace aerosol::image
