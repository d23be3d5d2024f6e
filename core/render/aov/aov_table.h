// The quantities that a render can show beside its picture, by the names that users ask for them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aerosol::render {

/// What a path knows beside its light.
enum class AovFeature : std::uint8_t {
  // Of the first surface that a camera ray meets, whatever it is made of.
  albedo,
  depth,
  position,
  uv,
  geometricNormal,
  shadingNormal,
  dPdu,
  dPdv,
  dUVdx,
  dUVdy,
  primitiveIndex,
  shapeIndex,
  motion,
  // Of what a path sees first: a surface, or a place in a medium.
  visibleAlbedo,
  visibleNormal,
  visibleDepth,
  visibleMotion,
  // Of the picture and of its making.
  halfA,
  halfB,
  pictureXyz,
  cost
};

/// Whether it is found by a ray of its own.
constexpr bool isOfFirstHit(AovFeature feature) { return feature <= AovFeature::motion; }
constexpr bool isOfFirstSeen(AovFeature feature) {
  return feature >= AovFeature::visibleAlbedo && feature <= AovFeature::visibleMotion;
}

enum class AovKind : std::uint8_t {
  light,     ///< The paths that match `paths`.
  feature,   ///< `feature`.
  variance,  ///< Of the mean of another feature.
  picture,   ///< From the sums of the picture alone.
  standardError,
  pictureVariance,
  sampleCount,
  objectMatte,
  materialMatte,
  list  ///< Stands for others.
};

struct AovType {
  std::string_view name;
  AovKind kind;
  std::string_view channels;  ///< A letter each.
  std::string_view doc;
  std::string_view paths = {};  ///< A light path expression.
  AovFeature feature = {};
  std::string_view members = {};  ///< Of a list: names with spaces.
  bool isListed = true;           ///< Shown to users.
};

std::span<const AovType> aovTypes();
/// Null when there is none of that name.
const AovType* findAovType(std::string_view name);
/// Of all that are listed.
std::vector<std::string> aovNames();

}  // namespace aerosol::render
