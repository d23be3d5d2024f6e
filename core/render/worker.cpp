#include "core/render/worker.h"

#include <algorithm>

#include "core/base/random.h"
#include "core/render/aov/deep_walk.h"
#include "core/render/aov/first_hit.h"

namespace aerosol::render {

namespace {

/// Which of the picture's two halves a sample belongs to. Of each two neighbours one is in either, by a hash: the
/// halves are as large as each other, and no dimension of a low-discrepancy sequence falls apart into them.
bool isInFirstHalf(const PathId& id) {
  const std::uint64_t pair = mixBits(pixelKey(id.sample / 2, id.x, id.y));
  return (id.sample & 1u) == (pair & 1u);
}

/// A path with what its AOVs take beside its light.
volume::Task<Radiance> traceRecorded(PathContext& path, const Integrator& integrator, CameraSample camera,
                                     Ray<World> ray) {
  path.record->begin();
  co_await recordFirstHit(path, camera, ray);
  if (DeepRecord* const deep = path.record->deep()) {
    const Vector<World> view = path.scene().camera->toWorld(camera.time)(Vector<aerosol::Camera>(0, 0, 1));
    deep->begin(dot(normalize(view), ray.direction));
    co_await recordDeep(path, ray);
  }
  co_return co_await integrator.trace(path, ray);
}

/// Paths ahead of the one that runs whose frames are fetched: several hundred frames do not fit the nearest cache.
constexpr std::size_t prefetchDistance = 3;

/// Paths wait for few shaders at a time where there are few: as many as keep their frames near, which takes a sixth
/// less time on a mesh (tests/bench/tables/mesh_rays.cpp) and a tenth less in a cloud. Where many media are asked, more
/// paths have to wait for the batches of each to be worth a call, and for lanes to be full.
constexpr std::size_t pathsWithoutMedia = 128, pathsOfMedium = 256;

int pathsInFlight(const SharedWork& shared) {
  const std::size_t few = std::max(pathsWithoutMedia, pathsOfMedium * shared.scene.media.size());
  const auto wanted = static_cast<std::size_t>(std::max(1, shared.options.pathsInFlight));
  return static_cast<int>(std::min(wanted, few));
}

}  // namespace

Worker::Worker(SharedWork shared) : shared_(shared), queues_(shared.scene, statistics_, shared.options.batchSize) {
  const auto count = static_cast<std::uint32_t>(pathsInFlight(shared));
  slots_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    slots_[i].path = std::make_unique<PathContext>(shared.scene, *this, statistics_);
    paths_.push_back(slots_[i].path.get());
    if (!shared.film.layout().isEmpty()) slots_[i].record = std::make_unique<PathRecord>(*shared.scene.aovs);
    slots_[i].path->record = slots_[i].record.get();
    if (shared.options.pilot) slots_[i].pilot = std::make_unique<PilotPath>();
    slots_[i].path->pilot = slots_[i].pilot.get();
    free_.push_back(count - 1 - i);
  }
  statistics_.lightSamples.resize(shared.scene.lights.size());
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
    current_->samples.reset(work->area, work->firstSample, work->endSample, shared_.film.layout().width);
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
  if (scene.camera->hasLens()) {
    camera.lens = random.next2D();
    statistics_.work.add(Work::lens);
  }
  camera.time = scene.shutter.open;
  if (scene.changes) {
    camera.time = scene.shutter.at(random.time());
    statistics_.work.add(Work::time);
    if (scene.camera->motion()) statistics_.work.add(Work::cameraMotion);
  }
  slot.tile = &tile;
  slot.filterWeight = offset.weight;
  slot.path->restart(id, random);
  const Ray<World> ray = scene.camera->ray(camera);
  if (scene.keepsFootprints) slot.path->setFootprint(scene.camera->footprint(camera));
  slot.task.emplace(slot.record ? traceRecorded(*slot.path, shared_.integrator, camera, ray)
                                : shared_.integrator.trace(*slot.path, ray));
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
  if (slot.pilot) {
    PilotPath noted = std::move(*slot.pilot);
    *slot.pilot = {};
    noted.x = id.x;
    noted.y = id.y;
    noted.sample = id.sample;
    noted.value = average(radiance.color);
    const std::lock_guard lock(shared_.options.pilot->mutex);
    shared_.options.pilot->paths.push_back(std::move(noted));
  }
  std::span<const float> aovs;
  if (slot.record) {
    statistics_.work.add(Work::layers);
    aovs = slot.record->finish({.color = radiance.color,
                                .filterWeight = slot.filterWeight,
                                .isInFirstHalf = isInFirstHalf(id),
                                .cost = static_cast<float>(slot.path->questionCount())});
  }
  tile.samples.add(id.x, id.y, id.sample, radiance.color * slot.filterWeight, radiance.alpha, aovs);
  ++statistics_.samples;
  if (tile.samples.isComplete()) close(&tile);
  free_.push_back(index);
}

void Worker::close(OpenTile* tile) {
  {
    const std::lock_guard lock(shared_.tileLocks[tile->work.tile]);
    shared_.film.commit(tile->samples);
    if (shared_.options.partDone) shared_.options.partDone(tile->work.area);
  }
  shared_.samplesDone += (tile->work.endSample - tile->work.firstSample) * tile->work.area.pixelCount();
  const auto at = std::find_if(open_.begin(), open_.end(), [&](const auto& each) { return each.get() == tile; });
  unused_.push_back(std::move(*at));
  open_.erase(at);
}

}  // namespace aerosol::render
