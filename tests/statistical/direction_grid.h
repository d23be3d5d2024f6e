// Cells of a cone of directions with equal solid angles, for histograms and quadrature.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/geometry.h"

namespace aerosol::test {

/// Rings of equal height around an axis, each cut into equal sectors. `oneMinusCosine` of the cone's half angle: 2 is
/// the whole sphere.
class DirectionGrid {
 public:
  DirectionGrid(Vector<World> axis, double oneMinusCosine, int rings, int sectors)
      : frame_(axis), height_(oneMinusCosine), rings_(rings), sectors_(sectors) {}

  std::size_t cellCount() const { return static_cast<std::size_t>(rings_ * sectors_); }
  double cellSolidAngle() const { return 2 * std::numbers::pi * height_ / (rings_ * sectors_); }

  /// `cellCount()` outside the cone.
  std::size_t cell(Vector<World> d) const {
    const double z = dot(d, frame_.z), x = dot(d, frame_.x), y = dot(d, frame_.y);
    const int ring = static_cast<int>(std::floor((1 - z) / height_ * rings_));
    if (ring > rings_ || (ring == rings_ && height_ < 2)) return cellCount();
    double turn = std::atan2(y, x) / (2 * std::numbers::pi);
    if (turn < 0) turn += 1;
    const int sector = std::min(sectors_ - 1, static_cast<int>(turn * sectors_));
    return static_cast<std::size_t>(std::clamp(ring, 0, rings_ - 1) * sectors_ + sector);
  }

  /// ∫ f over each cell by the midpoint rule with n × n points, which stands edges and singular outlines.
  template <class Function>
  std::vector<double> integrateCells(Function f, int n) const {
    return integrateAt(f, n, [](int i) { return i + 0.5; });
  }

  /// The same for smooth functions, peaks among them: Gauss's rule with two nodes a side on n/2 × n/2 pieces; n is
  /// even.
  template <class Function>
  std::vector<double> integrateSmoothCells(Function f, int n) const {
    return integrateAt(f, n, gaussNode);
  }

  /// The same to `tolerance` in each cell: with more and more points, n at most. The rule's error falls by 16 where
  /// there are twice as many, so that two results differ by 15 times that of the better one; of this a quarter is
  /// believed.
  template <class Function>
  std::vector<double> integrateSmoothCells(Function f, int n, double tolerance) const {
    std::vector<double> cells(cellCount());
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      double coarse = integrateCell(f, cell, 6, gaussNode);
      for (int points = 12;; points *= 2) {
        cells[cell] = integrateCell(f, cell, std::min(points, n), gaussNode);
        if (points >= n || std::fabs(cells[cell] - coarse) < 4 * tolerance) break;
        coarse = cells[cell];
      }
    }
    return cells;
  }

 private:
  static double gaussNode(int i) { return i / 2 * 2 + 1 + (i % 2 ? 1 : -1) / std::numbers::sqrt3; }

  template <class Function, class Place>
  double integrateCell(Function f, std::size_t cell, int n, Place place) const {
    const int ring = static_cast<int>(cell) / sectors_, sector = static_cast<int>(cell) % sectors_;
    double sum = 0;
    for (int i = ring * n; i < (ring + 1) * n; ++i) {
      const double c = place(i) / (rings_ * n) * height_, r = std::sqrt(c * (2 - c));
      for (int j = sector * n; j < (sector + 1) * n; ++j) {
        const double phi = 2 * std::numbers::pi * place(j) / (sectors_ * n);
        const Vector<World> d = normalize(frame_.at(static_cast<float>(r * std::cos(phi)),
                                                    static_cast<float>(r * std::sin(phi)), static_cast<float>(1 - c)));
        sum += static_cast<double>(f(d));
      }
    }
    return sum * cellSolidAngle() / (n * n);
  }

  /// Points in steps of a cell's nth part.
  template <class Function, class Place>
  std::vector<double> integrateAt(Function f, int n, Place place) const {
    std::vector<double> cells(cellCount());
    for (std::size_t cell = 0; cell < cells.size(); ++cell) cells[cell] = integrateCell(f, cell, n, place);
    return cells;
  }

  Frame<World> frame_;
  double height_;
  int rings_, sectors_;
};

}  // namespace aerosol::test
