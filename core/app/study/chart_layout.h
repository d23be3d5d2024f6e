// Where the parts of a chart are. Internal to the drawing of charts.
#pragma once

#include <string>
#include <vector>

#include "core/app/study/chart.h"

namespace aerosol::app {

struct PlotPoint {
  double x = 0, y = 0;  ///< Pixels from the upper left.
};

struct PlotLine {
  PlotPoint a, b;
};

enum class TextAnchor : unsigned char { start, middle, end };

struct PlotText {
  PlotPoint at;  ///< On the base line.
  std::string text;
  TextAnchor anchor = TextAnchor::start;
  bool isTitle = false;
  bool isUpright = false;  ///< Read from below.
};

struct PlotSeries {
  std::string color;
  bool isDashed = false;
  std::vector<PlotPoint> line;
  std::vector<PlotPoint> band;  ///< A polygon: forwards above, backwards below.
  PlotText label;               ///< In the legend.
  PlotLine sample;              ///< Beside it.
};

struct ChartLayout {
  static constexpr double width = 900, height = 460;
  static constexpr double left = 74, right = 290, top = 40, bottom = 56;

  std::vector<PlotLine> strongGrid, weakGrid;
  std::vector<PlotText> texts;
  std::vector<PlotSeries> series;
};

ChartLayout layOut(const Chart& chart);

}  // namespace aerosol::app
