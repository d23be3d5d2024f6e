#include "core/render/path_spans.h"

#include "core/render/prepared_scene.h"

namespace aerosol::render {

void PathSpans::begin(const PreparedScene& scene, std::span<const volume::Medium* const> media, const Ray<World>& ray,
                      double t0, double t1, std::span<const accel::Span> found, accel::Counters& counters) {
  media_ = media;
  nextBoundary_ = 0;
  hasRest_ = false;
  if (clipped_.size() == 1 && clipped_[0].t0 <= t0 && clipped_[0].t1 >= t1) {
    volumes_.begin({});
    return;
  }
  if (scene.geometry->overlapDesign() == accel::OverlapDesign::partition) {
    volumes_.begin(*scene.geometry, ray, t0, t1, counters);
  } else {
    volumes_.begin(found);
  }
}

const volume::MediumSpan* PathSpans::peek(double limit) {
  boundaryIsNext_ = nextBoundary_ < boundary_.size() && boundary_[nextBoundary_].t0 < limit;
  if (boundaryIsNext_) limit = boundary_[nextBoundary_].t0;
  if (const accel::Span* span = volumes_.peek(limit)) {
    boundaryIsNext_ = false;
    current_ = {span->t0, span->t1, media_[span->volume]};
    return &current_;
  }
  return boundaryIsNext_ ? &boundary_[nextBoundary_] : nullptr;
}

void PathSpans::pop() {
  if (boundaryIsNext_) {
    ++nextBoundary_;
  } else {
    volumes_.pop();
  }
}

bool PathSpans::take(volume::MediumSpan& span) {
  if (nextBoundary_ < boundary_.size()) {
    span = boundary_[nextBoundary_++];
    return true;
  }
  for (;;) {
    if (!hasRest_) {
      const accel::Span* const next = volumes_.peek();
      if (!next) return false;
      current_ = {next->t0, next->t1, media_[next->volume]};
      volumes_.pop();
    }
    span = current_;
    hasRest_ = false;
    for (const volume::MediumSpan& clip : clipped_) {
      if (clip.t1 <= span.t0 || clip.t0 >= span.t1) continue;
      current_.t0 = clip.t1;
      hasRest_ = clip.t1 < span.t1;
      span.t1 = clip.t0;
      break;
    }
    if (span.t0 < span.t1) return true;
  }
}

}  // namespace aerosol::render
