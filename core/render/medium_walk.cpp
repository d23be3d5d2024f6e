#include "core/render/medium_walk.h"

#include <algorithm>

#include "core/render/nesting.h"
#include "core/render/prepared_scene.h"
#include "core/volume/trackers/homogeneous.h"
#include "core/volume/trackers/null_scattering.h"
#include "core/volume/trackers/ray_marching.h"

namespace aerosol::render {

using volume::DistanceEvent;
using volume::DistanceMethod;
using volume::DistanceSample;
using volume::Medium;
using volume::MediumSpan;
using volume::Segment;
using volume::Task;

void findSegments(PathContext& path, const Ray<World>& ray, double t0, double t1, const Medium* boundaryMedium) {
  const PhaseScope phase(path.statistics().accel.phase, Phase::intervals);
  auto& boundary = path.mediumSpans.boundary();
  boundary.clear();
  if (boundaryMedium && t0 < t1) boundary.push_back({t0, t1, boundaryMedium});
  path.mediumSpans.clipped().clear();
  if (path.scene().nestsMedia && path.media.clipsVolumes()) path.mediumSpans.clipped().push_back({t0, t1, nullptr});
  path.mediumSpans.begin(path.scene(), ray, t0, t1, path.spans, path.statistics().accel);
  path.segments.begin(path.mediumSpans);
}

namespace {

/// Null scattering serves a segment when every medium has a bound; one marching medium makes the whole segment march.
DistanceMethod methodOf(const Segment& segment) {
  DistanceMethod method = DistanceMethod::closedForm;
  for (const Medium* medium : segment.media) {
    if (medium->method == DistanceMethod::marching) return DistanceMethod::marching;
    if (medium->method == DistanceMethod::nullScattering) method = DistanceMethod::nullScattering;
  }
  return method;
}

float stepSizeOf(const Segment& segment) {
  float step = std::numeric_limits<float>::infinity();
  for (const Medium* medium : segment.media) step = std::min(step, medium->stepSize);
  return step;
}

}  // namespace

Task<DistanceSample> sampleDistance(PathContext& path, Ray<World> ray, Color throughput) {
  DistanceSample whole;
  HashSource random(path.random());
  Segment segment;
  while (path.segments.next(segment)) {
    DistanceSample part;
    switch (methodOf(segment)) {
      case DistanceMethod::closedForm:
        part = volume::sampleHomogeneous(segment, throughput, random);
        break;
      case DistanceMethod::marching:
        part = co_await volume::sampleByMarching(path, ray, segment, stepSizeOf(segment), throughput, random);
        break;
      case DistanceMethod::nullScattering:
        part = co_await volume::sampleByNullScattering(path, ray, segment, throughput, random);
        break;
    }
    part.emission = whole.emission + whole.weight * part.emission;
    part.weight *= whole.weight;
    part.logPdf += whole.logPdf;
    if (whole.pdfKind == volume::PdfKind::joint) part.pdfKind = volume::PdfKind::joint;
    whole = part;
    if (whole.event != DistanceEvent::passed) break;
  }
  co_return whole;
}

namespace {

Task<Color> mediumTransmittance(PathContext& path, Ray<World> ray, MediumSpan span) {
  HashSource random(path.random());
  switch (span.medium->method) {
    case DistanceMethod::marching:
      co_return co_await volume::marchedTransmittance(path, ray, span, span.medium->stepSize, random);
    case DistanceMethod::nullScattering:
      co_return co_await volume::ratioTracking(path, ray, span, random);
    case DistanceMethod::closedForm:
      break;
  }
  const auto length = static_cast<float>(span.t1 - span.t0);
  co_return exp(volume::opticalDepth(span.medium->constant->sigmaT, length) * -1.0f);
}

/// The medium behind a surface without effect of its own.
const Medium* crossBoundary(PathContext& path, const accel::Interface& interface) {
  const PreparedScene& scene = path.scene();
  const PreparedObject& object = scene.objects[interface.key.object];
  if (!scene.nestsMedia) return interface.entering ? object.interior : object.exterior;
  path.shadowMedia.cross(boundaryInterior(scene, interface.key.object), interface.entering, path.statistics().media);
  const volume::Interior* ruling = path.shadowMedia.ruling();
  return ruling ? path.mediumAlongShadow(*ruling) : object.exterior;
}

/// Spans of all media between the ray's ends, surface-defined ones included.
void collectSpans(PathContext& path, const Ray<World>& ray, const Medium* boundaryMedium,
                  const volume::MediumStack& media) {
  auto &boundary = path.mediumSpans.boundary(), &clipped = path.mediumSpans.clipped();
  boundary.clear();
  clipped.clear();
  double begin = static_cast<double>(ray.tMin);
  const auto end = static_cast<double>(ray.tMax);
  const bool nests = path.scene().nestsMedia;
  if (nests) path.shadowMedia = media;
  const auto add = [&](double t) {
    if (!(begin < t)) return;
    if (boundaryMedium) boundary.push_back({begin, t, boundaryMedium});
    if (nests && path.shadowMedia.clipsVolumes()) clipped.push_back({begin, t, nullptr});
  };
  for (const accel::Interface& interface : path.interfaces) {
    add(interface.key.t);
    boundaryMedium = crossBoundary(path, interface);
    begin = interface.key.t;
  }
  add(end);
  path.mediumSpans.begin(path.scene(), ray, static_cast<double>(ray.tMin), end, path.spans, path.statistics().accel);
}

}  // namespace

Task<Color> estimateTransmittance(PathContext& path, Ray<World> ray, const Medium* boundaryMedium,
                                  const volume::MediumStack& media) {
  Color transmittance(1.0f);
  if (path.scene().geometry->occluded(ray, path.spans, path.interfaces, path.statistics().accel)) co_return Color();
  collectSpans(path, ray, boundaryMedium, media);
  path.setRay(ray);
  path.setRayTypes(shading::ray::shadow);
  for (MediumSpan span; !isBlack(transmittance) && path.mediumSpans.take(span);) {
    transmittance *= co_await mediumTransmittance(path, ray, span);
  }
  co_return transmittance;
}

}  // namespace aerosol::render
