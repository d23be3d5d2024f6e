// Places in the unit square, by weights of its cells.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace aerosol::render {

/// The steps of a growing sum. A place in it is found from where its share of the sum would be among steps of equal
/// height, in constant time on average (Chen and Asau 1974, "On Generating Random Variates from an Empirical
/// Distribution").
class GrowingSum {
 public:
  /// Of the sums behind each step; the last one is > 0. They stay where they are.
  static std::vector<std::uint32_t> guideOf(std::span<const double> sums) {
    std::vector<std::uint32_t> guide(sums.size());
    std::size_t i = 0;
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const double share = sums.back() * (static_cast<double>(k) / static_cast<double>(sums.size()));
      while (i + 1 < sums.size() && !(sums[i] > share)) ++i;
      guide[k] = static_cast<std::uint32_t>(i);
    }
    return guide;
  }

  /// The step that `u` in [0, 1) falls into, and where in it.
  static std::size_t find(std::span<const double> sums, std::span<const std::uint32_t> guide, double u, double& part) {
    const double wanted = u * sums.back();
    const auto k = std::min(static_cast<std::size_t>(u * static_cast<double>(sums.size())), sums.size() - 1);
    std::size_t i = guide[k];
    while (i > 0 && sums[i - 1] > wanted) --i;
    while (i + 1 < sums.size() && !(sums[i] > wanted)) ++i;
    // Where rounding leads behind the last step that has a height.
    while (i > 0 && !(sums[i] > sums[i - 1])) --i;
    const double before = i > 0 ? sums[i - 1] : 0, step = sums[i] - before;
    part = step > 0 ? std::clamp((wanted - before) / step, 0.0, 0x1.fffffffp-1) : 0.5;
    return i;
  }
};

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
      const std::vector<std::uint32_t> guide = GrowingSum::guideOf({cells_.data() + j * columns_, columns_});
      guides_.insert(guides_.end(), guide.begin(), guide.end());
    }
    rowGuide_ = GrowingSum::guideOf(rowSums_);
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
    const std::size_t j = GrowingSum::find(rowSums_, rowGuide_, static_cast<double>(u[1]), across);
    const std::size_t i = GrowingSum::find({cells_.data() + j * columns_, columns_},
                                           {guides_.data() + j * columns_, columns_}, static_cast<double>(u[0]), along);
    return {(static_cast<double>(i) + along) / static_cast<double>(columns_),
            (static_cast<double>(j) + across) / static_cast<double>(rows_)};
  }

 private:
  std::size_t columns_, rows_;
  std::vector<double> cells_, rowSums_;
  std::vector<std::uint32_t> guides_, rowGuide_;
};

}  // namespace aerosol::render
