// How much light comes back from microfacets: what a single scattering leaves of it, integrated beforehand.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/render/microfacet.h"

namespace aerosol::render {

/// The part of the light that facets which reflect everything send back at once; the rest hits another facet. In
/// (0, 1]. For correlated shadowing.
float mirrorAlbedo(Microfacets::Shape shape, float alphaX, float alphaY, Vector<Local> viewer);

/// What facets do on average with light that another facet has sent them, at a boundary whose far index is `eta` times
/// the near one: the part that they reflect. Cubic fits of 2 ∫ F(c) c dc (d'Eon 2016; Kulla and Conty 2017,
/// "Revisiting Physically Based Shading at Imageworks").
struct SecondMeeting {
  explicit SecondMeeting(float eta) : above(meanReflectance(eta)), below(meanReflectance(1 / eta)) {}

  /// How much of the light that a facet reflects to `light`, on the viewer's side, stays on that side.
  float stays(const Microfacets& facets, Vector<Local> viewer, Vector<Local> light) const {
    const float leaves = std::min(facets.seenByBoth(viewer, light) / facets.seen(viewer), 1.0f);
    return leaves + (1 - leaves) * above;
  }
  static float meanReflectance(float eta);

  float above, below;  ///< Met on the viewer's side, and from behind.
};

/// What becomes of the light that meets the facet `h` first: how much of what it reflects stays on the viewer's side,
/// and of what it lets through on the other; 0 where it lets nothing through.
struct FacetFate {
  FacetFate(const Microfacets& facets, const SecondMeeting& second, float eta, Vector<Local> viewer, Vector<Local> h);

  float reflectionStays, transmissionStays;
};

/// Of all the light that meets a boundary of dielectrics: the part that is reflected and stays, and the part that is
/// let through and stays behind. The rest crosses at its second meeting.
struct BoundaryShares {
  float reflected = 0, transmitted = 0;
};
BoundaryShares boundaryShares(const Microfacets& facets, float eta, Vector<Local> viewer);

/// Mean of `value(h)` over `count` facets that a viewer sees, drawn by the additive recurrence of Roberts 2018, "The
/// Unreasonable Effectiveness of Quasirandom Sequences".
template <class Value>
auto overVisibleFacets(int count, const Microfacets& facets, Vector<Local> viewer, Value&& value) {
  decltype(value(viewer)) sum{};
  for (int i = 0; i < count; ++i) {
    const double a = 0.5 + 0.7548776662466927 * i, b = 0.5 + 0.5698402909980532 * i;
    sum = sum + value(facets.sampleVisible(
                    viewer, {static_cast<float>(a - std::floor(a)), static_cast<float>(b - std::floor(b))}));
  }
  return sum * (1.0f / static_cast<float>(count));
}

/// What a coat of microfacets with separate shadowing lets in of light from outside that meets it at `cosine`, and the
/// mean of what it reflects back of diffuse light from below. `eta` > 1 is the index of the inside.
float coatTransmittance(Microfacets::Shape shape, float alpha, float eta, float cosine);
float coatInnerReflectance(Microfacets::Shape shape, float alpha, float eta);

}  // namespace aerosol::render
