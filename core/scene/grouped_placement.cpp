#include "core/scene/grouped_placement.h"

#include <cmath>

namespace aerosol::scene {

namespace {

/// The factor by which a matrix scales all lengths; nothing when it does not scale all the same.
std::optional<double> similarity(const Matrix4& m) {
  double squares[3][3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) squares[i][j] += m[k][i] * m[k][j];
    }
  }
  const double mean = (squares[0][0] + squares[1][1] + squares[2][2]) / 3;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (std::fabs(squares[i][j] - (i == j ? mean : 0)) > 1e-6 * mean) return {};
    }
  }
  return std::sqrt(mean);
}

/// Whether a matrix does nothing but scale all axes by one positive factor.
bool isPlainScale(const Matrix4& m) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const double expected = i == j ? m[0][0] : 0;
      if (std::fabs(m[i][j] - expected) > 1e-9 * std::fabs(m[0][0])) return false;
    }
  }
  return m[0][0] > 0;
}

}  // namespace

// Keys are interpolated part by part, translation, rotation and stretch (core/base/motion.h). Their product with a
// fixed transform is interpolated to the same when that is a similarity in front of them, or a plain scale behind them.
std::optional<std::string> placeInGroup(const Placement<World, Object>& group, Placement<World, Object>& inner) {
  if (!group.keys.empty() && !inner.keys.empty()) return "an object that moves is in a group that moves too";
  if (!group.keys.empty() && !isPlainScale(inner.matrix()))
    return "an object with a transform of its own is in a group that moves";
  if (!inner.keys.empty() && !similarity(group.matrix()))
    return "an object that moves is in a group that is stretched or sheared";
  Placement<World, Object> placed = Transform<World, Object>(multiply(group.matrix(), inner.matrix()),
                                                             multiply(inner.inverseMatrix(), group.inverseMatrix()));
  for (const MotionKey& key : group.keys) placed.keys.push_back({key.time, multiply(key.matrix, inner.matrix())});
  for (const MotionKey& key : inner.keys) placed.keys.push_back({key.time, multiply(group.matrix(), key.matrix)});
  inner = placed;
  return {};
}

}  // namespace aerosol::scene
