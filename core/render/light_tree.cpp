#include "core/render/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace aerosol::render {

namespace {

constexpr float pi = std::numbers::pi_v<float>;

float sineOf(float cosine) { return std::sqrt(std::max(0.0f, 1 - cosine * cosine)); }

/// cos(max(a - b, 0)) of two angles in [0, π].
float cosineOfDifference(float cosA, float cosB) {
  return cosA > cosB ? 1.0f : cosA * cosB + sineOf(cosA) * sineOf(cosB);
}

/// cos(min(a + b, π)).
float cosineOfSum(float cosA, float cosB) { return cosA <= -cosB ? -1.0f : cosA * cosB - sineOf(cosA) * sineOf(cosB); }

float angle(float cosine) { return std::acos(std::clamp(cosine, -1.0f, 1.0f)); }

/// The least angle between a normal of the cluster and the way to a point, as its cosine; `away` points there from the
/// centre, `distance` is its length.
float leastCosine(const LightBounds& bounds, Vector<World> away, float distance, float radius) {
  if (!(distance > radius) || bounds.cosSpread <= -1) return 1;
  const float ratio = radius / distance;
  const float cosSize = std::sqrt(1 - ratio * ratio);
  const float tolerated = cosineOfSum(bounds.cosSpread, cosSize);
  if (tolerated <= -1) return 1;
  return cosineOfDifference(dot(away, bounds.axis) / distance, tolerated);
}

/// Facing away up to rounding still counts.
constexpr float edge = 1e-4f;

/// Solid angle that lights of a cluster shine into, each into a hemisphere (Conty Estevez and Kulla, eq. 1).
float orientationMeasure(float cosSpread) {
  const float spread = angle(cosSpread), end = std::min(spread + pi / 2, pi);
  return 2 * pi * (1 - cosSpread) +
         pi / 2 * (2 * end * std::sin(spread) - std::cos(spread - 2 * end) - 2 * spread * std::sin(spread) + cosSpread);
}

float cost(const LightBounds& bounds) {
  if (!(bounds.intensity > 0)) return 0;
  const float size = bounds.halfDiagonal();
  return bounds.intensity * orientationMeasure(bounds.cosSpread) * size * size;
}

/// The cone around two cones.
void joinCones(const LightBounds& a, const LightBounds& b, LightBounds& result) {
  const LightBounds& wide = a.cosSpread <= b.cosSpread ? a : b;
  const LightBounds& narrow = a.cosSpread <= b.cosSpread ? b : a;
  result.axis = wide.axis;
  result.cosSpread = wide.cosSpread;
  if (wide.cosSpread <= -1) return;
  const float between = angle(dot(wide.axis, narrow.axis));
  const float wideSpread = angle(wide.cosSpread), narrowSpread = angle(narrow.cosSpread);
  if (std::min(between + narrowSpread, pi) <= wideSpread) return;
  const float spread = (wideSpread + between + narrowSpread) / 2;
  const Vector<World> side = narrow.axis - wide.axis * dot(wide.axis, narrow.axis);
  if (spread >= pi || !(length(side) > 1e-6f)) {
    result.cosSpread = -1;
    return;
  }
  const float turn = spread - wideSpread;
  result.axis = normalize(wide.axis * std::cos(turn) + normalize(side) * std::sin(turn));
  // Rounding of the axis must not leave a normal outside.
  result.cosSpread = std::max(-1.0f, std::cos(std::min(spread + 1e-3f, pi)));
}

}  // namespace

Point<World> LightBounds::centre() const {
  return {box.lower.x + 0.5f * (box.upper.x - box.lower.x), box.lower.y + 0.5f * (box.upper.y - box.lower.y),
          box.lower.z + 0.5f * (box.upper.z - box.lower.z)};
}
float LightBounds::halfDiagonal() const { return 0.5f * length(box.upper - box.lower); }

LightBounds join(const LightBounds& a, const LightBounds& b) {
  if (!(a.intensity > 0)) return b;
  if (!(b.intensity > 0)) return a;
  LightBounds result;
  result.box = a.box;
  result.box.extend(b.box.lower);
  result.box.extend(b.box.upper);
  result.intensity = a.intensity + b.intensity;
  joinCones(a, b, result);
  return result;
}

float PointQuery::operator()(const LightBounds& bounds) const {
  if (!(bounds.intensity > 0)) return 0;
  const Vector<World> away = point - bounds.centre();
  const float distance = length(away), radius = bounds.halfDiagonal();
  const float cosine = leastCosine(bounds, away, distance, radius);
  if (!(cosine > -edge)) return 0;
  const float kept = std::max({distance, radius, 1e-18f});
  return bounds.intensity * std::max(cosine, edge) / (kept * kept);
}

float RayQuery::operator()(const LightBounds& bounds) const {
  if (!(bounds.intensity > 0)) return 0;
  const Point<World> centre = bounds.centre();
  const float radius = bounds.halfDiagonal();
  double along = 0, unit = 0;
  for (int i = 0; i < 3; ++i) {
    const auto d = static_cast<double>(ray.direction[i]);
    along += (static_cast<double>(centre[i]) - static_cast<double>(ray.origin[i])) * d;
    unit += d * d;
  }
  const double projection = along / unit;
  const auto cosineFrom = [&](double t) {
    Vector<World> away;
    for (int i = 0; i < 3; ++i) {
      away[i] = static_cast<float>(static_cast<double>(ray.origin[i]) + t * static_cast<double>(ray.direction[i]) -
                                   static_cast<double>(centre[i]));
    }
    return leastCosine(bounds, away, length(away), radius);
  };
  double squared = 0;
  for (int i = 0; i < 3; ++i) {
    const double side = static_cast<double>(centre[i]) - static_cast<double>(ray.origin[i]) -
                        projection * static_cast<double>(ray.direction[i]);
    squared += side * side;
  }
  const double distance = std::max({std::sqrt(squared), static_cast<double>(radius), 1e-18});
  const double begin = stretches.begin(), end = std::min(stretches.end(), std::max(projection, begin) + 100 * distance);
  const double nearest = std::clamp(projection, begin, end);
  const float cosine = std::max({cosineFrom(begin), cosineFrom(nearest), cosineFrom(end), 0.05f});
  const double integral = volume::EquiangularSampler(stretches, projection, distance).integral();
  return static_cast<float>(std::min(static_cast<double>(bounds.intensity * cosine) * integral, 1e30));
}

namespace {

/// The least and the largest distance of a cluster's lights, by its bounding ball. From within it some are next to the
/// point: no nearer than a part of the others.
std::array<float, 2> distances(float toCentre, float radius) {
  constexpr float nearest = 0.1f;
  const float far = toCentre + radius;
  return {std::max(toCentre - radius, nearest * far), far};
}

}  // namespace

// Of 1 / d² for d even over [a, b]: E = 1 / (a b), E[x²] = (b³ − a³) / (3 (b − a) a³ b³), so V / E² = (b − a)² / (3 a
// b).
float PointQuery::spread(const LightBounds& bounds) const {
  const auto [a, b] = distances(length(point - bounds.centre()), bounds.halfDiagonal());
  return b > a && a > 0 ? (b - a) / std::sqrt(3 * a * b) : 0.0f;
}

// Of 1 / D, likewise: E = ln(b / a) / (b − a), E[x²] = 1 / (a b).
float RayQuery::spread(const LightBounds& bounds) const {
  const Vector<World> way = bounds.centre() - ray.origin;
  const Vector<World> beside = way - ray.direction * (dot(way, ray.direction) / dot(ray.direction, ray.direction));
  const auto [a, b] = distances(length(beside), bounds.halfDiagonal());
  if (!(b > a && a > 0)) return 0;
  const float ratio = (b - a) / (std::sqrt(a * b) * std::log(b / a));
  return std::sqrt(std::max(0.0f, ratio * ratio - 1));
}

LightTree::LightTree(std::span<const LightBounds> entries) {
  if (entries.empty()) return;
  order_.resize(entries.size());
  std::iota(order_.begin(), order_.end(), 0u);
  leafOf_.resize(entries.size());
  nodes_.reserve(2 * entries.size());
  nodes_.emplace_back();
  build(entries, 0, 0, static_cast<std::uint32_t>(entries.size()));
  nodes_.shrink_to_fit();
  for (const std::uint32_t entry : order_) intensities_.push_back(entries[entry].intensity);
}

void LightTree::build(std::span<const LightBounds> entries, std::uint32_t node, std::uint32_t begin,
                      std::uint32_t end) {
  LightBounds all;
  for (std::uint32_t i = begin; i < end; ++i) all = join(all, entries[order_[i]]);
  nodes_[node].bounds = all;
  double sum = 0, squares = 0, count = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const auto intensity = static_cast<double>(entries[order_[i]].intensity);
    sum += intensity;
    squares += intensity * intensity;
    count += intensity > 0;
  }
  nodes_[node].differences = sum > 0 ? static_cast<float>(std::max(0.0, count * squares / (sum * sum) - 1)) : 0.0f;
  const std::size_t largest = entries.size() > manyEntries ? largestLeaf : 1;
  if (end - begin <= largest) {
    nodes_[node].first = begin;
    nodes_[node].count = end - begin;
    for (std::uint32_t i = begin; i < end; ++i) leafOf_[order_[i]] = node;
    return;
  }
  const std::uint32_t middle = split(entries, begin, end);
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = children;
  nodes_[children].parent = nodes_[children + 1].parent = node;
  build(entries, children, begin, middle);
  build(entries, children + 1, middle, end);
}

// The axis along which the cluster is longest, cut where the sum of both costs is least of 15 places; in two halves
// where all centres are in one place.
std::uint32_t LightTree::split(std::span<const LightBounds> entries, std::uint32_t begin, std::uint32_t end) {
  constexpr int bins = 16;
  Box<World> centres;
  for (std::uint32_t i = begin; i < end; ++i) centres.extend(entries[order_[i]].centre());
  const Vector<World> sides = centres.upper - centres.lower;
  const int axis = sides.x >= sides.y && sides.x >= sides.z ? 0 : sides.y >= sides.z ? 1 : 2;
  const auto first = order_.begin() + begin, last = order_.begin() + end;
  const auto halve = [&] {
    const auto middle = first + (last - first) / 2;
    std::nth_element(first, middle, last, [&](std::uint32_t a, std::uint32_t b) {
      const float x = entries[a].centre()[axis], y = entries[b].centre()[axis];
      return x < y || (x == y && a < b);
    });
    return static_cast<std::uint32_t>(middle - order_.begin());
  };
  if (!(sides[axis] > 0) || !std::isfinite(sides[axis])) return halve();
  const float scale = bins / sides[axis];
  const auto binOf = [&](std::uint32_t entry) {
    return std::clamp(static_cast<int>((entries[entry].centre()[axis] - centres.lower[axis]) * scale), 0, bins - 1);
  };
  std::array<LightBounds, bins> content;
  for (auto i = first; i != last; ++i) {
    LightBounds& bin = content[static_cast<std::size_t>(binOf(*i))];
    bin = join(bin, entries[*i]);
  }
  std::array<float, bins> behind{};
  LightBounds right;
  for (std::size_t i = bins - 1; i > 0; --i) {
    right = join(right, content[i]);
    behind[i] = cost(right);
  }
  LightBounds left;
  int best = 0;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = 1; i < bins; ++i) {
    left = join(left, content[i - 1]);
    const float sum = cost(left) + behind[i];
    if (sum < least) {
      least = sum;
      best = static_cast<int>(i);
    }
  }
  const auto middle = std::partition(first, last, [&](std::uint32_t entry) { return binOf(entry) < best; });
  if (middle == first || middle == last) return halve();
  return static_cast<std::uint32_t>(middle - order_.begin());
}

std::size_t LightTree::clusterOf(std::uint32_t entry, const LightCut& cut) const {
  const auto end = cut.nodes.begin() + static_cast<std::ptrdiff_t>(cut.count);
  for (std::uint32_t index = leafOf_[entry];; index = nodes_[index].parent) {
    const auto found = std::find(cut.nodes.begin(), end, index);
    if (found != end) return static_cast<std::size_t>(found - cut.nodes.begin());
    if (index == 0) return cut.count;
  }
}

std::size_t LightTree::bytes() const {
  return nodes_.capacity() * sizeof(Node) + (order_.capacity() + leafOf_.capacity()) * sizeof(std::uint32_t) +
         intensities_.capacity() * sizeof(float);
}

}  // namespace aerosol::render
