#include "core/app/missing_samples.h"

#include <fmt/format.h>

#include <algorithm>

namespace aerosol::app {

namespace {

using Ranges = std::vector<render::PixelSum::Range>;

Ranges missingOf(const Ranges& present, std::uint64_t sampleCount) {
  Ranges missing;
  std::uint64_t next = 0;
  for (const auto& range : present) {
    if (range.first >= sampleCount) break;
    if (next < range.first) missing.push_back({next, range.first});
    next = range.end;
  }
  if (next < sampleCount) missing.push_back({next, sampleCount});
  return missing;
}

}  // namespace

/// Runs of equal pixels in a row, joined with the same run of the row above.
std::vector<MissingSamples> findMissing(const render::Film& film, std::uint64_t sampleCount) {
  const render::PixelRect area = film.area();
  std::vector<MissingSamples> found;
  std::vector<std::size_t> above;  // Of `found`: those that end at this row.
  for (int y = area.y0; y < area.y1; ++y) {
    std::vector<std::size_t> here;
    for (int x = area.x0; x < area.x1;) {
      const Ranges missing = missingOf(film.pixel(x, y).ranges(), sampleCount);
      int end = x + 1;
      while (end < area.x1 && missingOf(film.pixel(end, y).ranges(), sampleCount) == missing) ++end;
      if (!missing.empty()) {
        const auto match = std::find_if(above.begin(), above.end(), [&](std::size_t i) {
          return found[i].area.x0 == x && found[i].area.x1 == end && found[i].samples == missing;
        });
        if (match == above.end()) found.push_back({{x, y, end, y}, missing});
        here.push_back(match == above.end() ? found.size() - 1 : *match);
        found[here.back()].area.y1 = y + 1;
      }
      x = end;
    }
    above = std::move(here);
  }
  return found;
}

std::string describe(const MissingSamples& missing) {
  const render::PixelRect& a = missing.area;
  return fmt::format("samples {} of the pixels {},{},{},{} (x,y,w,h)", formatRanges(missing.samples), a.x0, a.y0,
                     a.width(), a.height());
}

std::string formatRanges(const std::vector<render::PixelSum::Range>& ranges) {
  std::string text;
  for (const auto& range : ranges) text += fmt::format("{}{}:{}", text.empty() ? "" : " ", range.first, range.end);
  return text.empty() ? "none" : text;
}

}  // namespace aerosol::app
