// How much light comes back from microfacets: what a single scattering leaves of it, integrated beforehand.
#pragma once

#include "core/render/microfacet.h"

namespace aerosol::render {

/// The part of the light that facets which reflect everything send back at once; the rest hits another facet. In
/// (0, 1]. For correlated shadowing.
float mirrorAlbedo(Microfacets::Shape shape, float alphaX, float alphaY, Vector<Local> viewer);

/// What a boundary of dielectrics reflects and transmits at once. `eta` is the far index over the near one. For
/// correlated shadowing; together at most 1.
struct BoundaryAlbedo {
  float reflected = 0, transmitted = 0;
};
BoundaryAlbedo boundaryAlbedo(Microfacets::Shape shape, float alphaX, float alphaY, float eta, Vector<Local> viewer);

/// What a coat of microfacets with separate shadowing lets in of light from outside that meets it at `cosine`, and the
/// mean of what it reflects back of diffuse light from below. `eta` > 1 is the index of the inside.
float coatTransmittance(Microfacets::Shape shape, float alpha, float eta, float cosine);
float coatInnerReflectance(Microfacets::Shape shape, float alpha, float eta);

}  // namespace aerosol::render
