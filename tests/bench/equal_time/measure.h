// One scene by all methods: error times time against a reference of its own.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/equal_time/scenes.h"

namespace aerosol::bench {

/// How much is rendered.
struct Effort {
  const char* name = "";
  int width = 0, height = 0;
  int seeds = 0;
  double secondsOfReference = 0;  ///< Of each half.
  double secondsOfSeed = 0;       ///< Of each method.
  double voxel = 0;               ///< Size, of the baked cloud.
};

inline constexpr std::array efforts{Effort{"tiny", 8, 6, 2, 0.02, 0.01, 0.2}, Effort{"quick", 48, 36, 4, 5, 0.4, 0.03},
                                    Effort{"full", 96, 72, 16, 120, 4, 0.015}};

/// Median and quartiles over the seeds.
struct Spread {
  double low = 0, median = 0, high = 0;

  static Spread of(std::vector<double> values);
};

struct MethodResult {
  std::string name;
  std::string choices;             ///< What preparation made of it, medium by medium.
  std::uint32_t samples = 0;       ///< A pixel.
  std::vector<double> error;       ///< By seed: mean squared, over the mean's square; the reference's own is taken off.
  std::vector<double> seconds;     ///< By seed: of the processor, on one thread.
  std::vector<double> cost;        ///< Their product.
  std::vector<double> pixelCost;   ///< The same with each value\'s error as a part of that value.
  double meanDifference = 0;       ///< From the reference's mean, all seeds together, as a part of it.
  double meanDifferenceError = 0;  ///< Its standard error, the reference's included.
};

struct SceneResult {
  std::string name;
  std::uint32_t referenceSamples = 0;  ///< A pixel, of the smaller half.
  double referenceError = 0;           ///< Relative, root mean square.
  double halvesDiffer = 0;             ///< Mean of the second half over that of the first, less 1.
  double halvesError = 0;              ///< Standard error of that.
  std::vector<MethodResult> methods;

  const MethodResult* find(const std::string& method) const;
  /// The least median cost of a method that was forced.
  const MethodResult* best() const;
};

/// Costs of one method over those of another, seed by seed.
Spread ratio(const std::vector<double>& one, const std::vector<double>& other);

/// `only`: the method measured beside the automatic choice; empty: all.
SceneResult measure(const BenchScene& scene, const Effort& effort, const std::string& only);

}  // namespace aerosol::bench
