#include "core/render/direct_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/render/aov/path_record.h"
#include "core/render/medium_walk.h"
#include "core/render/nesting.h"
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

namespace {

/// Towards a medium that glows: what all media emit between the vertex and the first surface in that direction.
volume::Task<Color> estimateGlow(PathContext& path, const ScatteringVertex& vertex, LightId light,
                                 LightUniforms uniforms, float time) {
  const LightSet& lights = path.scene().lightsOf(vertex.links());
  const std::optional<LightSample> sample = lights.sample(light, vertex.position(), uniforms);
  if (!sample) co_return Color();
  const Color scattered = vertex.evaluate(sample->direction);
  if (isBlack(scattered)) co_return Color();
  const float density = lights.pdfVolumes(vertex.position(), sample->direction) + vertex.pdf(sample->direction);
  Ray<World> ray;
  ray.time = time;
  ray.direction = sample->direction;
  ray.origin = vertex.originTowards(sample->direction);
  const auto hit = path.scene().geometry->closestHit(ray, path.spans, path.statistics().accel);
  path.setRayBeside(ray);
  path.setRayTypes(shading::ray::diffuse);
  findSegments(path, ray, 0, hit ? hit->t : std::numeric_limits<double>::infinity(),
               vertex.mediumTowards(sample->direction), vertex.mediaTowards(sample->direction), vertex.links());
  const volume::DistanceSample way = co_await sampleDistance(path, ray, scattered);
  if (path.record) path.record->noteLight(light.light, sample->direction, false);
  co_return scattered* way.emission * (1 / density);
}

/// What the texture of a light multiplies its light by, at a sample of it; there is one.
volume::Task<Color> lightTextureAt(PathContext& path, std::uint32_t light, LightSample sample, float time) {
  shading::ShadingPoint point;
  point.set(lang::Global::P, sample.point);
  point.set(lang::Global::N, sample.normal);
  point.set(lang::Global::Ng, sample.normal);
  point.set(lang::Global::u, sample.u);
  point.set(lang::Global::v, sample.v);
  point.set(lang::Global::time, time);
  point.setPlace(sample.place);
  co_return co_await lightTexture(path, light, point);
}

}  // namespace

LampDirections MediumVertex::lampsAround(const PreparedScene& scene, const volume::Medium& medium) const {
  const float extinction = medium.constant ? average(medium.constant->sigmaT)
                           : medium.bound  ? 0.5f * medium.bound->value
                                           : 1 / medium.stepSize;
  return {scene.lampsInMedia, scene.lightsOf(links_), position_, extinction, phase_.meanCosine(parameters_)};
}

volume::PhaseSample MediumVertex::sampleMixture(std::array<float, 2> u) const {
  const float share = lamps_->share();
  volume::PhaseSample sample;
  if (u[0] < share) {
    sample.direction = lamps_->sample({u[0] / share, u[1]});
  } else {
    sample = phase_.sample(parameters_, before_, {std::min((u[0] - share) / (1 - share), 0x1.fffffep-1f), u[1]});
    if (sample.isDelta) {
      sample.weight /= 1 - share;
      return sample;
    }
  }
  sample.pdf = pdf(sample.direction);
  sample.weight = phase_.evaluate(parameters_, before_, sample.direction) / sample.pdf;
  return sample;
}

DirectLight::DirectLight(PathContext& path, const ScatteringVertex& vertex, float time, float splitThreshold)
    : vertex_(vertex), lights_(path.scene().lightsOf(vertex.links())), uniforms_{.time = time} {
  const PhaseScope phase(path.statistics().accel.phase, Phase::lights);
  uniforms_.place = path.random().next2D();
  picks_ = lights_.pick(vertex.position(), path.random().next1D(), splitThreshold);
  if (picks_.count > 1) path.statistics().work.add(Work::lightSplitting);
}

// What serves several clusters is turned by the golden ratio of two dimensions (Roberts 2018).
LightUniforms DirectLight::uniforms() const {
  constexpr std::array turns{0.7548777f, 0.5698403f};
  LightUniforms uniforms = uniforms_;
  for (std::size_t i = 0; next_ > 1 && i < turns.size(); ++i) {
    const float turned = uniforms.place[i] + turns[i] * static_cast<float>(next_ - 1);
    uniforms.place[i] = std::min(turned - std::floor(turned), 0x1.fffffep-1f);
  }
  return uniforms;
}

volume::Task<Color> estimateDirectLight(PathContext& path, const DirectLight& lit) {
  std::optional<PhaseScope> phase(std::in_place, path.statistics().accel.phase, Phase::lights);
  const ScatteringVertex& vertex = lit.vertex();
  const LightSet& lights = lit.lights();
  const auto choice = lit.choice();
  if (!choice) co_return Color();
  LightUniforms uniforms = lit.uniforms();
  const float time = uniforms.time;
  ++path.statistics().lightSamples[choice->index];
  if (choice->part != LightId::whole) path.statistics().work.add(Work::lightTree);
  if (path.scene().hasMovingLights && lights[choice->index].moves()) path.statistics().work.add(Work::movingLight);
  if (vertex.links()) path.statistics().work.add(Work::linkedLight);
  const Rivalry rivalry = vertex.rivalry(choice->id());
  if (rivalry.isEnough) co_return Color();
  // The number that chose the light is used up; which part of it comes from a number of its own.
  uniforms.choice = path.random().nextHash();
  if (lights.hasVolumes() && lights[choice->index].isVolume()) {
    phase.reset();
    co_return co_await estimateGlow(path, vertex, choice->id(), uniforms, time);
  }
  const std::optional<LightSample> light = lights.sample(choice->id(), vertex.position(), uniforms);
  if (!light || isBlack(light->value)) co_return Color();

  Color scattered = vertex.evaluate(light->direction) * light->value;
  if (isBlack(scattered)) co_return Color();
  phase.reset();
  if (path.scene().isTextured(choice->index)) {
    scattered *= co_await lightTextureAt(path, choice->index, *light, time);
    if (isBlack(scattered)) co_return Color();
  }
  const float pdf = light->pdf * choice->probability;
  const auto byPlace = static_cast<float>(rivalry.ratio * static_cast<double>(light->pdf));
  const Ray<World> ray = shadowRay(vertex, *light, time);
  if (path.scene().lightsMeetFaces && liesBehindFace(path, ray, *light)) co_return Color();
  const Color transmittance = co_await estimateTransmittance(path, ray, vertex.mediumTowards(light->direction),
                                                             vertex.mediaTowards(light->direction), light->isDelta);
  if (path.record) path.record->noteLight(choice->index, light->direction, path.wentStraight);
  // Behind a surface that bends light, what a path meets is not counted.
  const float byDirection = light->isDelta || path.wentStraight ? 0.0f : vertex.pdf(light->direction);
  const float correction = vertex.correction(choice->id(), light->distance);
  co_return scattered* transmittance*(balance(pdf, byDirection + byPlace) * correction / pdf);
}

// Three techniques give a pair of place and light direction: this one with density p(light, t) p(ω), the tracker with
// sampling of a light from its place, p(t) P(light) p(ω), or with the phase function's sampling, p(t) p(direction). The
// balance heuristic leaves one over the sum of all. Where the first one is enough by itself the second is left out: its
// density is 0, for all three.
volume::Task<Color> estimateChosenLight(PathContext& path, const MediumVertex& vertex,
                                        const LightsAlongRay::Choice& choice, float time, float splitThreshold) {
  const LightSet& lights = path.scene().lightsOf(vertex.links());
  if (!lights.contains(choice.light.light)) co_return Color();
  ++path.statistics().lightSamples[choice.light.light];
  LightUniforms uniforms{.time = time};
  uniforms.place = path.random().next2D();
  uniforms.choice = path.random().nextHash();
  const std::optional<LightSample> light = lights.sample(choice.light, vertex.position(), uniforms);
  if (!light || isBlack(light->value)) co_return Color();
  Color scattered = vertex.evaluate(light->direction) * light->value;
  if (isBlack(scattered)) co_return Color();
  if (path.scene().isTextured(choice.light.light)) {
    scattered *= co_await lightTextureAt(path, choice.light.light, *light, time);
    if (isBlack(scattered)) co_return Color();
  }

  const auto directionPdf = static_cast<double>(light->pdf);
  const Ray<World> ray = shadowRay(vertex, *light, time);
  if (path.scene().lightsMeetFaces && liesBehindFace(path, ray, *light)) co_return Color();
  const Color transmittance = co_await estimateTransmittance(path, ray, vertex.mediumTowards(light->direction),
                                                             vertex.mediaTowards(light->direction), light->isDelta);
  if (path.record) path.record->noteLight(choice.light.light, light->direction, path.wentStraight);
  const double byDirection =
      light->isDelta || path.wentStraight ? 0 : static_cast<double>(vertex.pdf(light->direction));
  const double fromPlace =
      vertex.rivalry(choice.light).isEnough
          ? 0
          : static_cast<double>(lights.probability(choice.light, vertex.position(), splitThreshold));
  const double byTracker = directionPdf * fromPlace + byDirection;
  const double density = choice.density * directionPdf + vertex.place().choicePdf * byTracker;
  const auto correction = static_cast<double>(vertex.correction(choice.light, light->distance));
  co_return scattered* transmittance* static_cast<float>(correction / density);
}

float metEmissionWeight(const PreparedScene& scene, Vector<World> direction, const DirectionRecord& record) {
  const LightSet& lights = scene.lightsOf(record.links);
  if (record.isDelta || !lights.hasVolumes()) return 1;
  return balance(record.pdf, lights.pdfVolumes(record.from, direction));
}

volume::Task<Color> lightTexture(PathContext& path, std::uint32_t light, const shading::ShadingPoint& point) {
  const std::optional<shading::InstanceRef>& texture = path.scene().lightTextures[light];
  if (!texture) co_return Color(1);
  path.statistics().work.add(Work::lightTexture);
  co_return lightTextureOf(co_await path.shade(*texture, point));
}

Color escapedLight(const PreparedScene& scene, Vector<World> direction, const DirectionRecord& record,
                   PathRecord* aovs) {
  if (record.isReplaced) return {};
  const LightSet& lights = scene.lightsOf(record.links);
  Color sum;
  for (const std::uint32_t index : lights.infinite()) {
    const Light::Escaped light = record.isDelta ? Light::Escaped{lights[index].escaped(direction)}
                                                : lights.escapedWithPdf(index, record.from, direction);
    if (isBlack(light.radiance)) continue;
    const float weight = record.isDelta ? 1.0f : balance(record.pdf, light.pdf);
    sum += light.radiance * weight;
    if (aovs) aovs->addFromLight(light.radiance * weight, index);
  }
  return sum;
}

Color metLight(const PreparedScene& scene, std::uint32_t light, const accel::SurfaceHit& hit, const Ray<World>& ray,
               const DirectionRecord& record) {
  const LightSet& lights = scene.lightsOf(record.links);
  if (record.isReplaced || !lights.contains(light)) return Color();
  const LightHit at{hit.point, hit.geometricNormal, ray.direction, hit.primitive, ray.time};
  const Color radiance = lights[light].emitted(at);
  if (isBlack(radiance)) return Color();
  if (record.isDelta) return radiance;
  const LightId id = lights.idOf(light, at);
  const Rivalry rivalry = record.place ? record.place->rivalry(id) : Rivalry();
  const double byPoint =
      rivalry.isEnough ? 0 : static_cast<double>(lights.probability(id, record.from, record.splitThreshold));
  const auto others =
      static_cast<float>((byPoint + rivalry.ratio) * static_cast<double>(lights.pdf(id, record.from, at)));
  return radiance * balance(record.pdf, others);
}

}  // namespace aerosol::render
