#include <algorithm>

#include "core/accel/scene_data.h"

namespace aerosol::accel {

namespace {

/// Embree takes coordinates up to 1.8e18; volumes beyond that are treated as infinite.
constexpr float largestCoordinate = 1e18f;

/// Volumes met by a random line above which the partition is the faster design. Measured: a path that scatters in the
/// first segment takes half the time from about 20 overlapping elements on, one that goes through all of them the same;
/// with few of many elements under a ray the query's own hierarchy is up to twice as fast.
constexpr double partitionedOverlap = 16;

Diagnostic makeError(std::string message, std::vector<std::string> notes = {}) {
  return {Severity::error, {}, std::move(message), {}, std::move(notes)};
}

Diagnostic tooFar(std::string message) {
  return makeError(std::move(message), {"squares of lengths have to fit into floats: write lengths in a larger unit"});
}

bool allFinite(const Matrix4& m) {
  return std::ranges::all_of(
      m, [](const auto& row) { return std::ranges::all_of(row, [](double x) { return std::isfinite(x); }); });
}

bool isUsable(const Transform<World, Object>& toWorld) {
  return allFinite(toWorld.matrix()) && allFinite(toWorld.inverseMatrix()) && linearDeterminant(toWorld.matrix()) != 0;
}

bool hasNan(const Box<World>& box) {
  for (int i = 0; i < 3; ++i) {
    if (std::isnan(box.lower[i]) || std::isnan(box.upper[i])) return true;
  }
  return false;
}

bool isBounded(const Box<World>& box) {
  for (int i = 0; i < 3; ++i) {
    if (std::fabs(box.lower[i]) > largestCoordinate || std::fabs(box.upper[i]) > largestCoordinate) return false;
  }
  return true;
}

/// Traversal is in float and may miss a box that is touched exactly, or a flat one; user geometry decides in double
/// whatever box it is given, so boxes are enlarged a little.
RTCBounds paddedBounds(const Box<World>& box) {
  const Box<World> larger = withMargin(box);
  return {larger.lower.x, larger.lower.y, larger.lower.z, 0, larger.upper.x, larger.upper.y, larger.upper.z, 0};
}

void analyticBounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& data = *static_cast<const SceneData*>(arguments->geometryUserPtr);
  *arguments->bounds_o = paddedBounds(data.analytic[arguments->primID]->worldBounds());
}

void volumeBounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& data = *static_cast<const SceneData*>(arguments->geometryUserPtr);
  *arguments->bounds_o = paddedBounds(data.volumes[data.bounded[arguments->primID]]->worldBounds());
}

void instanceBounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& data = *static_cast<const SceneData*>(arguments->geometryUserPtr);
  *arguments->bounds_o = paddedBounds(data.instances[arguments->primID]->worldBounds());
}

void movingSurfaceBounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& data = *static_cast<const SceneData*>(arguments->geometryUserPtr);
  const auto& steps = data.surfaces[data.movingSurfaces[arguments->primID]].motion->steps;
  *arguments->bounds_o = paddedBounds(steps[arguments->timeStep]);
}

void movingVolumeBounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& data = *static_cast<const SceneData*>(arguments->geometryUserPtr);
  *arguments->bounds_o = paddedBounds(data.movingShapes[arguments->primID]->steps()[arguments->timeStep]);
}

void attach(RTCScene scene, RTCGeometry geometry) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

static_assert(sizeof(Point<World>) == 3 * sizeof(float) && sizeof(std::array<std::uint32_t, 3>) == 12);

/// The buffers are shared with Embree, which reads 16 bytes from the last vertex on: addMesh saw to the room.
void attachMesh(const SceneData& data, const MeshSurface& surface, RTCScene scene) {
  const TriangleMesh& mesh = surface.mesh;
  if (mesh.triangles.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(data.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0,
                             sizeof(Point<World>), mesh.positions.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(mesh.triangles[0]), mesh.triangles.size());
  rtcSetGeometryUserData(geometry, const_cast<MeshSurface*>(&surface));
  rtcSetGeometryIntersectFilterFunction(geometry, acceptTriangle);
  rtcSetGeometryOccludedFilterFunction(geometry, acceptShadowTriangle);
  attach(scene, geometry);
}

static_assert(sizeof(CurvePoint) == 4 * sizeof(float));

void attachCurves(const SceneData& data, const CurveSurface& surface, RTCScene scene) {
  const CurveSet& curves = surface.curves;
  const bool isLinear = curves.basis == CurveBasis::linear;
  RTCGeometry geometry = rtcNewGeometry(
      data.device, isLinear ? RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE : RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, curves.points.data(), 0,
                             sizeof(CurvePoint), curves.points.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, curves.segments.data(), 0,
                             sizeof(curves.segments[0]), curves.segments.size());
  if (isLinear) {
    // Between two pieces of one fibre there is no ball.
    auto* flags = static_cast<std::uint8_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_FLAGS, 0, RTC_FORMAT_UCHAR, 1, curves.segments.size()));
    for (std::size_t i = 0; flags && i < curves.segments.size(); ++i) {
      const bool follows = i > 0 && curves.segments[i - 1] + 1 == curves.segments[i];
      const bool goesOn = i + 1 < curves.segments.size() && curves.segments[i] + 1 == curves.segments[i + 1];
      flags[i] = static_cast<std::uint8_t>((follows ? RTC_CURVE_FLAG_NEIGHBOR_LEFT : 0) |
                                           (goesOn ? RTC_CURVE_FLAG_NEIGHBOR_RIGHT : 0));
    }
  }
  rtcSetGeometryUserData(geometry, const_cast<CurveSurface*>(&surface));
  rtcSetGeometryIntersectFilterFunction(geometry, acceptCurve);
  rtcSetGeometryOccludedFilterFunction(geometry, acceptShadowCurve);
  attach(scene, geometry);
}

/// A mesh alone, in the space where it rests.
RTCScene meshScene(const SceneData& data, const MeshSurface& surface) {
  RTCScene scene = rtcNewScene(data.device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  attachMesh(data, surface, scene);
  rtcCommitScene(scene);
  return scene;
}

void attachUser(const SceneData& data, std::size_t count, RTCBoundsFunction bounds, RTCIntersectFunctionN intersect,
                RTCOccludedFunctionN occluded, std::size_t steps = 1) {
  if (count == 0) return;
  RTCGeometry geometry = rtcNewGeometry(data.device, RTC_GEOMETRY_TYPE_USER);
  if (steps > 1) rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(steps));
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count));
  rtcSetGeometryUserData(geometry, const_cast<SceneData*>(&data));
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcSetGeometryOccludedFunction(geometry, occluded);
  attach(data.scene, geometry);
}

void extend(Box<World>& bounds, const Box<World>& box) {
  bounds.extend(box.lower);
  bounds.extend(box.upper);
}

/// Sorts the primitives into the tables of `data` and takes the bounds of all of them.
void indexPrimitives(SceneData& data) {
  for (ObjectId i = 0; i < data.surfaces.size(); ++i) {
    const Surface& surface = data.surfaces[i];
    if (surface.motion) {
      if (surface.motion->atRest.isEmpty()) continue;
      data.movingSurfaces.push_back(i);
      for (const Box<World>& step : surface.motion->steps) extend(data.bounds, step);
      continue;
    }
    if (surface.analytic) {
      data.analytic.push_back(surface.analytic.get());
      extend(data.bounds, surface.analytic->worldBounds());
      continue;
    }
    if (surface.curves) {
      extend(data.bounds, surface.curves->worldBounds());
      continue;
    }
    if (surface.instance) {
      if (surface.instance->shared->bounds.isEmpty()) continue;
      data.instances.push_back(surface.instance.get());
      extend(data.bounds, surface.instance->worldBounds());
      continue;
    }
    for (const auto& triangle : surface.mesh->mesh.triangles) {
      for (const std::uint32_t corner : triangle) data.bounds.extend(surface.mesh->mesh.positions[corner]);
    }
  }
  for (VolumeId i = 0; i < data.volumes.size(); ++i) {
    const Box<World> box = data.volumes[i]->worldBounds();
    if (box.isEmpty()) continue;
    if (!isBounded(box)) {
      data.unbounded.push_back(i);
      continue;
    }
    extend(data.bounds, box);
    const auto* moving = dynamic_cast<const MovingVolume*>(data.volumes[i].get());
    if (moving && data.overlap == OverlapDesign::partition) {
      data.unbounded.push_back(i);  // The partition is of space at one time.
      continue;
    }
    if (moving) {
      data.movingShapes.push_back(moving);
      data.movingVolumes.push_back(i);
      continue;
    }
    data.bounded.push_back(i);
  }
}

/// Takes the boxes of what moves while the shutter is open. The number of steps.
std::size_t sweep(SceneData& data, const Shutter& shutter) {
  std::size_t segments = 1;
  for (const Surface& surface : data.surfaces) {
    if (surface.motion) segments = std::max(segments, sweepSegments(surface.motion->placement));
  }
  for (const auto& motion : data.volumeMotions) {
    if (motion) segments = std::max(segments, sweepSegments(*motion));
  }
  for (Surface& surface : data.surfaces) {
    if (!surface.motion) continue;
    SurfaceMotion& motion = *surface.motion;
    if (surface.analytic) {
      motion.atRest = surface.analytic->worldBounds();
    } else {
      for (const auto& triangle : surface.mesh->mesh.triangles) {
        for (const std::uint32_t corner : triangle) motion.atRest.extend(surface.mesh->mesh.positions[corner]);
      }
    }
    if (!motion.atRest.isEmpty()) motion.steps = sweepBounds(motion.placement, motion.atRest, shutter, segments);
  }
  for (VolumeId i = 0; i < data.volumes.size(); ++i) {
    if (!data.volumeMotions[i]) continue;
    data.volumes[i] =
        std::make_unique<MovingVolume>(std::move(data.volumes[i]), *data.volumeMotions[i], shutter, segments);
  }
  return segments + 1;
}

struct IsaLevel {
  const char* name;
  bool supported;
};

std::vector<IsaLevel> isaLevels() {
#if defined(__x86_64__)
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") &&
                      __builtin_cpu_supports("avx512vl");
  return {{"avx512", avx512},
          {"avx2", __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")},
          {"avx", static_cast<bool>(__builtin_cpu_supports("avx"))},
          {"sse4.2", static_cast<bool>(__builtin_cpu_supports("sse4.2"))},
          {"sse2", true}};
#else
  return {{"neon", true}};
#endif
}

/// The level to use; Embree itself takes any name without complaint and crashes on what the machine lacks.
Result<std::string> chooseIsa(const std::string& wanted) {
  std::vector<std::string> notes{"known levels:"};
  for (const IsaLevel& level : isaLevels()) {
    if (level.supported && (wanted.empty() || wanted == level.name)) return std::string(level.name);
    if (wanted == level.name) return makeError("this machine has no " + wanted + " for Embree");
    notes[0] += std::string(" ") + level.name;
  }
  return makeError("'" + wanted + "' is not an instruction set of Embree", std::move(notes));
}

}  // namespace

OverlapDesign chooseOverlapDesign(std::span<const Box<World>> volumes) {
  std::vector<Box<World>> finite;
  std::ranges::copy_if(volumes, std::back_inserter(finite),
                       [](const Box<World>& box) { return !box.isEmpty() && isBounded(box); });
  return expectedOverlap(finite) > partitionedOverlap ? OverlapDesign::partition : OverlapDesign::split;
}

SceneBuilder::SceneBuilder() : data_(std::make_unique<SceneData>()) {}
SceneBuilder::~SceneBuilder() = default;
SceneBuilder::SceneBuilder(SceneBuilder&&) noexcept = default;
SceneBuilder& SceneBuilder::operator=(SceneBuilder&&) noexcept = default;

namespace {

/// What is wrong with a mesh, as an error; one without is made ready for Embree.
Result<TriangleMesh> readyMesh(TriangleMesh mesh) {
  if (auto defect = findDefect(mesh)) return makeError(*defect);
  for (const auto& p : mesh.positions) {
    if (!isBounded({p, p})) return tooFar("a position of the mesh is beyond 1e18");
  }
  resolveNormals(mesh);
  mesh.positions.reserve(mesh.positions.size() + 1);
  return mesh;
}

}  // namespace

Box<World> MeshInstance::worldBounds() const {
  const Double3 lower = toDouble(shared->bounds.lower), upper = toDouble(shared->bounds.upper);
  const Double3 half = (upper - lower) * 0.5, middle = mapPoint(toWorld.matrix(), (upper + lower) * 0.5);
  const auto along = [&](std::size_t row) {
    const auto& m = toWorld.matrix()[row];
    return std::fabs(m[0]) * half.x + std::fabs(m[1]) * half.y + std::fabs(m[2]) * half.z;
  };
  const Double3 reach{along(0), along(1), along(2)};
  return {{floatBelow(middle.x - reach.x), floatBelow(middle.y - reach.y), floatBelow(middle.z - reach.z)},
          {floatAbove(middle.x + reach.x), floatAbove(middle.y + reach.y), floatAbove(middle.z + reach.z)}};
}

Result<SharedMeshId> SceneBuilder::addShared(TriangleMesh mesh) {
  auto ready = readyMesh(std::move(mesh));
  if (!ready) return ready.errors();
  data_->shared.push_back(std::make_unique<SharedMesh>(std::move(*ready)));
  return static_cast<SharedMeshId>(data_->shared.size() - 1);
}

Result<ObjectId> SceneBuilder::addInstance(SharedMeshId mesh, const Transform<World, Object>& toWorld,
                                           bool passThrough) {
  if (!isUsable(toWorld)) return makeError("the transform cannot be inverted or is not finite");
  const auto object = static_cast<ObjectId>(data_->surfaces.size());
  auto instance = std::make_unique<MeshInstance>(MeshInstance{data_->shared[mesh].get(), object, passThrough, toWorld});
  if (!instance->shared->bounds.isEmpty() && !isBounded(instance->worldBounds()))
    return tooFar("the shape reaches beyond 1e18");
  data_->surfaces.push_back({nullptr, nullptr, std::move(instance)});
  return object;
}

Result<ObjectId> SceneBuilder::addCurves(CurveSet curves, bool passThrough) {
  const auto object = static_cast<ObjectId>(data_->surfaces.size());
  auto surface = std::make_unique<CurveSurface>(CurveSurface{object, passThrough, std::move(curves)});
  if (!isBounded(surface->worldBounds())) return tooFar("a fibre reaches beyond 1e18");
  data_->surfaces.push_back({nullptr, nullptr, nullptr, std::move(surface)});
  return object;
}

Result<ObjectId> SceneBuilder::addMesh(TriangleMesh unready, bool passThrough) {
  auto ready = readyMesh(std::move(unready));
  if (!ready) return ready.errors();
  TriangleMesh& mesh = *ready;
  const auto object = static_cast<ObjectId>(data_->surfaces.size());
  auto surface = std::make_unique<MeshSurface>(MeshSurface{object, passThrough, std::move(mesh)});
  data_->surfaces.push_back({std::move(surface), nullptr});
  return object;
}

namespace {

Result<ObjectId> addAnalytic(SceneData& data, AnalyticSurface surface) {
  if (!isUsable(surface.toWorld)) return makeError("the transform cannot be inverted or is not finite");
  if (!isBounded(surface.worldBounds())) return tooFar("the shape reaches beyond 1e18");
  surface.object = static_cast<ObjectId>(data.surfaces.size());
  data.surfaces.push_back({nullptr, std::make_unique<AnalyticSurface>(surface)});
  return surface.object;
}

}  // namespace

Result<ObjectId> SceneBuilder::addSphere(const Transform<World, Object>& toWorld, bool passThrough, bool flipNormals) {
  return addAnalytic(*data_, {AnalyticSurface::Kind::sphere, 0, passThrough, flipNormals, toWorld});
}

Result<ObjectId> SceneBuilder::addDisk(const Transform<World, Object>& toWorld, bool passThrough, bool flipNormals) {
  return addAnalytic(*data_, {AnalyticSurface::Kind::disk, 0, passThrough, flipNormals, toWorld});
}

Result<ObjectId> SceneBuilder::addCylinder(const Transform<World, Object>& toWorld, bool passThrough,
                                           bool flipNormals) {
  return addAnalytic(*data_, {AnalyticSurface::Kind::cylinder, 0, passThrough, flipNormals, toWorld});
}

namespace {

/// Makes the last surface move.
Result<ObjectId> setMotion(SceneData& data, Result<ObjectId> added, const MovingPlacement& toWorld) {
  if (added) data.surfaces.back().motion = std::make_unique<SurfaceMotion>(toWorld);
  return added;
}

}  // namespace

Result<ObjectId> SceneBuilder::addMesh(TriangleMesh mesh, const MovingPlacement& toWorld, bool passThrough) {
  return setMotion(*data_, addMesh(std::move(mesh), passThrough), toWorld);
}
Result<ObjectId> SceneBuilder::addSphere(const MovingPlacement& toWorld, bool passThrough, bool flipNormals) {
  return setMotion(*data_, addSphere(Transform<World, Object>(), passThrough, flipNormals), toWorld);
}
Result<ObjectId> SceneBuilder::addDisk(const MovingPlacement& toWorld, bool passThrough, bool flipNormals) {
  return setMotion(*data_, addDisk(Transform<World, Object>(), passThrough, flipNormals), toWorld);
}
Result<ObjectId> SceneBuilder::addCylinder(const MovingPlacement& toWorld, bool passThrough, bool flipNormals) {
  return setMotion(*data_, addCylinder(Transform<World, Object>(), passThrough, flipNormals), toWorld);
}
Result<VolumeId> SceneBuilder::addVolume(std::unique_ptr<const VolumeShape> volume, const MovingPlacement& toWorld) {
  auto added = addVolume(std::move(volume));
  if (added) data_->volumeMotions.back().emplace(toWorld);
  return added;
}

Result<VolumeId> SceneBuilder::addVolume(std::unique_ptr<const VolumeShape> volume) {
  if (hasNan(volume->worldBounds())) return makeError("the transform cannot be inverted or is not finite");
  data_->volumes.push_back(std::move(volume));
  data_->volumeMotions.emplace_back();
  return static_cast<VolumeId>(data_->volumes.size() - 1);
}

void SceneBuilder::letShadowsPass(ObjectId object) {
  data_->shadowsPass.resize(std::max<std::size_t>(data_->shadowsPass.size(), object + 1));
  data_->shadowsPass[object] = true;
}

void SceneBuilder::setVisibility(ObjectId object, std::uint32_t kinds) {
  data_->visibleTo.resize(std::max<std::size_t>(data_->visibleTo.size(), object + 1), ~0u);
  data_->visibleTo[object] = kinds;
}

OverlapDesign SceneBuilder::preferredOverlapDesign() const {
  // The partition is of space at one time.
  if (std::ranges::any_of(data_->volumeMotions, [](const auto& motion) { return motion.has_value(); }))
    return OverlapDesign::split;
  std::vector<Box<World>> boxes;
  for (const auto& volume : data_->volumes) boxes.push_back(volume->worldBounds());
  return chooseOverlapDesign(boxes);
}

Result<Scene> SceneBuilder::build(const SceneOptions& options) {
  auto isa = chooseIsa(options.embreeIsa);
  if (!isa) return isa.errors();
  std::unique_ptr<SceneData> data = std::move(data_);
  data_ = std::make_unique<SceneData>();
  data->isa = *isa;
  if (!data->visibleTo.empty()) data->visibleTo.resize(data->surfaces.size(), ~0u);
  data->shutter = options.shutter;
  data->overlap = options.overlap;
  const std::size_t steps = sweep(*data, options.shutter);
  for (const Surface& surface : data->surfaces) {
    if (!surface.motion) continue;
    if (options.shutter.isInstant()) return makeError("nothing moves while a shutter is open for no time");
    for (const Box<World>& step : surface.motion->steps) {
      if (!isBounded(step)) return tooFar("a shape moves beyond 1e18");
    }
  }
  indexPrimitives(*data);
  std::vector<Box<World>> boxes;
  for (const auto& volume : data->volumes) boxes.push_back(volume->worldBounds());

  data->device = rtcNewDevice(("isa=" + data->isa).c_str());
  if (!data->device) return makeError("Embree cannot be started");
  data->scene = rtcNewScene(data->device);
  rtcSetSceneFlags(data->scene, RTC_SCENE_FLAG_ROBUST);
  for (const Surface& surface : data->surfaces) {
    if (surface.curves) attachCurves(*data, *surface.curves, data->scene);
    if (surface.mesh && !surface.motion) attachMesh(*data, *surface.mesh, data->scene);
    if (surface.mesh && surface.motion) {
      surface.motion->mesh = meshScene(*data, *surface.mesh);
    }
  }
  for (const auto& shared : data->shared) shared->scene = meshScene(*data, shared->surface);
  attachUser(*data, data->instances.size(), instanceBounds, intersectInstance, occludeInstance);
  attachUser(*data, data->analytic.size(), analyticBounds, intersectAnalytic, occludeAnalytic);
  if (data->overlap == OverlapDesign::split) {
    attachUser(*data, data->bounded.size(), volumeBounds, recordVolume, recordShadowVolume);
  }
  attachUser(*data, data->movingSurfaces.size(), movingSurfaceBounds, intersectMoving, occludeMoving, steps);
  attachUser(*data, data->movingVolumes.size(), movingVolumeBounds, recordMovingVolume, recordMovingShadowVolume,
             steps);
  rtcCommitScene(data->scene);
  if (rtcGetDeviceError(data->device) != RTC_ERROR_NONE) {
    return makeError("Embree cannot build the acceleration structure: out of memory, or too many primitives");
  }
  Scene scene(std::move(data));
  scene.refinePartition(boxes, nullptr);
  return scene;
}

std::string version() { return RTC_VERSION_STRING; }

}  // namespace aerosol::accel
