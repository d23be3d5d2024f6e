// Clouds of points that shaders write.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/base/point_cloud.h"

namespace aerosol::accel {

/// Collects points from all threads. What is written in the end does not depend on the order in which they came.
class PointWriter {
 public:
  /// A point: attributes with one value each, "position" first. False, with the reason, when they are not those of the
  /// points before, or there are too many points.
  bool add(std::vector<PointAttribute> point, std::string& problem);

  /// The content of a file: .csv for an extension of ".csv", otherwise .ply with binary values, which holds no texts.
  /// Nothing, with the reason, when that cannot be.
  std::optional<std::string> encode(const std::string& extension, std::string& problem);

 private:
  std::mutex mutex_;
  std::vector<PointAttribute> attributes_;  ///< Of all points.
  std::size_t count_ = 0;
};

}  // namespace aerosol::accel
