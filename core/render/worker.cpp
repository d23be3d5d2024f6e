#include "core/render/worker.h"

#include <algorithm>

namespace aerosol::render {

namespace {

/// Paths ahead of the one that runs whose frames are fetched: several hundred frames do not fit the nearest cache.
constexpr std::size_t prefetchDistance = 3;

}  // namespace

Worker::Worker(SharedWork shared) : shared_(shared), queues_(shared.scene, statistics_, shared.options.batchSize) {
  const auto count = static_cast<std::uint32_t>(std::max(1, shared.options.pathsInFlight));
  slots_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    slots_[i].path = std::make_unique<PathContext>(shared.scene, *this, statistics_);
    paths_.push_back(slots_[i].path.get());
    free_.push_back(count - 1 - i);
  }
}

Worker::~Worker() = default;

bool Worker::isStopped() const { return shared_.options.stop && shared_.options.stop->load(std::memory_order_relaxed); }

void Worker::run() {
  while (!isStopped()) {
    refill();
    if (queues_.empty()) break;
    ready_.clear();
    for (const PendingQuestion& answered : queues_.runFullest(paths_)) {
      if (paths_[answered.slot]->answered()) ready_.push_back(answered.slot);
    }
    for (std::size_t i = 0; i < ready_.size(); ++i) {
      if (i + prefetchDistance < ready_.size()) paths_[ready_[i + prefetchDistance]]->prefetch();
      running_ = ready_[i];
      if (!paths_[running_]->resume()) finish(running_);
    }
  }
  for (const Slot& slot : slots_) statistics_.frameHeapBlocks += slot.path->frames().heapBlocks();
}

void Worker::refill() {
  while (!free_.empty() && !drained_) {
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    if (!startPath(slot)) {
      free_.push_back(slot);
      drained_ = true;
    }
  }
}

bool Worker::startPath(std::uint32_t index) {
  if (!current_) {
    const std::optional<TileWork> work = shared_.source.next();
    if (!work) return false;
    if (unused_.empty()) unused_.push_back(std::make_unique<OpenTile>());
    open_.push_back(std::move(unused_.back()));
    unused_.pop_back();
    current_ = open_.back().get();
    current_->work = *work;
    current_->started = 0;
    current_->samples.reset(work->area, work->firstSample, work->endSample);
  }
  OpenTile& tile = *current_;
  const std::size_t samples = tile.work.endSample - tile.work.firstSample;
  const std::size_t pixel = tile.started / samples;
  const auto width = static_cast<std::size_t>(tile.work.area.width());
  const PathId id{tile.work.area.x0 + static_cast<int>(pixel % width),
                  tile.work.area.y0 + static_cast<int>(pixel / width),
                  tile.work.firstSample + static_cast<std::uint32_t>(tile.started % samples)};
  if (++tile.started == samples * tile.work.area.pixelCount()) current_ = nullptr;

  Slot& slot = slots_[index];
  const PreparedScene& scene = shared_.scene;
  SampleStream random(scene.sampler, shared_.options.seed.value_or(scene.seed), id.x, id.y, id.sample);
  const FilterSample offset = scene.filter->sample(random.next2D());
  CameraSample camera;
  camera.x = static_cast<float>(id.x) + 0.5f + offset.dx;
  camera.y = static_cast<float>(id.y) + 0.5f + offset.dy;
  if (scene.camera->hasLens()) camera.lens = random.next2D();
  camera.time = scene.changes ? scene.shutter.at(random.time()) : scene.shutter.open;
  slot.tile = &tile;
  slot.filterWeight = offset.weight;
  slot.path->restart(id, random);
  slot.task.emplace(shared_.integrator.trace(*slot.path, scene.camera->ray(camera)));
  running_ = index;
  slot.task->start();
  if (!slot.path->isWaiting()) finish(index);
  return true;
}

void Worker::post(PathContext& path) {
  const PhaseScope phase(statistics_.accel.phase, Phase::gathering);
  const auto questions = path.questions();
  for (std::uint32_t i = 0; i < questions.size(); ++i) queues_.push(questions[i], path, {running_, i});
  if (questions[0].medium) statistics_.trackers.points += questions.size();
}

void Worker::finish(std::uint32_t index) {
  const PhaseScope phase(statistics_.accel.phase, Phase::film);
  Slot& slot = slots_[index];
  const Radiance radiance = slot.task->take();
  slot.task.reset();
  const PathId& id = slot.path->id();
  OpenTile& tile = *slot.tile;
  tile.samples.add(id.x, id.y, id.sample, radiance.color * slot.filterWeight, radiance.alpha);
  if (shared_.options.cost) shared_.options.cost->add(id.x, id.y, slot.path->questionCount());
  ++statistics_.samples;
  if (tile.samples.isComplete()) close(&tile);
  free_.push_back(index);
}

void Worker::close(OpenTile* tile) {
  {
    const std::lock_guard lock(shared_.tileLocks[tile->work.tile]);
    shared_.film.commit(tile->samples);
  }
  shared_.samplesDone += (tile->work.endSample - tile->work.firstSample) * tile->work.area.pixelCount();
  const auto at = std::find_if(open_.begin(), open_.end(), [&](const auto& each) { return each.get() == tile; });
  unused_.push_back(std::move(*at));
  open_.erase(at);
}

}  // namespace aerosol::render
