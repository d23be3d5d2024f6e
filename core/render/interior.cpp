#include "core/render/interior.h"

#include <algorithm>

#include "core/render/medium_preparation.h"
#include "core/render/nesting.h"
#include "core/render/surface_closures.h"

namespace aerosol::render {

using volume::Interior;

std::optional<Interior> interiorOf(const PreparedScene& scene, std::uint32_t object, const SurfaceAnswer& answer) {
  const PreparedObject& prepared = scene.objects[object];
  Interior interior;
  interior.object = object;
  volume::Coefficients sum;
  bool isDescribed = false;
  for (std::uint32_t i = 0; i < answer.siteCount(); ++i) {
    const Closure* closure = prepared.closures[i];
    const SurfaceAnswer::Site& site = answer.sites[i];
    if (!closure || closure->kind() != ClosureKind::interior || isBlack(site.weight)) continue;
    const InteriorMatter matter = closure->interior(site.parameters);
    const Color sigmaT = site.weight * matter.sigmaT, sigmaS = site.weight * matter.sigmaS;
    if (!isFinite(sigmaT) || !isFinite(sigmaS)) continue;
    if (matter.ior && !interior.saysIndex) {
      interior.ior = *matter.ior;
      interior.saysIndex = true;
    }
    if (!isDescribed && matter.priority != 0) interior.priority = matter.priority;
    isDescribed = true;
    sum.sigmaT += sigmaT;
    sum.sigmaS += sigmaS;
    if (!isBlack(sigmaS) && sum.lobeCount < sum.lobes.size()) {
      sum.lobes[sum.lobeCount++] = {sigmaS, std::clamp(matter.anisotropy, -1.0f, 1.0f)};
    }
  }
  if (!isDescribed && !prepared.separatesMedia()) return {};
  if (!isDescribed) interior.priority = prepared.priority;
  interior.clipsVolumes = prepared.clipsVolumes;
  interior.scene = prepared.interior;
  if (!interior.scene && !isBlack(sum.sigmaT)) {
    volume::Medium medium;
    medium.method = volume::DistanceMethod::closedForm;
    medium.transmittance = volume::TransmittanceMethod::closedForm;
    medium.constant = sum;
    medium.mayScatter = !isBlack(sum.sigmaS);
    medium.mayEmit = !isBlack(sum.emission);
    interior.own = medium;
  }
  return interior;
}

void turnDownwards(std::vector<accel::SurfaceHit>& hits) {
  std::ranges::reverse(hits);
  for (std::size_t first = 0, end = 0; first < hits.size(); first = end) {
    for (end = first + 1; end < hits.size() && hits[end].hasCompany;) ++end;
    std::reverse(hits.begin() + static_cast<std::ptrdiff_t>(first), hits.begin() + static_cast<std::ptrdiff_t>(end));
  }
}

volume::MediumStack findMedia(const PreparedScene& scene, Point<World> point, float time) {
  volume::MediumStack stack(scene.priorityOrder);
  Ray<World> up;
  up.origin = point;
  up.direction = {0, 1, 0};
  up.time = time;
  accel::SpanBuffer spans;
  accel::Counters counters;
  std::vector<accel::SurfaceHit> hits;
  std::optional<accel::HitKey> last;
  while (const auto hit = scene.geometry->closestHit(up, spans, counters, last ? &*last : nullptr)) {
    hits.push_back(*hit);
    last = hit->key();
  }
  turnDownwards(hits);
  volume::StackStatistics ignored;
  std::ranges::for_each(hits, [&](const accel::SurfaceHit& hit) {
    Ray<World> down = up;
    down.direction = {0, -1, 0};
    if (scene.objects[hit.object].isBoundary) {
      if (const auto interior = boundaryInterior(scene, hit.object)) stack.cross(*interior, !hit.entering, ignored);
      return;
    }
    const SurfaceAnswer answer =
        askSurface(scene, scene.objects[hit.object].material, shadingPointOf(scene, hit, down));
    if (const auto interior = interiorOf(scene, hit.object, answer)) stack.cross(*interior, !hit.entering, ignored);
  });
  return stack;
}

}  // namespace aerosol::render
