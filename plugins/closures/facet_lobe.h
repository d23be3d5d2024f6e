// Reflection by microfacets, whatever they are made of.
#pragma once

#include "core/render/facet_albedo.h"
#include "core/render/microfacet.h"
#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

/// What light that meets several facets adds to what meets one: a factor, by the reflectance of a facet that is seen
/// straight on. Turquin 2019, "Practical multiple scattering compensation for microfacet models", equation 16. `E` is
/// what facets of mirrors reflect at once.
inline Color compensation(const Microfacets& facets, Vector<Local> viewer, Color facing) {
  if (facets.isSingle()) return Color(1);
  // A little more than what the table says, so that its errors gain nothing.
  const float once = std::min(1.0f, 1.0075f * mirrorAlbedo(facets.shape(), facets.alphaX(), facets.alphaY(), viewer));
  return Color(1) + facing * ((1 - once) / once);
}

/// Reflection on the side of the normal. `Model` has the names of a lobe, `normal`, `tangent`, `alphaX`, `alphaY` and
/// `finish`, and gives `fresnel(cosine)`, the colour that one facet reflects. Torrance and Sparrow 1967 in the form of
/// Walter et al. 2007, equation 20.
template <class Model>
class FacetLobe {
 public:
  static constexpr std::string_view name = Model::name;
  static constexpr std::string_view doc = Model::doc;
  static constexpr auto& fields = Model::fields;
  static constexpr ClosureTraits traits = Model::traits;

  FacetLobe(std::span<const float> p, const ClosurePoint& point)
      : model_(p, point),
        point_(point),
        frame_(model_.normal, model_.tangent, point.toViewer),
        facets_(model_.finish, model_.alphaX, model_.alphaY),
        viewer_(frame_.toLocal(point.toViewer)) {
    if (isVisible() && !isSmooth()) factor_ = compensation(facets_, viewer_, model_.fresnel(1));
  }

  bool isVisible() const { return viewer_.z > 1e-6f && dot(model_.normal, point_.toViewer) > 0; }

  Color evaluate(Vector<World> toLight) const {
    const std::optional<Pair> pair = pairOf(toLight);
    if (!pair) return {};
    const float shape = facets_.density(pair->h) * facets_.seenByBoth(viewer_, pair->light);
    return model_.fresnel(dot(viewer_, pair->h)) * factor_ * (shape / (4 * viewer_.z));
  }
  float pdf(Vector<World> toLight) const {
    const std::optional<Pair> pair = pairOf(toLight);
    return pair ? facets_.visibleDensity(viewer_, pair->h) / (4 * std::max(dot(viewer_, pair->h), 1e-12f)) : 0;
  }
  std::optional<ClosureSample> sample(const ClosureUniforms& u) const {
    if (isSmooth()) {
      ClosureSample sample;
      sample.direction = normalize(frame_.toWorld(reflectAt(viewer_, {0, 0, 1})));
      if (!isOnItsSide(point_, sample.direction, true)) return {};
      sample.isDelta = true;
      sample.pdf = 1;
      sample.weight = model_.fresnel(viewer_.z);
      return sample;
    }
    const Vector<Local> light = reflectAt(viewer_, facets_.sampleVisible(viewer_, u.place));
    if (!(light.z > 0)) return {};
    return sampleTowards(*this, normalize(frame_.toWorld(light)));
  }
  Color albedo() const {
    const Color once = model_.fresnel(viewer_.z);
    if (isSmooth()) return once;
    const float part = mirrorAlbedo(facets_.shape(), facets_.alphaX(), facets_.alphaY(), viewer_);
    const Color all = once * factor_ * part;
    return {std::min(all.r, 1.0f), std::min(all.g, 1.0f), std::min(all.b, 1.0f)};
  }

 private:
  struct Pair {
    Vector<Local> light, h;
  };

  bool isSmooth() const { return std::max(model_.alphaX, model_.alphaY) < 1e-3f; }

  std::optional<Pair> pairOf(Vector<World> toLight) const {
    if (isSmooth() || !isOnItsSide(point_, toLight, true)) return {};
    Pair pair;
    pair.light = frame_.toLocal(toLight);
    if (!(pair.light.z > 0)) return {};
    pair.h = normalize(viewer_ + pair.light);
    if (!(dot(viewer_, pair.h) > 0)) return {};
    return pair;
  }

  Model model_;
  const ClosurePoint& point_;
  LocalFrame frame_;
  Microfacets facets_;
  Vector<Local> viewer_;
  Color factor_{1};
};

}  // namespace aerosol::render
