#include "core/volume/segments.h"

#include <algorithm>

namespace aerosol::volume {

void SegmentList::assign(std::span<const MediumSpan> spans) {
  boundaries_.clear();
  media_.clear();
  ends_.clear();
  segments_.clear();
  for (const MediumSpan& span : spans) {
    if (!(span.t0 < span.t1)) continue;
    boundaries_.push_back(span.t0);
    boundaries_.push_back(span.t1);
  }
  std::sort(boundaries_.begin(), boundaries_.end());
  boundaries_.erase(std::unique(boundaries_.begin(), boundaries_.end()), boundaries_.end());

  for (std::size_t i = 0; i + 1 < boundaries_.size(); ++i) {
    const float t0 = boundaries_[i];
    const float t1 = boundaries_[i + 1];
    const std::size_t first = media_.size();
    for (const MediumSpan& span : spans) {
      if (span.t0 <= t0 && span.t1 >= t1) media_.push_back(span.medium);
    }
    if (media_.size() == first) continue;
    segments_.push_back({t0, t1, {}});
    ends_.push_back(static_cast<std::uint32_t>(media_.size()));
  }
  std::uint32_t begin = 0;
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    segments_[i].media = {media_.data() + begin, ends_[i] - begin};
    begin = ends_[i];
  }
}

}  // namespace aerosol::volume
