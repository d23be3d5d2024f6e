// Runs an integrator over the pixels of a film on all threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>

#include "core/render/film.h"
#include "core/render/integrator.h"
#include "core/render/prepared_scene.h"
#include "core/render/statistics.h"

namespace aerosol::render {

/// How far a render is. Called from one thread at a time, several times a second at most.
struct Progress {
  double fraction = 0;        ///< Of all samples, 0 to 1.
  double seconds = 0;         ///< Since the start.
  std::uint64_t samples = 0;  ///< Finished, all pixels together.
};

struct RenderOptions {
  int threads = 0;                                ///< 0: one a processor.
  std::uint32_t firstSample = 0;                  ///< Of every pixel.
  std::uint32_t endSample = 16;                   ///< Behind the last.
  int pathsInFlight = 512;                        ///< Of one thread.
  int batchSize = 1024;                           ///< Points of one kernel call, at most.
  std::function<void(const Progress&)> progress;  ///< May be empty.
  const std::atomic<bool>* stop = nullptr;  ///< Set by somebody: the render ends soon; the film keeps what is complete.
};

struct RenderReport {
  WorkerStatistics statistics;
  double seconds = 0;
  bool interrupted = false;
};

/// Adds the samples [firstSample, endSample) of every pixel of the film's crop. The film's content depends on the
/// scene, the seed and the samples alone: not on threads, widths, batches or the order of work.
RenderReport render(const PreparedScene& scene, const Integrator& integrator, Film& film, const RenderOptions& options);

}  // namespace aerosol::render
