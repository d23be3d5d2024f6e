#include "core/volume/segment_stream.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aerosol::volume {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

void SegmentStream::begin(SpanSource& source) {
  source_ = &source;
  active_.clear();
  t_ = -infinity;
}

bool SegmentStream::next(Segment& segment) {
  if (isEmpty()) return false;
  std::erase_if(active_, [&](const MediumSpan& span) { return !(span.t1 > t_); });
  do {
    if (active_.empty()) {
      const MediumSpan* first = source_->peek(infinity);
      if (!first) return false;
      t_ = std::max(t_, first->t0);
    }
    while (const MediumSpan* span = source_->peek(std::nextafter(t_, infinity))) {
      if (span->t1 > t_) active_.push_back(*span);
      source_->pop();
    }
  } while (active_.empty());
  double end = infinity;
  for (const MediumSpan& span : active_) end = std::min(end, span.t1);
  if (const MediumSpan* following = source_->peek(end)) end = following->t0;
  media_.clear();
  for (const MediumSpan& span : active_) media_.push_back(span.medium);
  segment = {t_, end, media_};
  t_ = end;
  return true;
}

}  // namespace aerosol::volume
