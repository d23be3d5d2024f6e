// Points with attributes as shaders ask for them: the interface between the host services of compiled shaders and the
// library that reads files and finds neighbours. It stands in the base layer because neither of the two sees the other.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace aerosol {

/// One value, or a few, for each point.
struct PointAttribute {
  enum class Base : std::uint8_t { integer, floating, string };
  std::string name;
  Base base = Base::floating;
  int components = 1;
  std::vector<std::int32_t> integers;  ///< Point after point; the one of these three that `base` says is filled.
  std::vector<float> floats;
  std::vector<std::string> strings;

  std::size_t pointCount() const {
    return (integers.size() + floats.size() + strings.size()) / static_cast<std::size_t>(components);
  }
};

struct FoundPoint {
  double distanceSquared = 0;
  std::uint32_t index = 0;

  bool operator<(const FoundPoint& other) const {
    return distanceSquared != other.distanceSquared ? distanceSquared < other.distanceSquared : index < other.index;
  }
};

/// Const and safe to use from any thread.
class PointCloud {
 public:
  virtual ~PointCloud() = default;

  /// The first is "position", of three floats.
  virtual const std::vector<PointAttribute>& attributes() const = 0;
  std::size_t size() const { return attributes().front().pointCount(); }
  /// Null when there is none of that name.
  const PointAttribute* find(std::string_view name) const;

  /// The `maximum` nearest points within `radius` (its end included), nearest first, of equal distance the one with the
  /// lesser index. A position or radius that is no number finds nothing.
  virtual void search(const float* position, float radius, std::size_t maximum,
                      std::vector<FoundPoint>& found) const = 0;
};

}  // namespace aerosol
