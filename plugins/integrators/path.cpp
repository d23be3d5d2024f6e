// Path tracing through surfaces and media with next-event estimation and multiple importance sampling.
//
// Kulla 2019, "Path Tracing in Production – Volumes": the ray is cut into segments; a distance is sampled; closer than
// the surface the path scatters in the medium with weight σs T / pdf, otherwise it goes on at the surface with weight T
// / P.

#include "core/render/aov/first_seen.h"
#include "core/render/contribution_map.h"
#include "core/render/direct_light.h"
#include "core/render/interior.h"
#include "core/render/lights_along_ray.h"
#include "core/render/media_probe.h"
#include "core/render/medium_walk.h"
#include "core/render/nesting.h"
#include "core/render/path_state.h"
#include "core/render/prepared_scene.h"
#include "core/render/registry.h"
#include "core/render/subsurface_walk.h"
#include "core/render/surface_closures.h"

namespace aerosol::render {

namespace {

using volume::DistanceEvent;
using volume::Medium;
using volume::Task;

/// Every vertex has its own slots of the sample stream, whatever was drawn before: samples of a pixel stay stratified
/// against each other vertex by vertex. Slots before are the camera's.
constexpr std::uint32_t cameraSlots = 2;
constexpr std::uint32_t raySlots = 2 + distanceSlots;
constexpr std::uint32_t vertexSlots = 4;

/// Of the ray that is the path's segment number `length`.
void beginRay(PathContext& path, int length) {
  path.random().skipTo(cameraSlots + (raySlots + vertexSlots) * static_cast<std::uint32_t>(length - 1));
}
/// Of the vertex at its end.
void beginVertex(PathContext& path, int length) {
  path.random().skipTo(cameraSlots + (raySlots + vertexSlots) * static_cast<std::uint32_t>(length - 1) + raySlots);
}

/// What a ray is that leaves a surface, as shaders call it.
std::uint32_t rayTypeAfter(const ClosureSample& sample, bool crosses, std::uint32_t before) {
  if (sample.isPassing) return before;
  if (!sample.isDelta) return shading::ray::diffuse;
  return crosses ? shading::ray::refraction : shading::ray::reflection;
}

/// Distance from the camera of a point on the path's first stretch.
float seenDistance(const PathState& state, Point<World> point) {
  return state.wayBefore + length(point - state.ray.origin);
}

/// What the scene's limit leaves of light that ends the path, `more` scatterings from where its ray begins.
Color limited(PathContext& path, const PathState& state, Color light, int more) {
  const PathSettings& settings = path.scene().path;
  if (!settings.clampsIndirect || state.scatterings + more < 2) return light;
  const float value = maximum(abs(state.throughput * light));
  if (!(value > settings.clampIndirect)) return light;
  path.statistics().work.add(Work::clamping);
  return light * (settings.clampIndirect / value);
}

/// `worth` is the part of the weight that roulette is to see.
void continueFrom(PathState& state, Point<World> origin, Vector<World> direction, Color weight, Color worth) {
  state.worth = state.throughput * worth;
  state.throughput *= weight;
  state.ray.origin = origin;
  state.ray.direction = direction;
  state.ray.tMin = 0;
  state.ray.tMax = std::numeric_limits<float>::infinity();
  ++state.length;
  ++state.scatterings;
}

/// The lights beside the path's ray between t0 and t1. They stay where they are as long as the direction is followed
/// that is chosen on this ray.
const LightsAlongRay& lightsAlongRay(const PathContext& path, PathState& state, double t0, double t1) {
  const PreparedScene& scene = path.scene();
  if (scene.lights.placed().empty() || path.segments.isEmpty()) return LightsAlongRay::none();
  const bool mayScatter = hasOptionalEffects && state.length != scene.path.maxDepth;
  const LightChoice choice = mayScatter ? scene.lightChoice : LightChoice::none;
  const LightSet& lights = scene.lightsOf(commonLinks(path, state.boundaryMedium));
  const auto& before = state.direction.place;
  const bool isFirstUsed = before && state.lights[0] && before->lights == &*state.lights[0];
  return state.lights[isFirstUsed ? 1 : 0].emplace(
      lights, state.ray, scatteringStretches(path, t0, t1, state.boundaryMedium), choice, state.splitThreshold);
}

/// Clusters of lights are split at the ray's end where they matter to the picture: less so, the less of the light there
/// comes through. By what holds before anything is drawn for the ray, so that all densities agree about it.
float splitThreshold(const PreparedScene& scene, Color throughput) {
  if (!scene.splitsLights) return neverSplit;
  return scene.path.splitThreshold / std::max(maximum(abs(throughput)), 1e-6f);
}

/// Lights are tabulated on the ray's way.
void beginTable(PathContext& path, const LightsAlongRay& lights, volume::GivenDistance& given) {
  path.lightColumns = lights.columns();
  path.tabulated = {};
  path.tabulated.columns = &path.lightColumns;
  path.tabulated.u = path.random().next2D();
  given.t = std::numeric_limits<double>::infinity();
  given.lights = &path.tabulated;
}

/// At the end of the way: the place that the tables gave, and what they say of the tracker's.
std::optional<LightsAlongRay::Choice> chooseFromTable(PathContext& path, const LightsAlongRay& lights,
                                                      volume::GivenDistance& given, volume::DistanceSample& event) {
  const volume::TabulatedLight& table = *given.lights;
  path.statistics().work.add(Work::tabulatedLight);
  event.lightScale = table.mass > 0 ? event.lightScale / table.mass : 0;
  given.sample = table.found;
  given.sample.lightScale = table.mass > 0 ? table.scale / table.mass : 0;
  return lights.choose(table, path.random().nextHash());
}

/// Light that reaches the ray at a place chosen for it.
Task<Color> lightAlongRay(PathContext& path, const PathState& state, const LightsAlongRay& lights,
                          const LightsAlongRay::Choice& choice, const volume::DistanceSample& found) {
  if (found.event != DistanceEvent::scattered || found.medium->isHoldout) co_return Color();
  const PlaceOnRay place{&lights, found.t, found.choicePdf, found.lightScale};
  const MediumVertex vertex(path.scene(), *found.medium, state.ray, place, found.anisotropy, state.boundaryMedium,
                            path.media);
  const Color estimate = co_await estimateChosenLight(path, vertex, choice, state.ray.time, state.splitThreshold);
  const Color light = limited(path, state, found.weight * estimate, 1);
  if (path.record) {
    path.record->addSampled(light, inMedium);
    path.record->addInFront(seenDistance(state, vertex.position()), state.throughput * light);
  }
  path.setRay(state.ray);
  path.setRayTypes(state.rayTypes);
  co_return light;
}

/// The same for all choices but the first, where clusters of many lights are split: each finds its place on a way of
/// its own. The volumes along the ray are those of its query.
Task<Color> lightByFurtherChoices(PathContext& path, const PathState& state, const LightsAlongRay& lights,
                                  std::array<float, 2> u, double begin, double end) {
  struct Found {
    LightsAlongRay::Choice choice;
    volume::DistanceSample sample;
  };
  std::array<Found, LightCut::most> found;
  std::size_t count = 0;
  path.statistics().work.add(Work::lightSplitting);
  for (std::size_t i = 1; i < lights.count(); ++i) {
    const auto choice = lights.choose(u, i);
    if (!choice) continue;
    path.statistics().work.add(Work::chosenDistance);
    volume::GivenDistance given{.t = choice->t};
    findSegments(path, state.ray, begin, end, state.boundaryMedium, path.media, state.direction.links);
    co_await sampleDistance(path, state.ray, state.throughput, &given, DistanceNumbers::hashed, false);
    found[count++] = {*choice, given.sample};
  }
  Color sum;
  for (std::size_t i = 0; i < count; ++i) {
    sum += co_await lightAlongRay(path, state, lights, found[i].choice, found[i].sample);
  }
  co_return sum;
}

/// Goes on in a direction of the vertex's own choice; `seen` is the path's footprint there.
void leaveMedium(PathContext& path, PathState& state, const MediumVertex& vertex, const RayFootprint& seen,
                 std::array<float, 2> u) {
  if (vertex.followsLamps()) path.statistics().work.add(Work::lampDirection);
  const volume::PhaseSample next = vertex.sample(u);
  if (path.record) path.record->scatter(inMedium, Color(next.weight));
  state.direction = {vertex.position(), next.pdf, next.isDelta, vertex.place(), vertex.links(), state.splitThreshold};
  state.rayTypes = shading::ray::diffuse;
  state.lightsReach = true;
  if (path.keepsFootprints()) {
    path.setFootprint(footprintScattered(seen, vertex.position(), next.direction, next.pdf, next.isDelta));
  }
  continueFrom(state, vertex.position(), next.direction, Color(next.weight), Color(1.0f));
}

/// Where a path would bring much more than its pixel shows it goes on in several directions, all but one of them later.
/// Each has its part of the throughput.
void splitPath(PathContext& path, PathState& state, const MediumVertex& vertex, PathBranches& later) {
  const ContributionMap& contributions = path.scene().contributions;
  if (!hasOptionalEffects || contributions.isEmpty()) return;
  const int count = contributions.branches(vertex.position(), state.throughput, path.id().x, path.id().y);
  if (count < 2 || !later.hasRoom()) return;
  path.statistics().work.add(Work::contribution);
  path.statistics().pathVertices += static_cast<std::uint64_t>(count) - 1;
  const float part = 1 / static_cast<float>(count);
  state.throughput *= part;
  if (path.record) path.record->weaken(Color(part));
  const RayFootprint seen = path.footprint();
  for (int i = 1; i < count; ++i) {
    PathBranch& branch = later.begin(path, state, i);
    leaveMedium(path, branch.state, vertex, seen, branch.random.next2D());
    later.finish(path, state, seen);
  }
}

/// Scatters in a medium. False when the path ends.
Task<bool> scatterInMedium(PathContext& path, PathState& state, Radiance& radiance, const LightsAlongRay& lights,
                           const volume::DistanceSample& event, PathBranches& later) {
  const PreparedScene& scene = path.scene();
  const PlaceOnRay place{&lights, event.t, event.choicePdf, event.lightScale};
  const MediumVertex vertex(scene, *event.medium, state.ray, place, event.anisotropy, state.boundaryMedium, path.media);
  if (path.record) {
    const float distance = seenDistance(state, vertex.position());
    co_await seeMedium(path, *event.medium, vertex.position(), distance, state.throughput);
  }
  if (state.length == scene.path.maxDepth) co_return false;
  path.statistics().work.add(Work::mediumScattering);
  beginVertex(path, state.length);
  for (DirectLight lit(path, vertex, state.ray.time, state.splitThreshold); lit.next();) {
    const Color light = limited(path, state, co_await estimateDirectLight(path, lit), 1);
    radiance.color += state.throughput * light;
    if (path.record) path.record->addSampled(light, inMedium);
  }
  splitPath(path, state, vertex, later);
  leaveMedium(path, state, vertex, path.footprint(), path.random().next2D());
  co_return true;
}

/// The medium around the path when media nest.
const Medium* ruler(const PathContext& path, const Medium* outside) {
  return path.media.empty() ? outside : path.media.medium();
}

/// Goes through a surface that only bounds media.
void crossBoundary(PathContext& path, PathState& state, const accel::SurfaceHit& hit) {
  path.statistics().work.add(Work::mediumBoundary);
  const PreparedObject& object = path.scene().objects[hit.object];
  if (!path.scene().nestsMedia) {
    state.boundaryMedium = object.behind(hit.entering, state.boundaryMedium);
    return;
  }
  const auto interior = boundaryInterior(path.scene(), hit.object);
  if (!interior) return;
  path.statistics().work.add(Work::nesting);
  path.media.cross(*interior, hit.entering, path.statistics().media);
  state.boundaryMedium = ruler(path, object.exterior);
}

enum class Step : unsigned char { ends, scatters, passes };

/// The ray goes on behind faces that were crossed.
void goBehind(PathContext& path, PathState& state, const Nesting& nesting) {
  crossNesting(path, nesting);
  state.boundaryMedium = ruler(path, path.scene().objects[nesting.face->object].exterior);
}

/// A surface that coincides with what was crossed is met by the ray behind it, where that still runs into it.
void meetNext(PathState& state, const Nesting& nesting, Vector<World> before) {
  if (!nesting.below) return;
  accel::SurfaceHit hit = *nesting.below;
  if (dot(before, hit.geometricNormal) * dot(state.ray.direction, hit.geometricNormal) <= 0) return;
  hit.t = 0;
  state.touching = hit;
}

/// Whether light from this direction arrives on the side that the ray came from.
bool reflects(const accel::SurfaceHit& hit, Vector<World> direction) {
  return (dot(direction, hit.geometricNormal) > 0) == hit.entering;
}

/// All the way through a body is one event.
constexpr ScatterShare outOfBody[] = {{PathEvent::reflectDiffuse, Color(1.0f)}};

/// Light that entered a body and leaves it elsewhere, into the medium that it came from.
Task<Step> leaveBody(PathContext& path, PathState& state, Radiance& radiance, const BodyEntry& entry,
                     const ClosureSample& next) {
  const PreparedScene& scene = path.scene();
  ++path.statistics().bodyEntries;
  const auto way = walkThroughBody(*scene.geometry, entry, path.random(), path.statistics().accel);
  if (!way) co_return Step::ends;
  state.throughput *= next.weight * way->weight;
  if (path.record) path.record->weaken(next.weight * way->weight);
  const BodyExit exit(entry.body, way->hit);
  const SurfaceVertex::Side outside{state.boundaryMedium, path.media};
  const SurfaceVertex vertex(way->hit, exit.mix(), outside, outside);
  // The numbers with which lights were sampled where it entered serve again: no product has both.
  beginVertex(path, state.length);
  for (DirectLight lit(path, vertex, state.ray.time, neverSplit); lit.next();) {
    const Color light = limited(path, state, co_await estimateDirectLight(path, lit), 1);
    radiance.color += state.throughput * light;
    if (path.record && !isBlack(light)) path.record->addSampled(light, outOfBody);
  }
  const std::optional<ClosureSample> leaving =
      exit.mix().sample({.choice = 0, .place = {path.random().nextHash(), path.random().nextHash()}});
  if (!leaving) co_return Step::ends;
  if (path.record) {
    path.record->scatter(outOfBody, leaving->weight);
    state.wayBefore = seenDistance(state, entry.hit.point);
  }
  state.rayTypes = shading::ray::diffuse;
  state.lightsReach = true;
  state.direction = {.from = way->hit.point, .pdf = leaving->pdf, .isDelta = false};
  if (path.keepsFootprints()) {
    const RayFootprint& before = path.footprint();
    path.setFootprint(footprintScattered(before, way->hit.point, leaving->direction, leaving->pdf, false));
  }
  continueFrom(state, way->hit.originTowards(leaving->direction), leaving->direction, leaving->weight, leaving->weight);
  co_return Step::scatters;
}

/// Whether something that only shadow rays meet stands before a light: it takes away what lights sampled there would
/// have given, and as much from what the path finds by itself.
bool isShaded(PathContext& path, const PathState& state, double end) {
  if (!path.scene().hidesSurfaces || state.direction.isDelta) return false;
  Ray<World> ray = state.ray;
  ray.tMax = static_cast<float>(end * (1 - 1e-5));
  return path.scene().geometry->occluded(ray, path.spans, path.interfaces, path.statistics().accel) ||
         meetsWhatPassesPoints(path);
}

/// Emission and scattering at an opaque surface, unless a medium of higher priority hides it. `passed` becomes what was
/// gone through when the ray passes.
Task<Step> meetSurface(PathContext& path, PathState& state, Radiance& radiance, accel::SurfaceHit hit,
                       std::optional<accel::HitKey>& passed) {
  const PreparedScene& scene = path.scene();
  Nesting nesting;
  const shading::ShadingPoint point = shadingPointOf(path, hit, state.ray);
  if (scene.nestsMedia) {
    nesting = co_await findNesting(path, state.ray, hit);
    hit = *nesting.face;
  } else {
    co_await path.shade(scene.objects[hit.object].material, point);
  }
  const PreparedObject& object = scene.objects[hit.object];
  if (object.body) nesting.crossing = object.crossBody(hit.entering);
  const SurfaceAnswer& answer = path.surfaceAnswer();
  if (nesting.isInterface && !nesting.crossing.isHit) {
    goBehind(path, state, nesting);
    passed = nesting.last;
    co_return Step::passes;
  }
  const SurfaceClosures closures(object, answer, hit, state.ray.direction,
                                 nesting.isInterface || object.body ? &nesting.crossing : nullptr);
  if (path.record && !closures.mix().isPassing())
    seeSurface(path, closures.mix(), hit, seenDistance(state, hit.point), state.throughput);
  radiance.alpha = std::max(radiance.alpha, 1 - std::clamp(average(closures.mix().holdout()), 0.0f, 1.0f));
  const bool isHidden = scene.path.hideEmitters && state.rayTypes == shading::ray::camera;
  if (object.light && !isHidden && !isShaded(path, state, hit.t)) {
    Color emitted = metLight(scene, *object.light, hit, state.ray, state.direction);
    if (scene.isTextured(*object.light)) {
      const shading::ShadingPoint met = shadingPointOf(path, hit, state.ray);
      emitted *= co_await lightTexture(path, *object.light, met);
    }
    emitted = limited(path, state, emitted, 0);
    radiance.color += state.throughput * emitted;
    if (path.record) path.record->addFromLight(emitted, *object.light);
    ++path.statistics().lightSamples[*object.light];
  }
  if (const auto invalid = closures.invalidSite()) [[unlikely]] {
    ++path.statistics().invalidClosures;
    scene.messages->reportInvalidSurface(hit.object, *invalid, hit.point, path.id());
  }
  const Color glow = limited(path, state, closures.mix().emitted(), 0);
  radiance.color += state.throughput * glow;
  if (path.record) path.record->addFromObject(glow, hit.object);
  if (state.length == scene.path.maxDepth) co_return Step::ends;

  beginVertex(path, state.length);
  const Medium* behind = state.boundaryMedium;
  if (nesting.isInterface) {
    behind = nesting.crossing.mediumAfter;
  } else if (!scene.nestsMedia) {
    behind = object.behind(hit.entering, state.boundaryMedium);
  }
  const bool lightsPassed = state.lightsReach && object.passesShadows;
  const SurfaceVertex vertex(hit, closures.mix(), {state.boundaryMedium, path.media},
                             {behind, nesting.isInterface ? path.mediaBehind : path.media}, lightsPassed,
                             scene.linksOf(object));
  for (DirectLight lit(path, vertex, state.ray.time, state.splitThreshold); lit.next();) {
    const Color light = limited(path, state, co_await estimateDirectLight(path, lit), 1);
    radiance.color += state.throughput * light;
    if (!path.record || isBlack(light)) continue;
    const Vector<World> towards = path.record->litDirection();
    path.record->addSampled(light, ScatterShares(closures.mix(), towards, reflects(hit, towards)));
  }
  ClosureUniforms uniforms;
  uniforms.place = path.random().next2D();
  uniforms.choice = path.random().next1D();
  const std::optional<ClosureSample> next = closures.mix().sample(uniforms);
  if (!next) co_return Step::ends;
  if (scene.hasSubsurface && next->entersBody) {
    const BodyEntry entry{closures.mix().bodyOf(*next), hit, next->direction, state.ray.time};
    co_return co_await leaveBody(path, state, radiance, entry, *next);
  }
  const Vector<World> before = state.ray.direction;
  const bool crosses = dot(next->direction, hit.geometricNormal) * dot(before, hit.geometricNormal) > 0;
  if (path.record) {
    path.record->scatter(ScatterShares(closures.mix(), *next, !crosses), next->weight);
    state.wayBefore = seenDistance(state, hit.point);
  }
  state.rayTypes = rayTypeAfter(*next, crosses, state.rayTypes);
  // Light from behind such a surface came straight to where lights were sampled last; bent light is not to be added.
  const bool isReplaced = lightsPassed && crosses;
  state.lightsReach = !next->isDelta || isReplaced;
  const LinkedLights* const links = next->isPassing ? state.direction.links : vertex.links();
  state.direction = {.from = hit.point,
                     .pdf = next->pdf,
                     .isDelta = next->isDelta || isReplaced,
                     .links = links,
                     .splitThreshold = state.splitThreshold,
                     .isReplaced = isReplaced};
  if (path.keepsFootprints()) {
    path.setFootprint(
        footprintBehind(path.footprint(), *scene.geometry, hit, *next, state.ray.time, scene.largestFootprint));
  }
  if (crosses && object.body) nesting.below = findBelow(path, state.ray, hit);
  continueFrom(state, hit.originTowards(next->direction), next->direction, next->weight, next->weight);
  state.scatterings -= next->isPassing;
  if (crosses && nesting.isInterface) {
    goBehind(path, state, nesting);
    meetNext(state, nesting, before);
  } else if (crosses) {
    state.boundaryMedium = behind;
    meetNext(state, nesting, before);
  }
  co_return Step::scatters;
}

/// What pilots keep of a vertex.
[[gnu::noinline]] void noteVertex(PilotPath& pilot, const PathState& state, const Radiance& radiance) {
  pilot.vertices.push_back({state.ray.origin, average(abs(state.worth)), average(radiance.color)});
}

/// Russian roulette. False when the path ends. By throughput survival stays close to 1 where nothing is lost: in a
/// cloud of albedo 1 each chance to end would raise the weight of the survivors, bounce after bounce. The weight of a
/// direction out of a medium is left out until the next vertex: directions chosen towards lamps have small ones, and
/// bring more in exchange.
[[gnu::always_inline]] inline bool survivesRoulette(PathContext& path, PathState& state, const Radiance& radiance) {
  if (isBlack(state.throughput)) return false;
  const PreparedScene& scene = path.scene();
  if (path.pilot) noteVertex(*path.pilot, state, radiance);
  const bool isLong = state.length > scene.path.rrDepth;
  float survival = 1;
  if (hasOptionalEffects && !scene.contributions.isEmpty()) {
    path.statistics().work.add(Work::contribution);
    survival = scene.contributions.survival(state.ray.origin, state.worth, path.id().x, path.id().y);
    if (isLong) survival = std::min(survival, 0.999f);
  } else if (isLong) {
    survival = std::min(maximum(abs(state.worth)), 0.999f);
  }
  if (survival >= 1) return true;
  path.statistics().work.add(Work::roulette);
  if (!(path.random().nextHash() < survival)) return false;
  state.throughput = state.throughput / survival;
  if (path.record) path.record->weaken(Color(1 / survival));
  return true;
}

/// Of a ray that meets nothing: the path ends.
void addEscapedLight(PathContext& path, PathState& state, Radiance& radiance) {
  const PreparedScene& scene = path.scene();
  if (scene.lights.hasFound()) path.statistics().work.add(Work::foundLight);
  if (scene.path.clampsIndirect) {
    const Color light = escapedLight(scene, state.ray.direction, state.direction, nullptr);
    const Color left = limited(path, state, light, 0);
    const float part = isBlack(light) ? 1 : maximum(abs(left)) / maximum(abs(light));
    state.throughput *= part;
    if (path.record) path.record->weaken(Color(part));
  }
  radiance.color += state.throughput * escapedLight(scene, state.ray.direction, state.direction, path.record);
}

/// Follows a path to its end, but for the branches that are left for later.
Task<> followPath(PathContext& path, PathState& state, Radiance& radiance, PathBranches& later) {
  const PreparedScene& scene = path.scene();
  std::optional<accel::HitKey> passed;  // The boundary that this ray has just gone through.
  bool goesOn = true;
  while (goesOn) {
    std::optional<accel::SurfaceHit> hit = std::exchange(state.touching, {});
    const bool isTouching = hit.has_value();
    if (!isTouching) {
      hit = scene.geometry->closestHit(state.ray, path.spans, path.statistics().accel, passed ? &*passed : nullptr,
                                       state.rayTypes);
    }
    const double begin = isTouching ? 0 : passed ? passed->t : static_cast<double>(state.ray.tMin);
    const double end = hit ? hit->t : static_cast<double>(state.ray.tMax);
    path.setRay(state.ray);
    path.setRayTypes(state.rayTypes);
    path.setLength(state.length);
    findSegments(path, state.ray, begin, end, state.boundaryMedium, path.media, state.direction.links);
    state.splitThreshold = splitThreshold(scene, state.throughput);
    const LightsAlongRay& lights = lightsAlongRay(path, state, begin, end);
    beginRay(path, state.length);
    std::array<float, 2> u{};
    std::optional<LightsAlongRay::Choice> lit;
    std::optional<volume::GivenDistance> given;
    if (lights.chooses()) {
      u = path.random().next2D();
      lit = lights.choose(u);
      if (lit) given.emplace().t = lit->t;
    } else if (lights.isTabulated()) {
      beginTable(path, lights, given.emplace());
    }
    // Behind a boundary, or a face that was touched, the ray's own numbers are used up.
    const auto numbers = passed || isTouching ? DistanceNumbers::hashed : DistanceNumbers::stratified;
    volume::DistanceSample event;
    if (!path.segments.isEmpty()) {
      volume::GivenDistance* const wanted = given ? &*given : nullptr;
      event = scene.asksMedia || lights.isTabulated()
                  ? co_await sampleDistance(path, state.ray, state.throughput, wanted, numbers)
                  : sampleClosedForms(path, state.throughput, wanted, numbers);
    }
    if (given && given->lights) lit = chooseFromTable(path, lights, *given, event);
    path.statistics().raysIntoLights += lit && lit->isMet;
    if (lit && !given->lights) path.statistics().work.add(Work::chosenDistance);
    if (!isBlack(event.emission)) {
      path.statistics().work.add(Work::mediumEmission);
      // Lights are sampled up to the first surface, whatever it is.
      const float weight = passed ? 1.0f : metEmissionWeight(scene, state.ray.direction, state.direction);
      const Color glow = limited(path, state, event.emission * weight, 0);
      radiance.color += state.throughput * glow;
      if (path.record) {
        path.record->addFromMedia(glow);
        path.record->addInFront(state.throughput * glow);
      }
    }
    if (lights.count() > 1) {
      radiance.color += state.throughput * co_await lightByFurtherChoices(path, state, lights, u, begin, end);
    }
    if (lit) radiance.color += state.throughput * co_await lightAlongRay(path, state, lights, *lit, given->sample);
    state.throughput *= event.weight;
    if (path.record) path.record->weaken(event.weight);
    if (event.event == DistanceEvent::absorbed) break;

    if (event.event == DistanceEvent::scattered) {
      if (event.medium->isHoldout) {
        path.statistics().work.add(Work::holdout);
        break;
      }
      radiance.alpha = 1;
      passed.reset();
      goesOn = co_await scatterInMedium(path, state, radiance, lights, event, later) &&
               survivesRoulette(path, state, radiance);
    } else if (!hit) {
      // What lets the camera see straight through shows no environment either.
      const bool isHidden = scene.path.hideEmitters && state.rayTypes == shading::ray::camera;
      if (!isHidden && !isShaded(path, state, std::numeric_limits<double>::infinity())) {
        addEscapedLight(path, state, radiance);
      }
      if (!isHidden && !scene.lights.infinite().empty()) radiance.alpha = 1;
      goesOn = false;
    } else if (scene.objects[hit->object].isBoundary) {
      crossBoundary(path, state, *hit);
      passed = hit->key();
    } else {
      passed.reset();
      const Step step = co_await meetSurface(path, state, radiance, *hit, passed);
      goesOn = step == Step::passes || (step == Step::scatters && survivesRoulette(path, state, radiance));
    }
    path.statistics().pathVertices += goesOn;
    if (goesOn && state.length > 2) path.statistics().work.add(Work::laterScattering);
  }
}

Task<Radiance> tracePath(PathContext& path, Ray<World> cameraRay) {
  const PreparedScene& scene = path.scene();
  Radiance radiance;
  if (scene.nestsMedia) path.media = scene.initialMedia;
  if (scene.probesMedia) co_await probeMedia(path, cameraRay.at(cameraRay.tMin), cameraRay.time);
  PathState state{.ray = cameraRay,
                  .boundaryMedium = scene.nestsMedia ? ruler(path, scene.cameraMedium) : scene.cameraMedium};
  if (scene.path.maxDepth == 0) co_return radiance;
  PathBranches later;
  do {
    co_await followPath(path, state, radiance, later);
  } while (later.resumeLast(path, state));
  co_return radiance;
}

class PathIntegrator final : public Integrator {
 public:
  Task<Radiance> trace(PathContext& path, const Ray<World>& cameraRay) const override {
    return tracePath(path, cameraRay);
  }
};

}  // namespace

void registerIntegrator_path(Registry& registry) {
  registry.add(NamedIntegrator{.name = "path",
                               .doc = "Path tracing through surfaces and media with light sampling",
                               .integrator = std::make_shared<const PathIntegrator>()});
}

}  // namespace aerosol::render
