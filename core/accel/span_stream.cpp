#include "core/accel/span_stream.h"

#include <algorithm>
#include <cmath>

#include "core/accel/scene_data.h"

namespace aerosol::accel {

namespace {

constexpr std::uint32_t noVolume = std::numeric_limits<std::uint32_t>::max();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Turns the standard library's heaps upside down.
bool isLater(const Span& a, const Span& b) { return a.t0 != b.t0 ? a.t0 > b.t0 : a.volume > b.volume; }

}  // namespace

void SpanStream::begin(std::span<const Span> sorted) {
  scene_ = nullptr;
  next_ = sorted.data();
  end_ = next_ + sorted.size();
}

void SpanStream::begin(const Scene& scene, const Ray<World>& ray, double t0, double t1, Counters& counters) {
  scene_ = &scene;
  counters_ = &counters;
  ray_ = ray;
  from_ = t0;
  to_ = t1;
  next_ = end_ = &current_;
  stack_.clear();
  found_.clear();
  for (const std::uint32_t place : used_) table_[place] = noVolume;
  used_.clear();
  reached_ = infinity;
  if (!(t0 < t1)) return;

  const SceneData& data = scene.data();
  double entry = t0, exit = t1;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    origin_[k] = static_cast<double>(ray.origin[i]);
    direction_[k] = static_cast<double>(ray.direction[i]);
    inverse_[k] = 1 / direction_[k];
    if (data.partition.empty()) continue;
    const auto lower = static_cast<double>(data.partition.bounds().lower[i]);
    const auto upper = static_cast<double>(data.partition.bounds().upper[i]);
    if (direction_[k] == 0) {
      if (origin_[k] < lower || origin_[k] > upper) exit = -infinity;
      continue;
    }
    const double a = (lower - origin_[k]) * inverse_[k], b = (upper - origin_[k]) * inverse_[k];
    entry = std::max(entry, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  for (const VolumeId volume : data.unbounded) test(volume, from_);
  if (data.partition.empty() || !(entry <= exit)) return;
  stack_.push_back({0, entry, exit});
  reached_ = entry;
}

/// Goes on until a span can be given out, or none can start before `limit`.
void SpanStream::advance(double limit) {
  while (!stack_.empty() && reached_ < limit && (found_.empty() || found_.front().t0 >= reached_)) visitNext();
  if (found_.empty() || !(found_.front().t0 < limit)) return;
  std::ranges::pop_heap(found_, isLater);
  current_ = found_.back();
  found_.pop_back();
  next_ = &current_;
  end_ = next_ + 1;
}

/// Down to the nearest leaf of what is still to be visited. Of a ray within a plane one side is enough: what reaches
/// the plane is listed on both.
void SpanStream::visitNext() {
  const VolumePartition& partition = scene_->data().partition;
  Visit visit = stack_.back();
  stack_.pop_back();
  for (;;) {
    const VolumePartition::Node& node = partition.node(visit.node);
    if (node.isLeaf()) {
      openLeaf(partition.volumesOf(node), visit.t0);
      break;
    }
    const std::size_t axis = node.axis();
    const auto plane = static_cast<double>(node.plane);
    const std::uint32_t lower = visit.node + 1, upper = node.index();
    if (direction_[axis] == 0) {
      visit.node = origin_[axis] > plane ? upper : lower;
      continue;
    }
    const double t = (plane - origin_[axis]) * inverse_[axis];
    const bool goesUp = direction_[axis] > 0;
    const std::uint32_t nearChild = goesUp ? lower : upper, farChild = goesUp ? upper : lower;
    if (t > visit.t1) {
      visit.node = nearChild;
    } else if (t < visit.t0) {
      visit.node = farChild;
    } else {
      stack_.push_back({farChild, t, visit.t1});
      visit.node = nearChild;
      visit.t1 = t;
    }
  }
  reached_ = stack_.empty() ? infinity : stack_.back().t0;
}

void SpanStream::openLeaf(std::span<const VolumeId> volumes, double t0) {
  for (const VolumeId volume : volumes) {
    if (isNew(volume)) test(volume, t0);
  }
}

class SpanStream::Recorder final : public IntervalSink {
 public:
  Recorder(SpanStream& stream, VolumeId volume, double from) : stream_(stream), volume_(volume), from_(from) {}
  void add(const Interval& interval) override {
    const double t0 = std::fmax(interval.t0, from_), t1 = std::fmin(interval.t1, stream_.to_);
    if (!(t0 < t1)) return;
    ++stream_.counters_->spans;
    stream_.found_.push_back({t0, t1, volume_});
    std::ranges::push_heap(stream_.found_, isLater);
  }

 private:
  SpanStream& stream_;
  VolumeId volume_;
  double from_;
};

void SpanStream::test(VolumeId volume, double from) {
  ++counters_->volumeTests;
  Recorder recorder(*this, volume, from);
  if (!scene_->volume(volume).intersect(ray_, recorder)) ++counters_->openVolumes;
}

bool SpanStream::isNew(VolumeId volume) {
  if (2 * (used_.size() + 1) > table_.size()) growTable();
  const std::size_t mask = table_.size() - 1;
  std::size_t place = (volume * 0x9E3779B1u) & mask;
  for (; table_[place] != noVolume; place = (place + 1) & mask) {
    if (table_[place] == volume) return false;
  }
  table_[place] = volume;
  used_.push_back(static_cast<std::uint32_t>(place));
  return true;
}

void SpanStream::growTable() {
  std::vector<std::uint32_t> known;
  for (const std::uint32_t place : used_) known.push_back(table_[place]);
  table_.assign(std::max<std::size_t>(16, 2 * table_.size()), noVolume);
  used_.clear();
  for (const std::uint32_t volume : known) isNew(volume);
}

}  // namespace aerosol::accel
