#include "core/render/facet_albedo.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/render/fresnel.h"
#include "core/render/grid_table.h"

namespace aerosol::render {

namespace {

using Shape = Microfacets::Shape;

// Coordinates: places are denser towards grazing views and polished surfaces; indices are taken by their reflectance.
constexpr float leastCosine = 1e-3f;
constexpr float largestReflection = 0.5f;  // (3 - 1) / (3 + 1): indices from 1/3 to 3.

float cosineAt(float x) { return std::max(x * x, leastCosine); }
float placeOfCosine(float cosine) { return std::sqrt(std::clamp(cosine, 0.0f, 1.0f)); }
float alphaAt(float x) { return x * x; }
float placeOfAlpha(float alpha) { return std::sqrt(alpha); }
float etaAt(float x) {
  const float r = (2 * x - 1) * largestReflection;
  return (1 + r) / (1 - r);
}
float placeOfEta(float eta) { return 0.5f * ((eta - 1) / (eta + 1) / largestReflection + 1); }

Vector<Local> viewerAt(float cosine, float turn) {
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  return {sine * std::cos(turn), sine * std::sin(turn), cosine};
}

/// What drawing visible normals of GGX leaves to weigh of a facet: the normals that a Beckmann surface really shows.
float facetWeight(const Microfacets& facets, Vector<Local> viewer, Vector<Local> h, Vector<Local> light) {
  const float drawn = facets.visibleDensity(viewer, h);
  if (!(drawn > 0)) return 0;
  return facets.density(h) * facets.seenByBoth(viewer, light) * std::max(dot(viewer, h), 0.0f) / (viewer.z * drawn);
}

float integrateMirror(int count, const Microfacets& facets, Vector<Local> viewer) {
  return overVisibleFacets(count, facets, viewer, [&](Vector<Local> h) {
    const Vector<Local> light = reflectAt(viewer, h);
    return light.z > 0 ? facetWeight(facets, viewer, h, light) : 0.0f;
  });
}

struct Pair {
  float reflected = 0, transmitted = 0;
  friend Pair operator+(Pair a, Pair b) { return {a.reflected + b.reflected, a.transmitted + b.transmitted}; }
  friend Pair operator*(Pair a, float s) { return {a.reflected * s, a.transmitted * s}; }
};

/// Of what a coat with separate shadowing does to light: the mean over the facets that a viewer sees of `value(h)`,
/// which says where their light goes and how much of it. A ratio of two sums: Beckmann's normals are drawn as if they
/// were GGX's, and their weights add up to 1 but for noise.
template <class Value>
float coatMean(int count, const Microfacets& facets, Vector<Local> viewer, Value&& value) {
  const Pair sums = overVisibleFacets(count, facets, viewer, [&](Vector<Local> h) {
    const float drawn = facets.visibleDensity(viewer, h);
    if (!(drawn > 0)) return Pair();
    const float weight = facets.density(h) * std::max(dot(viewer, h), 0.0f) / drawn;
    const std::pair<Vector<Local>, float> light = value(h);
    return Pair{weight * light.second * (light.second > 0 ? facets.seen(light.first) : 0), weight};
  });
  return sums.transmitted > 0 ? sums.reflected / sums.transmitted : 0;
}

float integrateTransmission(int count, const Microfacets& facets, float eta, Vector<Local> viewer) {
  return coatMean(count, facets, viewer, [&](Vector<Local> h) {
    const auto bent = refractAt(viewer, h, eta);
    const bool goesIn = bent && bent->z < 0;
    return std::pair(goesIn ? *bent : viewer, goesIn ? 1 - fresnelDielectric(dot(viewer, h), eta) : 0.0f);
  });
}

float integrateReflection(int count, const Microfacets& facets, float eta, Vector<Local> viewer) {
  return coatMean(count, facets, viewer, [&](Vector<Local> h) {
    const Vector<Local> light = reflectAt(viewer, h);
    return std::pair(light, light.z > 0 ? fresnelDielectric(dot(viewer, h), eta) : 0.0f);
  });
}

/// The same of boundaries whose facets lose nothing to each other.
Pair integrateShares(int count, const Microfacets& facets, float eta, Vector<Local> viewer) {
  const SecondMeeting second(eta);
  return overVisibleFacets(count, facets, viewer, [&](Vector<Local> h) {
    const float drawn = facets.visibleDensity(viewer, h), cosine = std::max(dot(viewer, h), 0.0f);
    if (!(drawn > 0)) return Pair();
    const float weight = facets.density(h) * facets.seen(viewer) * cosine / (viewer.z * drawn);
    const float f = fresnelDielectric(cosine, eta);
    const FacetFate fate(facets, second, eta, viewer, h);
    return Pair{f * fate.reflectionStays * weight, (1 - f) * fate.transmissionStays * weight};
  });
}

Microfacets facetsOf(Shape shape, float alphaX, float alphaY, bool isSingle = false) {
  return Microfacets({shape, isSingle}, alphaX, alphaY);
}

/// Mirrors alike in all directions: by cosine and roughness.
struct MirrorTable {
  GridTable<2> values;

  explicit MirrorTable(Shape shape)
      : values({32, 32}, [&](std::array<float, 2> x) {
          const float alpha = alphaAt(x[1]);
          return alpha > 0 ? integrateMirror(4096, facetsOf(shape, alpha, alpha), viewerAt(cosineAt(x[0]), 0.3f))
                           : 1.0f;
        }) {}
};

/// Others: by cosine, both roughnesses and direction.
struct StretchedMirrorTable {
  GridTable<4> values;

  explicit StretchedMirrorTable(Shape shape)
      : values({12, 12, 12, 5}, [&](std::array<float, 4> x) {
          const Microfacets facets = facetsOf(shape, alphaAt(x[1]), alphaAt(x[2]));
          return integrateMirror(640, facets, viewerAt(cosineAt(x[0]), x[3] * std::numbers::pi_v<float> / 2));
        }) {}
};

/// Boundaries by cosine, roughness and index.
struct BoundaryTable {
  GridTable<3, Pair> values;

  explicit BoundaryTable(Shape shape)
      : values({16, 16, 21}, [&](std::array<float, 3> x) {
          const float alpha = alphaAt(x[1]);
          return integrateShares(400, facetsOf(shape, alpha, alpha), etaAt(x[2]), viewerAt(cosineAt(x[0]), 0.3f));
        }) {}
};

/// Coats from outside by cosine, roughness and index, from 1 on.
struct CoatTable {
  GridTable<3> values;

  explicit CoatTable(Shape shape)
      : values({40, 20, 16}, [&](std::array<float, 3> x) {
          const float alpha = alphaAt(x[1]);
          return integrateTransmission(240, facetsOf(shape, alpha, alpha, true), etaAt(0.5f + 0.5f * x[2]),
                                       viewerAt(cosineAt(x[0]), 0.3f));
        }) {}
};

/// The mean of diffuse light from inside. By the sum that Mitsuba takes (64 places, both ends among them), which is 2%
/// above the integral: its images are the reference for coats.
struct InnerCoatTable {
  GridTable<2> values;

  explicit InnerCoatTable(Shape shape)
      : values({24, 40}, [&](std::array<float, 2> x) {
          constexpr int places = 64;
          const Microfacets facets = facetsOf(shape, alphaAt(x[0]), alphaAt(x[0]), true);
          float sum = 0;
          for (int i = 1; i < places; ++i) {
            const float cosine = static_cast<float>(i) / (places - 1);
            sum += 2 * cosine * integrateReflection(160, facets, 1 / etaAt(0.5f + 0.5f * x[1]), viewerAt(cosine, 0.3f));
          }
          return sum / places;
        }) {}
};

/// Built when first asked for, then const; alike for all scenes.
template <class Tables>
const Tables& tablesOf(Shape shape) {
  if (shape == Shape::ggx) {
    static const Tables ggx(Shape::ggx);
    return ggx;
  }
  static const Tables beckmann(Shape::beckmann);
  return beckmann;
}

}  // namespace

float mirrorAlbedo(Shape shape, float alphaX, float alphaY, Vector<Local> viewer) {
  const float cosine = placeOfCosine(viewer.z);
  if (alphaX == alphaY) return tablesOf<MirrorTable>(shape).values({cosine, placeOfAlpha(alphaX)});
  const float turn = std::atan2(std::fabs(viewer.y), std::fabs(viewer.x)) * (2 / std::numbers::pi_v<float>);
  return tablesOf<StretchedMirrorTable>(shape).values({cosine, placeOfAlpha(alphaX), placeOfAlpha(alphaY), turn});
}

float SecondMeeting::meanReflectance(float eta) {
  if (eta >= 1) return std::min((eta - 1) / (4.08567f + 1.00071f * eta), 1.0f);
  return std::clamp(0.997118f + eta * (0.1014f - eta * (0.965241f + eta * 0.130607f)), 0.0f, 1.0f);
}

FacetFate::FacetFate(const Microfacets& facets, const SecondMeeting& second, float eta, Vector<Local> viewer,
                     Vector<Local> h) {
  const Vector<Local> mirrored = reflectAt(viewer, h);
  reflectionStays = mirrored.z > 0 ? second.stays(facets, viewer, mirrored) : second.above;
  const std::optional<Vector<Local>> bent = refractAt(viewer, h, eta);
  transmissionStays = !bent ? 0 : bent->z < 0 ? 1 : second.below;
}

/// Boundaries that are not alike in all directions would take a table of five dimensions: they are summed each time.
BoundaryShares boundaryShares(const Microfacets& facets, float eta, Vector<Local> viewer) {
  const bool isKnown = facets.alphaX() == facets.alphaY() && std::fabs(eta - 1) <= largestReflection * (eta + 1);
  const Pair pair = isKnown ? tablesOf<BoundaryTable>(facets.shape())
                                  .values({placeOfCosine(viewer.z), placeOfAlpha(facets.alphaX()), placeOfEta(eta)})
                            : integrateShares(96, facets, eta, viewer);
  return {pair.reflected, pair.transmitted};
}

float coatTransmittance(Shape shape, float alpha, float eta, float cosine) {
  return tablesOf<CoatTable>(shape).values({placeOfCosine(cosine), placeOfAlpha(alpha), 2 * placeOfEta(eta) - 1});
}

float coatInnerReflectance(Shape shape, float alpha, float eta) {
  return tablesOf<InnerCoatTable>(shape).values({placeOfAlpha(alpha), 2 * placeOfEta(eta) - 1});
}

}  // namespace aerosol::render
