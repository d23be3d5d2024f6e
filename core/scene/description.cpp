#include "core/scene/description.h"

#include <cmath>
#include <numbers>

#include "core/scene/focal_length.h"

namespace aerosol::scene {

const SourceLocation& Origin::of(const std::string& parameter) const {
  const auto found = parameters.find(parameter);
  return found == parameters.end() ? location : found->second;
}

const ShaderParameter* ShaderUse::find(const std::string& parameter) const {
  for (const ShaderParameter& p : parameters) {
    if (p.name == parameter) return &p;
  }
  return nullptr;
}

MediumSampling MediumSampling::orElse(const MediumSampling& other) const {
  MediumSampling result = *this;
  if (!result.distance) result.distance = other.distance;
  if (!result.transmittance) result.transmittance = other.transmittance;
  if (!result.stepSize) result.stepSize = other.stepSize;
  if (!result.densityBound) result.densityBound = other.densityBound;
  return result;
}

/// Thin lens: the half diagonal of a 36 × 24 mm film over the focal length is the tangent of half the angle.
FieldOfView Sensor::fieldOfView() const {
  if (fov) return {*fov, fovAxis};
  const double millimetres = parseFocalLength(focalLength).value_or(50);
  const double half = std::atan(0.5 * std::hypot(36.0, 24.0) / millimetres);
  return {static_cast<float>(2 * half * 180 / std::numbers::pi), FovAxis::diagonal};
}

const Value* Volume::find(const std::string& parameter) const {
  for (const NamedValue& p : parameters) {
    if (p.name == parameter) return &p.value;
  }
  return nullptr;
}

}  // namespace aerosol::scene
