// Distances and transmittances along whole rays: the media a ray runs through, and each one's tracker.
#pragma once

#include "core/accel/scene.h"
#include "core/render/linked_lights.h"
#include "core/render/path_context.h"
#include "core/volume/distance_sample.h"
#include "core/volume/equiangular.h"
#include "core/volume/task.h"

namespace aerosol::render {

/// Begins `path.segments`: what volume primitives (`path.spans`, as the ray's query left them) and the surface-defined
/// medium around the ray say about [t0, t1]. Where media nest, `media` are those around it. The path knows the ray's
/// type; `links` are those of the volume that it left by scattering.
void findSegments(PathContext& path, const Ray<World>& ray, double t0, double t1, const volume::Medium* boundaryMedium,
                  const volume::MediumStack& media, const LinkedLights* links = nullptr);

/// Where media may scatter between t0 and t1, as far as a look at the same spans tells: a superset.
volume::RayStretches scatteringStretches(const PathContext& path, double t0, double t1,
                                         const volume::Medium* boundaryMedium);

/// The lights that light all of the same media alike; null where those are all lights, or differ from medium to medium.
const LinkedLights* commonLinks(const PathContext& path, const volume::Medium* boundaryMedium);

/// Where the numbers of a distance come from. The first few decide most: of a path's own rays they come from the
/// stratified stream, which gives them `distanceSlots` slots.
enum class DistanceNumbers : std::uint8_t { stratified, hashed };
inline constexpr std::uint32_t distanceSlots = 2;

/// Samples a distance through `path.segments`, which are found no farther than the path comes. `throughput` steers
/// choices between channels alone. The result's weights and emission are for the whole way; `passed` means past the
/// last segment. What lies at a `given` distance is found on the same way; `tracks` false: nothing else is.
volume::Task<volume::DistanceSample> sampleDistance(PathContext& path, Ray<World> ray, Color throughput,
                                                    volume::GivenDistance* given = nullptr,
                                                    DistanceNumbers numbers = DistanceNumbers::hashed,
                                                    bool tracks = true);
/// The same where nothing has to be asked on the way: in scenes without `asksMedia`, when no lights are tabulated.
volume::DistanceSample sampleClosedForms(PathContext& path, Color throughput, volume::GivenDistance* given = nullptr,
                                         DistanceNumbers numbers = DistanceNumbers::hashed);

/// Whether one of `path.interfaces` is `PreparedObject::passesPoints`.
bool meetsWhatPassesPoints(const PathContext& path);

/// What arrives of the light that enters at the ray's end: the product of all media's transmittances (no sorting, no
/// splitting), zero behind an opaque surface. Estimated; may be negative where a bound is exceeded. Where media nest,
/// `media` are those around the ray's origin. `fromPoint`: no path can meet the light, which shines through
/// `PreparedObject::passesPoints`; for others these are opaque here, and paths meet the light behind them.
volume::Task<Color> estimateTransmittance(PathContext& path, Ray<World> ray, const volume::Medium* boundaryMedium,
                                          const volume::MediumStack& media, bool fromPoint);

}  // namespace aerosol::render
