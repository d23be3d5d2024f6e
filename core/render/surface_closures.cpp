#include "core/render/surface_closures.h"

#include <algorithm>
#include <cmath>

namespace aerosol::render {

shading::ShadingPoint shadingPointOf(const accel::SurfaceHit& hit, const Ray<World>& ray) {
  using lang::Global;
  shading::ShadingPoint point;
  point.set(Global::P, hit.point);
  point.set(Global::I, ray.direction);
  point.set(Global::N, hit.shadingNormal);
  point.set(Global::Ng, hit.geometricNormal);
  point.set(Global::u, hit.u);
  point.set(Global::v, hit.v);
  point.set(Global::dPdu, hit.dPdu);
  point.set(Global::dPdv, hit.dPdv);
  point.set(Global::time, ray.time);
  return point;
}

namespace {

/// Shaders may return normals of any length; closures want unit ones.
void normalizeDirections(const Closure& closure, std::span<float> parameters, Normal<World> fallback) {
  std::size_t at = 0;
  for (const DescribedField& field : closure.fields()) {
    if (field.type == FieldType::direction) {
      Vector<World> v = normalize(Vector<World>(parameters[at], parameters[at + 1], parameters[at + 2]));
      if (!(squaredLength(v) > 0.5f)) v = fallback.vector();
      for (int i = 0; i < 3; ++i) parameters[at + static_cast<std::size_t>(i)] = v[i];
    }
    at += static_cast<std::size_t>(field.components());
  }
}

bool isSoundSite(const Closure& closure, const SurfaceAnswer::Site& site) {
  std::size_t count = 0;
  for (const DescribedField& field : closure.fields()) count += static_cast<std::size_t>(field.components());
  return isFinite(site.weight) && std::all_of(site.parameters.begin(), site.parameters.begin() + count,
                                              [](float parameter) { return std::isfinite(parameter); });
}

}  // namespace

SurfaceClosures::SurfaceClosures(const PreparedObject& object, const SurfaceAnswer& answer,
                                 const accel::SurfaceHit& hit, Vector<World> direction,
                                 const volume::Crossing* crossing)
    : answer_(answer) {
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < answer_.siteCount; ++i) {
    SurfaceAnswer::Site& site = answer_.sites[i];
    if (!object.closures[i] || isBlack(site.weight)) continue;
    if (object.closures[i]->kind() == ClosureKind::interior) continue;
    if (!isSoundSite(*object.closures[i], site)) {
      if (!invalidSite_) invalidSite_ = i;
      continue;
    }
    normalizeDirections(*object.closures[i], site.parameters, hit.shadingNormal);
    terms_[count++] = {object.closures[i], site.weight, site.parameters};
  }
  ClosurePoint point{-direction, hit.geometricNormal};
  if (crossing) {
    point.iorNear = crossing->iorBefore;
    point.iorFar = crossing->iorAfter;
  }
  mix_.emplace(std::span(terms_.data(), count), point);
}

}  // namespace aerosol::render
