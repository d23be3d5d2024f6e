// Intervals of a line through voxels in a frustum, against cutting the line at every face of every block.

#include "core/grid/kd_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/grid/overlay_grid.h"
#include "tests/support/effort.h"

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

const Matrix4 placed = {{{0.8, -0.6, 0, 3}, {0.6, 0.8, 0, -1}, {0, 0, 1.5, 2}, {0, 0, 0, 1}}};

VoxelMap linearDepth() {
  Matrix4 inverse;
  invert(placed, inverse);
  return VoxelMap::linearDepth({-0.5, -0.5, -0.5}, {95.5, 71.5, 119.5}, 0.2, 6, inverse);
}
VoxelMap projective() {
  Matrix4 inverse;
  invert(placed, inverse);
  const Matrix4 view = {{{80, 0, 47.5, 0}, {0, 72, 35.5, 0}, {0, 0, 133, -135}, {0, 0, 1, 0}}};
  return VoxelMap::projective(multiply(view, inverse));
}
VoxelMap affine() {
  Matrix4 inverse;
  invert(placed, inverse);
  for (auto& row : inverse) {
    for (double& entry : row) entry *= 10;
  }
  return VoxelMap::affine(inverse);
}

std::vector<VoxelBox> someBoxes() {
  std::mt19937 random(8);
  std::vector<VoxelBox> boxes;
  for (int i = 0; i < 60; ++i) {
    VoxelBox box;
    for (std::size_t r = 0; r < 3; ++r) {
      box.least[r] = static_cast<std::int32_t>(random() % 110) - 4;
      box.greatest[r] = box.least[r] + static_cast<std::int32_t>(random() % 9);
    }
    boxes.push_back(box);
  }
  boxes.push_back({{8, 8, 8}, {39, 39, 39}});
  return boxes;
}

/// What occupied means, by its definition, at points that the map takes back one by one.
class Reference {
 public:
  Reference(std::vector<VoxelBox> boxes, const VoxelMap& map) : boxes_(std::move(boxes)), map_(map) {
    for (std::size_t r = 0; r < 3; ++r) {
      lower_[r] = 1e30;
      upper_[r] = -1e30;
      for (const VoxelBox& box : boxes_) {
        lower_[r] = std::min(lower_[r], box.least[r] - 1.0);
        upper_[r] = std::max(upper_[r], box.greatest[r] + 1.0);
      }
    }
  }

  bool isOccupied(const Triple& point) const {
    const auto p = map_.toIndex(point);
    if (!p) return false;
    for (std::size_t r = 0; r < 3; ++r) {
      if ((*p)[r] < lower_[r] || (*p)[r] >= upper_[r]) return false;
    }
    return std::ranges::any_of(boxes_, [&](const VoxelBox& box) {
      for (std::size_t r = 0; r < 3; ++r) {
        const auto block = static_cast<int>(std::floor((*p)[r] / 8));
        if (block < (box.least[r] - 1) >> 3 || block > box.greatest[r] >> 3) return false;
      }
      return true;
    });
  }

  std::vector<Interval> walk(const Triple& o, const Triple& d) const {
    std::vector<double> cuts;
    const auto cut = [&](const VoxelMap::Form& plane) {
      const double slope = plane[0] * d[0] + plane[1] * d[1] + plane[2] * d[2];
      const double value = plane[0] * o[0] + plane[1] * o[1] + plane[2] * o[2] + plane[3];
      if (std::fabs(slope) > 1e-13) cuts.push_back(-value / slope);
    };
    for (std::size_t r = 0; r < 3; ++r) {
      for (double face = std::floor(lower_[r] / 8) * 8; face <= upper_[r] + 8; face += 8) cut(map_.plane(r, face));
      cut(map_.plane(r, lower_[r]));
      cut(map_.plane(r, upper_[r]));
      cut(map_.denominator[r]);
    }
    std::ranges::sort(cuts);
    std::vector<Interval> result;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      if (!(cuts[i + 1] - cuts[i] > 1e-10)) continue;
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

  Triple inside(std::mt19937& random) const {
    std::uniform_real_distribution<double> uniform(0, 1);
    Triple index;
    for (std::size_t r = 0; r < 3; ++r) index[r] = lower_[r] + uniform(random) * (upper_[r] - lower_[r]);
    return map_.toFile(index).value_or(Triple{});
  }

 private:
  std::vector<VoxelBox> boxes_;
  const VoxelMap& map_;
  Triple lower_{}, upper_{};
};

/// Without what is too short, and gaps that are, to be told apart in double.
std::vector<Interval> cleaned(const std::vector<Interval>& intervals, double shortest) {
  std::vector<Interval> result;
  for (const Interval& each : intervals) {
    if (!(each.t1 - each.t0 > shortest)) continue;
    if (!result.empty() && each.t0 - result.back().t1 < shortest) {
      result.back().t1 = each.t1;
    } else {
      result.push_back(each);
    }
  }
  return result;
}

std::vector<Interval> walk(const KdTree& tree, const VoxelMap& map, const Triple& o, const Triple& d) {
  List list;
  tree.walk(LineToGrid(map, o, d), list);
  return list.intervals;
}

/// Lines from anywhere to anywhere: inside and outside, behind the eye, through it, along axes.
std::pair<Triple, Triple> someLine(const Reference& reference, const VoxelMap& map, std::mt19937& random, int kind) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Triple a = reference.inside(random), b = reference.inside(random);
  Triple origin = a, direction{uniform(random), uniform(random), uniform(random)};
  if (kind == 1) {
    for (std::size_t r = 0; r < 3; ++r) direction[r] = b[r] - a[r];
  } else if (kind == 2 && map.eye) {
    for (std::size_t r = 0; r < 3; ++r) direction[r] = a[r] - (*map.eye)[r];
    origin = *map.eye;
  } else if (kind == 3) {
    direction = {};
    direction[random() % 3] = random() % 2 == 0 ? 1 : -1;
  } else if (kind == 4) {
    for (std::size_t r = 0; r < 3; ++r) origin[r] = a[r] - 7 * direction[r];
  }
  return {origin, direction};
}

/// A million lines with AEROSOL_WHOLE_TESTS=1, otherwise 300,000.
TEST(KdTrees, LinesThroughFrustums) {
  const int lines = test::effort(100'000, 333'334);
  const std::vector<VoxelBox> boxes = someBoxes();
  const KdTree tree(boxes, VoxelInterpolation::trilinear);
  std::mt19937 random(9);
  for (const VoxelMap& map : {linearDepth(), projective(), affine()}) {
    const Reference reference(boxes, map);
    int hits = 0;
    for (int i = 0; i < lines; ++i) {
      const auto [o, d] = someLine(reference, map, random, i % 5);
      const auto expected = cleaned(reference.walk(o, d), 1e-7), found = cleaned(walk(tree, map, o, d), 1e-7);
      // A line along a face, or one that touches an edge, may go either way by a rounding.
      ASSERT_EQ(found.size(), expected.size()) << i;
      for (std::size_t k = 0; k < found.size(); ++k) {
        ASSERT_NEAR(found[k].t0, expected[k].t0, 1e-6) << i;
        ASSERT_NEAR(found[k].t1, expected[k].t1, 1e-6) << i;
        ++hits;
      }
    }
    EXPECT_GT(hits, lines / 3);
  }
}

/// Exactly in a plane of the grid: the blocks behind it count, those before do not.
TEST(KdTrees, LinesInPlanes) {
  const VoxelMap map = VoxelMap::projective({{{8, 0, 0, 0}, {0, 8, 0, 0}, {0, 0, 64, -64}, {0, 0, 1, 0}}});
  const std::vector<VoxelBox> upper = {{{1, -6, 9}, {6, 6, 14}}}, lower = {{{-7, -6, 9}, {-2, 6, 14}}};
  for (const auto& [boxes, count] : {std::pair{upper, 1u}, std::pair{lower, 0u}}) {
    const KdTree tree(boxes, VoxelInterpolation::trilinear);
    // x = 0 is the plane of index 0, where a block begins; the line goes through the eye.
    const auto found = walk(tree, map, {0, 0.1, 0}, {0, 0, 1});
    EXPECT_EQ(found.size(), count);
  }
}

TEST(KdTrees, NothingBehindTheEyeAndNothingAtAll) {
  const KdTree tree(someBoxes(), VoxelInterpolation::tricubic);
  const VoxelMap map = projective();
  const Triple eye = *map.eye;
  // Away from the view, from the eye and from behind it.
  EXPECT_TRUE(walk(tree, map, {eye[0], eye[1], eye[2] - 1}, {1, 0, 0}).empty());
  for (const Interval& each : walk(tree, map, eye, {0.1, 0.1, -1.5})) EXPECT_LT(each.t1, 0);
  List none;
  KdTree().walk(LineToGrid(map, {0, 0, 0}, {0, 0, 1}), none);
  EXPECT_TRUE(none.intervals.empty());
}

/// A range of depths of 1 to 10^7.
TEST(KdTrees, DeepViews) {
  const double near = 1e-3, far = 1e4, scale = 64 * far / (far - near);
  const VoxelMap map =
      VoxelMap::projective({{{16, 0, 8, 0}, {0, 16, 8, 0}, {0, 0, scale, -scale * near}, {0, 0, 1, 0}}});
  const std::vector<VoxelBox> boxes = {{{0, 0, 0}, {15, 15, 63}}};
  const KdTree tree(boxes, VoxelInterpolation::trilinear);
  const auto found = walk(tree, map, {0, 0, 0}, {0.1, 0.05, 1});
  ASSERT_EQ(found.size(), 1u);
  const auto begin = map.toIndex({0.1 * found[0].t0, 0.05 * found[0].t0, found[0].t0});
  ASSERT_TRUE(begin);
  EXPECT_NEAR((*begin)[2], -1, 1e-9);
  EXPECT_NEAR(found[0].t1, 1e4, 0.1);
}

TEST(OverlayGrids, HoldWhatTheBlocksHold) {
  const std::vector<VoxelBox> boxes = someBoxes();
  const KdTree tree(boxes, VoxelInterpolation::trilinear);
  std::mt19937 random(10);
  for (const VoxelMap& map : {linearDepth(), projective()}) {
    const Reference reference(boxes, map);
    double before = 1e30;
    for (const int resolution : {8, 32, 96}) {
      const OverlayGrid grid(tree, map, resolution);
      std::mt19937 lines(11);
      double exact = 0, padded = 0;
      for (int i = 0; i < 3000; ++i) {
        const auto [o, d] = someLine(reference, map, lines, i % 5);
        List cells;
        grid.walk(o, d, cells);
        for (const Interval& each : cells.intervals) padded += each.t1 - each.t0;
        for (const Interval& each : walk(tree, map, o, d)) {
          exact += each.t1 - each.t0;
          double covered = 0;
          for (const Interval& cell : cells.intervals)
            covered += std::max(0.0, std::min(cell.t1, each.t1) - std::max(cell.t0, each.t0));
          ASSERT_NEAR(covered, each.t1 - each.t0, 1e-6) << i;
        }
      }
      EXPECT_GE(padded, exact * (1 - 1e-9));
      EXPECT_LT(padded / exact, before);
      before = padded / exact;
    }
    EXPECT_LT(before, 3);
  }
}

}  // namespace
}  // namespace aerosol::grid
