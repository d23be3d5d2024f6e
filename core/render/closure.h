// Closures: what surface shaders return, as the integrator sees them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/color.h"
#include "core/base/described_field.h"
#include "core/base/geometry.h"
#include "core/render/subsurface_body.h"

namespace aerosol::render {

enum class ClosureKind : unsigned char {
  scattering,   ///< Has a density over directions.
  transparent,  ///< Lets light pass straight on.
  emission,     ///< Emits and does not scatter.
  interior,     ///< Says what lies inside; scatters nothing itself.
  subsurface,   ///< Light enters, and leaves the body (`Closure::body`) somewhere else.
  holdout,      ///< Takes its weight from the image's coverage.
  output,       ///< Gives its weight to an AOV; neither scatters nor emits.
  shadowing     ///< On top of others: dims light by its direction (`Closure::shadowing`), scatters nothing itself.
};

/// What a closure promises; held by the tests over all of them.
struct ClosureTraits {
  bool isBounded = true;       ///< Never scatters more than arrives.
  bool isReciprocal = true;    ///< f(a, b) / η_a² = f(b, a) / η_b².
  bool hasExactAlbedo = true;  ///< `albedo` is more than an estimate where the surface is seen steeply.
  bool isDiffuse = false;      ///< Scatters as a matte surface does; otherwise it is glossy.
};

/// Where a closure is asked. Unit vectors in world space.
struct ClosurePoint {
  Vector<World> toViewer;
  Normal<World> geometricNormal;  ///< Outwards: the side away from the interior.
  float iorNear = 0;              ///< Index of the medium on the viewer's side; 0 where nobody says.
  float iorFar = 0;               ///< On the other side.

  /// The far index over the near one; of a boundary in empty space whose inside has the index `ior`, where nobody says.
  float relativeIor(float ior) const {
    if (iorNear > 0 && iorFar > 0) return iorFar / iorNear;
    return dot(toViewer, geometricNormal) > 0 ? ior : 1 / ior;
  }
};

/// Random numbers for one sample, each in [0, 1).
struct ClosureUniforms {
  float choice = 0;
  std::array<float, 2> place{};
};

struct ClosureSample {
  Vector<World> direction;  ///< Unit, away from the surface.
  Color weight;             ///< f |cos| / pdf.
  float pdf = 0;            ///< Per steradian; of a delta direction the probability of having chosen it.
  bool isDelta = false;
  bool isPassing = false;   ///< Goes straight on, as if nothing was there.
  bool entersBody = false;  ///< Goes on inside: `Closure::body` of the term says where.
  std::uint32_t term = 0;   ///< Of a mixture: which of its terms was chosen.
  /// How refraction into another index changes radiance without a change of energy; part of the weight.
  float radianceScale = 1;
};

/// A homogeneous medium inside a surface, per scene unit.
struct InteriorMatter {
  Color sigmaT, sigmaS;
  float anisotropy = 0;
  std::optional<float> ior;  ///< None: the closures of the surface have their own.
  int priority = 0;          ///< 0: off.
};

/// A closure. Its parameters are floats as described by `fields`. Directions point away from the surface.
class Closure {
 public:
  virtual ~Closure() = default;

  virtual std::string_view name() const = 0;
  virtual std::string_view doc() const = 0;
  virtual std::span<const DescribedField> fields() const = 0;
  virtual ClosureKind kind() const = 0;
  virtual ClosureTraits traits() const { return {}; }

  /// Bidirectional scattering function times |cos| between `toLight` and the shading normal; without delta parts.
  virtual Color evaluate(std::span<const float> parameters, const ClosurePoint& point, Vector<World> toLight) const;
  /// The part of `evaluate` that is diffuse: all of it, or nothing, unless a closure is a sum of both.
  virtual Color evaluateDiffuse(std::span<const float> parameters, const ClosurePoint& point,
                                Vector<World> toLight) const;
  /// The density with which `sample` returns `toLight`.
  virtual float pdf(std::span<const float> parameters, const ClosurePoint& point, Vector<World> toLight) const;
  /// None when the light is absorbed.
  virtual std::optional<ClosureSample> sample(std::span<const float> parameters, const ClosurePoint& point,
                                              const ClosureUniforms& u) const;
  /// The part of light that is scattered back or on, each channel in [0, 1]. An estimate is enough for choosing among
  /// closures, but what has a chance of scattering is not 0.
  virtual Color albedo(std::span<const float> parameters, const ClosurePoint& point) const;
  /// What is left of light from a direction; of a closure of that kind.
  virtual float shadowing(std::span<const float> parameters, Vector<World> toLight) const;
  /// Radiance towards the viewer.
  virtual Color emitted(std::span<const float> parameters, const ClosurePoint& point) const;
  /// What light that enters goes through; of a closure of that kind.
  virtual SubsurfaceBody body(std::span<const float> parameters) const;
  /// What lies inside the surface; of a closure of that kind.
  virtual InteriorMatter interior(std::span<const float> parameters) const;
};

}  // namespace aerosol::render
