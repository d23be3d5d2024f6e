#include "core/render/lamp_directions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/prepared_scene.h"
#include "core/render/warp.h"

namespace aerosol::render {

namespace {

constexpr double pi = std::numbers::pi;
constexpr float belowOne = 0x1.fffffep-1f;

/// Behind this optical depth a lamp hardly matters; short of it paths towards it do, as they are the ones that arrive.
constexpr float reach = 16;

bool contains(const Box<World>& box, Point<World> p) {
  for (int i = 0; i < 3; ++i) {
    if (!(p[i] >= box.lower[i] && p[i] <= box.upper[i])) return false;
  }
  return true;
}

bool mayScatter(const volume::Medium* medium) { return medium && medium->mayScatter && !medium->isHoldout; }

}  // namespace

// Inside the cone the density is that of its edge, so that it is continuous; both parts together integrate to one.
LampCone::LampCone(const LampInMedia& lamp, Point<World> from) {
  const Vector<World> way = lamp.centre - from;
  const double distance = static_cast<double>(length(way));
  axis_ = normalize(way);
  const double sine = std::clamp(static_cast<double>(lamp.extent) / distance, 1e-4, 1.0);
  edge_ = std::asin(sine);
  const double even = 2 * pi * (1 - std::cos(edge_)) * (pi - edge_) / sine, outside = pi * (pi - edge_) * (pi - edge_);
  inside_ = even / (even + outside);
  factor_ = 1 / (even + outside);
  evenPdf_ = factor_ * (pi - edge_) / sine;
}

Vector<World> LampCone::sample(std::array<float, 2> u) const {
  const double xi = static_cast<double>(u[0]), phi = 2 * pi * static_cast<double>(u[1]);
  double theta = 0;
  if (xi < inside_) {
    const double height = (1 - std::cos(edge_)) * xi / inside_;
    theta = 2 * std::asin(std::sqrt(0.5 * height));
  } else {
    theta = pi - (pi - edge_) * std::sqrt(1 - (xi - inside_) / (1 - inside_));
  }
  const double sine = std::sin(theta);
  return alongFrame(Frame<World>(axis_), {sine * std::cos(phi), sine * std::sin(phi), std::cos(theta)});
}

float LampCone::pdf(Vector<World> direction) const {
  // The sine of the half angle keeps its digits where the cosine has none.
  const double half = 0.5 * static_cast<double>(length(direction - axis_));
  const double theta = 2 * std::asin(std::min(half, 1.0));
  if (theta <= edge_) return static_cast<float>(evenPdf_);
  const double sine = std::sin(theta);
  return static_cast<float>(factor_ * (sine > 1e-9 ? (pi - theta) / sine : 1.0));
}

LampDirections::LampDirections(std::span<const LampInMedia> lamps, const LightSet& lights, Point<World> from,
                               float extinction, float meanCosine) {
  const double spread = largestShare * static_cast<double>(1 - std::min(std::fabs(meanCosine), 1.0f));
  for (const LampInMedia& lamp : lamps) {
    const float distance = length(lamp.centre - from);
    if (count_ == most || !lights.contains(lamp.light) || !(distance > 1.01f * lamp.extent)) continue;
    const double part = static_cast<double>(lights.probability(lamp.light, from)) * spread *
                        std::exp(-static_cast<double>(extinction * distance / reach));
    if (!(part > 1e-3)) continue;
    cones_[count_] = LampCone(lamp, from);
    shares_[count_++] = static_cast<float>(part);
    share_ += static_cast<float>(part);
  }
}

Vector<World> LampDirections::sample(std::array<float, 2> u) const {
  float rest = u[0] * share_;
  std::size_t i = 0;
  for (; i + 1 < count_ && rest >= shares_[i]; ++i) rest -= shares_[i];
  return cones_[i].sample({std::clamp(rest / shares_[i], 0.0f, belowOne), u[1]});
}

float LampDirections::pdf(Vector<World> direction) const {
  float sum = 0;
  for (std::size_t i = 0; i < count_; ++i) sum += shares_[i] * cones_[i].pdf(direction);
  return sum / share_;
}

std::vector<LampInMedia> findLampsInMedia(const PreparedScene& scene) {
  if (!scene.lights.tree().isEmpty() || scene.lights.placed().size() > LampDirections::most) return {};
  const auto isInMedia = [&](Point<World> p) {
    if (mayScatter(scene.cameraMedium)) return true;
    for (std::size_t id = 0; id < scene.volumes.size(); ++id) {
      const Box<World> box = scene.geometry->volume(static_cast<accel::VolumeId>(id)).worldBounds();
      if (mayScatter(scene.volumes[id]) && contains(box, p)) return true;
    }
    for (std::size_t id = 0; id < scene.objects.size(); ++id) {
      const PreparedObject& object = scene.objects[id];
      if (mayScatter(object.exterior)) return true;
      const bool isBody = mayScatter(object.body ? volume::mediumOf(*object.body) : object.interior) ||
                          (scene.nestsMedia && !object.isBoundary && !object.light);
      if (isBody && contains(scene.geometry->surfaceBounds(static_cast<accel::ObjectId>(id)), p)) return true;
    }
    return false;
  };
  std::vector<LampInMedia> lamps;
  for (const PlacedLight& placed : scene.lights.placed()) {
    if (!scene.lights[placed.index].isVolume() && isInMedia(placed.place.centre))
      lamps.push_back({placed.index, placed.place.centre, placed.place.extent});
  }
  return lamps;
}

}  // namespace aerosol::render
