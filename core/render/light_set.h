// All lights of a scene and the choice among them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/render/light.h"

namespace aerosol::render {

/// Chooses lights in proportion to their importance at the point, mixed with one part in ten of equal chances so that
/// no light that emits becomes too rare. Lights without power are never chosen. Cost grows with the number of lights.
class LightSet {
 public:
  struct Choice {
    std::uint32_t index = 0;
    float probability = 0;
  };

  LightSet() = default;
  /// `sceneRadius` bounds the scene for the power of lights at infinity.
  LightSet(std::vector<std::unique_ptr<const Light>> lights, float sceneRadius);

  std::size_t size() const { return lights_.size(); }
  const Light& operator[](std::uint32_t index) const { return *lights_[index]; }
  /// Indices of the lights that a ray may see which leaves the scene.
  std::span<const std::uint32_t> infinite() const { return infinite_; }

  /// `u` in [0, 1); none when no light emits.
  std::optional<Choice> choose(Point<World> from, float u) const;
  /// With which `choose` takes the light.
  float probability(std::uint32_t index, Point<World> from) const;

  /// A sample of one light, chosen by `u`; the choice's probability is part of its pdf.
  std::optional<LightSample> sample(Point<World> from, float u, const LightUniforms& uniforms) const;
  /// The pdf of `sample` for a hit of light `index`, and for a direction in which light `index` is seen at infinity.
  float pdf(std::uint32_t index, Point<World> from, const LightHit& hit) const;
  float pdfEscaped(std::uint32_t index, Point<World> from, Vector<World> direction) const;

 private:
  std::vector<std::unique_ptr<const Light>> lights_;
  std::vector<std::uint32_t> infinite_;
  double share(std::uint32_t index, Point<World> from) const;
  double totalImportance(Point<World> from) const;

  std::vector<std::uint32_t> emitting_;  ///< Lights with power.
};

}  // namespace aerosol::render
