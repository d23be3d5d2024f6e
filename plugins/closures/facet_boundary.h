// Reflection and refraction by microfacets of a boundary between two media.
//
// Walter, Marschner, Li and Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces", equations 20 and
// 21. Radiance that crosses into an index eta times as large is compressed into a smaller solid angle: going the other
// way, from the light to the viewer, it grows by eta² (their n_o² over n_t², which is in equation 21).
#pragma once

#include <algorithm>

#include "core/render/facet_albedo.h"
#include "core/render/fresnel.h"
#include "core/render/microfacet.h"
#include "core/render/thin_film.h"
#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

/// A film on a boundary whose far index is `eta` times the near one; its own is told over empty space.
inline ThinFilm filmAt(const ClosurePoint& point, float thickness_nm, float ior, float eta) {
  const float near = point.iorNear > 0 ? point.iorNear : eta > 0 && eta < 1 ? 1 / eta : 1;
  return {thickness_nm, ior / near};
}

/// `Model` has the names of a lobe, `normal`, `tangent`, `alphaX`, `alphaY`, `finish` and `eta`, the far index over the
/// near one, and gives `curve(cosine)`, the part of the light that one facet reflects (it lets the rest through), each
/// channel in [0, 1], and the factors `reflectionTint` and `transmissionTint`.
///
/// Light that shadowing takes from what one facet reflects, or that is sent to the wrong side, meets another facet.
/// Instead of following it from facet to facet (Heitz, Hanika, d'Eon and Dachsbacher 2016, "Multiple-Scattering
/// Microfacet BSDFs with the Smith Model") we let each such ray end at its second meeting, as reflection between the
/// two faces of a groove does (Lee et al. 2018, "Practical multiple scattering for rough surfaces"): the second facet
/// reflects the mean ρ of Fresnel's curve and lets 1 - ρ through, and what arrives on a side from the wrong direction
/// is turned over at the plane of the surface. What was refracted is not shadowed once more on its way out. So
/// everything that arrives goes somewhere, whatever the widths, the index and the curve are, and no table of albedos
/// has to be exact for that.
template <class Model>
class FacetBoundary {
 public:
  static constexpr std::string_view name = Model::name;
  static constexpr std::string_view doc = Model::doc;
  static constexpr auto& fields = Model::fields;
  static constexpr ClosureTraits traits = Model::traits;

  FacetBoundary(std::span<const float> p, const ClosurePoint& point)
      : model_(p, point),
        point_(point),
        frame_(model_.normal, model_.tangent, point.toViewer),
        facets_(model_.finish, model_.alphaX, model_.alphaY),
        viewer_(frame_.toLocal(point.toViewer)),
        second_(model_.eta) {}

  /// Shading normals that the viewer sees from behind scatter nothing.
  bool isVisible() const { return viewer_.z > 1e-6f && model_.eta > 0; }

  Color albedo() const {
    if (isSmooth() || facets_.isSingle()) return reflected(viewer_.z) + transmitted(viewer_.z);
    BoundaryShares shares = boundaryShares(facets_, model_.eta, viewer_);
    const Color tints[] = {model_.reflectionTint, model_.transmissionTint,
                           model_.reflectionTint * model_.transmissionTint};
    Color reflection(shares.reflected), transmission(shares.transmitted);
    if (hasOwnCurve()) addOwnCurve(reflection, transmission);
    Color all;
    for (int c = 0; c < 3; ++c) {
      const float r = std::clamp(reflection[c], 0.0f, 1.0f), t = std::clamp(transmission[c], 0.0f, 1 - r);
      all[c] = std::clamp(tints[0][c] * r + tints[1][c] * t + tints[2][c] * (1 - r - t), 0.0f, 1.0f);
    }
    return all;
  }

  Color evaluate(Vector<World> toLight) const { return scattered(toLight).value; }
  float pdf(Vector<World> toLight) const { return scattered(toLight).pdf; }

  std::optional<ClosureSample> sample(const ClosureUniforms& u) const {
    const Vector<Local> h = isSmooth() ? Vector<Local>(0, 0, 1) : facets_.sampleVisible(viewer_, u.place);
    const float cosine = dot(viewer_, h);
    if (!(cosine > 0)) return {};
    const float reflection = reflectionChance(cosine);
    const bool reflects = u.choice < reflection;
    std::optional<Vector<Local>> light =
        reflects ? std::optional(reflectAt(viewer_, h)) : refractAt(viewer_, h, model_.eta);
    if (!light) return {};
    const float rest = reflects ? u.choice / reflection : (u.choice - reflection) / (1 - reflection);
    if (!isSmooth() && !facets_.isSingle()) light = afterSecond(*light, reflects, rest);
    const bool stays = light->z > 0;
    // What crosses where one side scatters nothing is absorbed.
    const bool isAbsorbed = isSmooth() || facets_.isSingle() || isBlack(tintOfBoth());
    if (stays != reflects && isAbsorbed) return {};
    ClosureSample sample;
    sample.direction = normalize(frame_.toWorld(*light));
    if (!isOnItsSide(point_, sample.direction, stays)) return {};
    const float scale = stays ? 1 : 1 / (model_.eta * model_.eta);
    sample.radianceScale = scale;
    if (isSmooth()) {
      sample.isDelta = true;
      sample.pdf = reflects ? reflection : 1 - reflection;
      sample.weight = (reflects ? reflected(cosine) : transmitted(cosine) * scale) / sample.pdf;
      return sample;
    }
    const Scattered found = scattered(sample.direction);
    if (!(found.pdf > 0)) return {};
    sample.pdf = found.pdf;
    sample.weight = found.value / found.pdf;
    return sample;
  }

 private:
  struct Scattered {
    Color value;
    float pdf = 0;
  };

  /// Polished, or between equal indices, where facets bend nothing.
  bool isSmooth() const { return std::max(model_.alphaX, model_.alphaY) < 1e-3f || std::fabs(model_.eta - 1) < 1e-3f; }

  bool hasOwnCurve() const {
    if constexpr (requires { model_.hasOwnCurve(); }) return model_.hasOwnCurve();
    return true;
  }

  /// Where reflection is total the curve has nothing to say.
  Color curve(float cosine) const {
    return 1 - cosine * cosine >= model_.eta * model_.eta ? Color(1) : model_.curve(cosine);
  }
  Color reflected(float cosine) const { return model_.reflectionTint * curve(cosine); }
  Color transmitted(float cosine) const { return model_.transmissionTint * (Color(1) - curve(cosine)); }

  Color tintOfBoth() const { return model_.reflectionTint * model_.transmissionTint; }

  float reflectionChance(float cosine) const {
    const Color part = curve(cosine);
    const float r = average(model_.reflectionTint * part), t = average(model_.transmissionTint * (Color(1) - part));
    return r + t > 0 ? r / (r + t) : 0;
  }

  /// The difference that the model's own curve makes to Fresnel's, over some of the facets that are seen.
  void addOwnCurve(Color& reflection, Color& transmission) const {
    constexpr int count = 16;
    overVisibleFacets(count, facets_, viewer_, [&](Vector<Local> h) {
      const float cosine = dot(viewer_, h);
      const Color more = curve(cosine) - Color(fresnelDielectric(cosine, model_.eta));
      const FacetFate fate(facets_, second_, model_.eta, viewer_, h);
      reflection += more * (fate.reflectionStays / count);
      transmission += more * (-fate.transmissionStays / count);
      return 0.0f;
    });
  }

  /// Where light goes that one facet has sent to `light`; `u` decides what the second one does.
  Vector<Local> afterSecond(Vector<Local> light, bool reflects, float u) const {
    const Vector<Local> over(light.x, light.y, -light.z);
    if (!reflects) return light.z < 0 ? light : u < second_.below ? over : light;
    if (light.z > 0) return u < second_.stays(facets_, viewer_, light) ? light : over;
    return u < second_.above ? over : light;
  }

  Scattered scattered(Vector<World> toLight) const {
    Scattered sum;
    if (isSmooth()) return sum;
    const Vector<Local> light = frame_.toLocal(toLight);
    if (light.z == 0 || !isOnItsSide(point_, toLight, light.z > 0)) return sum;
    const bool stays = light.z > 0;
    const Color& tint = stays ? model_.reflectionTint : model_.transmissionTint;
    if (facets_.isSingle()) {
      const float seen = facets_.seen(light);
      stays ? addReflected(sum, light, 1, tint * seen) : addRefracted(sum, light, 1, tint * seen);
      return sum;
    }
    const Color both = tintOfBoth();
    const Vector<Local> over(light.x, light.y, -light.z);
    const float squaredEta = model_.eta * model_.eta;
    if (stays) {
      addReflected(sum, light, second_.stays(facets_, viewer_, light), tint);
      addReflected(sum, over, second_.above, tint);
      addRefracted(sum, light, 1 - second_.below, both * squaredEta);
    } else {
      addRefracted(sum, light, 1, tint);
      addRefracted(sum, over, second_.below, tint);
      addReflected(sum, over, 1 - second_.stays(facets_, viewer_, over), both / squaredEta);
      addReflected(sum, light, 1 - second_.above, both / squaredEta);
    }
    return sum;
  }

  /// The part `share` of what facets reflect to `light`, on whichever side that is.
  void addReflected(Scattered& sum, Vector<Local> light, float share, Color factor) const {
    const bool isThere = share > 0 && !isBlack(factor);
    const std::optional<Vector<Local>> h = isThere ? facetBetween(viewer_ + light) : std::nullopt;
    if (!h || !(dot(viewer_, *h) > 0)) return;
    const float vh = dot(viewer_, *h);
    sum.value += factor * curve(vh) * (share * facets_.density(*h) * facets_.seen(viewer_) / (4 * viewer_.z));
    sum.pdf += share * reflectionChance(vh) * facets_.visibleDensity(viewer_, *h) / (4 * std::max(vh, 1e-12f));
  }
  /// Of what they refract. Facets seen from behind: nothing (Walter et al., the factor χ).
  void addRefracted(Scattered& sum, Vector<Local> light, float share, Color factor) const {
    const float eta = model_.eta;
    const bool isThere = share > 0 && !isBlack(factor);
    const std::optional<Vector<Local>> h = isThere ? facetBetween(viewer_ + light * eta) : std::nullopt;
    if (!h) return;
    const float vh = dot(viewer_, *h), lh = dot(light, *h), way = vh + eta * lh;
    if (!(vh > 0) || !(lh < 0)) return;
    const float spread = std::fabs(lh) / (way * way);
    sum.value += factor * (Color(1) - curve(vh)) *
                 (share * facets_.density(*h) * facets_.seen(viewer_) * vh * spread / viewer_.z);
    sum.pdf += share * (1 - reflectionChance(vh)) * facets_.visibleDensity(viewer_, *h) * eta * eta * spread;
  }
  static std::optional<Vector<Local>> facetBetween(Vector<Local> sum) {
    if (!(squaredLength(sum) > 1e-12f)) return {};
    const Vector<Local> h = normalize(sum);
    return h.z < 0 ? -h : h;
  }

  Model model_;
  const ClosurePoint& point_;
  LocalFrame frame_;
  Microfacets facets_;
  Vector<Local> viewer_;
  SecondMeeting second_;
};

}  // namespace aerosol::render
