#include "core/render/moving_light.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace aerosol::render {

namespace {

/// Lights are written in world space; the one that stands still takes the space that moves for the world.
template <class T>
Point<T> pointAs(Point<World> p) {
  return {p.x, p.y, p.z};
}
Point<World> asWorld(Point<Object> p) { return {p.x, p.y, p.z}; }
Normal<World> asWorld(Normal<Object> n) { return {n.x, n.y, n.z}; }

Vector<World> asVector(Normal<World> n) { return {n.x, n.y, n.z}; }

/// One instant of the motion.
class Instant {
 public:
  explicit Instant(const Transform<World, Object>& place) : place_(place), back_(place.inverse()) {}

  Point<World> toLocal(Point<World> p) const { return asWorld(back_(p)); }
  Vector<World> toLocal(Vector<World> d) const {
    const Vector<Object> v = back_(d);
    return normalize(Vector<World>{v.x, v.y, v.z});
  }
  Normal<World> toLocal(Normal<World> n) const { return normalize(asWorld(back_(n))); }
  Point<World> toWorld(Point<World> p) const { return place_(pointAs<Object>(p)); }
  Normal<World> toWorld(Normal<World> n) const { return normalize(scaled(n)); }

  LightHit toLocal(const LightHit& hit) const {
    LightHit local = hit;
    local.point = toLocal(hit.point);
    local.normal = toLocal(hit.normal);
    local.direction = toLocal(hit.direction);
    return local;
  }

  /// Area in the world over that in the moving space, of a surface with this unit normal there.
  double areaScale(Normal<World> local) const {
    return std::fabs(determinant()) * static_cast<double>(length(asVector(scaled(local))));
  }
  /// Of lengths, in the mean over directions.
  double lengthScale() const { return std::cbrt(std::fabs(determinant())); }

 private:
  Normal<World> scaled(Normal<World> n) const { return place_(Normal<Object>{n.x, n.y, n.z}); }
  double determinant() const {
    const Matrix4& m = place_.matrix();
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  }

  Transform<World, Object> place_;
  Transform<Object, World> back_;
};

/// What a density per solid angle is divided by to be one per area.
double areaPerAngle(Point<World> from, Point<World> point, Normal<World> normal) {
  double squared = 0, facing = 0;
  for (int i = 0; i < 3; ++i) {
    const double d = static_cast<double>(point[i]) - static_cast<double>(from[i]);
    squared += d * d;
    facing += d * static_cast<double>(normal[i]);
  }
  const double cosine = std::fabs(facing) / std::sqrt(squared);
  return cosine > 0 ? squared / cosine : 0;
}

class MovingLight final : public Light {
 public:
  MovingLight(std::unique_ptr<const Light> atRest, const MovingTransform<World, Object>& placement,
              const Shutter& shutter)
      : atRest_(std::move(atRest)), placement_(placement) {
    const std::size_t count = std::clamp<std::size_t>(4 * placement.motion().keys().size() + 1, 9, 65);
    for (std::size_t i = 0; i < count; ++i)
      looked_.emplace_back(placement.at(shutter.at(static_cast<float>(i) / static_cast<float>(count - 1))));
    findPlace();
  }

  std::optional<LightSample> sample(Point<World> from, const LightUniforms& u) const override {
    const Instant now = at(u.time);
    const Point<World> local = now.toLocal(from);
    return toWorld(now, from, local, atRest_->sample(local, u));
  }
  float pdf(Point<World> from, const LightHit& hit) const override {
    return pdfOf(from, hit, [&](Point<World> local, const LightHit& seen) { return atRest_->pdf(local, seen); });
  }
  Color emitted(const LightHit& hit) const override { return atRest_->emitted(at(hit.time).toLocal(hit)); }

  Color power(float sceneRadius) const override {
    return atRest_->power(sceneRadius) *
           static_cast<float>(isDelta() ? 1 : middle().lengthScale() * middle().lengthScale());
  }
  float importance(Point<World> at) const override {
    double sum = 0;
    for (const Instant& each : looked_) {
      const double seen = static_cast<double>(atRest_->importance(each.toLocal(at)));
      sum += isDelta() ? seen / (each.lengthScale() * each.lengthScale()) : seen;
    }
    return static_cast<float>(sum / static_cast<double>(looked_.size()));
  }
  std::optional<LightPlace> place() const override { return place_; }

  std::uint32_t partCount() const override { return atRest_->partCount(); }
  std::optional<LightBounds> partBounds(std::uint32_t part) const override {
    auto bounds = atRest_->partBounds(part);
    if (!bounds) return {};
    Box<World> swept;
    double scale = 0;
    for (const Instant& each : looked_) {
      for (int corner = 0; corner < 8; ++corner) {
        Point<World> p = bounds->box.lower;
        for (int i = 0; i < 3; ++i) {
          if (corner >> i & 1) p[i] = bounds->box.upper[i];
        }
        swept.extend(each.toWorld(p));
      }
      scale = std::max(scale, each.lengthScale());
    }
    bounds->box = swept;
    // It may turn: light may come from any of its sides.
    bounds->cosSpread = -1;
    if (!isDelta()) bounds->intensity *= static_cast<float>(scale * scale);
    return bounds;
  }
  std::optional<LightSample> samplePart(std::uint32_t part, Point<World> from, const LightUniforms& u) const override {
    const Instant now = at(u.time);
    const Point<World> local = now.toLocal(from);
    return toWorld(now, from, local, atRest_->samplePart(part, local, u));
  }
  float pdfPart(std::uint32_t part, Point<World> from, const LightHit& hit) const override {
    return pdfOf(from, hit,
                 [&](Point<World> local, const LightHit& seen) { return atRest_->pdfPart(part, local, seen); });
  }
  std::uint32_t partAt(const LightHit& hit) const override { return atRest_->partAt(hit); }
  bool isDelta() const override { return atRest_->isDelta(); }
  bool moves() const override { return true; }
  bool isInfinite() const override { return false; }

 private:
  Instant at(float time) const { return Instant(placement_.at(time)); }
  const Instant& middle() const { return looked_[looked_.size() / 2]; }

  /// Where its centre comes, with room for all of it. No ray is kept off its way: it is at no place for long.
  void findPlace() {
    const auto still = atRest_->place();
    if (!still) return;
    Box<World> way;
    for (const Instant& each : looked_) way.extend(each.toWorld(still->centre));
    LightPlace place{.centre = middle().toWorld(still->centre), .intensity = still->intensity};
    for (const Instant& each : looked_) {
      const float reach =
          length(each.toWorld(still->centre) - place.centre) + still->extent * static_cast<float>(each.lengthScale());
      place.extent = std::max(place.extent, reach);
    }
    if (!isDelta()) place.intensity *= static_cast<float>(middle().lengthScale() * middle().lengthScale());
    place_ = place;
  }

  std::optional<LightSample> toWorld(const Instant& now, Point<World> from, Point<World> local,
                                     const std::optional<LightSample>& found) const {
    if (!found) return {};
    LightSample placed = *found;
    placed.point = now.toWorld(found->point);
    const Vector<World> way = placed.point - from;
    placed.distance = length(way);
    if (!(placed.distance > 0)) return {};
    placed.direction = way * (1 / placed.distance);
    if (found->isDelta) {
      const auto before = static_cast<double>(squaredLength(found->point - local));
      placed.value *= static_cast<float>(before / static_cast<double>(squaredLength(way)));
      if (!isFinite(placed.value)) return {};
      return placed;
    }
    placed.normal = now.toWorld(found->normal);
    placed.pdf = static_cast<float>(static_cast<double>(found->pdf) / areaPerAngle(local, found->point, found->normal) /
                                    now.areaScale(found->normal) * areaPerAngle(from, placed.point, placed.normal));
    if (!(placed.pdf > 0) || !std::isfinite(placed.pdf)) return {};
    return placed;
  }

  template <class Pdf>
  float pdfOf(Point<World> from, const LightHit& hit, const Pdf& pdf) const {
    const Instant now = at(hit.time);
    const Point<World> local = now.toLocal(from);
    const LightHit seen = now.toLocal(hit);
    const double per = areaPerAngle(local, seen.point, seen.normal);
    const double density = static_cast<double>(pdf(local, seen)) / per / now.areaScale(seen.normal) *
                           areaPerAngle(from, hit.point, hit.normal);
    return per > 0 && std::isfinite(density) ? static_cast<float>(density) : 0.0f;
  }

  std::unique_ptr<const Light> atRest_;
  MovingTransform<World, Object> placement_;
  std::vector<Instant> looked_;  ///< At times spread evenly over the shutter.
  std::optional<LightPlace> place_;
};

}  // namespace

std::unique_ptr<const Light> makeMovingLight(std::unique_ptr<const Light> atRest,
                                             const MovingTransform<World, Object>& placement, const Shutter& shutter) {
  return std::make_unique<MovingLight>(std::move(atRest), placement, shutter);
}

}  // namespace aerosol::render
