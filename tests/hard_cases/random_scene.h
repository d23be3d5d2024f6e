// Small scenes of volumes, dielectrics, lights and cameras, drawn by rapidcheck.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/support/rendering.h"

namespace aerosol::test {

/// What stands in a scene, in lengths of 1; written in any unit. Only within a property: it draws from rapidcheck.
struct RandomScene {
  enum class Kind { ball, box, cylinder, cone, glass, frosted, matter, inside, count };

  struct Thing {
    Kind kind{};
    std::array<double, 3> place{}, size{}, step{};  ///< `step`: how far it moves while the shutter is open.
    double angle = 0, extinction = 0, albedo = 0, anisotropy = 0, ior = 1, glow = 0;
    int priority = 0;
    std::string distance, transmittance, material;
  };
  enum class View { plain, lens, parallel };

  std::vector<Thing> things;
  std::array<double, 3> camera{}, light{};
  View view{};
  double aperture = 0;
  bool hasPoint = false, hasSun = false, hasSpot = false, hasLamp = false, hasGround = false, moves = false;
  std::string overlap, sampler;

  /// With nothing that shines but a sky of 1 where that is asked for.
  static RandomScene make(bool skyAlone);

  /// The largest index of a dielectric that rays may begin in; at least 1.
  double largestIndexAtCamera() const;

  /// All but the sensor and the integrator.
  std::string content(double unit) const;
  TestScene load(double unit, const SceneOptions& options = {}) const;
};

}  // namespace aerosol::test
