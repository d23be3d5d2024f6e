#include "core/render/facet_albedo.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/render/fresnel.h"

namespace aerosol::render {

namespace {

using Shape = Microfacets::Shape;

/// Values over a grid in N dimensions, interpolated linearly; coordinates from 0 to 1.
template <std::size_t N, class Value = float>
class GridTable {
 public:
  template <class Function>
  GridTable(std::array<int, N> counts, Function&& value) : counts_(counts) {
    std::size_t size = 1;
    for (const int count : counts) size *= static_cast<std::size_t>(count);
    values_.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      std::array<float, N> at;
      std::size_t rest = i;
      for (std::size_t d = 0; d < N; ++d) {
        const auto count = static_cast<std::size_t>(counts[d]);
        at[d] = static_cast<float>(rest % count) / static_cast<float>(count - 1);
        rest /= count;
      }
      values_[i] = value(at);
    }
  }

  Value operator()(std::array<float, N> at) const {
    std::array<std::size_t, N> lower;
    std::array<float, N> part;
    for (std::size_t d = 0; d < N; ++d) {
      const float x = std::clamp(at[d], 0.0f, 1.0f) * static_cast<float>(counts_[d] - 1);
      const int cell = std::min(static_cast<int>(x), counts_[d] - 2);
      lower[d] = static_cast<std::size_t>(cell);
      part[d] = x - static_cast<float>(cell);
    }
    Value sum{};
    for (unsigned corner = 0; corner < 1u << N; ++corner) {
      float weight = 1;
      std::size_t index = 0, stride = 1;
      for (std::size_t d = 0; d < N; ++d) {
        const bool isUpper = (corner >> d & 1u) != 0;
        weight *= isUpper ? part[d] : 1 - part[d];
        index += (lower[d] + (isUpper ? 1 : 0)) * stride;
        stride *= static_cast<std::size_t>(counts_[d]);
      }
      if (weight > 0) sum = sum + values_[index] * weight;
    }
    return sum;
  }

 private:
  std::array<int, N> counts_;
  std::vector<Value> values_;
};

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

Pair integrateBoundary(int count, const Microfacets& facets, float eta, Vector<Local> viewer) {
  return overVisibleFacets(count, facets, viewer, [&](Vector<Local> h) {
    Pair pair;
    const float f = fresnelDielectric(dot(viewer, h), eta);
    if (const Vector<Local> light = reflectAt(viewer, h); light.z > 0) {
      pair.reflected = f * facetWeight(facets, viewer, h, light);
    }
    const auto bent = refractAt(viewer, h, eta);
    if (bent && bent->z < 0) pair.transmitted = (1 - f) * facetWeight(facets, viewer, h, *bent);
    return pair;
  });
}

/// The reflected part alone.
float integrateReflection(const Microfacets& facets, float eta, Vector<Local> viewer) {
  return overVisibleFacets(128, facets, viewer, [&](Vector<Local> h) {
    const Vector<Local> light = reflectAt(viewer, h);
    return light.z > 0 ? fresnelDielectric(dot(viewer, h), eta) * facetWeight(facets, viewer, h, light) : 0.0f;
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
          return integrateBoundary(400, facetsOf(shape, alpha, alpha), etaAt(x[2]), viewerAt(cosineAt(x[0]), 0.3f));
        }) {}
};

/// Coats from outside by cosine, roughness and index, from 1 on.
struct CoatTable {
  GridTable<3> values;

  explicit CoatTable(Shape shape)
      : values({32, 20, 12}, [&](std::array<float, 3> x) {
          const float alpha = alphaAt(x[1]);
          return integrateBoundary(200, facetsOf(shape, alpha, alpha, true), etaAt(0.5f + 0.5f * x[2]),
                                   viewerAt(cosineAt(x[0]), 0.3f))
              .transmitted;
        }) {}
};

/// The mean of diffuse light from inside. By the sum that Mitsuba takes (64 places, both ends among them), which is 2%
/// above the integral: its images are the reference for coats.
struct InnerCoatTable {
  GridTable<2> values;

  explicit InnerCoatTable(Shape shape)
      : values({12, 16}, [&](std::array<float, 2> x) {
          constexpr int places = 64;
          const Microfacets facets = facetsOf(shape, alphaAt(x[0]), alphaAt(x[0]), true);
          float sum = 0;
          for (int i = 1; i < places; ++i) {
            const float cosine = static_cast<float>(i) / (places - 1);
            sum += 2 * cosine * integrateReflection(facets, 1 / etaAt(0.5f + 0.5f * x[1]), viewerAt(cosine, 0.3f));
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

/// Boundaries that are not alike in all directions would take a table of five dimensions: they are summed each time.
BoundaryAlbedo boundaryAlbedo(Shape shape, float alphaX, float alphaY, float eta, Vector<Local> viewer) {
  if (alphaX != alphaY) {
    constexpr int places = 96;
    const Pair pair = integrateBoundary(places, facetsOf(shape, alphaX, alphaY), eta, viewer);
    return {pair.reflected, pair.transmitted};
  }
  const Pair pair =
      tablesOf<BoundaryTable>(shape).values({placeOfCosine(viewer.z), placeOfAlpha(alphaX), placeOfEta(eta)});
  return {pair.reflected, pair.transmitted};
}

float coatTransmittance(Shape shape, float alpha, float eta, float cosine) {
  return tablesOf<CoatTable>(shape).values({placeOfCosine(cosine), placeOfAlpha(alpha), 2 * placeOfEta(eta) - 1});
}

float coatInnerReflectance(Shape shape, float alpha, float eta) {
  return tablesOf<InnerCoatTable>(shape).values({placeOfAlpha(alpha), 2 * placeOfEta(eta) - 1});
}

}  // namespace aerosol::render
