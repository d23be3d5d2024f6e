#include "core/render/direct_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/render/medium_walk.h"
#include "core/render/prepared_scene.h"

namespace aerosol::render {

namespace {

/// Distances in a float ray are off by some of these parts of the coordinates involved.
constexpr float rayError = 8 * std::numeric_limits<float>::epsilon();

float largestCoordinate(Point<World> p) { return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}); }

/// The ray from a vertex to a light sample. It ends before the light's surface by what rounding of its direction can
/// move its end, more where it grazes the light: otherwise the light would shade itself now and then.
Ray<World> shadowRay(const ScatteringVertex& vertex, const LightSample& light, float time) {
  Ray<World> ray;
  ray.time = time;
  ray.direction = light.direction;
  ray.origin = vertex.originTowards(light.direction);
  if (!std::isfinite(light.distance)) return ray;
  const bool hasSurface = !(light.normal == Normal<World>());
  const Point<World> end = hasSurface ? accel::offsetPoint(light.point, light.normal, -light.direction) : light.point;
  const Vector<World> way = end - ray.origin;
  const float distance = length(way);
  ray.direction = normalize(way);
  ray.tMax = distance;
  if (hasSurface) {
    const float error = rayError * (distance + largestCoordinate(end));
    const float cosine = std::max(std::fabs(dot(ray.direction, light.normal)), 1e-4f);
    ray.tMax = std::max(0.5f * distance, distance - error / cosine);
  }
  return ray;
}

}  // namespace

volume::Task<Color> estimateDirectLight(PathContext& path, const ScatteringVertex& vertex, float time) {
  std::optional<PhaseScope> phase(std::in_place, path.statistics().accel.phase, Phase::lights);
  const LightSet& lights = path.scene().lights;
  LightUniforms uniforms;
  uniforms.place = path.random().next2D();
  uniforms.choice = path.random().next1D();
  const auto choice = lights.choose(vertex.position(), uniforms.choice);
  if (!choice) co_return Color();
  // The number that chose the light is used up; which part of it comes from a number of its own.
  uniforms.choice = path.random().nextHash();
  const std::optional<LightSample> light = lights[choice->index].sample(vertex.position(), uniforms);
  if (!light || isBlack(light->value)) co_return Color();

  const Color scattered = vertex.evaluate(light->direction) * light->value;
  if (isBlack(scattered)) co_return Color();
  const float pdf = light->pdf * choice->probability;
  const float weight = light->isDelta ? 1.0f : balance(pdf, vertex.pdf(light->direction));
  phase.reset();
  const Color transmittance =
      co_await estimateTransmittance(path, shadowRay(vertex, *light, time), vertex.mediumTowards(light->direction),
                                     vertex.mediaTowards(light->direction));
  co_return scattered* transmittance*(weight / pdf);
}

Color escapedLight(const PreparedScene& scene, Vector<World> direction, const DirectionRecord& record) {
  Color sum;
  for (const std::uint32_t index : scene.lights.infinite()) {
    const Color radiance = scene.lights[index].escaped(direction);
    if (isBlack(radiance)) continue;
    const float weight =
        record.isDelta ? 1.0f : balance(record.pdf, scene.lights.pdfEscaped(index, record.from, direction));
    sum += radiance * weight;
  }
  return sum;
}

Color metLight(const PreparedScene& scene, std::uint32_t light, const accel::SurfaceHit& hit, Vector<World> direction,
               const DirectionRecord& record) {
  const LightHit at{hit.point, hit.geometricNormal, direction};
  const Color radiance = scene.lights[light].emitted(at);
  if (isBlack(radiance)) return Color();
  return radiance * (record.isDelta ? 1.0f : balance(record.pdf, scene.lights.pdf(light, record.from, at)));
}

}  // namespace aerosol::render
