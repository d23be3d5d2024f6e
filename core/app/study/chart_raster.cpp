#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <string_view>

#include "core/app/study/chart_layout.h"

namespace aerosol::app {

namespace {

/// Strokes of a letter: pairs of digits x y from the lower left, strokes separated by '/'. Letters are 4 wide; y is 2
/// on the base line, 6 at the top of small letters and 8 of large ones.
std::string_view strokesOf(char c) {
  static const std::map<char, std::string_view> strokes{
      {'0', "0208484202"},    {'1', "162822"},        {'2', "084845050242"},
      {'3', "08484202/1545"}, {'4', "080545/4842"},   {'5', "480805454202"},
      {'6', "480802424505"},  {'7', "084822"},        {'8', "0208484202/0545"},
      {'9', "450508484202"},  {'a', "064642020444"},  {'b', "0802424606"},
      {'c', "46060242"},      {'d', "4842020646"},    {'e', "044446060242"},
      {'f', "381812/0636"},   {'g', "420206464000"},  {'h', "0802/064642"},
      {'i', "2622/2828"},     {'j', "262000/2828"},   {'k', "0802/460442"},
      {'l', "2822"},          {'m', "02064642/2622"}, {'n', "02064642"},
      {'o', "0206464202"},    {'p', "0006464202"},    {'q', "4046060242"},
      {'r', "020646"},        {'s', "460604444202"},  {'t', "181232/0636"},
      {'u', "06024246"},      {'v', "062246"},        {'w', "0612243246"},
      {'x', "0642/0246"},     {'y', "060242/464000"}, {'z', "06460242"},
      {'.', "2222"},          {',', "2321"},          {':', "2222/2525"},
      {'-', "0545"},          {'+', "0545/2723"},     {'%', "0248/0717180807/3343423233"},
      {'/', "0248"},          {'(', "38272332"},      {')', "18272312"},
      {'=', "0444/0646"},     {'<', "470543"},        {'\'', "2826"}};
  const auto found = strokes.find(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
  return found == strokes.end() ? std::string_view() : found->second;
}

constexpr double letterAdvance = 6;

class Canvas {
 public:
  Canvas() {
    image_.width = static_cast<int>(ChartLayout::width);
    image_.height = static_cast<int>(ChartLayout::height);
    image_.channels = {"R", "G", "B"};
    image_.pixels.assign(static_cast<std::size_t>(image_.width) * static_cast<std::size_t>(image_.height) * 3, 1.0f);
  }

  void line(PlotPoint a, PlotPoint b, const std::string& color, double thickness) {
    const double reach = thickness / 2 + 1;
    forPixels(
        std::min(a.x, b.x) - reach, std::min(a.y, b.y) - reach, std::max(a.x, b.x) + reach, std::max(a.y, b.y) + reach,
        [&](PlotPoint p) { return std::clamp(thickness / 2 + 0.5 - distance(p, a, b), 0.0, 1.0); }, color);
  }

  void polyline(const std::vector<PlotPoint>& points, const std::string& color, bool isDashed) {
    constexpr double dash = 6;
    double travelled = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const PlotPoint a = points[i - 1], b = points[i];
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      if (!isDashed) {
        line(a, b, color, 2);
        continue;
      }
      for (double t = 0; t < length;) {
        const double end = std::min(length, t + dash - std::fmod(travelled + t, dash));
        const auto along = [&](double s) {
          return PlotPoint{a.x + (b.x - a.x) * s / length, a.y + (b.y - a.y) * s / length};
        };
        if (std::fmod(travelled + t + 1e-9, 2 * dash) < dash) line(along(t), along(end), color, 2);
        t = std::max(end, t + 1e-6);
      }
      travelled += length;
    }
  }

  void fill(const std::vector<PlotPoint>& polygon, const std::string& color, double opacity) {
    if (polygon.size() < 4) return;
    double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
    for (const PlotPoint& p : polygon) {
      x0 = std::min(x0, p.x);
      y0 = std::min(y0, p.y);
      x1 = std::max(x1, p.x);
      y1 = std::max(y1, p.y);
    }
    forPixels(x0, y0, x1, y1, [&](PlotPoint p) { return isInside(p, polygon) ? opacity : 0.0; }, color);
  }

  void text(const PlotText& t) {
    const double size = t.isTitle ? 1.6 : 1.15;
    const double width = static_cast<double>(t.text.size()) * letterAdvance * size;
    double offset = t.anchor == TextAnchor::start ? 0 : t.anchor == TextAnchor::middle ? -width / 2 : -width;
    for (const char c : t.text) {
      std::string_view rest = strokesOf(c);
      while (!rest.empty()) {
        const std::string_view stroke = rest.substr(0, rest.find('/'));
        rest.remove_prefix(std::min(rest.size(), stroke.size() + 1));
        for (std::size_t i = 2; i + 1 < stroke.size(); i += 2) {
          line(place(t, offset, stroke[i - 2], stroke[i - 1], size), place(t, offset, stroke[i], stroke[i + 1], size),
               "#3b3a36", 1.2);
        }
      }
      offset += letterAdvance * size;
    }
  }

  image::ImageBuffer take() { return std::move(image_); }

 private:
  static PlotPoint place(const PlotText& t, double offset, char x, char y, double size) {
    const double along = offset + (x - '0') * size, up = (y - '2') * size;
    return t.isUpright ? PlotPoint{t.at.x - up, t.at.y - along} : PlotPoint{t.at.x + along, t.at.y - up};
  }

  static double distance(PlotPoint p, PlotPoint a, PlotPoint b) {
    const double dx = b.x - a.x, dy = b.y - a.y, length = dx * dx + dy * dy;
    const double t = length > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length, 0.0, 1.0) : 0;
    return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
  }

  static bool isInside(PlotPoint p, const std::vector<PlotPoint>& polygon) {
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
      const PlotPoint &a = polygon[i], &b = polygon[j];
      if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) inside = !inside;
    }
    return inside;
  }

  template <class Coverage>
  void forPixels(double x0, double y0, double x1, double y1, const Coverage& coverage, const std::string& color) {
    std::array<float, 3> rgb{};
    for (std::size_t c = 0; c < 3; ++c)
      rgb[c] = static_cast<float>(std::stoi(color.substr(1 + 2 * c, 2), nullptr, 16)) / 255;
    const auto clampTo = [](double value, int end) {
      return std::clamp(static_cast<int>(std::floor(value)), 0, end - 1);
    };
    for (int y = clampTo(y0, image_.height); y <= clampTo(y1, image_.height); ++y) {
      for (int x = clampTo(x0, image_.width); x <= clampTo(x1, image_.width); ++x) {
        const auto alpha = static_cast<float>(coverage({x + 0.5, y + 0.5}));
        if (!(alpha > 0)) continue;
        float* pixel = &image_.pixels[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) +
                                           static_cast<std::size_t>(x))];
        for (std::size_t c = 0; c < 3; ++c) pixel[c] += alpha * (rgb[c] - pixel[c]);
      }
    }
  }

  image::ImageBuffer image_;
};

}  // namespace

image::ImageBuffer chartPicture(const Chart& chart) {
  const ChartLayout layout = layOut(chart);
  Canvas canvas;
  for (const PlotLine& l : layout.weakGrid) canvas.line(l.a, l.b, "#e3e1dc", 1);
  for (const PlotLine& l : layout.strongGrid) canvas.line(l.a, l.b, "#8a8780", 1);
  for (const PlotSeries& s : layout.series) canvas.fill(s.band, s.color, 0.16);
  for (const PlotSeries& s : layout.series) {
    canvas.polyline(s.line, s.color, s.isDashed);
    for (const PlotPoint& p : s.line) canvas.line(p, p, s.color, 6);
    canvas.polyline({s.sample.a, s.sample.b}, s.color, s.isDashed);
    canvas.text(s.label);
  }
  for (const PlotText& text : layout.texts) canvas.text(text);
  return canvas.take();
}

}  // namespace aerosol::app
