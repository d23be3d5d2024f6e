// Reflection and refraction by microfacets of a boundary between two media.
//
// Walter, Marschner, Li and Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces", equations 20 and
// 21. Radiance that crosses into an index eta times as large is compressed into a smaller solid angle: going the other
// way, from the light to the viewer, it grows by eta² (their n_o² over n_t², which is in equation 21).
#pragma once

#include <algorithm>

#include "core/render/facet_albedo.h"
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
/// near one, and gives `reflected(cosine)` and `transmitted(cosine)`, the colours that one facet sends either way, and
/// `reflectance(cosine)`, the mean of the first without tints, where that is not Fresnel's for `eta` (or not always:
/// `hasOwnCurve`).
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
        viewer_(frame_.toLocal(point.toViewer)) {
    if (!isVisible() || isSmooth() || facets_.isSingle()) return;
    factor_ = 1 / std::clamp(1.006f * keptOnce(), 0.2f, 1.0f);
  }

  /// Shading normals that the viewer sees from behind scatter nothing.
  bool isVisible() const { return viewer_.z > 1e-6f && model_.eta > 0; }

  Color albedo() const {
    if (isSmooth() || facets_.isSingle()) return model_.reflected(viewer_.z) + model_.transmitted(viewer_.z);
    const BoundaryAlbedo once =
        boundaryAlbedo(facets_.shape(), facets_.alphaX(), facets_.alphaY(), model_.eta, viewer_);
    const float f = fresnelDielectric(viewer_.z, model_.eta);
    const auto scaled = [&](Color c, float part, float expected) {
      return expected > 1e-4f ? c * (part * factor_ / expected) : c;
    };
    const Color all = scaled(model_.reflected(viewer_.z), once.reflected, f) +
                      scaled(model_.transmitted(viewer_.z), once.transmitted, 1 - f);
    return {std::min(all.r, 1.0f), std::min(all.g, 1.0f), std::min(all.b, 1.0f)};
  }

  Color evaluate(Vector<World> toLight) const {
    const std::optional<Facet> facet = facetOf(toLight);
    if (!facet) return Color();
    const float vh = dot(viewer_, facet->h);
    const float shape = factor_ * facets_.density(facet->h) * facets_.seenByBoth(viewer_, facet->light);
    if (facet->reflects) return model_.reflected(vh) * (shape / (4 * viewer_.z));
    const float lh = dot(facet->light, facet->h), sum = vh + model_.eta * lh;
    return model_.transmitted(vh) * (shape * std::fabs(vh * lh) / (viewer_.z * sum * sum));
  }

  float pdf(Vector<World> toLight) const {
    const std::optional<Facet> facet = facetOf(toLight);
    if (!facet) return 0;
    const float chosen = facets_.visibleDensity(viewer_, facet->h);
    const float vh = dot(viewer_, facet->h), reflection = reflectionChance(vh);
    if (facet->reflects) return reflection * chosen / (4 * std::max(vh, 1e-12f));
    const float lh = dot(facet->light, facet->h), eta = model_.eta, sum = vh + eta * lh;
    return (1 - reflection) * chosen * eta * eta * std::fabs(lh) / (sum * sum);
  }

  std::optional<ClosureSample> sample(const ClosureUniforms& u) const {
    const Vector<Local> h = isSmooth() ? Vector<Local>(0, 0, 1) : facets_.sampleVisible(viewer_, u.place);
    const float cosine = dot(viewer_, h);
    if (!(cosine > 0)) return {};
    const float reflection = reflectionChance(cosine);
    const bool reflects = u.choice < reflection;
    const std::optional<Vector<Local>> light =
        reflects ? std::optional(reflectAt(viewer_, h)) : refractAt(viewer_, h, model_.eta);
    if (!light || (light->z > 0) != reflects) return {};
    ClosureSample sample;
    sample.direction = normalize(frame_.toWorld(*light));
    if (!isOnItsSide(point_, sample.direction, reflects)) return {};
    const float scale = reflects ? 1 : 1 / (model_.eta * model_.eta);
    sample.radianceScale = scale;
    if (isSmooth()) {
      sample.isDelta = true;
      sample.pdf = reflects ? reflection : 1 - reflection;
      sample.weight = (reflects ? model_.reflected(cosine) : model_.transmitted(cosine) * scale) / sample.pdf;
      return sample;
    }
    sample.pdf = pdf(sample.direction);
    if (!(sample.pdf > 0)) return {};
    sample.weight = evaluate(sample.direction) / sample.pdf;
    return sample;
  }

 private:
  /// The facet that sends light from one direction to the viewer.
  struct Facet {
    Vector<Local> light, h;
    bool reflects = false;
  };

  /// Polished, or between equal indices, where facets bend nothing.
  bool isSmooth() const { return std::max(model_.alphaX, model_.alphaY) < 1e-3f || std::fabs(model_.eta - 1) < 1e-3f; }

  /// What facets leave of the light that meets one of them. Where the model reflects more than a dielectric, a mixture
  /// of that with mirrors; where it reflects less, one with facets that let everything through.
  float keptOnce() const {
    const BoundaryAlbedo once =
        boundaryAlbedo(facets_.shape(), facets_.alphaX(), facets_.alphaY(), model_.eta, viewer_);
    if constexpr (requires { model_.reflectance(1.0f); }) {
      if (!hasOwnCurve()) return once.reflected + once.transmitted;
      const float own = model_.reflectance(viewer_.z), fresnel = fresnelDielectric(viewer_.z, model_.eta);
      const float kept = once.reflected + once.transmitted;
      const float mirror = mirrorAlbedo(facets_.shape(), facets_.alphaX(), facets_.alphaY(), viewer_);
      const float passed = fresnel < 0.999f ? std::min(once.transmitted / (1 - fresnel), 1.0f) : 1;
      // What films reflect goes up and down with the angle: as if all of it was mirrored, rather too little comes back.
      if (hasFilm()) return own * mirror + (1 - own) * passed;
      if (own >= fresnel) return fresnel < 1 ? kept + (mirror - kept) * (own - fresnel) / (1 - fresnel) : kept;
      return kept + (passed - kept) * (fresnel - own) / fresnel;
    }
    return once.reflected + once.transmitted;
  }

  bool hasFilm() const {
    if constexpr (requires { model_.film.isThere(); }) return model_.film.isThere();
    return false;
  }
  bool hasOwnCurve() const {
    if constexpr (requires { model_.hasOwnCurve(); }) return model_.hasOwnCurve();
    return true;
  }

  std::optional<Facet> facetOf(Vector<World> toLight) const {
    if (isSmooth()) return {};
    Facet facet;
    facet.light = frame_.toLocal(toLight);
    if (facet.light.z == 0) return {};
    facet.reflects = facet.light.z > 0;
    if (!isOnItsSide(point_, toLight, facet.reflects)) return {};
    Vector<Local> h = facet.reflects ? viewer_ + facet.light : -(viewer_ + facet.light * model_.eta);
    if (!(squaredLength(h) > 1e-12f)) return {};
    h = normalize(h);
    facet.h = h.z < 0 ? -h : h;
    const float vh = dot(viewer_, facet.h), lh = dot(facet.light, facet.h);
    // Facets seen from behind: nothing (Walter et al., the factor χ).
    if (!(vh > 0) || (lh > 0) != facet.reflects) return {};
    return facet;
  }

  float reflectionChance(float cosine) const {
    const float r = average(model_.reflected(cosine)), t = average(model_.transmitted(cosine));
    return r + t > 0 ? r / (r + t) : 0;
  }

  Model model_;
  const ClosurePoint& point_;
  LocalFrame frame_;
  Microfacets facets_;
  Vector<Local> viewer_;
  float factor_ = 1;
};

}  // namespace aerosol::render
