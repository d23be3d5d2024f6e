#include <algorithm>

#include "core/accel/scene_data.h"

namespace aerosol::accel {

namespace {

/// Where and how a ray meets a surface, of which the key is known.
SurfaceHit describe(const Surface& surface, const Ray<World>& ray, const HitKey& key) {
  const DoubleRay exact{toDouble(ray.origin), toDouble(ray.direction)};
  if (surface.curves) return describeHit(*surface.curves, key.primitive, exact, key.t);
  const MeshSurface* const mesh = surface.restingMesh();
  const auto standing = [&](const DoubleRay& r) {
    return mesh ? describeHit(*mesh, key.primitive, r, key.t) : describeHit(*surface.analytic, r, key.t);
  };
  if (surface.restsInWorld()) [[likely]]
    return standing(exact);
  const Transform<World, Object> placement = *surface.placement(ray.time);
  SurfaceHit hit = placeHit(standing(takeBack(placement, exact)), mesh, placement);
  hit.object = key.object;
  hit.passThrough = key.passThrough;
  return hit;
}

class Query;

/// What Embree hands to every callback.
struct QueryContext : EmbreeContext {
  Query* query = nullptr;
};

/// One running query.
///
/// Embree decides *whether* a triangle is hit, watertight and in float; *where* is computed here in double. A candidate
/// that beats the best one so far is accepted, but Embree's far end is set not to its distance but a little behind
/// (`slack_`, several times the error of Embree's own distances), so whatever might be nearer or equal in double is
/// still offered: the winner is the smallest HitKey of all and does not depend on the order of traversal.
///
/// A ray through an edge is reported by Embree for both triangles (it is generous there, so that no ray slips through).
/// That is one crossing of the surface, and whoever counts entries and exits must see one: of neighbouring triangles
/// crossed in the same direction at all but the same distance only the first counts.
///
/// A volume primitive is never a hit: its callback records a span and leaves the ray as it is. The spans are cut at the
/// hit when traversal is over.
class Query {
 public:
  Query(const SceneData& scene, const Ray<World>& ray, SpanBuffer& spans, Counters& counters, const HitKey* after)
      : scene_(scene),
        ray_(ray),
        exact_{toDouble(ray.origin), toDouble(ray.direction)},
        after_(after),
        begin_(std::fmax(static_cast<double>(ray.tMin), after ? after->t : 0)),
        end_(static_cast<double>(ray.tMax)),
        spans_(spans),
        counters_(counters) {
    initContext(context_);
    context_.query = this;
    spans.clear();
    if (!scene.shutter.isInstant()) {
      const float time = (ray.time - scene.shutter.open) / (scene.shutter.close - scene.shutter.open);
      embreeTime_ = std::clamp(time, 0.0f, 1.0f);
    }
    double reach = 0;
    if (!scene.bounds.isEmpty()) {
      const Double3 lower = toDouble(scene.bounds.lower), upper = toDouble(scene.bounds.upper);
      reach = length(upper - lower) + length(exact_.origin - lower);
    }
    slack_ = reach * 0x1p-20;
    edgeSlack_ = reach * 0x1p-16;
  }

  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  static Query& of(EmbreeContext* context) { return *static_cast<QueryContext*>(context)->query; }

  bool isValid() const {
    const Double3 o = exact_.origin, d = exact_.direction;
    // Embree squares coordinates; geometry ends long before.
    constexpr double farthest = 1e18;
    return dot(o, o) < farthest * farthest && std::isfinite(dot(d, d)) && dot(d, d) > 0 && !std::isnan(ray_.tMin) &&
           !std::isnan(ray_.tMax);
  }
  bool isEmpty() const { return !(begin_ < end_); }
  /// From now on there is nothing else.
  void restrictTo(ObjectId object) { only_ = object; }
  /// From now on surfaces that are visible to none of these kinds are not there.
  void lookAs(std::uint32_t kinds) { kinds_ = kinds; }

  void findClosest() {
    recordUnbounded();
    RTCRayHit embreeRay;
    embreeRay.ray = makeRay();
    embreeRay.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    embreeRay.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersectRay(scene_.scene, context_, embreeRay);
    finishSpans(hasBest_ ? best_.t : end_);
  }

  bool findOccluder(InterfaceBuffer& interfaces) {
    interfaces.clear();
    interfaces_ = &interfaces;
    recordUnbounded();
    RTCRay embreeRay = makeRay();
    occludeRay(scene_.scene, context_, embreeRay);
    if (embreeRay.tfar < 0) {
      spans_.clear();
      interfaces.clear();
      return true;
    }
    finishSpans(end_);
    std::ranges::sort(interfaces);
    mergeRepeated(interfaces);
    return false;
  }

  /// Whether the hit is now the best one.
  bool offer(const HitKey& key) {
    if (!isInRange(key) || (only_ && key.object != *only_)) return false;
    if (!scene_.visibleTo.empty() && !(scene_.visibleTo[key.object] & kinds_)) return false;
    if (hasBest_ && !(key < best_)) {
      nextT_ = std::fmin(nextT_, key.t);
      return false;
    }
    if (hasBest_) nextT_ = std::fmin(nextT_, best_.t);
    best_ = key;
    hasBest_ = true;
    return true;
  }

  /// Whether the hit blocks a shadow ray; one that does not is recorded.
  template <class Entering>
  bool offerShadow(const HitKey& key, Entering&& entering) {
    if (!isInRange(key)) return false;
    if (!key.passThrough && !(key.object < scene_.shadowsPass.size() && scene_.shadowsPass[key.object])) return true;
    interfaces_->push_back({key, entering()});
    return false;
  }

  void record(VolumeId volume) {
    if (only_) return;
    ++counters_.volumeTests;
    Recorder recorder(*this, volume);
    if (!scene_.volumes[volume]->intersect(ray_, recorder)) ++counters_.openVolumes;
  }

  float embreeFar() const { return floatAbove((hasBest_ ? best_.t : end_) + slack_ - shift_); }
  /// The ray in the space of the triangles that are being asked for.
  const DoubleRay& exactRay() const { return *current_; }
  float time() const { return ray_.time; }
  Counters& counters() { return counters_; }

  /// The key of a hit on the mesh that is being asked for.
  HitKey keyOf(const MeshSurface& surface, std::uint32_t triangle, double t) const {
    if (instance_) return {t, instance_->passThrough, instance_->object, triangle};
    return {t, surface.passThrough, surface.object, triangle};
  }

  /// Calls `ask(embreeRay, context)` with the ray in the space where a mesh rests, near to the mesh.
  template <class Ask>
  void whereItRests(const Transform<World, Object>& placement, const Box<World>& atRest, Ask&& ask) {
    const DoubleRay back = takeBack(placement, exact_);
    const double speed = length(back.direction), outerSlack = slack_;
    const Double3 lower = toDouble(atRest.lower), upper = toDouble(atRest.upper);
    current_ = &back;
    shift_ = std::fmax(nearestDistance(back, atRest) - length(upper - lower) / speed, 0);
    const Double3 start = back.origin + back.direction * shift_;
    slack_ = std::fmax(slack_, (length(upper - lower) + length(start - lower) + length(lower)) / speed * 0x1p-20);
    RTCRay r = makeRay();
    r.org_x = static_cast<float>(start.x);
    r.org_y = static_cast<float>(start.y);
    r.org_z = static_cast<float>(start.z);
    r.dir_x = static_cast<float>(back.direction.x);
    r.dir_y = static_cast<float>(back.direction.y);
    r.dir_z = static_cast<float>(back.direction.z);
    r.tnear = std::fmax(floatBelow(begin_ - slack_ - shift_), 0.0f);
    QueryContext context;
    initContext(context);
    context.query = this;
    if (r.tnear <= r.tfar) ask(r, context);
    current_ = &exact_;
    shift_ = 0;
    slack_ = outerSlack;
  }
  /// The same with a shared mesh.
  template <class Ask>
  void inInstance(const MeshInstance& instance, Ask&& ask) {
    if (only_ && instance.object != *only_) return;
    instance_ = &instance;
    whereItRests(instance.toWorld, instance.shared->bounds, ask);
    instance_ = nullptr;
  }
  const SceneData& scene() const { return scene_; }

  std::optional<SurfaceHit> hit() const {
    if (!hasBest_) return {};
    SurfaceHit hit = describe(scene_.surfaces[best_.object], ray_, best_);
    hit.hasCompany = nextT_ - best_.t <= slack_;
    return hit;
  }

 private:
  /// Cuts intervals to the ray and keeps them as spans.
  class Recorder final : public IntervalSink {
   public:
    Recorder(Query& query, VolumeId volume) : query_(query), volume_(volume) {}
    void add(const Interval& interval) override {
      const double t0 = std::fmax(interval.t0, query_.begin_), t1 = std::fmin(interval.t1, query_.end_);
      if (t0 < t1) query_.spans_.push_back({t0, t1, volume_});
    }

   private:
    Query& query_;
    VolumeId volume_;
  };

  bool isInRange(const HitKey& key) const {
    const bool isBehindStart = after_ ? key > *after_ && key.t > static_cast<double>(ray_.tMin) : key.t > begin_;
    return isBehindStart && key.t < end_ && !(after_ && isRepeated(key, *after_));
  }

  /// Whether `key` is the same crossing as the earlier `first`.
  bool isRepeated(const HitKey& key, const HitKey& first) const {
    if (key.object != first.object || key.t - first.t > edgeSlack_) return false;
    if (key.primitive == first.primitive) return key.t == first.t;
    const Surface& surface = scene_.surfaces[key.object];
    if (surface.curves) return false;
    const TriangleMesh& mesh = surface.restingMesh()->mesh;
    if (!areNeighbours(mesh, key.primitive, first.primitive)) return false;
    if (surface.restsInWorld()) return entersAt(mesh, key.primitive, exact_) == entersAt(mesh, first.primitive, exact_);
    const DoubleRay back = takeBack(*surface.placement(ray_.time), exact_);
    return entersAt(mesh, key.primitive, back) == entersAt(mesh, first.primitive, back);
  }

  /// Drops every interface that repeats the last kept one of its object.
  void mergeRepeated(InterfaceBuffer& interfaces) const {
    std::size_t kept = 0;
    for (const Interface& next : interfaces) {
      std::size_t last = kept;
      while (last > 0 && interfaces[last - 1].key.object != next.key.object &&
             next.key.t - interfaces[last - 1].key.t <= edgeSlack_) {
        --last;
      }
      if (last == 0 || !isRepeated(next.key, interfaces[last - 1].key)) interfaces[kept++] = next;
    }
    interfaces.resize(kept);
  }

  RTCRay makeRay() const {
    RTCRay r{};
    r.org_x = ray_.origin.x;
    r.org_y = ray_.origin.y;
    r.org_z = ray_.origin.z;
    r.dir_x = ray_.direction.x;
    r.dir_y = ray_.direction.y;
    r.dir_z = ray_.direction.z;
    r.tnear = std::fmax(floatBelow(begin_ - slack_), 0.0f);
    r.tfar = embreeFar();
    r.time = embreeTime_;
    r.mask = ~0u;
    return r;
  }

  void recordUnbounded() {
    if (scene_.overlap == OverlapDesign::partition) return;
    for (const VolumeId volume : scene_.unbounded) record(volume);
  }

  void finishSpans(double end) {
    std::erase_if(spans_, [&](const Span& span) { return span.t0 >= end; });
    for (Span& span : spans_) span.t1 = std::fmin(span.t1, end);
    std::ranges::sort(spans_,
                      [](const Span& a, const Span& b) { return a.t0 != b.t0 ? a.t0 < b.t0 : a.volume < b.volume; });
    const auto repeated = std::ranges::unique(spans_);
    spans_.erase(repeated.begin(), repeated.end());
    counters_.spans += spans_.size();
  }

  QueryContext context_;
  const SceneData& scene_;
  const Ray<World>& ray_;
  DoubleRay exact_;
  const DoubleRay* current_ = &exact_;
  const MeshInstance* instance_ = nullptr;  ///< Whose mesh is being asked for; null: one that nothing shares.
  double shift_ = 0;                        ///< Of Embree's distances.
  float embreeTime_ = 0;
  const HitKey* after_;
  double begin_, end_;
  double slack_ = 0, edgeSlack_ = 0;
  HitKey best_;
  double nextT_ = std::numeric_limits<double>::infinity();  ///< Of the nearest hit offered but for the best one.
  bool hasBest_ = false;
  std::optional<ObjectId> only_;
  std::uint32_t kinds_ = ~0u;
  SpanBuffer& spans_;
  InterfaceBuffer* interfaces_ = nullptr;
  Counters& counters_;
};

}  // namespace

namespace {

/// Whether a query of a mesh alone finds a hit.
bool isMet(RTCScene mesh, const RTCRay& ray, EmbreeContext& context) {
  RTCRayHit embreeRay{};
  embreeRay.ray = ray;
  embreeRay.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  embreeRay.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersectRay(mesh, context, embreeRay);
  return embreeRay.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

}  // namespace

void acceptTriangle(const RTCFilterFunctionNArguments* arguments) {
  Query& query = Query::of(arguments->context);
  const auto& surface = *static_cast<const MeshSurface*>(arguments->geometryUserPtr);
  const std::uint32_t triangle = RTCHitN_primID(arguments->hit, arguments->N, 0);
  const auto t = planeDistance(surface.mesh, triangle, query.exactRay());
  if (!t || !query.offer(query.keyOf(surface, triangle, *t))) {
    arguments->valid[0] = 0;
    return;
  }
  RTCRayN_tfar(arguments->ray, arguments->N, 0) = query.embreeFar();
}

void acceptShadowTriangle(const RTCFilterFunctionNArguments* arguments) {
  Query& query = Query::of(arguments->context);
  const auto& surface = *static_cast<const MeshSurface*>(arguments->geometryUserPtr);
  const std::uint32_t triangle = RTCHitN_primID(arguments->hit, arguments->N, 0);
  const auto t = planeDistance(surface.mesh, triangle, query.exactRay());
  const auto entering = [&] { return entersAt(surface.mesh, triangle, query.exactRay()); };
  if (!t || !query.offerShadow(query.keyOf(surface, triangle, *t), entering)) {
    arguments->valid[0] = 0;
  }
}

namespace {

/// Fibres are met from outside alone: what they let through is told by their material, and where it comes in.
bool leavesFibre(const RTCFilterFunctionNArguments* arguments, const DoubleRay& ray) {
  const Double3 normal{static_cast<double>(RTCHitN_Ng_x(arguments->hit, arguments->N, 0)),
                       static_cast<double>(RTCHitN_Ng_y(arguments->hit, arguments->N, 0)),
                       static_cast<double>(RTCHitN_Ng_z(arguments->hit, arguments->N, 0))};
  return dot(normal, ray.direction) > 0;
}

}  // namespace

/// Of fibres Embree knows the distance best.
void acceptCurve(const RTCFilterFunctionNArguments* arguments) {
  Query& query = Query::of(arguments->context);
  const auto& surface = *static_cast<const CurveSurface*>(arguments->geometryUserPtr);
  const std::uint32_t segment = RTCHitN_primID(arguments->hit, arguments->N, 0);
  const auto t = static_cast<double>(RTCRayN_tfar(arguments->ray, arguments->N, 0));
  if (leavesFibre(arguments, query.exactRay()) || isOwnStart(surface, segment, query.exactRay(), t) ||
      !query.offer({t, surface.passThrough, surface.object, segment})) {
    arguments->valid[0] = 0;
    return;
  }
  RTCRayN_tfar(arguments->ray, arguments->N, 0) = query.embreeFar();
}

void acceptShadowCurve(const RTCFilterFunctionNArguments* arguments) {
  Query& query = Query::of(arguments->context);
  const auto& surface = *static_cast<const CurveSurface*>(arguments->geometryUserPtr);
  const std::uint32_t segment = RTCHitN_primID(arguments->hit, arguments->N, 0);
  const auto t = static_cast<double>(RTCRayN_tfar(arguments->ray, arguments->N, 0));
  const auto entering = [] { return true; };
  if (leavesFibre(arguments, query.exactRay()) || isOwnStart(surface, segment, query.exactRay(), t) ||
      !query.offerShadow({t, surface.passThrough, surface.object, segment}, entering)) {
    arguments->valid[0] = 0;
  }
}

void intersectAnalytic(const RTCIntersectFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  Query& query = Query::of(arguments->context);
  const AnalyticSurface& surface = *query.scene().analytic[arguments->primID];
  const Crossings crossings = intersect(surface, query.exactRay());
  for (int i = 0; i < crossings.count; ++i) {
    if (!query.offer({crossings.t[i], surface.passThrough, surface.object, 0})) continue;
    RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0) = query.embreeFar();
    RTCHitN_geomID(RTCRayHitN_HitN(arguments->rayhit, arguments->N), arguments->N, 0) = arguments->geomID;
  }
}

void occludeAnalytic(const RTCOccludedFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  Query& query = Query::of(arguments->context);
  const AnalyticSurface& surface = *query.scene().analytic[arguments->primID];
  const Crossings crossings = intersect(surface, query.exactRay());
  for (int i = 0; i < crossings.count; ++i) {
    const double t = crossings.t[i];
    const auto entering = [&] { return entersAt(surface, query.exactRay(), t); };
    if (!query.offerShadow({t, surface.passThrough, surface.object, 0}, entering)) continue;
    RTCRayN_tfar(arguments->ray, arguments->N, 0) = -std::numeric_limits<float>::infinity();
    return;
  }
}

void recordVolume(const RTCIntersectFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  Query& query = Query::of(arguments->context);
  query.record(query.scene().bounded[arguments->primID]);
}

void recordShadowVolume(const RTCOccludedFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  Query& query = Query::of(arguments->context);
  query.record(query.scene().bounded[arguments->primID]);
}

void intersectInstance(const RTCIntersectFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  Query& query = Query::of(arguments->context);
  const MeshInstance& instance = *query.scene().instances[arguments->primID];
  bool isHit = false;
  query.inInstance(instance, [&](const RTCRay& ray, EmbreeContext& context) {
    isHit = isMet(instance.shared->scene, ray, context);
  });
  if (!isHit) return;
  RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0) = query.embreeFar();
  RTCHitN_geomID(RTCRayHitN_HitN(arguments->rayhit, arguments->N), arguments->N, 0) = arguments->geomID;
}

void occludeInstance(const RTCOccludedFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  Query& query = Query::of(arguments->context);
  const MeshInstance& instance = *query.scene().instances[arguments->primID];
  bool isBlocked = false;
  query.inInstance(instance, [&](RTCRay ray, EmbreeContext& context) {
    occludeRay(instance.shared->scene, context, ray);
    isBlocked = ray.tfar < 0;
  });
  if (isBlocked) RTCRayN_tfar(arguments->ray, arguments->N, 0) = -std::numeric_limits<float>::infinity();
}

void intersectMoving(const RTCIntersectFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  Query& query = Query::of(arguments->context);
  const Surface& surface = query.scene().surfaces[query.scene().movingSurfaces[arguments->primID]];
  ++query.counters().movingSurfaceTests;
  bool isHit = false;
  if (surface.mesh) {
    const Transform<World, Object> placement = surface.motion->placement.at(query.time());
    query.whereItRests(placement, surface.motion->atRest, [&](const RTCRay& ray, EmbreeContext& context) {
      isHit = isMet(surface.motion->mesh, ray, context);
    });
  } else {
    const DoubleRay back = takeBack(surface.motion->placement.at(query.time()), query.exactRay());
    const Crossings crossings = intersect(*surface.analytic, back);
    for (int i = 0; i < crossings.count; ++i) {
      const bool isBest = query.offer({crossings.t[i], surface.analytic->passThrough, surface.analytic->object, 0});
      isHit = isHit || isBest;
    }
  }
  if (!isHit) return;
  RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0) = query.embreeFar();
  RTCHitN_geomID(RTCRayHitN_HitN(arguments->rayhit, arguments->N), arguments->N, 0) = arguments->geomID;
}

void occludeMoving(const RTCOccludedFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  Query& query = Query::of(arguments->context);
  const Surface& surface = query.scene().surfaces[query.scene().movingSurfaces[arguments->primID]];
  ++query.counters().movingSurfaceTests;
  bool isBlocked = false;
  if (surface.mesh) {
    const Transform<World, Object> placement = surface.motion->placement.at(query.time());
    query.whereItRests(placement, surface.motion->atRest, [&](RTCRay ray, EmbreeContext& context) {
      occludeRay(surface.motion->mesh, context, ray);
      isBlocked = ray.tfar < 0;
    });
  } else {
    const DoubleRay back = takeBack(surface.motion->placement.at(query.time()), query.exactRay());
    const Crossings crossings = intersect(*surface.analytic, back);
    for (int i = 0; i < crossings.count && !isBlocked; ++i) {
      const double t = crossings.t[i];
      const auto entering = [&] { return entersAt(*surface.analytic, back, t); };
      isBlocked = query.offerShadow({t, surface.analytic->passThrough, surface.analytic->object, 0}, entering);
    }
  }
  if (isBlocked) RTCRayN_tfar(arguments->ray, arguments->N, 0) = -std::numeric_limits<float>::infinity();
}

void recordMovingVolume(const RTCIntersectFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  Query& query = Query::of(arguments->context);
  ++query.counters().movingVolumeTests;
  query.record(query.scene().movingVolumes[arguments->primID]);
}

void recordMovingShadowVolume(const RTCOccludedFunctionNArguments* arguments) {
  if (!arguments->valid[0]) return;
  Query& query = Query::of(arguments->context);
  ++query.counters().movingVolumeTests;
  query.record(query.scene().movingVolumes[arguments->primID]);
}

std::optional<SurfaceHit> Scene::closestHit(const Ray<World>& ray, SpanBuffer& spans, Counters& counters,
                                            const HitKey* after, std::uint32_t kinds) const {
  const PhaseScope phase(counters.phase, Phase::tracing);
  ++counters.closestHitQueries;
  Query query(*data_, ray, spans, counters, after);
  query.lookAs(kinds);
  if (!query.isValid()) {
    ++counters.invalidRays;
    return {};
  }
  if (query.isEmpty()) return {};
  query.findClosest();
  return query.hit();
}

std::optional<SurfaceHit> Scene::closestHitOn(ObjectId object, const Ray<World>& ray, Counters& counters) const {
  const PhaseScope phase(counters.phase, Phase::tracing);
  ++counters.closestHitQueries;
  SpanBuffer none;
  Query query(*data_, ray, none, counters, nullptr);
  if (!query.isValid()) {
    ++counters.invalidRays;
    return {};
  }
  if (query.isEmpty()) return {};
  query.restrictTo(object);
  query.findClosest();
  return query.hit();
}

bool Scene::occluded(const Ray<World>& ray, SpanBuffer& spans, InterfaceBuffer& interfaces, Counters& counters) const {
  const PhaseScope phase(counters.phase, Phase::tracing);
  ++counters.occlusionQueries;
  interfaces.clear();
  Query query(*data_, ray, spans, counters, nullptr);
  if (!query.isValid()) {
    ++counters.invalidRays;
    return false;
  }
  if (query.isEmpty()) return false;
  return query.findOccluder(interfaces);
}

Counters& Counters::operator+=(const Counters& other) {
  closestHitQueries += other.closestHitQueries;
  occlusionQueries += other.occlusionQueries;
  volumeTests += other.volumeTests;
  spans += other.spans;
  movingSurfaceTests += other.movingSurfaceTests;
  movingVolumeTests += other.movingVolumeTests;
  openVolumes += other.openVolumes;
  invalidRays += other.invalidRays;
  return *this;
}

Scene::Scene(std::unique_ptr<SceneData> data) : data_(std::move(data)) {}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

Box<World> Scene::bounds() const { return data_->bounds; }
ObjectId Scene::objectCount() const { return static_cast<ObjectId>(data_->surfaces.size()); }
VolumeId Scene::volumeCount() const { return static_cast<VolumeId>(data_->volumes.size()); }
const TriangleMesh* Scene::mesh(ObjectId object) const {
  const MeshSurface* const mesh = data_->surfaces[object].restingMesh();
  return mesh ? &mesh->mesh : nullptr;
}
const Transform<World, Object>* Scene::sharedPlacement(ObjectId object) const {
  const auto& instance = data_->surfaces[object].instance;
  return instance ? &instance->toWorld : nullptr;
}
SurfaceHit Scene::hitAt(const Ray<World>& ray, const HitKey& key) const {
  return describe(data_->surfaces[key.object], ray, key);
}

Box<World> Scene::surfaceBounds(ObjectId object) const {
  const Surface& surface = data_->surfaces[object];
  if (surface.analytic) return surface.analytic->worldBounds();
  if (surface.instance) return surface.instance->worldBounds();
  if (surface.curves) return surface.curves->worldBounds();
  Box<World> box;
  for (const auto& triangle : surface.mesh->mesh.triangles) {
    for (const std::uint32_t corner : triangle) box.extend(surface.mesh->mesh.positions[corner]);
  }
  return box;
}
const VolumeShape& Scene::volume(VolumeId volume) const { return *data_->volumes[volume]; }
const std::string& Scene::isa() const { return data_->isa; }
OverlapDesign Scene::overlapDesign() const { return data_->overlap; }
const PartitionStatistics& Scene::partitionStatistics() const { return data_->partition.statistics(); }

void Scene::refinePartition(std::span<const Box<World>> occupied, const EmptinessTest& isEmpty) {
  if (data_->overlap != OverlapDesign::partition) return;
  std::vector<PartitionItem> items;
  for (const VolumeId volume : data_->bounded) items.push_back({volume, occupied[volume]});
  data_->partition = VolumePartition(items, isEmpty);
}

}  // namespace aerosol::accel
