// Where the time of a render went.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/app/statistics_report.h"

namespace aerosol::app {

/// The work of one compiled shader.
struct ShaderCost {
  std::string shader;   ///< Its name in the scene.
  std::string variant;  ///< "coefficients", "extinction" or "surface".
  std::size_t instances = 0;
  render::KernelStatistics work;
  double share = 0;  ///< Of the threads' time.
};

/// Those that were called, the dearest first. `threadSeconds` is the time of all threads together.
std::vector<ShaderCost> shaderCosts(const render::PreparedScene& scene, const render::WorkerStatistics& statistics,
                                    double threadSeconds);

/// A part of the work of paths that is no shader.
struct PhaseCost {
  std::string name;
  double share = 0;
};

/// Shares of the threads' time as the profiler saw them; empty without a profile.
std::vector<PhaseCost> phaseCosts(const render::WorkerStatistics& statistics);

/// Tables for people.
std::string explainCost(const render::PreparedScene& scene, const render::RenderReport& report, int threads);

/// How a render went, for programs.
struct StatisticsRecord {
  const render::PreparedScene& scene;
  const render::RenderReport& report;
  const render::Film& film;
  PreparationTimes times;
  int threads = 1;
  std::string sceneFile;
};
std::string statisticsJson(const StatisticsRecord& record);

}  // namespace aerosol::app
