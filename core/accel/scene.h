// All surfaces and volume primitives of a scene in one acceleration structure, and the ray queries.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/accel/convex_volume.h"
#include "core/accel/curves.h"
#include "core/accel/hit.h"
#include "core/accel/mesh.h"
#include "core/accel/volume_partition.h"
#include "core/accel/volume_shape.h"
#include "core/base/motion.h"
#include "core/base/phase.h"
#include "core/base/result.h"

namespace aerosol::accel {

/// Counts of one thread; passed into every query.
struct Counters {
  std::uint64_t closestHitQueries = 0;
  std::uint64_t occlusionQueries = 0;
  std::uint64_t volumeTests = 0;  ///< Rays tested against a volume primitive's exact shape.
  std::uint64_t spans = 0;        ///< Volume spans returned.
  std::uint64_t movingSurfaceTests = 0, movingVolumeTests = 0;  ///< Rays near something that moves.
  std::uint64_t openVolumes = 0;  ///< Rays along which a volume primitive's mesh is not closed.
  std::uint64_t invalidRays = 0;  ///< Rays that were not finite; they hit nothing.
  PhaseMark phase;                ///< What the thread is at.

  Counters& operator+=(const Counters& other);
};

/// How the volume primitives along a ray are found (see SpanStream).
enum class OverlapDesign : std::uint8_t {
  split,     ///< All by the ray's query; sorted.
  partition  ///< By walking a partition of space.
};

struct SceneOptions {
  /// The instruction set for intersections: sse2, sse4.2, avx, avx2, avx512; empty: the best of this machine. Hits may
  /// differ in the last bit between two of them.
  std::string embreeIsa;
  OverlapDesign overlap = OverlapDesign::split;
  Shutter shutter = {};  ///< Rays' times lie in it. What moves needs one that is open for some time.
};

/// The design that measurements speak for (tests/bench/places/overlap.cpp): the partition where a line through all
/// volumes meets many of them. Decided by their bounds alone, so that it is the same everywhere.
OverlapDesign chooseOverlapDesign(std::span<const Box<World>> volumes);

struct SceneData;

using SharedMeshId = std::uint32_t;  ///< Meshes that several objects share, counted from 0.

/// Immutable; every query is safe to call from any thread at once. Rays need a finite origin, a finite direction that
/// is not zero, and 0 <= tMin (a negative one counts as 0); other rays hit nothing and are counted.
class Scene {
 public:
  explicit Scene(std::unique_ptr<SceneData> data);
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  /// The first surface with tMin < t < tMax, and (replacing the content of `spans`) the volume spans between tMin and
  /// that hit, or tMax without a hit, sorted by (t0, volume). A ray that starts in a volume has a span that begins at
  /// tMin.
  ///
  /// With `after`, the key of an earlier hit of the same ray: the next hit in the order of HitKey, and the spans from
  /// there on. No spans where volumes are partitioned: a SpanStream finds them. That is how to go on behind a
  /// pass-through surface: no hit is lost or found twice, coincident or not. A crossing at an edge that triangles
  /// share, or of doubled faces, is one hit.
  ///
  /// `kinds` says by bits what the ray is: surfaces that are visible to none of them are not there.
  std::optional<SurfaceHit> closestHit(const Ray<World>& ray, SpanBuffer& spans, Counters& counters,
                                       const HitKey* after = nullptr, std::uint32_t kinds = ~0u) const;

  /// The same with one object alone, as if there was nothing else; no spans.
  std::optional<SurfaceHit> closestHitOn(ObjectId object, const Ray<World>& ray, Counters& counters) const;

  /// Whether an opaque surface has tMin < t < tMax. If not, `spans` holds all volume spans in [tMin, tMax], sorted by
  /// (t0, volume) (none where they are partitioned), and `interfaces` all hits of pass-through surfaces in the order of
  /// HitKey; if so, both are empty.
  bool occluded(const Ray<World>& ray, SpanBuffer& spans, InterfaceBuffer& interfaces, Counters& counters) const;

  /// The hit that a query of this ray has reported by its key.
  SurfaceHit hitAt(const Ray<World>& ray, const HitKey& key) const;

  /// How the shading normal of a hit changes when the point moves by a small `step` on the surface; 0 where it is flat.
  Vector<World> normalChange(const SurfaceHit& hit, Vector<World> step, float time) const;

  /// Bounds of every surface and of every finite volume while the shutter is open.
  Box<World> bounds() const;
  ObjectId objectCount() const;
  VolumeId volumeCount() const;
  /// The mesh of an object with its normals resolved, of one that moves or is shared in its own space; null for
  /// spheres, disks and fibres.
  const TriangleMesh* mesh(ObjectId object) const;
  /// Where a shared mesh stands; null for all other objects.
  const Transform<World, Object>* sharedPlacement(ObjectId object) const;
  Box<World> surfaceBounds(ObjectId object) const;
  const VolumeShape& volume(VolumeId volume) const;
  OverlapDesign overlapDesign() const;
  /// Of the partition; all 0 without one.
  const PartitionStatistics& partitionStatistics() const;
  /// Where volumes are partitioned: does so again, with what is known of their content. `occupied` gives by volume a
  /// box outside of which there is nothing of it. Before the first ray.
  void refinePartition(std::span<const Box<World>> occupied, const EmptinessTest& isEmpty);
  /// The instruction set in use, as in SceneOptions.
  const std::string& isa() const;

  const SceneData& data() const { return *data_; }  ///< Internal to this folder.

 private:
  std::unique_ptr<SceneData> data_;
};

/// Collects primitives. What is wrong with one is an error without a location: the caller knows where it came from.
class SceneBuilder {
 public:
  SceneBuilder();
  ~SceneBuilder();
  SceneBuilder(SceneBuilder&&) noexcept;
  SceneBuilder& operator=(SceneBuilder&&) noexcept;

  /// `passThrough` surfaces (null bsdf) do not stop shadow rays.
  Result<ObjectId> addMesh(TriangleMesh mesh, bool passThrough = false);
  /// A mesh in a space of its own, for any number of objects: it and its acceleration structure are kept once.
  Result<SharedMeshId> addShared(TriangleMesh mesh);
  /// An object that looks like the shared mesh; `toWorld` may be any invertible affine map.
  Result<ObjectId> addInstance(SharedMeshId mesh, const Transform<World, Object>& toWorld, bool passThrough = false);
  /// Fibres.
  Result<ObjectId> addCurves(CurveSet curves, bool passThrough = false);
  /// The unit sphere; `toWorld` may be any invertible affine map.
  Result<ObjectId> addSphere(const Transform<World, Object>& toWorld, bool passThrough = false,
                             bool flipNormals = false);
  /// The unit disk in the xy plane, facing +z.
  Result<ObjectId> addDisk(const Transform<World, Object>& toWorld, bool passThrough = false, bool flipNormals = false);
  /// The cylinder of radius 1 about the z axis from z = 0 to 1, without caps, facing away from its axis.
  Result<ObjectId> addCylinder(const Transform<World, Object>& toWorld, bool passThrough = false,
                               bool flipNormals = false);
  Result<VolumeId> addVolume(std::unique_ptr<const VolumeShape> volume);
  /// Shadow rays do not stop at the surface, though other rays meet it: they list it among their interfaces.
  void letShadowsPass(ObjectId object);
  /// The kinds of rays, as bits, that find the surface; without this all do. Shadow rays always do.
  void setVisibility(ObjectId object, std::uint32_t kinds);

  /// What `chooseOverlapDesign` says of the volumes added so far.
  OverlapDesign preferredOverlapDesign() const;
  // The same where `toWorld` changes with time; meshes and volumes are given in the space that moves.
  Result<ObjectId> addMesh(TriangleMesh mesh, const MovingTransform<World, Object>& toWorld, bool passThrough = false);
  Result<ObjectId> addSphere(const MovingTransform<World, Object>& toWorld, bool passThrough = false,
                             bool flipNormals = false);
  Result<ObjectId> addDisk(const MovingTransform<World, Object>& toWorld, bool passThrough = false,
                           bool flipNormals = false);
  Result<ObjectId> addCylinder(const MovingTransform<World, Object>& toWorld, bool passThrough = false,
                               bool flipNormals = false);
  Result<VolumeId> addVolume(std::unique_ptr<const VolumeShape> volume, const MovingTransform<World, Object>& toWorld);

  /// Builds the acceleration structure on all cores; the builder is empty afterwards.
  Result<Scene> build(const SceneOptions& options = {});

 private:
  std::unique_ptr<SceneData> data_;
};

/// Embree's version, such as "3.13.5".
std::string version();

}  // namespace aerosol::accel
