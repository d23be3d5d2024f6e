#include "core/base/motion.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace aerosol {

namespace {

using Linear = std::array<std::array<double, 3>, 3>;
using Quaternion = std::array<double, 4>;  // (x, y, z, w)

Linear linearPart(const Matrix4& m) {
  Linear l;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) l[i][j] = m[i][j];
  }
  return l;
}

/// Cofactors: the inverse transposed, times the determinant.
Linear cofactors(const Linear& m) {
  Linear c;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
    }
  }
  return c;
}

double determinant(const Linear& m) {
  const Linear c = cofactors(m);
  return m[0][0] * c[0][0] + m[0][1] * c[0][1] + m[0][2] * c[0][2];
}

Linear inverseOf(const Linear& m) {
  const Linear c = cofactors(m);
  const double scale = 1 / (m[0][0] * c[0][0] + m[0][1] * c[0][1] + m[0][2] * c[0][2]);
  Linear inverse;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) inverse[i][j] = c[j][i] * scale;
  }
  return inverse;
}

Linear product(const Linear& a, const Linear& b) {
  Linear p;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) p[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  }
  return p;
}

/// Higham, "Computing the Polar Decomposition" (1986): Newton's iteration Q ← (Q + Q⁻ᵀ) / 2 converges to the orthogonal
/// factor. A mirror's factor is turned into a rotation.
Linear rotationOf(const Linear& m) {
  Linear q = m;
  for (int step = 0; step < 100; ++step) {
    const Linear inverse = inverseOf(q);
    double change = 0;
    Linear next;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        next[i][j] = 0.5 * (q[i][j] + inverse[j][i]);
        change = std::max(change, std::fabs(next[i][j] - q[i][j]));
      }
    }
    q = next;
    if (change < 1e-15) break;
  }
  if (determinant(q) < 0) {
    for (auto& row : q) {
      for (double& x : row) x = -x;
    }
  }
  return q;
}

/// Shepperd 1978: the largest of the four components is found first.
Quaternion quaternionOf(const Linear& r) {
  const double trace = r[0][0] + r[1][1] + r[2][2];
  Quaternion q;
  if (trace > 0) {
    const double s = 2 * std::sqrt(trace + 1);
    q = {(r[2][1] - r[1][2]) / s, (r[0][2] - r[2][0]) / s, (r[1][0] - r[0][1]) / s, 0.25 * s};
  } else {
    std::size_t i = r[1][1] > r[0][0] ? 1 : 0;
    if (r[2][2] > r[i][i]) i = 2;
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const double s = 2 * std::sqrt(std::max(0.0, r[i][i] - r[j][j] - r[k][k] + 1));
    q[i] = 0.25 * s;
    q[j] = (r[j][i] + r[i][j]) / s;
    q[k] = (r[k][i] + r[i][k]) / s;
    q[3] = (r[k][j] - r[j][k]) / s;
  }
  return q;
}

double dot(const Quaternion& a, const Quaternion& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

/// Shoemake, "Animating Rotation with Quaternion Curves" (1985).
Quaternion slerp(const Quaternion& a, const Quaternion& b, double u) {
  const double cosine = std::clamp(dot(a, b), -1.0, 1.0), angle = std::acos(cosine), sine = std::sin(angle);
  const bool isNear = sine < 1e-6;
  const double wa = isNear ? 1 - u : std::sin((1 - u) * angle) / sine, wb = isNear ? u : std::sin(u * angle) / sine;
  Quaternion q;
  for (std::size_t i = 0; i < 4; ++i) q[i] = wa * a[i] + wb * b[i];
  const double scale = 1 / std::sqrt(dot(q, q));
  for (double& x : q) x *= scale;
  return q;
}

Linear matrixOf(const Quaternion& q) {
  const auto [x, y, z, w] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
}

void assemble(const Linear& linear, const Linear& inverseLinear, const std::array<double, 3>& translation,
              Matrix4& matrix, Matrix4& inverse) {
  for (std::size_t i = 0; i < 3; ++i) {
    double back = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      matrix[i][j] = linear[i][j];
      inverse[i][j] = inverseLinear[i][j];
      back += inverseLinear[i][j] * translation[j];
    }
    matrix[i][3] = translation[i];
    inverse[i][3] = -back;
  }
  matrix[3] = inverse[3] = {0, 0, 0, 1};
}

bool isAffine(const Matrix4& m) { return m[3] == std::array<double, 4>{0, 0, 0, 1}; }

bool isFinite(const Matrix4& m) {
  return std::ranges::all_of(
      m, [](const auto& row) { return std::ranges::all_of(row, [](double x) { return std::isfinite(x); }); });
}

}  // namespace

std::optional<Motion::Problem> Motion::findProblem(std::span<const MotionKey> keys) {
  if (keys.empty()) return Problem{0, "an animation needs at least one transform"};
  if (keys.size() > maximumKeys) {
    return Problem{maximumKeys, "an animation has at most " + std::to_string(maximumKeys) + " transforms"};
  }
  std::vector<std::size_t> order(keys.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::pair(keys[i].time, i); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const MotionKey& key = keys[order[i]];
    const bool isUsable = isAffine(key.matrix) && isFinite(key.matrix);
    const double size = isUsable ? determinant(linearPart(key.matrix)) : 0;
    Matrix4 inverse;
    if (size == 0 || !invert(key.matrix, inverse) || !isFinite(inverse))
      return Problem{order[i], "this transform is not affine and invertible"};
    if (i == 0) continue;
    const MotionKey& before = keys[order[i - 1]];
    if (key.time == before.time)
      return Problem{std::max(order[i], order[i - 1]), "a second transform at the same time"};
    if ((determinant(linearPart(before.matrix)) < 0) != (size < 0)) {
      return Problem{std::max(order[i], order[i - 1]),
                     "one transform mirrors and the next does not: the motion between them passes through a singular "
                     "matrix"};
    }
  }
  return {};
}

Motion::Motion(std::vector<MotionKey> keys) : keys_(std::move(keys)) {
  std::ranges::sort(keys_, {}, &MotionKey::time);
  for (const MotionKey& key : keys_) {
    Part part;
    part.matrix = linearPart(key.matrix);
    part.inverse = inverseOf(part.matrix);
    const Linear rotation = rotationOf(part.matrix);
    part.rotation = quaternionOf(rotation);
    Linear transposed;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) transposed[i][j] = rotation[j][i];
    }
    part.stretch = product(transposed, part.matrix);
    if (!parts_.empty() && dot(parts_.back().rotation, part.rotation) < 0) {
      for (double& x : part.rotation) x = -x;
    }
    if (!parts_.empty()) parts_.back().keepsShape = parts_.back().matrix == part.matrix;
    parts_.push_back(part);
  }
}

void Motion::at(double time, Matrix4& matrix, Matrix4& inverse) const {
  const auto translationOf = [&](std::size_t i) {
    return std::array{keys_[i].matrix[0][3], keys_[i].matrix[1][3], keys_[i].matrix[2][3]};
  };
  const auto stand = [&](std::size_t i) {
    assemble(parts_[i].matrix, parts_[i].inverse, translationOf(i), matrix, inverse);
  };
  if (!(time > keys_.front().time)) return stand(0);
  if (!(time < keys_.back().time)) return stand(keys_.size() - 1);
  std::size_t i = 0;
  while (keys_[i + 1].time <= time) ++i;
  const double u = (time - keys_[i].time) / (keys_[i + 1].time - keys_[i].time);
  const std::array<double, 3> from = translationOf(i), to = translationOf(i + 1);
  std::array<double, 3> translation;
  for (std::size_t k = 0; k < 3; ++k) translation[k] = from[k] + u * (to[k] - from[k]);
  const Part &a = parts_[i], &b = parts_[i + 1];
  if (a.keepsShape) return assemble(a.matrix, a.inverse, translation, matrix, inverse);
  Linear stretch;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) stretch[r][c] = (1 - u) * a.stretch[r][c] + u * b.stretch[r][c];
  }
  const Linear linear = product(matrixOf(slerp(a.rotation, b.rotation, u)), stretch);
  assemble(linear, inverseOf(linear), translation, matrix, inverse);
}

bool Motion::moves(const Shutter& shutter) const {
  const auto open = static_cast<double>(shutter.open), close = static_cast<double>(shutter.close);
  for (std::size_t i = 0; i + 1 < keys_.size(); ++i) {
    const bool isSeen = keys_[i].time < close && keys_[i + 1].time > open;
    if (isSeen && keys_[i].matrix != keys_[i + 1].matrix) return true;
  }
  return false;
}

}  // namespace aerosol
