// Directions out of a medium, chosen towards lamps that are in media too.
//
// A ray that leaves a vertex at the angle θ to a lamp r away, and goes on through a medium, collects of its light about
// ∫ dt / (D² + t²) = (π − θ) / (r sin θ): rays that pass near the lamp bring nearly all, and hardly any phase function
// sends paths there. So some paths follow that law instead, p(ω) = (π − θ) / (π³ sin θ) per steradian (θ = π (1 − √ξ)),
// even over the cone that the lamp fills, as one sample of the mixture with the phase function (Veach and Guibas 1995):
// no weight exceeds the inverse of the phase function's own share. What a point light in a medium is to equiangular
// sampling (Kulla and Fajardo 2012) this is to the direction before it; Georgiev et al. 2013, "Joint Importance
// Sampling of Low-Order Volumetric Scattering", treat both vertices at once.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/render/light_set.h"

namespace aerosol::render {

/// A lamp that may stand in a medium that scatters.
struct LampInMedia {
  std::uint32_t light = 0;
  Point<World> centre;
  float extent = 0;  ///< Half of its size.
};

/// The law above for one lamp.
class LampCone {
 public:
  LampCone() = default;
  /// `lamp` must be farther away from the point than its extent.
  LampCone(const LampInMedia& lamp, Point<World> from);

  /// Unit; `u` in [0, 1)².
  Vector<World> sample(std::array<float, 2> u) const;
  /// Per steradian, of a unit direction.
  float pdf(Vector<World> direction) const;

 private:
  Vector<World> axis_{0, 0, 1};
  double edge_ = 0;     ///< Angle of the cone that the lamp fills.
  double inside_ = 0;   ///< Part of the directions in that cone,
  double evenPdf_ = 0;  ///< and their density.
  double factor_ = 0;   ///< Density outside: factor (π − θ) / sin θ.
};

/// The laws for all lamps, with the parts of paths that follow them.
class LampDirections {
 public:
  /// More lamps than these are left to other techniques.
  static constexpr std::size_t most = 4;
  /// The largest part of paths that lamps get.
  static constexpr double largestShare = 0.7;

  /// Nothing is ever chosen.
  LampDirections() = default;
  /// `extinction` about that between the point and the lamps, per scene unit; `meanCosine` of the phase function.
  LampDirections(std::span<const LampInMedia> lamps, const LightSet& lights, Point<World> from, float extinction,
                 float meanCosine);

  bool isEmpty() const { return count_ == 0; }
  /// The part of paths that follows lamps.
  float share() const { return share_; }
  /// Of these; `u` in [0, 1)².
  Vector<World> sample(std::array<float, 2> u) const;
  float pdf(Vector<World> direction) const;

 private:
  std::array<LampCone, most> cones_{};
  std::array<float, most> shares_{};  ///< Of each lamp in `share_`.
  std::size_t count_ = 0;
  float share_ = 0;
};

struct PreparedScene;

/// The lamps of a scene that may be within media that scatter, by the boxes of these; none where they are too many to
/// be weighed one by one.
std::vector<LampInMedia> findLampsInMedia(const PreparedScene& scene);

}  // namespace aerosol::render
