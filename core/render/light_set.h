// All lights of a scene and the choice among them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/render/light.h"
#include "core/render/light_tree.h"
#include "core/render/optional_effects.h"

namespace aerosol::render {

/// A light that is somewhere.
struct PlacedLight {
  std::uint32_t index = 0;
  LightPlace place;
};

/// A light, or one of its parts where lights are chosen part by part.
struct LightId {
  static constexpr std::uint32_t whole = 0xffffffffu;

  std::uint32_t light = 0;
  std::uint32_t part = whole;
};

/// Chooses lights by their importance at the point, mixed with one part in ten of equal chances so that no light that
/// emits becomes too rare. Few lights are weighed one by one. Of many, those that are somewhere stand in a hierarchy,
/// meshes triangle by triangle, which takes its turn as one light among those at infinity. Lights without power are
/// never chosen.
class LightSet {
 public:
  /// Up to so many lights, counting triangles, there is no hierarchy.
  static constexpr std::size_t few = 16;

  struct Choice {
    std::uint32_t index = 0;
    float probability = 0;
    std::uint32_t part = LightId::whole;

    LightId id() const { return {index, part}; }
  };

  LightSet() = default;
  /// `sceneRadius` bounds the scene for the power of lights at infinity. `samplesAll`: also lights that directions find
  /// as well (Light::isSampled), as shadow rays see less in their way than those do.
  LightSet(std::vector<std::unique_ptr<const Light>> lights, float sceneRadius, bool samplesAll = true);
  /// Some of the lights of another set, by index, which keep their indices and, of many, their parts.
  LightSet(const LightSet& all, const std::vector<bool>& chosen, float sceneRadius);

  /// Of a set of some lights, that of all.
  std::size_t size() const { return lights_.size(); }
  bool contains(std::uint32_t index) const { return chosen_.empty() || chosen_[index]; }
  const Light& operator[](std::uint32_t index) const { return *lights_[index]; }
  /// Indices of the lights that a ray may see which leaves the scene.
  std::span<const std::uint32_t> infinite() const { return infinite_; }
  /// Whether any light is found by directions alone, and whether any is sampled.
  bool hasFound() const { return hasFound_; }
  bool hasSampled() const { return candidateCount() > 0; }
  /// Lights with power that are not at infinity.
  std::span<const PlacedLight> placed() const { return placed_; }
  /// Of a light among `placed`, or of its part; none for others.
  std::optional<LightPlace> placeOf(LightId id) const;
  /// Of the lights in `placed`, if they are many; empty otherwise.
  const LightTree& tree() const { return tree_; }
  LightId idOf(std::uint32_t treeEntry) const { return entries_[treeEntry]; }
  /// The light that was hit, as it is chosen.
  LightId idOf(std::uint32_t light, const LightHit& hit) const;
  std::uint32_t entryOf(LightId id) const { return firstEntries_[id.light] + id.part; }

  /// The lights that are sampled at one point, or clusters of them: one of each.
  struct Picks {
    std::size_t count = 0;

   private:
    friend class LightSet;
    std::uint32_t single = 0;  ///< The light; of the hierarchy, clusters.
    bool isTree = false;
    LightCut cut;
    double probability = 1;
    float rest = 0;  ///< What is left of the number that chose: in [0, 1).
  };
  /// `u` in [0, 1); none when no light emits. Clusters are split as LightTree says. Few lights are not.
  Picks pick(Point<World> from, float u, float splitThreshold) const {
    if (only_ == several) return pickAmongSeveral(from, u, splitThreshold);
    Picks picks;
    picks.single = only_;
    picks.count = 1;
    picks.rest = std::min(u, belowOne);
    return picks;
  }
  /// None where none of the cluster can be seen.
  std::optional<Choice> choose(const Picks& picks, std::size_t index, Point<World> from) const;
  /// A single one.
  std::optional<Choice> choose(Point<World> from, float u) const {
    const Picks picks = pick(from, u, neverSplit);
    return picks.count > 0 ? choose(picks, 0, from) : std::nullopt;
  }
  /// With which `choose` takes the light; of some cluster, where these are split.
  float probability(LightId id, Point<World> from, float splitThreshold = neverSplit) const {
    if (only_ == several) return probabilityAmongSeveral(id, from, splitThreshold);
    return only_ == id.light ? 1.0f : 0.0f;
  }
  float probability(std::uint32_t index, Point<World> from) const { return probability(LightId{index}, from); }

  /// A sample of a light, however it was chosen, and its density.
  std::optional<LightSample> sample(LightId id, Point<World> from, const LightUniforms& uniforms) const;
  float pdf(LightId id, Point<World> from, const LightHit& hit) const;

  /// A sample of one light, chosen by `u`; the choice's probability is part of its pdf.
  std::optional<LightSample> sample(Point<World> from, float u, const LightUniforms& uniforms) const;
  /// The pdf of `sample` for a hit of light `index`, and for a direction in which light `index` is seen at infinity.
  float pdf(std::uint32_t index, Point<World> from, const LightHit& hit) const;
  float pdfEscaped(std::uint32_t index, Point<World> from, Vector<World> direction) const;
  /// With the radiance of that light.
  Light::Escaped escapedWithPdf(std::uint32_t index, Point<World> from, Vector<World> direction) const;
  /// The density of directions in which any medium that glows is sampled.
  float pdfVolumes(Point<World> from, Vector<World> direction) const;
  bool hasVolumes() const { return hasOptionalEffects && !volumes_.empty(); }

 private:
  static constexpr std::uint32_t several = ~std::uint32_t{0};
  static constexpr float belowOne = 0x1.fffffep-1f;

  Picks pickAmongSeveral(Point<World> from, float u, float splitThreshold) const;
  float probabilityAmongSeveral(LightId id, Point<World> from, float splitThreshold) const;
  /// Sorts the lights. How many parts those have that are somewhere.
  std::size_t gather(float sceneRadius);
  void plantTree();
  void findOnly();
  /// Of the lights in `single_`, then of the tree.
  double importance(std::size_t candidate, Point<World> from) const;
  bool hasTree() const { return hasOptionalEffects && !tree_.isEmpty(); }
  std::size_t candidateCount() const { return single_.size() + (hasTree() ? 1 : 0); }
  double probabilityOf(std::size_t candidate, Point<World> from) const;

  std::vector<std::shared_ptr<const Light>> lights_;
  std::vector<bool> chosen_;  ///< By index; empty: all.
  std::vector<std::uint32_t> infinite_;
  bool samplesAll_ = true;
  bool hasFound_ = false;
  std::vector<std::uint32_t> single_;   ///< Lights with power that are weighed one by one.
  std::uint32_t only_ = several;        ///< The light, where it is the only one with power.
  std::vector<std::uint32_t> volumes_;  ///< Media that glow; among `single_`.
  std::vector<PlacedLight> placed_;
  LightTree tree_;
  std::vector<LightId> entries_;             ///< Of the tree.
  std::vector<std::uint32_t> firstEntries_;  ///< By light.
};

}  // namespace aerosol::render
