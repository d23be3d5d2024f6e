// Counts of a render. One set a worker, added up at the end.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/accel/scene.h"
#include "core/render/effect_work.h"
#include "core/volume/medium.h"
#include "core/volume/medium_stack.h"

namespace aerosol::render {

/// Work of one kernel: a shader's program in one variant.
struct KernelStatistics {
  std::uint64_t calls = 0;
  std::uint64_t points = 0;
  std::uint64_t lanes = 0;  ///< Points rounded up to whole vectors, call by call.
  std::uint64_t nanoseconds = 0;
  std::uint64_t countedLanesRun = 0, countedLanesUsed = 0;  ///< As below.

  KernelStatistics& operator+=(const KernelStatistics& other);
};

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
  std::uint64_t invalidCoefficients = 0;     ///< Shader results that were NaN, infinite or negative.
  std::uint64_t amplifyingCoefficients = 0;  ///< Shader results that scatter more than they take from rays.
  std::uint64_t invalidVelocities = 0;       ///< That were NaN or infinite: their points did not move.
  std::uint64_t invalidClosures = 0;         ///< Surface points with closures that were NaN or infinite.
  std::uint64_t raysIntoLights = 0;          ///< Rays through media that meet a point light without a radius.
  std::uint64_t bodyEntries = 0;             ///< Paths that went into the body of a surface.
  volume::StackStatistics media;
  WorkCounts work;
  std::vector<std::uint64_t> lightSamples;         ///< By light: how often it was chosen at a point, or met by a ray.
  std::vector<KernelStatistics> kernels;           ///< By family · variantCount + variant.
  std::array<std::uint64_t, phaseCount> phases{};  ///< How often the thread was seen there; only of profiled renders.
  std::uint64_t frameHeapBlocks = 0;               ///< Coroutine frames that did not fit their slot.

  WorkerStatistics& operator+=(const WorkerStatistics& other);
};

}  // namespace aerosol::render
