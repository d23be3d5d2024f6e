#include "core/app/study/chart_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace aerosol::app {

namespace {

/// One logarithmic axis: values to pixels.
struct Axis {
  double low = 0, high = 1;   ///< Logarithms.
  double start = 0, end = 1;  ///< Pixels.

  double at(double value) const {
    const double l = value > 0 ? std::log10(value) : low;
    return start + (end - start) * std::clamp((l - low) / (high - low), 0.0, 1.0);
  }
};

Axis makeAxis(double least, double largest, double start, double end) {
  if (!(least > 0) || !(largest >= least) || !std::isfinite(largest)) return {-2, 0, start, end};
  // A little room beyond the outermost points.
  const double low = std::log10(least) - 0.08, high = std::log10(largest) + 0.08;
  return {low, std::max(high, low + 0.3), start, end};
}

/// 1, 2 and 5 of every power of ten within the axis; only powers where there are many.
std::vector<double> ticksOf(const Axis& axis) {
  std::vector<double> ticks;
  const bool many = axis.high - axis.low > 2.5;
  for (int power = static_cast<int>(std::floor(axis.low)); power <= std::ceil(axis.high); ++power) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double l = power + std::log10(digit);
      if (l >= axis.low && l <= axis.high && (digit == 1 || !many)) ticks.push_back(std::pow(10, power) * digit);
    }
  }
  return ticks;
}

std::string plain(double value) {
  if (value >= 1e-3 && value < 1e6) return fmt::format("{:g}", std::round(value * 1e6) / 1e6);
  return fmt::format("{:.0e}", value);
}

/// What fits into the legend: the end of a long name tells it from others.
std::string shorten(const std::string& name) {
  constexpr std::size_t longest = 34;
  return name.size() <= longest ? name : "..." + name.substr(name.size() - longest + 3);
}

}  // namespace

ChartLayout layOut(const Chart& chart) {
  using L = ChartLayout;
  double xLow = std::numeric_limits<double>::infinity(), xHigh = 0, yLow = xLow, yHigh = 0;
  for (const ChartSeries& series : chart.series) {
    for (const ChartPoint& p : series.points) {
      xLow = std::min(xLow, p.x);
      xHigh = std::max(xHigh, p.x);
      yLow = std::min(yLow, p.y);
      yHigh = std::max(yHigh, p.y);
    }
  }
  const Axis x = makeAxis(xLow, xHigh, L::left, L::width - L::right);
  const Axis y = makeAxis(yLow, yHigh, L::height - L::bottom, L::top);
  ChartLayout layout;
  for (const double tick : ticksOf(x)) {
    layout.weakGrid.push_back({{x.at(tick), y.start}, {x.at(tick), y.end}});
    layout.texts.push_back({{x.at(tick), y.start + 18}, plain(tick), TextAnchor::middle, false, false});
  }
  for (const double tick : ticksOf(y)) {
    layout.weakGrid.push_back({{x.start, y.at(tick)}, {x.end, y.at(tick)}});
    const std::string text = chart.yIsPercent ? plain(100 * tick) + "%" : plain(tick);
    layout.texts.push_back({{x.start - 8, y.at(tick) + 4}, text, TextAnchor::end, false, false});
  }
  layout.strongGrid = {{{x.start, y.start}, {x.end, y.start}}, {{x.start, y.start}, {x.start, y.end}}};
  layout.texts.push_back({{L::left, 22}, chart.title, TextAnchor::start, true, false});
  layout.texts.push_back({{0.5 * (x.start + x.end), L::height - 14}, chart.xTitle, TextAnchor::middle, false, false});
  layout.texts.push_back({{18, 0.5 * (y.start + y.end)}, chart.yTitle, TextAnchor::middle, false, true});
  double legend = L::top + 10;
  for (const ChartSeries& series : chart.series) {
    PlotSeries plotted{series.color, series.isDashed, {}, {}, {}, {}};
    for (const ChartPoint& p : series.points) {
      plotted.line.push_back({x.at(p.x), y.at(p.y)});
      plotted.band.push_back({x.at(p.x), y.at(p.high)});
    }
    for (auto p = series.points.rbegin(); p != series.points.rend(); ++p) {
      plotted.band.push_back({x.at(p->x), y.at(p->low)});
    }
    const double from = L::width - L::right + 16;
    plotted.sample = {{from, legend}, {from + 26, legend}};
    plotted.label = {{from + 34, legend + 4}, shorten(series.name), TextAnchor::start, false, false};
    legend += 20;
    layout.series.push_back(std::move(plotted));
  }
  return layout;
}

std::string chartColor(std::size_t index) {
  static constexpr const char* colors[] = {"#1b6ca8", "#d1495b", "#3a7d44", "#e08e1b", "#6a4c93",
                                           "#00838f", "#8d5524", "#c2185b", "#5c6b73", "#9e9d24"};
  return colors[index % std::size(colors)];
}

}  // namespace aerosol::app
