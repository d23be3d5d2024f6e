// Transforms that change with time.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/geometry.h"

namespace aerosol {

/// When light is let in: from `open` to `close`, seconds of the scene's time.
struct Shutter {
  float open = 0;
  float close = 0;

  /// Open for no time, all is still as it is at that instant.
  bool isInstant() const { return !(open < close); }
  /// `u` in [0, 1] of the way from `open` to `close`.
  float at(float u) const { return open + u * (close - open); }

  friend bool operator==(const Shutter&, const Shutter&) = default;
};

/// A transform at one time.
struct MotionKey {
  double time = 0;  ///< Seconds.
  Matrix4 matrix = identityMatrix();
};

/// A motion through keys, at rest before the first and after the last.
///
/// Shoemake and Duff, "Matrix Animation and Polar Decomposition" (1992): each key is taken apart into M = T R S, where
/// T is a translation, R a rotation and S symmetric. Between two keys T and S are interpolated linearly and R on the
/// shortest great arc of unit quaternions. S stays positive definite (or negative, of mirrors), so nothing becomes flat
/// on the way.
class Motion {
 public:
  static constexpr std::size_t maximumKeys = 64;

  /// Which key is wrong, and why.
  struct Problem {
    std::size_t key = 0;
    std::string message;
  };
  /// What keeps the keys from being a motion; nothing when they are one. They may come in any order.
  static std::optional<Problem> findProblem(std::span<const MotionKey> keys);

  /// Keys without a problem.
  explicit Motion(std::vector<MotionKey> keys);

  /// The transform at a time (seconds), and its inverse.
  void at(double time, Matrix4& matrix, Matrix4& inverse) const;
  /// Whether anything changes while the shutter is open.
  bool moves(const Shutter& shutter) const;
  /// In order of time.
  std::span<const MotionKey> keys() const { return keys_; }

 private:
  using Linear = std::array<std::array<double, 3>, 3>;
  using Quaternion = std::array<double, 4>;
  struct Part {
    Linear matrix, inverse;  ///< Of the key's upper left block, as given.
    Linear stretch;
    Quaternion rotation;      ///< On the same half as the key's before.
    bool keepsShape = false;  ///< The block is the same as the next key's.
  };

  std::vector<MotionKey> keys_;
  std::vector<Part> parts_;
};

/// A place that moves with a motion: the motion's transform after a fixed one.
template <class To, class From>
class MovingTransform {
 public:
  explicit MovingTransform(std::shared_ptr<const Motion> motion, const Transform<From, From>& local = {})
      : motion_(std::move(motion)), local_(local), isPlain_(local.matrix() == identityMatrix()) {}

  Transform<To, From> at(float time) const {
    Matrix4 matrix, inverse;
    motion_->at(static_cast<double>(time), matrix, inverse);
    if (isPlain_) return {matrix, inverse};
    return {multiply(matrix, local_.matrix()), multiply(local_.inverseMatrix(), inverse)};
  }
  const Motion& motion() const { return *motion_; }

 private:
  std::shared_ptr<const Motion> motion_;
  Transform<From, From> local_;
  bool isPlain_;
};

}  // namespace aerosol
