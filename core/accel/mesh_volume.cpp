#include "core/accel/mesh_volume.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <tuple>
#include <unordered_map>

#include "core/accel/embree.h"
#include "core/accel/slab.h"
#include "core/accel/surfaces.h"
#include "core/accel/welded_corners.h"

namespace aerosol::accel {

struct MeshVolume::Data {
  Data() = default;
  ~Data() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  TriangleMesh mesh;
  Box<World> bounds;
  Box<Object> objectBounds;
  MeshTopology topology;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
};

namespace {

/// One crossing of the surface. The order is that along the line, in double.
struct Crossing {
  double t = 0;
  std::uint32_t triangle = 0;
  bool entering = false;

  friend bool operator<(const Crossing& a, const Crossing& b) {
    return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
  }
};

/// A few crossings without the heap, any number with it.
class CrossingList {
 public:
  void add(const Crossing& crossing) {
    if (count_ < few_.size()) {
      few_[count_++] = crossing;
      return;
    }
    if (many_.empty()) many_.assign(few_.begin(), few_.end());
    many_.push_back(crossing);
    ++count_;
  }
  std::span<Crossing> all() { return many_.empty() ? std::span(few_.data(), count_) : std::span(many_); }

 private:
  std::array<Crossing, 32> few_;
  std::size_t count_ = 0;
  std::vector<Crossing> many_;
};

struct CollectContext : EmbreeContext {
  const TriangleMesh* mesh = nullptr;
  DoubleRay ray;
  CrossingList* crossings = nullptr;
};

void collect(const RTCFilterFunctionNArguments* arguments) {
  auto& context = *static_cast<CollectContext*>(arguments->context);
  const std::uint32_t triangle = RTCHitN_primID(arguments->hit, arguments->N, 0);
  if (const auto t = planeDistance(*context.mesh, triangle, context.ray)) {
    context.crossings->add({*t, triangle, entersAt(*context.mesh, triangle, context.ray)});
  }
  arguments->valid[0] = 0;
}

/// Of the ray with the triangles that a line from `start` on meets.
void collectCrossings(RTCScene scene, const TriangleMesh& mesh, const DoubleRay& ray, Double3 start, double end,
                      CrossingList& crossings) {
  CollectContext context;
  initContext(context);
  context.mesh = &mesh;
  context.ray = ray;
  context.crossings = &crossings;
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(start.x);
  query.ray.org_y = static_cast<float>(start.y);
  query.ray.org_z = static_cast<float>(start.z);
  query.ray.dir_x = static_cast<float>(ray.direction.x);
  query.ray.dir_y = static_cast<float>(ray.direction.y);
  query.ray.dir_z = static_cast<float>(ray.direction.z);
  query.ray.tnear = 0;
  query.ray.tfar = floatAbove(end);
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersectRay(scene, context, query);
}

/// A line through an edge meets both triangles of it: of neighbours crossed in the same direction at all but the same
/// distance the first counts.
std::span<Crossing> sortAndMerge(std::span<Crossing> all, const TriangleMesh& mesh, double slack) {
  std::sort(all.begin(), all.end());
  std::size_t kept = 0;
  for (const Crossing& next : all) {
    bool isRepeated = false;
    for (std::size_t i = kept; i-- > 0 && next.t - all[i].t <= slack && !isRepeated;) {
      isRepeated = all[i].triangle == next.triangle ||
                   (all[i].entering == next.entering && areNeighbours(mesh, all[i].triangle, next.triangle));
    }
    if (!isRepeated) all[kept++] = next;
  }
  return all.first(kept);
}

bool addsUp(std::span<const Crossing> crossings, bool isOriented) {
  if (!isOriented) return crossings.size() % 2 == 0;
  const auto entries = std::ranges::count_if(crossings, [](const Crossing& c) { return c.entering; });
  return 2 * static_cast<std::size_t>(entries) == crossings.size();
}

bool pairByParity(std::span<const Crossing> crossings, IntervalSink& intervals) {
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    if (crossings[i].t < crossings[i + 1].t) intervals.add({crossings[i].t, crossings[i + 1].t});
  }
  return crossings.size() % 2 == 0;
}

/// Inside where the winding number is not zero. Where the numbers do not add up to zero, only what is certain on the
/// way: each entry with the next exit.
bool pairByWinding(std::span<const Crossing> crossings, IntervalSink& intervals) {
  if (addsUp(crossings, true)) {
    int winding = 0;
    double begin = 0;
    for (const Crossing& crossing : crossings) {
      if (winding == 0) begin = crossing.t;
      winding += crossing.entering ? 1 : -1;
      if (winding == 0 && begin < crossing.t) intervals.add({begin, crossing.t});
    }
    return true;
  }
  const Crossing* entry = nullptr;
  for (const Crossing& crossing : crossings) {
    if (crossing.entering) {
      if (!entry) entry = &crossing;
    } else if (entry) {
      if (entry->t < crossing.t) intervals.add({entry->t, crossing.t});
      entry = nullptr;
    }
  }
  return false;
}

Diagnostic makeError(std::string message) { return {Severity::error, {}, std::move(message), {}, {}}; }

}  // namespace

MeshTopology examine(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> corner = weldedCorners(mesh);
  struct Uses {
    int forward = 0, backward = 0;
  };
  std::unordered_map<std::uint64_t, Uses> edges;
  for (const auto& triangle : mesh.triangles) {
    const std::uint32_t c[3] = {corner[triangle[0]], corner[triangle[1]], corner[triangle[2]]};
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = c[i], b = c[(i + 1) % 3];
      Uses& uses = edges[edgeKey(a, b)];
      ++(a < b ? uses.forward : uses.backward);
    }
  }
  MeshTopology topology;
  for (const auto& [key, uses] : edges) {
    const int count = uses.forward + uses.backward;
    if (count == 1) ++topology.openEdges;
    if (count == 2 && uses.forward != uses.backward) ++topology.flippedEdges;
    if (count > 2) ++topology.crowdedEdges;
  }
  return topology;
}

MeshVolume::MeshVolume(std::unique_ptr<const Data> data) : data_(std::move(data)) {}
MeshVolume::~MeshVolume() = default;
Box<World> MeshVolume::worldBounds() const { return data_->bounds; }
Box<Object> MeshVolume::objectBounds() const { return data_->objectBounds; }

Result<std::unique_ptr<const VolumeShape>> MeshVolume::make(TriangleMesh mesh,
                                                            const Transform<World, Object>& toWorld) {
  if (auto defect = findDefect(mesh)) return makeError(*defect);
  if (mesh.triangles.empty()) return makeError("the mesh has no triangles");
  auto data = std::make_unique<Data>();
  for (const Point<World>& p : mesh.positions) data->objectBounds.extend(Point<Object>(p.x, p.y, p.z));
  transformMesh(mesh, toWorld);
  if (auto defect = findDefect(mesh)) return makeError(*defect);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) data->bounds.extend(mesh.positions[corner]);
  }
  data->topology = examine(mesh);
  data->mesh = std::move(mesh);
  TriangleMesh& kept = data->mesh;
  kept.positions.reserve(kept.positions.size() + 1);

  data->device = rtcNewDevice("threads=1");
  if (!data->device) return makeError("Embree cannot be started");
  data->scene = rtcNewScene(data->device);
  rtcSetSceneFlags(data->scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(data->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, kept.positions.data(), 0,
                             sizeof(Point<World>), kept.positions.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, kept.triangles.data(), 0,
                             sizeof(kept.triangles[0]), kept.triangles.size());
  rtcSetGeometryIntersectFilterFunction(geometry, collect);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(data->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(data->scene);
  if (rtcGetDeviceError(data->device) != RTC_ERROR_NONE)
    return makeError("Embree cannot build the mesh: out of memory");
  return {std::unique_ptr<const VolumeShape>(new MeshVolume(std::move(data)))};
}

/// Embree looks from just before the bounds on, in float; which triangles are crossed is its (watertight) decision,
/// where is computed in double from the ray itself. So a camera a million sizes away sees the same volume.
///
/// Lines through vertices and along faces may count a crossing once too often or too rarely. Where a closed mesh's
/// crossings do not add up, the triangles are chosen once more by parallel lines a hair away, in general position.
bool MeshVolume::intersect(const Ray<World>& ray, IntervalSink& intervals) const {
  constexpr int attempts = 4;
  const DoubleRay exact{toDouble(ray.origin), toDouble(ray.direction)};
  const Double3 lower = toDouble(data_->bounds.lower), upper = toDouble(data_->bounds.upper);
  const double size = length(upper - lower), speed = length(exact.direction);
  const double closest = dot((lower + upper) * 0.5 - exact.origin, exact.direction) / (speed * speed);
  const Double3 start = exact.origin + exact.direction * (closest - size / speed);
  const double reach = size + length(start);
  const Frame<World> frame(toFloat<Vector<World>>(exact.direction * (1 / speed)));
  std::span<const Crossing> sorted;
  CrossingList crossings;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    crossings = {};
    const double nudge = attempt * reach * 0x1p-21;
    collectCrossings(data_->scene, data_->mesh, exact,
                     start + toDouble(frame.x * std::cos(2.4f * static_cast<float>(attempt)) +
                                      frame.y * std::sin(2.4f * static_cast<float>(attempt))) *
                                 nudge,
                     2.0001 * size / speed, crossings);
    sorted = sortAndMerge(crossings.all(), data_->mesh, reach * 0x1p-18 / speed);
    if (!data_->topology.isClosed() || addsUp(sorted, data_->topology.isOriented())) break;
  }
  return data_->topology.isOriented() ? pairByWinding(sorted, intervals) : pairByParity(sorted, intervals);
}

}  // namespace aerosol::accel
