// Places in the unit square, by weights of its cells.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace aerosol::render {

/// Places drawn in proportion to the weights of cells, uniform in each cell.
class CellChoice {
 public:
  CellChoice(int columns, int rows, const std::vector<double>& weights)
      : columns_(static_cast<std::size_t>(columns)), rows_(static_cast<std::size_t>(rows)), cells_(weights) {
    double sum = 0;
    for (std::size_t j = 0; j < rows_; ++j) {
      double row = 0;
      for (std::size_t i = 0; i < columns_; ++i) cells_[j * columns_ + i] = row += weights[j * columns_ + i];
      rowSums_.push_back(sum += row);
    }
  }

  double total() const { return rowSums_.back(); }
  /// Per unit of u and v.
  double density(double u, double v) const {
    const auto i = std::min(static_cast<std::size_t>(u * static_cast<double>(columns_)), columns_ - 1);
    const auto j = std::min(static_cast<std::size_t>(v * static_cast<double>(rows_)), rows_ - 1);
    const double cell = cells_[j * columns_ + i] - (i > 0 ? cells_[j * columns_ + i - 1] : 0);
    return cell * static_cast<double>(columns_ * rows_) / total();
  }
  std::array<double, 2> sample(std::array<float, 2> u) const {
    double along = 0, across = 0;
    const std::size_t j = find({rowSums_.data(), rows_}, static_cast<double>(u[1]), across);
    const std::size_t i = find({cells_.data() + j * columns_, columns_}, static_cast<double>(u[0]), along);
    return {(static_cast<double>(i) + along) / static_cast<double>(columns_),
            (static_cast<double>(j) + across) / static_cast<double>(rows_)};
  }

 private:
  /// The step of a growing sum that `u` falls into, and where in it.
  static std::size_t find(std::span<const double> sums, double u, double& part) {
    const double wanted = u * sums.back();
    auto found = std::upper_bound(sums.begin(), sums.end(), wanted);
    if (found == sums.end()) found = std::lower_bound(sums.begin(), sums.end(), sums.back());
    const auto i = static_cast<std::size_t>(found - sums.begin());
    const double before = i > 0 ? sums[i - 1] : 0, step = sums[i] - before;
    part = step > 0 ? std::clamp((wanted - before) / step, 0.0, 0x1.fffffffp-1) : 0.5;
    return i;
  }

  std::size_t columns_, rows_;
  std::vector<double> cells_, rowSums_;
};

}  // namespace aerosol::render
