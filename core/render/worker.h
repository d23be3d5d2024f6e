// One thread of a render: about a thousand paths in flight, their questions answered in batches.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/render/aov/path_record.h"
#include "core/render/film.h"
#include "core/render/integrator.h"
#include "core/render/kernel_queue.h"
#include "core/render/path_context.h"
#include "core/render/renderer.h"
#include "core/render/tile_source.h"

namespace aerosol::render {

/// What the workers of one render share.
struct SharedWork {
  const PreparedScene& scene;
  const Integrator& integrator;
  const RenderOptions& options;
  TileSource& source;
  Film& film;
  std::vector<std::mutex>& tileLocks;  ///< One a tile: two passes over one tile may end at once.
  std::atomic<std::uint64_t>& samplesDone;
};

/// Starts paths, lets each run until it asks for shader values, runs the fullest queue of questions, and goes on with
/// the paths that were answered. New paths come from the next tile before the last has drained. A path stays on its
/// thread.
class Worker final : public QuestionSink {
 public:
  explicit Worker(SharedWork shared);
  ~Worker() override;

  void run();
  const WorkerStatistics& statistics() const { return statistics_; }
  const PhaseMark& phase() const { return statistics_.accel.phase; }

 private:
  /// A tile of which samples are in flight.
  struct OpenTile {
    TileWork work;
    FilmTile samples;
    std::size_t started = 0;
  };
  struct Slot {
    std::unique_ptr<PathContext> path;
    std::optional<volume::Task<Radiance>> task;
    std::unique_ptr<PathRecord> record;  ///< Null without AOVs.
    std::unique_ptr<PilotPath> pilot;    ///< Null but in a pilot.
    OpenTile* tile = nullptr;
    float filterWeight = 1;
  };

  void post(PathContext& path) override;
  void refill();
  /// False when there is no more work.
  bool startPath(std::uint32_t slot);
  void finish(std::uint32_t slot);
  void close(OpenTile* tile);
  bool isStopped() const;

  SharedWork shared_;
  WorkerStatistics statistics_;
  KernelQueues queues_;
  std::vector<Slot> slots_;
  std::vector<PathContext*> paths_;
  std::vector<std::uint32_t> free_;
  std::vector<std::uint32_t> ready_;
  std::vector<std::unique_ptr<OpenTile>> open_;
  std::vector<std::unique_ptr<OpenTile>> unused_;
  OpenTile* current_ = nullptr;
  std::uint32_t running_ = 0;  ///< The slot whose path is being run.
  bool drained_ = false;
};

}  // namespace aerosol::render
