#include "core/volume/segments.h"

#include <algorithm>

namespace aerosol::volume {

// A sweep over the ends of the spans in order: the cost is that of sorting them and of writing the result.
void SegmentList::assign(std::span<const MediumSpan> spans) {
  starts_.clear();
  for (std::uint32_t i = 0; i < spans.size(); ++i) {
    if (spans[i].t0 < spans[i].t1) starts_.push_back(i);
  }
  ends_ = starts_;
  std::sort(starts_.begin(), starts_.end(), [&](auto a, auto b) { return spans[a].t0 < spans[b].t0; });
  std::sort(ends_.begin(), ends_.end(), [&](auto a, auto b) { return spans[a].t1 < spans[b].t1; });

  active_.clear();
  media_.clear();
  mediaEnds_.clear();
  segments_.clear();
  std::size_t start = 0;
  for (std::size_t end = 0; end < ends_.size();) {
    // All that happens at the next boundary; who starts there ends later.
    const bool startsFirst = start < starts_.size() && spans[starts_[start]].t0 < spans[ends_[end]].t1;
    const double t = startsFirst ? spans[starts_[start]].t0 : spans[ends_[end]].t1;
    for (; end < ends_.size() && spans[ends_[end]].t1 == t; ++end) {
      active_.erase(std::lower_bound(active_.begin(), active_.end(), ends_[end]));
    }
    for (; start < starts_.size() && spans[starts_[start]].t0 == t; ++start) {
      active_.insert(std::lower_bound(active_.begin(), active_.end(), starts_[start]), starts_[start]);
    }
    if (active_.empty()) continue;
    double next = spans[ends_[end]].t1;
    if (start < starts_.size()) next = std::min(next, spans[starts_[start]].t0);
    for (const std::uint32_t i : active_) media_.push_back(spans[i].medium);
    segments_.push_back({t, next, {}});
    mediaEnds_.push_back(static_cast<std::uint32_t>(media_.size()));
  }
  std::uint32_t begin = 0;
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    segments_[i].media = {media_.data() + begin, mediaEnds_[i] - begin};
    begin = mediaEnds_[i];
  }
}

}  // namespace aerosol::volume
