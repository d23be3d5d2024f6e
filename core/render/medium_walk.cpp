#include "core/render/medium_walk.h"

#include <algorithm>

#include "core/render/interior.h"
#include "core/render/nesting.h"
#include "core/render/prepared_scene.h"
#include "core/render/surface_closures.h"
#include "core/volume/trackers/analytic.h"
#include "core/volume/trackers/candidate_list.h"
#include "core/volume/trackers/homogeneous.h"
#include "core/volume/trackers/null_scattering.h"
#include "core/volume/trackers/ray_marching.h"
#include "core/volume/trackers/transmittance.h"

namespace aerosol::render {

using volume::DistanceEvent;
using volume::DistanceMethod;
using volume::DistanceSample;
using volume::Medium;
using volume::MediumSpan;
using volume::Segment;
using volume::Task;

namespace {

/// The ray that was traced last has no medium on its way: its spans are known at once.
bool meetsNothing(const PathContext& path, const Medium* boundaryMedium) {
  return !boundaryMedium && path.spans.empty() &&
         path.scene().geometry->overlapDesign() != accel::OverlapDesign::partition;
}

}  // namespace

void findSegments(PathContext& path, const Ray<World>& ray, double t0, double t1, const Medium* boundaryMedium,
                  const volume::MediumStack& media, const LinkedLights* links) {
  if (meetsNothing(path, boundaryMedium)) {
    path.segments.beginEmpty();
    return;
  }
  const PhaseScope phase(path.statistics().accel.phase, Phase::intervals);
  auto& boundary = path.mediumSpans.boundary();
  boundary.clear();
  if (links) boundaryMedium = links->seen(boundaryMedium);
  if (boundaryMedium && t0 < t1) boundary.push_back({t0, t1, boundaryMedium});
  if (path.scene().seesCoarse(path.length())) path.statistics().work.add(Work::coarseVoxels);
  path.mediumSpans.clipped().clear();
  if (path.scene().nestsMedia && media.clipsVolumes()) path.mediumSpans.clipped().push_back({t0, t1, nullptr});
  path.mediumSpans.begin(path.scene(), path.scene().volumesFor(path.rayTypes(), links, path.length()), ray, t0, t1,
                         path.spans, path.statistics().accel);
  path.segments.begin(path.mediumSpans);
}

namespace {

/// Null scattering serves a segment when every medium has a bound; one marching medium makes the whole segment march.
DistanceMethod methodOf(const Segment& segment) {
  if (!hasOptionalEffects) return DistanceMethod::closedForm;
  if (segment.media.size() == 1) return segment.media.front()->method;
  DistanceMethod method = DistanceMethod::closedForm;
  for (const Medium* medium : segment.media) {
    const DistanceMethod own = medium->method == DistanceMethod::analytic ? medium->besideOthers : medium->method;
    if (own == DistanceMethod::marching) return DistanceMethod::marching;
    if (own == DistanceMethod::nullScattering) method = DistanceMethod::nullScattering;
  }
  return method;
}

void countWork(WorkCounts& work, const Segment& segment, DistanceMethod method) {
  constexpr std::array works{Work::closedForm, Work::voxels, Work::marching, Work::nullScattering};
  static_assert(static_cast<int>(DistanceMethod::closedForm) == 0 && static_cast<int>(DistanceMethod::analytic) == 1 &&
                static_cast<int>(DistanceMethod::marching) == 2 &&
                static_cast<int>(DistanceMethod::nullScattering) == 3);
  work.add(works[static_cast<std::size_t>(method)]);
  if (segment.media.size() > 1) work.add(Work::overlap);
  const Medium& first = *segment.media.front();
  if (first.tree) work.add(Work::tree);
  if (!first.constant) return;
  const Color sigma = first.constant->sigmaT;
  if (sigma.r != sigma.g || sigma.g != sigma.b) work.add(Work::chromatic);
}

bool listsCandidates(const Segment& segment) {
  return std::ranges::any_of(segment.media,
                             [](const Medium* medium) { return medium->collisions == volume::Collisions::listed; });
}

float stepSizeOf(const Segment& segment) {
  float step = std::numeric_limits<float>::infinity();
  for (const Medium* medium : segment.media) step = std::min(step, medium->stepSize);
  return step;
}

/// Three numbers of the stratified stream, then hashes.
class DistanceSource {
 public:
  DistanceSource(SampleStream& stream, DistanceNumbers numbers) : hashes_(stream) {
    if (numbers == DistanceNumbers::hashed) return;
    const std::array<float, 2> pair = stream.next2D();
    first_ = {stream.next1D(), pair[0], pair[1]};
    left_ = 3;
  }
  float next() { return left_ > 0 ? first_[--left_] : hashes_.next(); }

 private:
  std::array<float, 3> first_{};  ///< Taken from its end.
  std::size_t left_ = 0;
  HashSource hashes_;
};

/// Constant media behind this optical depth are left to transmittance sampling.
constexpr double largestDepth = 8;

/// Length at which the least extinct channel of a constant medium has lost its light; infinite where it varies.
double reachOf(const Medium& medium) {
  if (!medium.constant) return std::numeric_limits<double>::infinity();
  const float sigma = minimum(medium.constant->sigmaT);
  return sigma > volume::negligibleExtinction ? largestDepth / static_cast<double>(sigma)
                                              : std::numeric_limits<double>::infinity();
}

}  // namespace

volume::RayStretches scatteringStretches(const PathContext& path, double t0, double t1, const Medium* boundaryMedium) {
  volume::RayStretches stretches;
  double end = t1;
  if (boundaryMedium) end = std::min(end, t0 + reachOf(*boundaryMedium));
  const auto add = [&](double a, double b, const Medium* medium) {
    if (!(a < b)) return;
    if (!medium || !medium->constant) return stretches.add(a, b);
    stretches.add(a, b, {medium->constant->sigmaT, medium->constant->sigmaS});
  };
  const bool isPartitioned = path.scene().geometry->overlapDesign() == accel::OverlapDesign::partition;
  const bool isWhole = (boundaryMedium && boundaryMedium->mayScatter) || isPartitioned;
  if (isWhole) add(t0, end, isPartitioned ? nullptr : boundaryMedium);
  // Overlap, and what only weakens light, is not told apart.
  bool isSimple = isWhole || !boundaryMedium || (boundaryMedium->constant && isBlack(boundaryMedium->constant->sigmaT));
  double behind = t0;
  for (const accel::Span& span : path.spans) {
    const Medium& medium = path.mediumSpans.mediumOf(span);
    const double a = std::max(span.t0, t0);
    end = std::min(end, a + reachOf(medium));
    const double b = std::min(span.t1, end);
    const bool scatters = medium.mayScatter && !medium.isHoldout;
    if (scatters) add(a, b, &medium);
    isSimple = isSimple && scatters && !isWhole && a >= behind;
    behind = std::max(behind, span.t1);
  }
  if (!isSimple) stretches.forgetExtinction();
  return stretches;
}

const LinkedLights* commonLinks(const PathContext& path, const Medium* boundaryMedium) {
  const PreparedScene& scene = path.scene();
  if (!hasOptionalEffects || scene.linkedLights.empty() ||
      scene.geometry->overlapDesign() == accel::OverlapDesign::partition)
    return nullptr;
  if (boundaryMedium && boundaryMedium->mayScatter) return nullptr;
  std::optional<std::uint32_t> links;
  for (const accel::Span& span : path.spans) {
    const Medium& medium = path.mediumSpans.mediumOf(span);
    if (!medium.mayScatter || medium.isHoldout) continue;
    if (links.value_or(medium.lightLinks) != medium.lightLinks) return nullptr;
    links = medium.lightLinks;
  }
  return links.value_or(0) == 0 ? nullptr : scene.linkedLights[*links - 1].get();
}

namespace {

/// Of the way behind `whole`.
void append(DistanceSample& whole, DistanceSample part) {
  part.emission = whole.emission + whole.weight * part.emission;
  part.weight *= whole.weight;
  part.logPdf += whole.logPdf;
  part.choicePdf *= whole.choicePdf;
  if (whole.pdfKind == volume::PdfKind::joint) part.pdfKind = volume::PdfKind::joint;
  whole = part;
}

}  // namespace

DistanceSample sampleClosedForms(PathContext& path, Color throughput, volume::GivenDistance* given,
                                 DistanceNumbers numbers) {
  DistanceSample whole;
  Segment segment;
  if (!path.segments.next(segment)) return whole;
  DistanceSource random(path.random(), numbers);
  bool tracks = true;
  do {
    const bool finds = given && given->concerns(segment);
    if (!tracks && !finds) break;
    countWork(path.statistics().work, segment, DistanceMethod::closedForm);
    const volume::HomogeneousSegment homogeneous(segment, throughput);
    if (tracks) append(whole, homogeneous.sample(random));
    if (finds) homogeneous.find(*given, random);
    tracks = whole.event == DistanceEvent::passed;
  } while ((tracks || (given && given->isOpen())) && path.segments.next(segment));
  return whole;
}

Task<DistanceSample> sampleDistance(PathContext& path, Ray<World> ray, Color throughput, volume::GivenDistance* given,
                                    DistanceNumbers numbers, bool tracks) {
  DistanceSample whole;
  Segment segment;
  if (!path.segments.next(segment)) co_return whole;
  DistanceSource random(path.random(), numbers);
  do {
    tracks = tracks && whole.event == DistanceEvent::passed;
    const bool finds = given && given->concerns(segment);
    if (!tracks && !finds) break;
    DistanceSample part;
    const DistanceMethod plain = methodOf(segment);
    // Tabulated lights want cells, of constants as well.
    const bool isTabulated = plain == DistanceMethod::closedForm && finds && given->lights;
    const DistanceMethod method = isTabulated ? DistanceMethod::marching : plain;
    countWork(path.statistics().work, segment, plain);
    switch (method) {
      case DistanceMethod::closedForm: {
        const volume::HomogeneousSegment homogeneous(segment, throughput);
        if (tracks) part = homogeneous.sample(random);
        if (finds) homogeneous.find(*given, random);
        break;
      }
      case DistanceMethod::analytic: {
        const volume::AnalyticSegment voxels(segment, ray, throughput);
        if (tracks) part = voxels.sample(random);
        if (finds) voxels.find(*given, random);
        break;
      }
      case DistanceMethod::marching:
        part = co_await volume::sampleByMarching(path, ray, segment, stepSizeOf(segment), throughput, random,
                                                 path.marchingTable, given, tracks);
        break;
      case DistanceMethod::nullScattering:
        part = co_await (listsCandidates(segment)
                             ? volume::sampleFromCandidates(path, ray, segment, throughput, random, given, tracks)
                             : volume::sampleByNullScattering(path, ray, segment, throughput, random, given, tracks));
        break;
    }
    if (!tracks) continue;
    append(whole, part);
    tracks = whole.event == DistanceEvent::passed;
  } while ((tracks || (given && given->isOpen())) && path.segments.next(segment));
  co_return whole;
}

namespace {

/// What the materials of the surfaces on the way say that let shadow rays pass.
Task<> askStraightSurfaces(PathContext& path, Ray<World> ray) {
  const PreparedScene& scene = path.scene();
  path.straight.clear();
  for (std::size_t i = 0; i < path.interfaces.size(); ++i) {
    const accel::HitKey key = path.interfaces[i].key;
    const PreparedObject& object = scene.objects[key.object];
    path.statistics().work.add(Work::straightCrossing);
    PathContext::StraightCrossing crossing{Color(1.0f), {}};
    if (!object.isBoundary && object.castsShadows) {
      const shading::ShadingPoint point = shadingPointOf(path, scene.geometry->hitAt(ray, key), ray);
      const SurfaceAnswer& answer = co_await path.shade(object.material, point);
      crossing.through = Color();
      for (std::uint32_t site = 0; site < answer.siteCount(); ++site) {
        const Closure* const closure = object.closures[site];
        if (closure && closure->kind() == ClosureKind::transparent) crossing.through += answer.sites[site].weight;
      }
      if (!isFinite(crossing.through)) crossing.through = Color();
      crossing.interior = interiorOf(scene, key.object, answer);
    }
    path.straight.push_back(std::move(crossing));
  }
}

/// Crosses a surface that does not stop light, on the path's shadow stack where media nest. Gives what the surface lets
/// through; `medium` becomes the one behind it.
Color crossInterface(PathContext& path, std::size_t index, const Medium*& medium) {
  const PreparedScene& scene = path.scene();
  const accel::Interface& interface = path.interfaces[index];
  const PreparedObject& object = scene.objects[interface.key.object];
  const bool isBoundary = object.isBoundary;
  if (!object.castsShadows) {
    path.wentStraight = path.wentStraight || object.stopsScattered;
    return Color(1.0f);
  }
  if (!scene.nestsMedia) {
    medium = object.behind(interface.entering, medium);
    path.wentStraight = path.wentStraight || !isBoundary;
    return isBoundary ? Color(1.0f) : path.straight[index].through;
  }
  const std::optional<volume::Interior> interior =
      isBoundary ? boundaryInterior(scene, interface.key.object) : path.straight[index].interior;
  // A surface inside of a stronger medium is not there.
  const bool isHit = !isBoundary && (!interior || path.shadowMedia.judge(*interior, interface.entering).isHit);
  path.wentStraight = path.wentStraight || isHit;
  if (interior) {
    path.shadowMedia.cross(*interior, interface.entering, path.statistics().media);
    const volume::Interior* ruling = path.shadowMedia.ruling();
    medium = ruling ? path.keepShadowMedium(*ruling) : object.exterior;
  }
  return isHit ? path.straight[index].through : Color(1.0f);
}

/// Spans of all media between the ray's ends, surface-defined ones included. Gives what the surfaces on the way let
/// through.
Color collectSpans(PathContext& path, const Ray<World>& ray, const Medium* boundaryMedium,
                   const volume::MediumStack& media) {
  auto &boundary = path.mediumSpans.boundary(), &clipped = path.mediumSpans.clipped();
  boundary.clear();
  clipped.clear();
  double begin = static_cast<double>(ray.tMin);
  const auto end = static_cast<double>(ray.tMax);
  const bool nests = path.scene().nestsMedia;
  if (nests) {
    path.shadowMedia = media;
    path.beginShadowMedia(path.interfaces.size());
  }
  const auto add = [&](double t) {
    if (!(begin < t)) return;
    if (boundaryMedium) boundary.push_back({begin, t, boundaryMedium});
    if (nests && path.shadowMedia.clipsVolumes()) clipped.push_back({begin, t, nullptr});
  };
  Color through(1.0f);
  for (std::size_t i = 0; i < path.interfaces.size(); ++i) {
    const double t = path.interfaces[i].key.t;
    add(t);
    through *= crossInterface(path, i, boundaryMedium);
    begin = t;
  }
  add(end);
  path.mediumSpans.begin(path.scene(), path.scene().shadowVolumesFor(path.length() + 1), ray,
                         static_cast<double>(ray.tMin), end, path.spans, path.statistics().accel);
  return through;
}

}  // namespace

bool meetsWhatPassesPoints(const PathContext& path) {
  return std::any_of(path.interfaces.begin(), path.interfaces.end(), [&](const accel::Interface& interface) {
    return path.scene().objects[interface.key.object].passesPoints;
  });
}

Task<Color> estimateTransmittance(PathContext& path, Ray<World> ray, const Medium* boundaryMedium,
                                  const volume::MediumStack& media, bool fromPoint) {
  path.wentStraight = false;
  if (path.scene().geometry->occluded(ray, path.spans, path.interfaces, path.statistics().accel)) co_return Color();
  if (path.scene().shadowsPass && !fromPoint && meetsWhatPassesPoints(path)) co_return Color();
  if (path.interfaces.empty() && meetsNothing(path, boundaryMedium)) co_return Color(1.0f);
  path.setRayBeside(ray);
  path.setRayTypes(shading::ray::shadow);
  if (path.scene().shadowsPass) co_await askStraightSurfaces(path, ray);
  Color transmittance = collectSpans(path, ray, boundaryMedium, media);
  HashSource random(path.random());
  for (MediumSpan span; !isBlack(transmittance) && path.mediumSpans.take(span);) {
    const auto method = span.medium->transmittance;
    if (!path.scene().asksMedia || method == volume::TransmittanceMethod::closedForm) {
      transmittance *= volume::closedTransmittance(span);
    } else {
      transmittance *= co_await volume::estimateTransmittance(method, path, ray, span, random);
    }
  }
  co_return transmittance;
}

}  // namespace aerosol::render
