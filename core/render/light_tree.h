// A hierarchy over many lights, asked with a point or with the stretches of a ray.
//
// Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting": clusters of lights
// with a box, a cone around their normals and their intensity; from the root down one of two children is chosen in
// proportion to its importance. For a point that is I cos θ' / d², with θ' the least angle between a normal and the way
// to the point; d is not less than the cluster's half diagonal, so a cluster around the point is not overrated. For a
// ray it is I ∫ dt / (D² + t²): what equiangular sampling will divide by (1 / D where the stretch is long). Whatever
// may light the point has a positive probability: θ' is a lower bound. (Along a ray the chance of a light that shines
// away from it is small, not zero: other techniques do not depend on it.)
//
// Adaptive splitting (section 5.3 there): where lights of a cluster differ so much, in strength or by how far away they
// may be, that one of them tells little of the others, the cluster is split and both halves are sampled. Theirs splits
// each cluster whose estimated variance is above a threshold. Here the one cluster is split next whose importance times
// relative spread is largest, while that is more than the given part of all the light: so the number has a bound, far
// clusters of no consequence are left whole, and the cut depends on the query alone, which densities need.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/volume/equiangular.h"

namespace aerosol::render {

/// Where lights are and where they shine.
struct LightBounds {
  Box<World> box;
  Vector<World> axis{0, 0, 1};  ///< Unit, in the middle of the normals.
  float cosSpread = -1;         ///< Of the largest angle between axis and a normal; -1: they shine everywhere.
  float intensity = 0;          ///< At least 0: largest radiant intensity, averaged over channels.

  Point<World> centre() const;
  float halfDiagonal() const;
};

/// Both together.
LightBounds join(const LightBounds& a, const LightBounds& b);

/// How much a cluster may matter to a point.
struct PointQuery {
  Point<World> point;
  float operator()(const LightBounds& bounds) const;
  /// Standard deviation over mean of what lights all over the cluster give, as far as their distance decides it.
  float spread(const LightBounds& bounds) const;
};

/// How much a cluster may matter to the stretches of a ray.
struct RayQuery {
  const Ray<World>& ray;
  const volume::RayStretches& stretches;
  float operator()(const LightBounds& bounds) const;
  float spread(const LightBounds& bounds) const;
};

/// Clusters that hold every light once, of which each is sampled.
struct LightCut {
  static constexpr std::size_t most = 8;

  std::array<std::uint32_t, most> nodes{};
  std::size_t count = 0;
};

/// A threshold of `LightTree::cut` that nothing is above.
inline constexpr float neverSplit = std::numeric_limits<float>::infinity();

/// Const after it was built. Entries are numbered as they were given.
class LightTree {
 public:
  /// A leaf has one entry; of very many lights, up to this number, chosen by intensity.
  static constexpr std::size_t largestLeaf = 8, manyEntries = 1 << 17;

  LightTree() = default;
  /// Entries without intensity are never chosen.
  explicit LightTree(std::span<const LightBounds> entries);

  bool isEmpty() const { return nodes_.empty(); }
  const LightBounds& whole() const { return nodes_[0].bounds; }

  struct Choice {
    std::uint32_t entry = 0;
    float probability = 0;
    float rest = 0;  ///< What is left of the number that chose: in [0, 1).
  };
  /// `u` in [0, 1). None where no cluster matters.
  template <class Query>
  std::optional<Choice> choose(const Query& query, float u) const {
    return isEmpty() || !(query(nodes_[0].bounds) > 0) ? std::nullopt : chooseBelow(query, 0, u);
  }
  /// With which `choose` takes the entry.
  template <class Query>
  float probability(const Query& query, std::uint32_t entry) const {
    return probability(query, entry, LightCut{{}, 1});
  }

  /// Splits clusters of which the spread matters more than `threshold` times all the light. Empty where none matters.
  template <class Query>
  LightCut cut(const Query& query, float threshold) const;
  /// Which cluster of the cut holds the entry; `cut.count` where none does.
  std::size_t clusterOf(std::uint32_t entry, const LightCut& cut) const;
  const LightBounds& bounds(std::uint32_t node) const { return nodes_[node].bounds; }
  /// One entry of a cluster of the cut.
  template <class Query>
  std::optional<Choice> chooseBelow(const Query& query, std::uint32_t node, float u) const;
  /// With which the entry is taken by `chooseBelow` with the cluster that holds it; 0 where none does.
  template <class Query>
  float probability(const Query& query, std::uint32_t entry, const LightCut& cut) const;

  std::size_t bytes() const;

 private:
  static constexpr std::uint32_t inner = 0;
  struct Node {
    LightBounds bounds;
    std::uint32_t first = 0;      ///< Of an inner node its first child, the second stands behind it; else of `order_`.
    std::uint32_t count = inner;  ///< Entries of a leaf.
    std::uint32_t parent = 0;
    float differences = 0;  ///< Variance over squared mean of the intensities within.
  };

  void build(std::span<const LightBounds> entries, std::uint32_t node, std::uint32_t begin, std::uint32_t end);
  std::uint32_t split(std::span<const LightBounds> entries, std::uint32_t begin, std::uint32_t end);
  /// The probability of the first child; none when neither matters.
  template <class Query>
  std::optional<float> firstChance(const Query& query, const Node& node) const {
    const float a = query(nodes_[node.first].bounds), b = query(nodes_[node.first + 1].bounds);
    if (!(a + b > 0)) return {};
    return a / (a + b);
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;   ///< Entries, leaf by leaf.
  std::vector<float> intensities_;     ///< In that order.
  std::vector<std::uint32_t> leafOf_;  ///< By entry.
};

template <class Query>
LightCut LightTree::cut(const Query& query, float threshold) const {
  LightCut cut;
  if (isEmpty()) return cut;
  std::array<float, LightCut::most> importance{query(nodes_[0].bounds)}, doubt{};
  if (!(importance[0] > 0)) return cut;
  cut.count = 1;
  if (!(threshold < neverSplit)) return cut;
  // What one light tells of the cluster's sum: distances and intensities vary independently (Conty Estevez and Kulla,
  // eq. 9, relative to the mean).
  const auto setDoubt = [&](std::size_t i) {
    const Node& node = nodes_[cut.nodes[i]];
    if (node.count != inner) return void(doubt[i] = 0);
    const float byDistance = query.spread(node.bounds);
    const float square = byDistance * byDistance;
    doubt[i] = importance[i] * std::sqrt(square + node.differences + square * node.differences);
  };
  setDoubt(0);
  float total = importance[0];
  while (cut.count < LightCut::most) {
    const auto worst =
        static_cast<std::size_t>(std::max_element(doubt.begin(), doubt.begin() + cut.count) - doubt.begin());
    if (!(doubt[worst] > threshold * total)) break;
    const std::uint32_t child = nodes_[cut.nodes[worst]].first;
    const float a = query(nodes_[child].bounds), b = query(nodes_[child + 1].bounds);
    doubt[worst] = 0;
    if (!(a + b > 0)) continue;
    total += a + b - importance[worst];
    cut.nodes[worst] = a > 0 ? child : child + 1;
    importance[worst] = a > 0 ? a : b;
    setDoubt(worst);
    if (!(a > 0 && b > 0)) continue;
    cut.nodes[cut.count] = child + 1;
    importance[cut.count] = b;
    setDoubt(cut.count++);
  }
  return cut;
}

template <class Query>
std::optional<LightTree::Choice> LightTree::chooseBelow(const Query& query, std::uint32_t top, float u) const {
  constexpr float belowOne = 0x1.fffffep-1f;
  Choice choice{.probability = 1, .rest = u};
  const Node* node = nodes_.data() + top;
  while (node->count == inner) {
    const std::optional<float> first = firstChance(query, *node);
    if (!first) return {};
    const bool takesFirst = choice.rest < *first;
    const float chance = takesFirst ? *first : 1 - *first;
    choice.rest = std::min((takesFirst ? choice.rest : choice.rest - *first) / chance, belowOne);
    choice.probability *= chance;
    node = nodes_.data() + node->first + (takesFirst ? 0 : 1);
  }
  float left = choice.rest * node->bounds.intensity;
  std::uint32_t i = node->first;
  for (; i + 1 < node->first + node->count && left >= intensities_[i]; ++i) left -= intensities_[i];
  if (!(intensities_[i] > 0)) return {};
  choice.entry = order_[i];
  choice.rest = std::clamp(left / intensities_[i], 0.0f, belowOne);
  choice.probability *= intensities_[i] / node->bounds.intensity;
  return choice;
}

template <class Query>
float LightTree::probability(const Query& query, std::uint32_t entry, const LightCut& cut) const {
  if (isEmpty() || !(query(nodes_[0].bounds) > 0)) return 0;
  std::uint32_t index = leafOf_[entry];
  const Node& leaf = nodes_[index];
  if (!(leaf.bounds.intensity > 0)) return 0;
  float probability = 1;
  for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
    if (order_[i] == entry) probability = intensities_[i] / leaf.bounds.intensity;
  }
  const auto isCut = [&](std::uint32_t node) {
    return std::find(cut.nodes.begin(), cut.nodes.begin() + cut.count, node) != cut.nodes.begin() + cut.count;
  };
  while (!isCut(index)) {
    if (index == 0) return 0;
    const Node& parent = nodes_[nodes_[index].parent];
    const std::optional<float> first = firstChance(query, parent);
    if (!first) return 0;
    probability *= index == parent.first ? *first : 1 - *first;
    index = nodes_[index].parent;
  }
  return probability;
}

}  // namespace aerosol::render
