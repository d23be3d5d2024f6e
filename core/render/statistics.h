// Counts of a render. One set a worker, added up at the end.
#pragma once

#include <cstdint>

#include "core/accel/scene.h"
#include "core/volume/medium.h"
#include "core/volume/medium_stack.h"

namespace aerosol::render {

struct WorkerStatistics {
  accel::Counters accel;
  volume::TrackerStatistics trackers;
  std::uint64_t samples = 0;
  std::uint64_t pathVertices = 0;  ///< Scattering events, in media and on surfaces.
  std::uint64_t kernelCalls = 0;
  std::uint64_t kernelPoints = 0;
  std::uint64_t kernelLanes = 0;      ///< Points rounded up to whole vectors, call by call.
  std::uint64_t countedLanesRun = 0;  ///< Weighted by the cost of each block of code; kernels with counters alone.
  std::uint64_t countedLanesUsed = 0;
  std::uint64_t invalidCoefficients = 0;  ///< Shader results that were NaN, infinite or negative.
  std::uint64_t invalidClosures = 0;      ///< Surface points with closures that were NaN or infinite.
  volume::StackStatistics media;
  std::uint64_t frameHeapBlocks = 0;  ///< Coroutine frames that did not fit their slot.

  WorkerStatistics& operator+=(const WorkerStatistics& other);
};

}  // namespace aerosol::render
