#include <fmt/format.h>

#include <cmath>

#include "core/accel/curves.h"
#include "core/accel/text_source.h"

namespace aerosol::accel {

namespace {

constexpr std::string_view blanks = " \t\r";

class CurveReader {
 public:
  CurveReader(const TextSource& source, CurveBasis basis, const Transform<World, Object>& toWorld)
      : source_(source), toWorld_(toWorld) {
    curves_.basis = basis;
  }

  Result<CurveSet> read() {
    const std::string_view text = source_.text();
    for (std::size_t at = 0; at < text.size() && !errors_.hasErrors();) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      readLine(at, end);
      at = end + 1;
    }
    endFibre(text.size());
    if (!errors_.hasErrors() && curves_.points.empty()) errors_.add(source_.at(0, "the file holds no points"));
    if (errors_.hasErrors()) return errors_;
    return std::move(curves_);
  }

 private:
  void readLine(std::size_t at, std::size_t end) {
    const std::string_view text = source_.text();
    double numbers[4];
    std::size_t count = 0;
    for (;;) {
      at = std::min(text.find_first_not_of(blanks, at), end);
      if (at == end) break;
      const std::size_t stop = std::min(text.find_first_of(blanks, at), end);
      const auto number = parseNumber(text.substr(at, stop - at));
      if (!number || std::fabs(*number) > 1e18) return fail(at, "this is not a finite number below 1e18");
      if (count == 4) return fail(at, "a point of a fibre has four numbers: x, y, z and radius");
      numbers[count++] = *number;
      at = stop;
    }
    if (count == 0) return endFibre(end);
    if (count < 4) return fail(end, "a point of a fibre has four numbers: x, y, z and radius");
    if (numbers[3] < 0) return fail(end, "a radius cannot be negative");
    const Point<Object> place(static_cast<float>(numbers[0]), static_cast<float>(numbers[1]),
                              static_cast<float>(numbers[2]));
    curves_.points.push_back({toWorld_(place), static_cast<float>(numbers[3])});
  }

  void endFibre(std::size_t at) {
    const std::size_t count = curves_.points.size() - first_, each = curves_.pointsOfSegment();
    if (count == 0 || errors_.hasErrors()) return;
    if (count < each) return fail(at, fmt::format("a fibre needs {} points at least, this one has {}", each, count));
    const std::size_t segments = count - each + 1;
    for (std::size_t i = 0; i < segments; ++i) {
      curves_.segments.push_back(static_cast<std::uint32_t>(first_ + i));
      const auto part = [&](std::size_t k) { return static_cast<float>(k) / static_cast<float>(segments); };
      curves_.along.push_back({part(i), part(i + 1)});
    }
    first_ = curves_.points.size();
  }

  void fail(std::size_t at, std::string message) { errors_.add(source_.at(at, std::move(message))); }

  const TextSource& source_;
  const Transform<World, Object>& toWorld_;
  CurveSet curves_;
  std::size_t first_ = 0;  ///< Point of the fibre that is being read.
  Diagnostics errors_;
};

}  // namespace

Result<CurveSet> loadCurves(const std::string& path, CurveBasis basis, const Transform<World, Object>& toWorld) {
  auto source = TextSource::read(path);
  if (!source) return source.errors();
  return CurveReader(*source, basis, toWorld).read();
}

}  // namespace aerosol::accel
