#include "core/render/nesting.h"

#include <algorithm>
#include <cmath>

#include "core/render/interior.h"
#include "core/render/prepared_scene.h"
#include "core/render/surface_closures.h"

namespace aerosol::render {

using volume::Interior;

namespace {

/// Faces behind a hit that a ray which goes on from there, a little off the surface, may miss.
double coincidence(const accel::SurfaceHit& hit, Vector<World> direction) {
  const float largest = std::max({std::fabs(hit.point.x), std::fabs(hit.point.y), std::fabs(hit.point.z)});
  const float cosine = std::fabs(dot(direction, hit.geometricNormal));
  return static_cast<double>(largest) * 0x1p-21 / static_cast<double>(std::max(cosine, 1e-3f));
}

/// Whether there is no interface between two interiors: they are one, or merge.
bool areOne(const Interior* a, const Interior* b) {
  if (!a || !b) return a == b;
  return a->object == b->object || (a->priority && a->priority == b->priority && a->ior == b->ior);
}

bool isStronger(const PreparedScene& scene, const Interior& a, const Interior& b) {
  if (!a.priority || !b.priority) return a.priority.has_value();
  return scene.priorityOrder == volume::PriorityOrder::higherWins ? *a.priority > *b.priority
                                                                  : *a.priority < *b.priority;
}

/// The face whose closures hold between two media.
const PathContext::Face& interfaceFace(const PathContext& path, const Interior* before, const Interior* after) {
  const PathContext::Face* best = nullptr;
  for (const PathContext::Face& face : path.faces) {
    const std::uint32_t object = face.hit.object;
    const bool rules = (before && before->object == object) || (after && after->object == object);
    if (face.hit.passThrough || !rules) continue;
    if (!best || isStronger(path.scene(), face.interior, best->interior)) best = &face;
  }
  return best ? *best : path.faces.front();
}

/// Ends the ray behind what coincides with a face; gives where that is.
double limitToCompany(Ray<World>& ray, const accel::SurfaceHit& face) {
  const double reach = face.t + coincidence(face, ray.direction);
  ray.tMax = std::nextafter(static_cast<float>(reach), std::numeric_limits<float>::infinity());
  return reach;
}

/// Finds the faces that coincide with the first one; what ends the row is `below`.
volume::Task<bool> findCompany(PathContext& path, Ray<World> ray, Nesting& nesting) {
  const PreparedScene& scene = path.scene();
  const double reach = limitToCompany(ray, *nesting.face);
  for (;;) {
    const auto hit =
        scene.geometry->closestHit(ray, path.spans, path.statistics().accel, &nesting.last, path.rayTypes());
    if (!hit || hit->t > reach) co_return path.faces.size() > 1;
    std::optional<Interior> interior;
    if (scene.objects[hit->object].isBoundary) {
      interior = boundaryInterior(scene, hit->object);
    } else {
      const shading::ShadingPoint point = shadingPointOf(path, *hit, ray);
      interior = interiorOf(scene, hit->object, co_await path.shade(scene.objects[hit->object].material, point));
    }
    if (!interior) {
      nesting.below = *hit;
      co_return path.faces.size() > 1;
    }
    nesting.last = hit->key();
    path.faces.push_back({*hit, *interior});
  }
}

}  // namespace

std::optional<Interior> boundaryInterior(const PreparedScene& scene, std::uint32_t object) {
  const PreparedObject& prepared = scene.objects[object];
  if (!prepared.separatesMedia()) return {};
  Interior interior;
  interior.object = object;
  interior.scene = prepared.interior;
  interior.priority = prepared.priority;
  interior.clipsVolumes = prepared.clipsVolumes;
  return interior;
}

bool liesBehindFace(PathContext& path, Ray<World> ray, const LightSample& light) {
  const PreparedScene& scene = path.scene();
  if (!scene.lightsMeetFaces || light.normal == Normal<World>() || !std::isfinite(light.distance)) return false;
  const float end = length(light.point - ray.origin);
  ray.tMin = ray.tMax;
  ray.tMax = end + std::max(end - ray.tMin, 0.0f);
  const auto hit = scene.geometry->closestHit(ray, path.spans, path.statistics().accel);
  return hit && hit->hasCompany && scene.objects[hit->object].saysInside && !scene.objects[hit->object].light;
}

volume::Task<Nesting> findNesting(PathContext& path, Ray<World> ray, accel::SurfaceHit hit) {
  const PreparedScene& scene = path.scene();
  Nesting nesting;
  path.statistics().work.add(Work::nesting);
  nesting.face = hit;
  nesting.last = hit.key();
  const shading::ShadingPoint point = shadingPointOf(path, hit, ray);
  const auto interior = interiorOf(scene, hit.object, co_await path.shade(scene.objects[hit.object].material, point));
  if (!interior) co_return nesting;
  nesting.isInterface = true;
  path.faces.clear();
  path.faces.push_back({hit, *interior});
  path.mediaBehind = path.media;
  if (!hit.hasCompany || !co_await findCompany(path, ray, nesting)) {
    nesting.crossing = path.media.judge(*interior, hit.entering);
    path.mediaBehind.cross(*interior, hit.entering, nesting.crossed);
    // The answer of what is below has taken the place of the face's.
    if (nesting.below && nesting.crossing.isHit) co_await path.shade(scene.objects[hit.object].material, point);
    if (nesting.crossing.mediumAfter) nesting.crossing.mediumAfter = path.mediaBehind.medium();
    co_return nesting;
  }
  bool hasFree = false;
  for (const PathContext::Face& face : path.faces) {
    path.mediaBehind.cross(face.interior, face.hit.entering, nesting.crossed);
    hasFree = hasFree || (!face.interior.priority && !face.hit.passThrough);
  }
  nesting.crossed.coincidentFaces += path.faces.size() - 1;
  const Interior* const before = path.media.ruling();
  const Interior* const after = path.mediaBehind.ruling();
  nesting.crossing = {.isHit = hasFree || !areOne(before, after),
                      .iorBefore = path.media.ior(),
                      .iorAfter = path.mediaBehind.ior(),
                      .hasIndices = (before && before->saysIndex) || (after && after->saysIndex) || before == after,
                      .mediumAfter = path.mediaBehind.medium()};
  if (!nesting.crossing.isHit) co_return nesting;
  nesting.face = interfaceFace(path, before, after).hit;
  const shading::ShadingPoint chosen = shadingPointOf(path, *nesting.face, ray);
  co_await path.shade(scene.objects[nesting.face->object].material, chosen);
  co_return nesting;
}

std::optional<accel::SurfaceHit> findBelow(PathContext& path, Ray<World> ray, const accel::SurfaceHit& face) {
  if (!face.hasCompany) return {};
  const double reach = limitToCompany(ray, face);
  const accel::HitKey key = face.key();
  auto hit = path.scene().geometry->closestHit(ray, path.spans, path.statistics().accel, &key, path.rayTypes());
  if (hit && (hit->t > reach || hit->object == face.object)) hit.reset();
  return hit;
}

void crossNesting(PathContext& path, const Nesting& nesting) {
  path.media = path.mediaBehind;
  path.statistics().media += nesting.crossed;
}

}  // namespace aerosol::render
