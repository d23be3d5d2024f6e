// How much the parts of Disney's material scatter, so that their sum can be kept from giving more than it gets.
#pragma once

#include "core/render/facet_albedo.h"
#include "core/render/fresnel.h"
#include "core/render/grid_table.h"
#include "plugins/closures/cosine_albedo.h"
#include "plugins/closures/disney.h"

namespace aerosol::render::disney {

/// What facets that lose what several of them scatter do with white light, by what one facet reflects: all, the part
/// (1 - cos)^5, or what Fresnel's equations say for an index, and what they let through then.
struct FacetAlbedo {
  float mirror = 0, grazing = 0, reflected = 0, transmitted = 0;

  friend FacetAlbedo operator+(FacetAlbedo a, FacetAlbedo b) {
    return {a.mirror + b.mirror, a.grazing + b.grazing, a.reflected + b.reflected, a.transmitted + b.transmitted};
  }
  friend FacetAlbedo operator*(FacetAlbedo a, float s) {
    return {a.mirror * s, a.grazing * s, a.reflected * s, a.transmitted * s};
  }
  /// Of Schlick's curve from r0 on.
  Color schlick(Color r0) const { return r0 * (mirror - grazing) + Color(grazing); }
};

inline FacetAlbedo integrateFacets(int count, const Microfacets& facets, float eta, Vector<Local> viewer) {
  return overVisibleFacets(count, facets, viewer, [&](Vector<Local> h) {
    FacetAlbedo found;
    const float cosine = dot(viewer, h), f = fresnelDielectric(cosine, eta);
    if (const Vector<Local> light = reflectAt(viewer, h); light.z > 0) {
      const float seen = facets.seen(light);
      found = {seen, seen * disney::grazing(cosine), seen * f, 0};
    }
    const auto bent = refractAt(viewer, h, eta);
    if (bent && bent->z < 0) found.transmitted = (1 - f) * facets.seen(*bent);
    return found;
  });
}

/// From outside: `eta` from 1 to 3. Of uneven facets as much as even ones of the smaller width scatter, which is more.
inline FacetAlbedo facetAlbedo(const Microfacets& facets, float eta, Vector<Local> viewer) {
  static const GridTable<3, FacetAlbedo> table({24, 16, 10}, [](std::array<float, 3> x) {
    const float cosine = std::max(x[0] * x[0], 1e-3f), alpha = std::max(x[1] * x[1], 1e-3f);
    const Microfacets even({Microfacets::Shape::ggx, true}, alpha, alpha);
    return integrateFacets(256, even, 1 + 2 * x[2], {std::sqrt(std::max(0.0f, 1 - cosine * cosine)), 0, cosine});
  });
  const float alpha = std::min(facets.alphaX(), facets.alphaY());
  return table({std::sqrt(viewer.z), std::sqrt(alpha), 0.5f * (eta - 1)});
}

/// Of white diffuse reflection, plain and flat, by roughness and the viewer's cosine.
inline float diffuseAlbedo(float roughness, float flatness, float cosine) {
  const auto shape = [](float flat) {
    return [flat](float r, float viewer, float light, float between) {
      const float half = std::sqrt(std::max(0.0f, 0.5f * (1 + between)));
      return diffuse({r, flat, 0, 0}, Color(3.14159265f), viewer, light, half).g;
    };
  };
  static const CosineAlbedo plain(shape(0)), flat(shape(1));
  return mix(plain(roughness, cosine), flat(roughness, cosine), flatness);
}

/// Of the sheen, at weight 1.
inline float sheenAlbedo(float cosine) {
  static const CosineAlbedo table([](float, float, float, float between) {
    return 3.14159265f * grazing(std::sqrt(std::max(0.0f, 0.5f * (1 + between))));
  });
  return table(0, cosine);
}

/// By how much a material has to be dimmed whose parts scatter `sum` of what arrives. What is more is for the errors of
/// tables, which grow towards grazing views.
inline float excess(Color sum, float cosine) {
  return std::max(1.0f, (1.003f + 0.03f * grazing(cosine)) * std::max({sum.r, sum.g, sum.b}));
}

}  // namespace aerosol::render::disney
