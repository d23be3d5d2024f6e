// A ray on its way through a medium's tree of bounds, leaf by leaf.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/volume/medium.h"

namespace aerosol::volume {

/// The leaves along a ray in order. The ray is taken into lattice coordinates at the place where the walk begins, in
/// double: a camera a million sizes away loses nothing. Which leaf comes next is decided by stepping a whole number
/// over the face through which the ray leaves; the other two coordinates are kept within the leaf that is left. So
/// rounding can neither skip a leaf nor return to one, on faces, edges and corners alike, and an axis without direction
/// (0 or -0) is never divided by. Outside of the tree's box its `outside` holds.
class BoundWalk {
 public:
  BoundWalk() = default;
  /// At distance `t` of the ray. A constant medium is one uniform leaf, one without a tree one leaf under its bound.
  BoundWalk(const Medium& medium, const Ray<World>& ray, double t) { begin(medium, ray, t); }
  void begin(const Medium& medium, const Ray<World>& ray, double t) {
    if (medium.tree && !medium.constant) {
      tree_ = medium.tree;
      if (medium.motion) [[unlikely]] {
        enter(ray, t, medium.motion->at(ray.time).inverseMatrix());
      } else {
        enter(ray, t, tree_->objectToWorld.inverseMatrix());
      }
      return;
    }
    leaf_ = medium.whole();
    if (medium.constant) known_ = &*medium.constant;
  }

  const BoundNode& leaf() const { return leaf_; }
  /// Where the leaf ends, in distances of the ray; infinite for the last one.
  double end() const { return end_; }
  /// Coefficients where they are the same in the whole leaf; null where they vary.
  const Coefficients* known() const { return known_; }

  /// What else is known of the leaf; null outside of a tree.
  const BoundRanges* ranges() const {
    return node_ && !isOutside_ ? &tree_->ranges[static_cast<std::size_t>(node_ - tree_->nodes.data())] : nullptr;
  }

  /// Goes on to the leaf behind `end()`.
  void next() {
    if (isOutside_) {
      if (end_ == entry_) return enterDomain();
      end_ = std::numeric_limits<double>::infinity();
      return;
    }
    const double t = end_ - start_;
    const std::int32_t low = ~((1 << shift_) - 1), side = (1 << shift_) - 1;
    std::array<std::int32_t, 3> cell;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t first = cell_[i] & low;
      cell[i] = i == exitAxis_ ? (direction_[i] > 0 ? first + side + 1 : first - 1)
                               : clampCell(origin_[i] + t * direction_[i], first, first + side);
    }
    cell_ = cell;
    if (end_ >= exit_ || cell_[exitAxis_] < 0 || cell_[exitAxis_] >= tree_->cellsPerSide()) return leave();
    look();
  }

 private:
  static std::int32_t clampCell(double x, std::int32_t first, std::int32_t last) {
    if (!(x > static_cast<double>(first))) return first;  // Also where the ray is so far out that x is no number.
    return x >= static_cast<double>(last) ? last : static_cast<std::int32_t>(x);
  }

  void enter(const Ray<World>& ray, double t, const Matrix4& m) {
    start_ = t;
    const double cells = tree_->cellsPerSide();
    const std::array<double, 3> d{static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
                                  static_cast<double>(ray.direction.z)};
    const std::array<double, 3> o{static_cast<double>(ray.origin.x) + t * d[0],
                                  static_cast<double>(ray.origin.y) + t * d[1],
                                  static_cast<double>(ray.origin.z) + t * d[2]};
    double entry = -std::numeric_limits<double>::infinity(), exit = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
      const int axis = static_cast<int>(i);
      const double lower = static_cast<double>(tree_->domain.lower[axis]);
      const double scale = cells / (static_cast<double>(tree_->domain.upper[axis]) - lower);
      origin_[i] = (m[i][0] * o[0] + m[i][1] * o[1] + m[i][2] * o[2] + m[i][3] - lower) * scale;
      direction_[i] = (m[i][0] * d[0] + m[i][1] * d[1] + m[i][2] * d[2]) * scale;
      forward_[i] = direction_[i] >= 0;
      if (direction_[i] == 0) {
        inverse_[i] = std::numeric_limits<double>::infinity();
        if (origin_[i] < 0 || origin_[i] > cells) exit = -std::numeric_limits<double>::infinity();
        continue;
      }
      inverse_[i] = 1 / direction_[i];
      const double a = -origin_[i] * inverse_[i], b = (cells - origin_[i]) * inverse_[i];
      entry = std::max(entry, std::min(a, b));
      exit = std::min(exit, std::max(a, b));
    }
    entry_ = start_ + entry;
    exit_ = start_ + exit;
    if (!(entry < exit) || exit <= 0) return leave();
    if (entry <= 0) return enterDomain();
    isOutside_ = true;
    take(tree_->outside);
    end_ = entry_;
  }

  void take(const BoundNode& leaf) {
    static constexpr Coefficients nothing{};
    leaf_ = leaf;
    node_ = &leaf;
    known_ = leaf.kind() == LeafKind::uniform ? &tree_->uniform[leaf.index()]
             : leaf.kind() == LeafKind::empty ? &nothing
                                              : nullptr;
  }

  void leave() {
    isOutside_ = true;
    take(tree_->outside);
    entry_ = std::numeric_limits<double>::quiet_NaN();
    end_ = std::numeric_limits<double>::infinity();
  }

  void enterDomain() {
    isOutside_ = false;
    const double t = std::max(entry_ - start_, 0.0);
    const std::int32_t last = tree_->cellsPerSide() - 1;
    for (std::size_t i = 0; i < 3; ++i) cell_[i] = clampCell(origin_[i] + t * direction_[i], 0, last);
    end_ = start_ + t;
    look();
  }

  void look() {
    const BoundTree::Place place = tree_->find(cell_);
    take(*place.leaf);
    shift_ = place.shift;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
      // An axis without direction gives infinity, or no number on the face itself: never the nearest.
      const double t = (static_cast<double>(((cell_[i] >> shift_) + forward_[i]) << shift_) - origin_[i]) * inverse_[i];
      if (t < nearest) {
        nearest = t;
        exitAxis_ = i;
      }
    }
    end_ = std::max(end_, start_ + nearest);
  }

  const BoundTree* tree_ = nullptr;
  BoundNode leaf_;
  const BoundNode* node_ = nullptr;  ///< The same, where it stands in the tree.
  const Coefficients* known_ = nullptr;
  double start_ = 0;
  double end_ = std::numeric_limits<double>::infinity();
  double entry_ = 0, exit_ = 0;  ///< Of the domain.
  std::array<double, 3> origin_{}, direction_{}, inverse_{};
  std::array<std::int32_t, 3> cell_{};
  std::array<std::int32_t, 3> forward_{};  ///< 1 where the ray goes up or along the axis' faces.
  int shift_ = 0;
  std::size_t exitAxis_ = 0;
  bool isOutside_ = false;
};

}  // namespace aerosol::volume
