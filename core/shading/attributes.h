// Named values that shaders may ask for: of the whole scene, of its objects, and of single points.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/lang/fold.h"

namespace aerosol::shading {

/// Values by name.
class AttributeTable {
 public:
  void set(std::string_view name, lang::Constant value);
  /// Null when there is none of that name.
  const lang::Constant* find(std::uint64_t nameHash) const;
  bool empty() const { return values_.empty(); }

 private:
  std::map<std::uint64_t, lang::Constant> values_;
};

/// Attributes of the scene ("global") and of everything in it that has a name. Const after preparation.
class SceneAttributes {
 public:
  AttributeTable global;

  /// The table of an object or camera, made when there is none yet.
  AttributeTable& object(std::string_view name);
  /// Null when there is no object of that name.
  const AttributeTable* find(std::uint64_t nameHash) const;

 private:
  std::map<std::uint64_t, AttributeTable> objects_;
};

/// A ray that a shader sends; distances are lengths, whatever the direction's.
struct TraceRequest {
  std::array<float, 3> origin{}, direction{};  ///< World space.
  float least = 0, greatest = std::numeric_limits<float>::infinity();
  std::string_view set;  ///< Name of the objects that count; empty: all.
};

/// What it hit. World space.
struct TraceAnswer {
  bool isHit = false;
  float distance = 0;
  std::array<float, 3> position{}, normal{}, geometricNormal{};
  float u = 0, v = 0;
  const AttributeTable* object = nullptr;
};

/// What is known of the points of the batch that runs, by their index in it. The functions here say: nothing.
class PointFacts {
 public:
  /// Floats that user data holds at most.
  static constexpr std::size_t maximumUserData = 16;

  virtual ~PointFacts() = default;
  /// Bits of the ray that asks (ray_type.h).
  virtual std::uint32_t rayTypes(std::uint32_t point) const;
  /// Is the surface seen from the side that its normal points away from?
  virtual bool isBackfacing(std::uint32_t point) const;
  /// What the point's random numbers depend on: the same for the same sample of a pixel, whatever else is in the batch.
  virtual std::uint64_t randomKey(std::uint32_t point) const;
  /// Area of the object, in square scene units.
  virtual float surfaceArea(std::uint32_t point) const;
  /// Of the object that the point lies on or in; null when it has none.
  virtual const AttributeTable* attributes(std::uint32_t point) const;
  /// A value of the geometry that is interpolated to the point: floats, triples, matrices or arrays of them. Gives its
  /// type and writes its components; nothing when there is none of that name.
  virtual std::optional<lang::Type> userData(std::uint32_t point, std::uint64_t nameHash,
                                             std::span<float, maximumUserData> values) const;
  /// Sends a ray from the point: whether it hits anything. The answer is all that messages tell of it.
  virtual bool trace(std::uint32_t point, const TraceRequest& request, TraceAnswer& answer) const;
  /// How such a value changes to the next shading sample, in x (axis 0) or y (1): writes its components. Zero here.
  virtual void userDataChange(std::uint32_t point, std::uint64_t nameHash, int axis,
                              std::span<float, maximumUserData> values) const;
};

}  // namespace aerosol::shading
