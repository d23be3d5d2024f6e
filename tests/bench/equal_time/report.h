// What was measured: as text, as JSON, and beside what an earlier run has written.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "tests/bench/equal_time/measure.h"

namespace aerosol::bench {

/// A table of one scene.
std::string describe(const SceneResult& scene);

/// The ratios of all scenes, with the automatic choice's distance from the best and from the simplest.
std::string summarise(const std::vector<SceneResult>& scenes);

std::string toJson(const std::vector<SceneResult>& scenes, const Effort& effort);

/// Median costs of a file that `toJson` made: scene, method, cost.
struct EarlierCost {
  std::string scene, method;
  double cost = 0;
};
struct Earlier {
  std::string effort;
  std::vector<EarlierCost> costs;
};
Result<Earlier> readJson(const std::string& file);

std::string compare(const std::vector<SceneResult>& now, const Effort& effort, const Earlier& earlier);

}  // namespace aerosol::bench
