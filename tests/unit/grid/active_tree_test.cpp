// Intervals of a line through active blocks, against cutting the line at every face of every block.

#include "core/grid/active_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace aerosol::grid {
namespace {

using Triple = std::array<double, 3>;

struct Interval {
  double t0, t1;
};

class List final : public IntervalTaker {
 public:
  void add(double t0, double t1) override { intervals.push_back({t0, t1}); }
  std::vector<Interval> intervals;
};

std::vector<Interval> walk(const ActiveTree& tree, const Triple& o, const Triple& d) {
  List list;
  tree.walk(o, d, list);
  return list.intervals;
}

/// What occupied means, by its definition.
class Reference {
 public:
  Reference(std::vector<VoxelBox> boxes, VoxelInterpolation interpolation) : boxes_(std::move(boxes)) {
    const bool isCubic = interpolation == VoxelInterpolation::tricubic;
    reach_ = interpolation == VoxelInterpolation::nearest ? 0.5 : isCubic ? 2 : 1;
    before_ = isCubic ? 2 : 1;
    behind_ = isCubic ? 1 : 0;
    for (std::size_t r = 0; r < 3; ++r) {
      lower[r] = 1e30;
      upper[r] = -1e30;
      for (const VoxelBox& box : boxes_) {
        lower[r] = std::min(lower[r], box.least[r] - reach_);
        upper[r] = std::max(upper[r], box.greatest[r] + reach_);
      }
    }
  }

  bool isOccupied(const Triple& p) const {
    for (std::size_t r = 0; r < 3; ++r) {
      if (p[r] < lower[r] || p[r] >= upper[r]) return false;
    }
    return std::ranges::any_of(boxes_, [&](const VoxelBox& box) {
      for (std::size_t r = 0; r < 3; ++r) {
        const auto block = static_cast<int>(std::floor(p[r] / 8));
        if (block < (box.least[r] - before_) >> 3 || block > (box.greatest[r] + behind_) >> 3) return false;
      }
      return true;
    });
  }

  std::vector<Interval> walk(const Triple& o, const Triple& d) const {
    std::vector<double> cuts;
    for (std::size_t r = 0; r < 3; ++r) {
      if (d[r] == 0) continue;
      for (double face = std::floor(lower[r] / 8) * 8; face <= upper[r] + 8; face += 8)
        cuts.push_back((face - o[r]) / d[r]);
      cuts.push_back((lower[r] - o[r]) / d[r]);
      cuts.push_back((upper[r] - o[r]) / d[r]);
    }
    std::ranges::sort(cuts);
    std::vector<Interval> result;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      if (!(cuts[i + 1] - cuts[i] > 1e-9)) continue;
      const double middle = 0.5 * (cuts[i] + cuts[i + 1]);
      if (!isOccupied({o[0] + middle * d[0], o[1] + middle * d[1], o[2] + middle * d[2]})) continue;
      if (!result.empty() && cuts[i] - result.back().t1 < 1e-8) {
        result.back().t1 = cuts[i + 1];
      } else {
        result.push_back({cuts[i], cuts[i + 1]});
      }
    }
    return result;
  }

  Triple lower{}, upper{};

 private:
  std::vector<VoxelBox> boxes_;
  double reach_;
  int before_, behind_;
};

/// Without what is too short to be told apart in double.
std::vector<Interval> cleaned(const std::vector<Interval>& intervals) {
  std::vector<Interval> result;
  for (const Interval& each : intervals) {
    if (!(each.t1 - each.t0 > 1e-8)) continue;
    if (!result.empty() && each.t0 - result.back().t1 < 1e-8) {
      result.back().t1 = each.t1;
    } else {
      result.push_back(each);
    }
  }
  return result;
}

void expectSame(const ActiveTree& tree, const Reference& reference, const Triple& o, const Triple& d,
                std::size_t& total) {
  const auto found = cleaned(walk(tree, o, d)), expected = cleaned(reference.walk(o, d));
  ASSERT_EQ(found.size(), expected.size())
      << o[0] << ' ' << o[1] << ' ' << o[2] << "; " << d[0] << ' ' << d[1] << ' ' << d[2];
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_NEAR(found[i].t0, expected[i].t0, 1e-8);
    ASSERT_NEAR(found[i].t1, expected[i].t1, 1e-8);
  }
  total += found.size();
}

/// A million lines: in general position, along axes, through corners of blocks, in faces, with -0.
TEST(ActiveTree, AgreesWithBruteForce) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::size_t total = 0;
  for (int scene = 0; scene < 200; ++scene) {
    std::vector<VoxelBox> boxes(1 + random() % 6);
    for (VoxelBox& box : boxes) {
      for (std::size_t r = 0; r < 3; ++r) {
        box.least[r] = static_cast<std::int32_t>(random() % 90) - 45;
        box.greatest[r] = box.least[r] + static_cast<std::int32_t>(random() % 8);
      }
    }
    const auto interpolation = static_cast<VoxelInterpolation>(scene % 3);
    const ActiveTree tree(boxes, interpolation);
    const Reference reference(boxes, interpolation);
    for (int k = 0; k < 5000; ++k) {
      Triple o, d{};
      for (std::size_t r = 0; r < 3; ++r) {
        o[r] = 60 * uniform(random);
        d[r] = uniform(random);
      }
      if (k % 5 == 1) {  // Along an axis, some in a face.
        const std::size_t axis = random() % 3;
        for (std::size_t r = 0; r < 3; ++r) {
          if (r != axis) d[r] = k % 2 == 0 ? 0.0 : -0.0;
          if (r != axis && k % 4 == 0) o[r] = 8 * std::round(o[r] / 8);
        }
      }
      if (k % 5 == 2) {  // Towards a corner of a block.
        for (std::size_t r = 0; r < 3; ++r) d[r] = 8 * std::round(5 * uniform(random)) - o[r];
      }
      if (k % 5 == 3) {  // Diagonals through corners.
        for (std::size_t r = 0; r < 3; ++r) {
          o[r] = 8 * std::round(5 * uniform(random));
          d[r] = random() % 2 == 0 ? 1 : -1;
        }
      }
      if (d[0] == 0 && d[1] == 0 && d[2] == 0) continue;
      expectSame(tree, reference, o, d, total);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(total, 50'000u);
}

TEST(ActiveTree, FarApartAndHuge) {
  const std::vector<VoxelBox> boxes = {{{0, 0, 0}, {7, 7, 7}}, {{1 << 28, 0, 0}, {(1 << 28) + 4095, 4095, 4095}}};
  const ActiveTree tree(boxes, VoxelInterpolation::trilinear);
  EXPECT_LT(tree.bytes(), 20'000'000u);
  const auto found = walk(tree, {-100, 4, 4}, {1, 0, 0});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].t0, 99);
  EXPECT_EQ(found[0].t1, 108);
  EXPECT_EQ(found[1].t0, (1 << 28) + 92);
  EXPECT_EQ(found[1].t1, (1 << 28) + 4196);
}

TEST(ActiveTree, OfNothingIsEmpty) {
  const ActiveTree tree({}, VoxelInterpolation::trilinear);
  EXPECT_TRUE(tree.empty());
  EXPECT_TRUE(walk(tree, {0, 0, 0}, {1, 0, 0}).empty());
}

}  // namespace
}  // namespace aerosol::grid
