// Distributions of microfacet normals, in the local frame of a surface.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/base/geometry.h"

namespace aerosol::render {

/// The frame of a shading normal: z is the normal, x the direction of `alphaX`.
struct Local {};

/// The texts by which shaders call the finishes: `Microfacets::finishAt`. The first two return what light loses between
/// facets that it meets once, and hide facets from both sides by their height; the others do neither (Mitsuba's).
inline constexpr std::string_view microfacetFinishes[] = {"ggx", "beckmann", "ggx_single", "beckmann_single"};

/// Microfacets with Smith's shadowing. All directions are unit and point away from the surface; the viewer is at z > 0.
/// Walter, Marschner, Li and Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces"; anisotropy and
/// visible normals after Heitz 2014 and 2018.
class Microfacets {
 public:
  enum class Shape : unsigned char { ggx, beckmann };
  struct Finish {
    Shape shape = Shape::ggx;
    bool isSingle = false;
  };

  /// Of an index into `microfacetFinishes`.
  static Finish finishAt(float index) {
    const int i = static_cast<int>(index);
    return {i % 2 == 1 ? Shape::beckmann : Shape::ggx, i >= 2};
  }

  /// Roughness is squared slope width: alpha in [1e-4, 1]; smaller is taken as that.
  Microfacets(Finish finish, float alphaX, float alphaY);

  /// D(h), per steradian.
  float density(Vector<Local> h) const;
  /// G1(w): the part of the facets that is seen from w.
  float seen(Vector<Local> w) const { return 1 / (1 + lambda(w)); }
  /// G2(a, b): both on one side, or one on each. Correlated by height; of single finishes the product of both G1.
  float seenByBoth(Vector<Local> a, Vector<Local> b) const;
  /// Whether light that meets several facets is lost.
  bool isSingle() const { return isSingle_; }
  Shape shape() const { return shape_; }
  float alphaX() const { return alphaX_; }
  float alphaY() const { return alphaY_; }
  /// A normal with the density `visibleDensity`.
  Vector<Local> sampleVisible(Vector<Local> viewer, std::array<float, 2> u) const;
  /// G1(v) |v·h| D(h) / |cos v| of GGX. Beckmann normals are drawn so too: their density is at most 4/e times that.
  float visibleDensity(Vector<Local> viewer, Vector<Local> h) const;

 private:
  float lambda(Vector<Local> w) const;

  Shape shape_;
  bool isSingle_;
  float alphaX_, alphaY_;
};

/// The local frame of a normal, turned so that the viewer is at z >= 0; x along `tangent` where that says anything.
class LocalFrame {
 public:
  LocalFrame(Vector<World> normal, Vector<World> tangent, Vector<World> viewer);

  Vector<Local> toLocal(Vector<World> v) const { return {dot(v, x_), dot(v, y_), dot(v, z_)}; }
  Vector<World> toWorld(Vector<Local> v) const { return x_ * v.x + y_ * v.y + z_ * v.z; }

 private:
  Vector<World> x_, y_, z_;
};

/// `w` mirrored at h.
inline Vector<Local> reflectAt(Vector<Local> w, Vector<Local> h) { return h * (2 * dot(w, h)) - w; }

/// `w` (on the side of h) bent through a facet h; `eta` is the far index over the near one. None in total reflection.
std::optional<Vector<Local>> refractAt(Vector<Local> w, Vector<Local> h, float eta);

}  // namespace aerosol::render
