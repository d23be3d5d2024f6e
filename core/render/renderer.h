// Runs an integrator over the pixels of a film on all threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/render/contribution_map.h"
#include "core/render/film.h"
#include "core/render/integrator.h"
#include "core/render/prepared_scene.h"
#include "core/render/sample_map.h"
#include "core/render/statistics.h"

namespace aerosol::render {

/// How far a render is. Called from one thread at a time, several times a second at most.
struct Progress {
  double fraction = 0;        ///< Of all samples, 0 to 1.
  double seconds = 0;         ///< Since the start.
  std::uint64_t samples = 0;  ///< Finished since the start, all pixels together.
  double before = 0;          ///< Fraction that was there at the start.
  double error = 0;           ///< Relative error of the image a little earlier (film_error.h); 0: not known.
};

/// The paths of a pilot, in any order.
struct PilotLog {
  std::mutex mutex;
  std::vector<PilotPath> paths;
};

struct RenderOptions {
  int threads = 0;                                ///< 0: one a processor.
  std::uint32_t firstSample = 0;                  ///< Of every pixel.
  std::uint32_t endSample = 16;                   ///< Behind the last.
  const SampleMap* map = nullptr;                 ///< What tiles take instead, of the film's area; null: the same.
  int pathsInFlight = 512;                        ///< Of one thread.
  int batchSize = 1024;                           ///< Points of one kernel call, at most.
  std::function<void(const Progress&)> progress;  ///< May be empty.
  std::optional<std::uint64_t> seed;              ///< Instead of the scene's.
  /// What the film holds so far as bytes (see film_archive.h), now and then while the render goes on; may be empty.
  std::function<void(std::string)> checkpoint;
  /// Called with each part of the film that got samples, by the thread that renders it: others keep off that part.
  std::function<void(const PixelRect&)> partDone;
  PilotLog* pilot = nullptr;                ///< Takes note of all paths.
  double checkpointSeconds = 30;            ///< From the end of one to the next; longer where they take long.
  bool profile = false;                     ///< Look where the threads are, a thousand times a second.
  const std::atomic<bool>* stop = nullptr;  ///< Set by somebody: the render ends soon; the film keeps what is complete.
};

struct RenderReport {
  WorkerStatistics statistics;
  double seconds = 0;
  bool interrupted = false;
};

/// Adds those of the samples [firstSample, endSample) that the pixels of the film's crop do not have. The film's
/// content depends on the scene, the seed and the samples alone: not on threads, widths, batches or the order of work.
RenderReport render(const PreparedScene& scene, const Integrator& integrator, Film& film, const RenderOptions& options);

}  // namespace aerosol::render
