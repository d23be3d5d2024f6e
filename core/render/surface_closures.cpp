#include "core/render/surface_closures.h"

#include <algorithm>
#include <cmath>

namespace aerosol::render {

shading::ShadingPoint shadingPointOf(const PreparedScene& scene, const accel::SurfaceHit& hit, const Ray<World>& ray) {
  using lang::Global;
  const bool isTurned = scene.objects[hit.object].facesViewer && !hit.entering;
  shading::ShadingPoint point;
  point.set(Global::P, hit.point);
  point.set(Global::I, ray.direction);
  point.set(Global::N, isTurned ? -hit.shadingNormal : hit.shadingNormal);
  point.set(Global::Ng, isTurned ? -hit.geometricNormal : hit.geometricNormal);
  point.setTurned(isTurned);
  point.set(Global::u, hit.u);
  point.set(Global::v, hit.v);
  point.set(Global::dPdu, hit.dPdu);
  point.set(Global::dPdv, hit.dPdv);
  point.set(Global::time, ray.time);
  point.setPlace({hit.primitive, hit.b1, hit.b2});
  return point;
}

shading::ShadingPoint shadingPointOf(PathContext& path, const accel::SurfaceHit& hit, const Ray<World>& ray) {
  using lang::Global;
  const PreparedScene& scene = path.scene();
  shading::ShadingPoint point = shadingPointOf(scene, hit, ray);
  if (!path.keepsFootprints()) [[likely]]
    return point;
  path.statistics().work.add(Work::footprint);
  const SurfaceFootprint on = footprintOn(path.askedFootprint(), hit, scene.largestFootprint);
  point.set(Global::dPdx, on.position.x);
  point.set(Global::dPdy, on.position.y);
  point.set(Global::dIdx, on.direction.x);
  point.set(Global::dIdy, on.direction.y);
  point.set(Global::dudx, on.uv_x[0]);
  point.set(Global::dvdx, on.uv_x[1]);
  point.set(Global::dudy, on.uv_y[0]);
  point.set(Global::dvdy, on.uv_y[1]);
  // The normal of the footprint, and of what is displaced from it, has to lie on the side of N.
  const float side = dot(cross(on.position.x, on.position.y), hit.geometricNormal);
  point.set(Global::flipHandedness, (side < 0) != point.isTurned() ? 1.0f : 0.0f);
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

std::size_t parameterCount(const PreparedObject& object, std::size_t site) {
  const std::size_t layers = object.layers.empty() ? 0 : object.layers[site].size();
  return static_cast<std::size_t>(componentCount(object.closures[site]->fields())) + 3 * layers;
}

bool isSoundSite(const PreparedObject& object, std::size_t index, const SurfaceAnswer::Site& site) {
  const auto count = static_cast<std::ptrdiff_t>(parameterCount(object, index));
  return isFinite(site.weight) && std::all_of(site.parameters.begin(), site.parameters.begin() + count,
                                              [](float parameter) { return std::isfinite(parameter); });
}

}  // namespace

SurfaceClosures::SurfaceClosures(const PreparedObject& object, const SurfaceAnswer& answer,
                                 const accel::SurfaceHit& hit, Vector<World> direction,
                                 const volume::Crossing* crossing)
    : answer_(answer) {
  SmallArray<bool, SurfaceAnswer::usualSites> isSound(answer_.siteCount());
  for (std::uint32_t i = 0; i < answer_.siteCount(); ++i) {
    SurfaceAnswer::Site& site = answer_.sites[i];
    const bool isUsed = object.closures[i] && (!isBlack(site.weight) || !object.layers.empty());
    if (!isUsed || object.closures[i]->kind() == ClosureKind::interior) continue;
    isSound[i] = isSoundSite(object, i, site);
    const bool isTurned = object.facesViewer && !hit.entering;
    if (isSound[i])
      normalizeDirections(*object.closures[i], site.parameters, isTurned ? -hit.shadingNormal : hit.shadingNormal);
    if (!isSound[i] && !invalidSite_) invalidSite_ = i;
  }
  ClosurePoint point{-direction, hit.geometricNormal};
  if (crossing && crossing->hasIndices) {
    point.iorNear = crossing->iorBefore;
    point.iorFar = crossing->iorAfter;
  }
  terms_.resize(answer_.siteCount());
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < answer_.siteCount(); ++i) {
    if (!isSound[i] || isBlack(answer_.sites[i].weight)) continue;
    if (object.closures[i]->kind() == ClosureKind::shadowing) continue;
    const Color weight = object.layers.empty() ? answer_.sites[i].weight
                                               : weightBelow(object, i, {isSound.data(), isSound.size()}, point);
    if (isBlack(weight)) continue;
    WeightedClosure& term = terms_[count++];
    term = {object.closures[i], weight, answer_.sites[i].parameters};
    if (!object.labels.empty()) term.label = object.labels[i];
    if (object.layers.empty()) continue;
    for (const lang::ClosureLayer& layer : object.layers[i]) {
      if (!isSound[layer.top] || object.closures[layer.top]->kind() != ClosureKind::shadowing) continue;
      term.shadowing = object.closures[layer.top];
      term.shadowingParameters = answer_.sites[layer.top].parameters;
    }
  }
  mix_.emplace(std::span(terms_.data(), count), point);
}

/// The weight of a site that is seen through others: each lets pass what it does not scatter itself, 1 - w albedo
/// (OSL's layer: the albedo is that towards the viewer, so the sum gains no energy).
Color SurfaceClosures::weightBelow(const PreparedObject& object, std::uint32_t site, std::span<const bool> isSound,
                                   const ClosurePoint& point) const {
  Color weight = answer_.sites[site].weight;
  std::size_t at = static_cast<std::size_t>(componentCount(object.closures[site]->fields()));
  for (const lang::ClosureLayer& layer : object.layers[site]) {
    const auto& p = answer_.sites[site].parameters;
    const Color amount(p[at], p[at + 1], p[at + 2]);
    at += 3;
    if (!isSound[layer.top] || isBlack(amount)) continue;
    const Color hidden = amount * object.closures[layer.top]->albedo(answer_.sites[layer.top].parameters, point);
    for (int i = 0; i < 3; ++i) weight[i] *= std::clamp(1 - hidden[i], 0.0f, 1.0f);
  }
  return weight;
}

}  // namespace aerosol::render
