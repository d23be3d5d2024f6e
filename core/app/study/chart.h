// Charts with two logarithmic axes: laid out once, drawn as SVG or as pixels.
#pragma once

#include <string>
#include <vector>

#include "core/image/image.h"

namespace aerosol::app {

struct ChartPoint {
  double x = 0, y = 0;       ///< Greater than 0.
  double low = 0, high = 0;  ///< Band around y; low may be 0: down to the lower edge.
};

struct ChartSeries {
  std::string name;
  std::string color;  ///< "#rrggbb".
  bool isDashed = false;
  std::vector<ChartPoint> points;
};

struct Chart {
  std::string title, xTitle, yTitle;
  bool yIsPercent = true;
  std::vector<ChartSeries> series;
};

/// An <svg> element without a size of its own: it fills the width that it is given.
std::string chartSvg(const Chart& chart);

/// The same as a picture of values as displays take them (sRGB).
image::ImageBuffer chartPicture(const Chart& chart);

/// Distinct colours, one after the other.
std::string chartColor(std::size_t index);

/// Text that is safe inside of HTML and SVG.
std::string escapeHtml(const std::string& text);

}  // namespace aerosol::app
