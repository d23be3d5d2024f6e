#include <fmt/format.h>

#include "core/app/study/chart_layout.h"

namespace aerosol::app {

namespace {

const char* nameOf(TextAnchor anchor) {
  return anchor == TextAnchor::start ? "start" : anchor == TextAnchor::middle ? "middle" : "end";
}

std::string drawText(const PlotText& t) {
  const std::string turn = t.isUpright ? fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", t.at.x, t.at.y) : "";
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}{}>{}</text>\n", t.at.x, t.at.y,
                     nameOf(t.anchor), t.isTitle ? " class=\"title\"" : "", turn, escapeHtml(t.text));
}

std::string drawLine(const PlotLine& l, const char* style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", l.a.x, l.a.y, l.b.x, l.b.y,
                     style);
}

std::string listOf(const std::vector<PlotPoint>& points) {
  std::string text;
  for (const PlotPoint& p : points) text += fmt::format("{:.1f},{:.1f} ", p.x, p.y);
  return text;
}

}  // namespace

std::string escapeHtml(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string chartSvg(const Chart& chart) {
  const ChartLayout layout = layOut(chart);
  std::string svg = fmt::format("<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
                                ChartLayout::width, ChartLayout::height, escapeHtml(chart.title));
  for (const PlotLine& line : layout.weakGrid) svg += drawLine(line, "stroke=\"#e3e1dc\"");
  for (const PlotLine& line : layout.strongGrid) svg += drawLine(line, "stroke=\"#8a8780\"");
  for (const PlotSeries& s : layout.series) {
    if (s.band.size() > 3)
      svg += fmt::format("<polygon points=\"{}\" fill=\"{}\" opacity=\"0.16\"/>\n", listOf(s.band), s.color);
  }
  for (const PlotSeries& s : layout.series) {
    const char* dash = s.isDashed ? " stroke-dasharray=\"6 4\"" : "";
    svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", listOf(s.line),
                       s.color, dash);
    for (const PlotPoint& p : s.line) {
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", p.x, p.y, s.color);
    }
    svg += drawLine(s.sample, fmt::format("stroke=\"{}\" stroke-width=\"2\"{}", s.color, dash).c_str());
    svg += drawText(s.label);
  }
  for (const PlotText& text : layout.texts) svg += drawText(text);
  return svg + "</svg>\n";
}

}  // namespace aerosol::app
