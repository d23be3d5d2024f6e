#include "core/render/lights_along_ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aerosol::render {

namespace {

/// A point light that is met by a ray gets this part of the way through media as its radius.
constexpr double chosenRadius = 1e-4;

/// Places of a ray in float are no better than this.
constexpr double rounding = 0.5 * static_cast<double>(std::numeric_limits<float>::epsilon());

/// The falloff varies by this factor, or less: its samples are no better than others. By the second one or more: always
/// taken. Between the two at random, so that images have no seam.
constexpr double uselessVariation = 2, fullVariation = 8;

/// Optical depth of a tabulated cell up to which the table is as good as the extinction itself.
constexpr double fineDepth = 2;

}  // namespace

const LightsAlongRay& LightsAlongRay::none() {
  static const LightsAlongRay empty;
  return empty;
}

LightFromRay LightFromRay::of(const LightPlace& light, const Ray<World>& ray, const volume::RayStretches& stretches) {
  double along = 0, unit = 0, largest = 0;
  std::array<double, 3> toLight;
  for (int i = 0; i < 3; ++i) {
    const auto o = static_cast<double>(ray.origin[i]), c = static_cast<double>(light.centre[i]);
    const auto d = static_cast<double>(ray.direction[i]);
    toLight[static_cast<std::size_t>(i)] = c - o;
    along += (c - o) * d;
    unit += d * d;
    largest = std::max({largest, std::fabs(o), std::fabs(c)});
  }
  LightFromRay result;
  result.projection = along / unit;
  if (!light.cone.isWhole()) {
    const std::array<double, 3> direction{static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
                                          static_cast<double>(ray.direction.z)};
    result.inCone = insideCone(light.cone, toLight, direction);
  }
  double squared = 0;
  for (int i = 0; i < 3; ++i) {
    const double side =
        toLight[static_cast<std::size_t>(i)] - result.projection * static_cast<double>(ray.direction[i]);
    squared += side * side;
  }
  result.distance = std::sqrt(squared);
  result.keptDistance = std::max(result.distance, static_cast<double>(std::max(light.extent, light.radius)));
  if (!light.hasSingularity || light.radius > 0 || stretches.isEmpty()) return result;
  const double tolerance = rounding * (largest + std::fabs(result.projection));
  const bool isBeside =
      stretches.begin() > result.projection + tolerance || stretches.end() < result.projection - tolerance;
  if (isBeside || result.distance > tolerance) return result;
  const double length = stretches.end() - stretches.begin();
  result.isMet = true;
  result.keptDistance = std::max(result.distance, chosenRadius * (std::isfinite(length) ? length : 1.0));
  return result;
}

/// In [0, 1]: how the light varies over the stretches, of which `lit` are in its cone, as far as that makes samples of
/// it worth while.
double LightsAlongRay::chanceOf(const LightFromRay& seen, const volume::RayStretches& lit) const {
  if (lit.isEmpty()) return 0;
  double near = std::numeric_limits<double>::infinity(), far = 0;
  for (const volume::RayStretch& s : lit.all()) {
    const double a = s.a - seen.projection, b = s.b - seen.projection;
    near = std::min(near, a * b <= 0 ? 0 : std::min(std::fabs(a), std::fabs(b)));
    far = std::max({far, std::fabs(a), std::fabs(b)});
  }
  const double d2 = seen.keptDistance * seen.keptDistance;
  double variation = (d2 + far * far) / (d2 + near * near);
  if (&lit != &stretches_) variation *= stretches_.length() / lit.length();
  if (std::isnan(variation)) return 0;
  return std::clamp((variation - uselessVariation) / (fullVariation - uselessVariation), 0.0, 1.0);
}

LightsAlongRay::Candidate LightsAlongRay::candidate(const LightPlace& light) const {
  const LightFromRay seen = LightFromRay::of(light, ray_, stretches_);
  std::optional<volume::RayStretches> part;
  if (!light.cone.isWhole()) part = stretches_.within(seen.inCone.begin, seen.inCone.end);
  const volume::RayStretches& lit = part ? *part : stretches_;
  Candidate result;
  result.isMet = seen.isMet;
  result.chance = chanceOf(seen, lit);
  // Of one light alone no share is asked for.
  const bool isWeighed = lights_->tree().isEmpty() && lights_->placed().size() > 1;
  if (lit.isEmpty() || (result.chance == 0 && !isWeighed)) return result;
  result.isAttenuated = lit.isKnown() && lights_->tree().isEmpty();
  if (result.isAttenuated) {
    result.attenuated = {lit, seen.projection, seen.keptDistance};
  } else {
    result.even = {lit, seen.projection, seen.keptDistance};
  }
  result.share = static_cast<double>(light.intensity) * result.integral();
  if (!std::isfinite(result.share)) result.chance = 0;
  return result;
}

double LightsAlongRay::totalShare() const {
  double total = 0;
  for (const PlacedLight& light : lights_->placed()) total += candidate(light.place).share;
  return total;
}

std::optional<LightsAlongRay::Choice> LightsAlongRay::choose(std::array<float, 2> u, std::size_t index) const {
  if (!chooses_ || stretches_.isEmpty() || lights_->placed().empty()) return {};
  // Turned by the golden ratio of two dimensions (Roberts 2018).
  constexpr std::array turns{0.7548777f, 0.5698403f};
  for (std::size_t i = 0; index > 0 && i < 2; ++i) {
    const float turned = u[i] + turns[i] * static_cast<float>(index);
    u[i] = std::min(turned - std::floor(turned), 0x1.fffffep-1f);
  }
  // What is left of the first number decides whether the choice is carried out.
  if (!lights_->tree().isEmpty()) {
    if (index >= cut_.count) return {};
    const auto entry = lights_->tree().chooseBelow(RayQuery{ray_, stretches_}, cut_.nodes[index], u[0]);
    if (!entry) return {};
    const LightId id = lights_->idOf(entry->entry);
    const Candidate seen = candidate(*lights_->placeOf(id));
    if (!(static_cast<double>(entry->rest) < seen.chance)) return {};
    return place(id, seen, static_cast<double>(entry->probability), u[1]);
  }
  const double total = lights_->placed().size() > 1 ? totalShare() : 0;
  auto rest = static_cast<double>(u[0]);
  for (const PlacedLight& light : lights_->placed()) {
    const Candidate seen = candidate(light.place);
    const double probability = total > 0 ? seen.share / total : 1;
    if (rest >= probability && &light != &lights_->placed().back()) {
      rest -= probability;
      continue;
    }
    if (!(rest < probability * seen.chance)) return {};
    return place(LightId{light.index}, seen, probability, u[1]);
  }
  return {};
}

std::optional<LightsAlongRay::Choice> LightsAlongRay::place(LightId light, const Candidate& seen, double probability,
                                                            float xi) {
  const double t = seen.sample(static_cast<double>(xi));
  const double density = probability * seen.chance * seen.pdf(t);
  if (!(density > 0 && std::isfinite(density))) return {};
  return Choice{light, t, density, seen.isMet};
}

double LightsAlongRay::probability(LightId light, const Candidate& seen) const {
  if (light.part != LightId::whole) {
    return static_cast<double>(lights_->tree().probability(RayQuery{ray_, stretches_}, lights_->entryOf(light), cut_));
  }
  return lights_->placed().size() > 1 ? seen.share / totalShare() : 1;
}

LightsAlongRay::Claim LightsAlongRay::claim(LightId light, double t) const {
  if (!chooses_ || stretches_.isEmpty()) return {};
  const std::optional<LightPlace> place = lights_->placeOf(light);
  if (!place) return {};
  const Candidate seen = candidate(*place);
  if (seen.chance == 0) return {};
  const double density = probability(light, seen) * seen.chance * seen.pdf(t);
  if (!(density > 0 && std::isfinite(density))) return {};
  return {density, seen.isAttenuated && seen.chance >= 1 && seen.attenuated.coarseness() <= fineDepth};
}

void LightsAlongRay::tabulate() {
  if (!lights_->tree().isEmpty()) {
    cut_ = lights_->tree().cut(RayQuery{ray_, stretches_}, 0.0f);
    columnCount_ = static_cast<std::uint8_t>(cut_.count);
  } else {
    columnCount_ = static_cast<std::uint8_t>(std::min(lights_->placed().size(), volume::LightColumns::most));
  }
}

volume::LightColumn LightsAlongRay::column(std::size_t index) const {
  LightPlace place;
  if (lights_->tree().isEmpty()) {
    place = lights_->placed()[index].place;
  } else {
    const LightBounds& bounds = lights_->tree().bounds(cut_.nodes[index]);
    place = {.centre = bounds.centre(), .extent = bounds.halfDiagonal(), .intensity = bounds.intensity};
  }
  const LightFromRay seen = LightFromRay::of(place, ray_, stretches_);
  return {seen.projection, seen.keptDistance, static_cast<double>(place.intensity)};
}

volume::LightColumns LightsAlongRay::columns() const {
  volume::LightColumns all;
  all.count = columnCount_;
  for (std::size_t i = 0; i < all.count; ++i) all.columns[i] = column(i);
  return all;
}

std::optional<LightsAlongRay::Choice> LightsAlongRay::choose(const volume::TabulatedLight& found, float u) const {
  if (found.found.event == volume::DistanceEvent::passed || !(found.mass > 0)) return {};
  const double t = found.found.t;
  LightId light;
  if (lights_->tree().isEmpty()) {
    light.light = lights_->placed()[found.column].index;
  } else {
    const PointQuery query{ray_.at(static_cast<float>(t))};
    const auto entry = lights_->tree().chooseBelow(query, cut_.nodes[found.column], u);
    if (!entry) return {};
    light = lights_->idOf(entry->entry);
  }
  const Claim claim = tabulatedClaim(light, t, found.scale / found.mass);
  if (!(claim.density > 0)) return {};
  return Choice{light, t, claim.density, false};
}

LightsAlongRay::Claim LightsAlongRay::tabulatedClaim(LightId light, double t, double scale) const {
  if (columnCount_ == 0 || !(scale > 0)) return {};
  std::size_t index = 0;
  double chance = 1;
  if (lights_->tree().isEmpty()) {
    const auto placed = lights_->placed();
    const auto found = std::ranges::find(placed, light.light, &PlacedLight::index);
    index = static_cast<std::size_t>(found - placed.begin());
  } else if (!lights_->placeOf(light)) {
    return {};
  } else {
    const std::uint32_t entry = lights_->entryOf(light);
    index = lights_->tree().clusterOf(entry, cut_);
    if (index < columnCount_) {
      const PointQuery query{ray_.at(static_cast<float>(t))};
      chance = static_cast<double>(lights_->tree().probability(query, entry, cut_));
    }
  }
  if (index >= columnCount_) return {};
  const double density = scale * column(index).falloff(t) * chance;
  if (!(density > 0 && std::isfinite(density))) return {};
  return {density, true};
}

float LightsAlongRay::correction(LightId light, double t, float distance) const {
  if (!lights_) return 1;
  const std::optional<LightPlace> place = lights_->placeOf(light);
  if (!place || !place->hasSingularity) return 1;
  const LightFromRay seen = LightFromRay::of(*place, ray_, stretches_);
  const double x = t - seen.projection, squared = static_cast<double>(distance) * static_cast<double>(distance);
  const double kept = seen.keptDistance * seen.keptDistance + x * x;
  return kept > 0 ? static_cast<float>(squared / kept) : 1.0f;
}

}  // namespace aerosol::render
