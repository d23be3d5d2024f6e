#include "core/render/filter.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

// Ernst, Stamminger, Greiner, "Filter Importance Sampling" (2006): with samples drawn in proportion to |f| and carrying
// the sign of f, the pixel is E[sign L] ∫|f|/∫f. Nothing is shared between pixels, so a pixel's value depends on its
// own samples alone.

namespace aerosol::render {

namespace {

constexpr int cellsOfCurves = 2048;

/// The cubics of Mitchell and Netravali, "Reconstruction Filters in Computer Graphics" (1988), eq. 8. B = 0, C = 1/2 is
/// the one of Catmull and Rom.
double mitchell(double x, double b, double c) {
  const double t = std::fabs(x);
  if (t < 1) return (((12 - 9 * b - 6 * c) * t + (-18 + 12 * b + 6 * c)) * t * t + (6 - 2 * b)) / 6;
  return ((((-b - 6 * c) * t + (6 * b + 30 * c)) * t + (-12 * b - 48 * c)) * t + (8 * b + 24 * c)) / 6;
}

/// sinc(x) under the main lobe of a sinc that ends at `lobes`.
double lanczos(double x, double lobes) {
  const double a = std::numbers::pi * x;
  return std::fabs(a) < 1e-9 ? 1 : lobes * std::sin(a) * std::sin(a / lobes) / (a * a);
}

}  // namespace

Filter::Filter(const scene::ReconstructionFilter& filter) {
  const double r = static_cast<double>(filter.radius);
  switch (filter.type) {
    case scene::FilterType::box:
      build({{-r, 1}, {r, 1}});
      return;
    case scene::FilterType::tent:
      build({{-r, 0}, {0, 1}, {r, 0}});
      return;
    case scene::FilterType::gaussian: {
      const double scale = -0.5 / (static_cast<double>(filter.stddev) * static_cast<double>(filter.stddev));
      const double edge = std::exp(scale * r * r);
      const auto f = [=](double x) { return std::max(0.0, std::exp(scale * x * x) - edge); };
      *this = Filter(f, r, cellsOfCurves);
      return;
    }
    case scene::FilterType::mitchell: {
      const double b = static_cast<double>(filter.b), c = static_cast<double>(filter.c);
      *this = Filter([=](double x) { return mitchell(x, b, c); }, r, cellsOfCurves);
      return;
    }
    case scene::FilterType::catmullrom:
      *this = Filter([](double x) { return mitchell(x, 0, 0.5); }, r, cellsOfCurves);
      return;
    case scene::FilterType::lanczos:
      *this = Filter([=](double x) { return lanczos(x, r); }, r, cellsOfCurves);
      return;
  }
}

Filter::Filter(const std::function<double(double)>& f, double radius, int cells) {
  assert(radius > 0 && cells > 0);
  std::vector<std::array<double, 2>> points;
  for (int i = 0; i <= cells; ++i) {
    const double x = radius * (2.0 * i / cells - 1);
    const double value = f(x);
    if (!points.empty() && points.back()[1] * value < 0) {
      const auto& [x0, f0] = points.back();
      points.push_back({x0 + (x - x0) * f0 / (f0 - value), 0});
    }
    points.push_back({x, value});
  }
  build(points);
}

void Filter::build(const std::vector<std::array<double, 2>>& points) {
  double absolute = 0;
  integral_ = 0;
  knots_.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) {
      const double piece = 0.5 * (points[i][1] + points[i - 1][1]) * (points[i][0] - points[i - 1][0]);
      integral_ += piece;
      absolute += std::fabs(piece);
    }
    knots_.push_back({points[i][0], points[i][1], absolute});
  }
  assert(integral_ > 0);
  for (Knot& knot : knots_) knot.cumulative /= absolute;
  guide_.clear();
  std::uint32_t above = 1;
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(knots_.size());
    while (above + 1 < knots_.size() && !(share < knots_[above].cumulative)) ++above;
    guide_.push_back(above);
  }
  weight_ = absolute == integral_ ? 1 : absolute / integral_;
}

Filter::Offset Filter::sampleAxis(double u) const {
  const auto share = static_cast<std::size_t>(u * static_cast<double>(guide_.size()));
  std::size_t above = guide_[std::min(share, guide_.size() - 1)];
  while (above > 1 && u < knots_[above - 1].cumulative) --above;
  while (above + 1 < knots_.size() && !(u < knots_[above].cumulative)) ++above;
  const Knot &a = knots_[above - 1], &b = knots_[above];
  const double mass = b.cumulative - a.cumulative;
  const double v = mass > 0 ? std::clamp((u - a.cumulative) / mass, 0.0, 1.0) : 0.5;
  const double fa = std::fabs(a.f), fb = std::fabs(b.f);
  const double root = fa + std::sqrt(fa * fa + (fb - fa) * (fb + fa) * v);
  const double t = root > 0 ? std::min(1.0, v * (fa + fb) / root) : v;
  return {a.x + (b.x - a.x) * t, a.f + b.f < 0};
}

FilterSample Filter::sample(std::array<float, 2> u) const {
  const Offset x = sampleAxis(static_cast<double>(u[0])), y = sampleAxis(static_cast<double>(u[1]));
  const double weight = weight_ * weight_;
  return {static_cast<float>(x.x), static_cast<float>(y.x),
          static_cast<float>(x.negative != y.negative ? -weight : weight)};
}

double Filter::evaluate(double x) const {
  if (!(x >= knots_.front().x && x <= knots_.back().x)) return 0;
  const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, x,
                                      [](double value, const Knot& knot) { return value < knot.x; });
  const Knot &a = *(above - 1), &b = *above;
  const double t = b.x > a.x ? (x - a.x) / (b.x - a.x) : 0;
  return (a.f + (b.f - a.f) * t) / integral_;
}

}  // namespace aerosol::render
