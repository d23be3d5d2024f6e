// Matte matter below a boundary of a dielectric, without what the boundary itself reflects.
//
// Light enters with the transmittance 1 - R(l), is scattered by Lambert's law, of which the boundary sends back the
// part R' again and again, and leaves with 1 - R(v): f = (1 - R(v)) (1 - R(l)) a / (1 - a R') / (π eta²). Known as the
// diffuse part of a plastic (Weidlich and Wilkie 2007, "Arbitrarily Layered Micro-Facet Surfaces", for the idea; the
// mean R' of a smooth boundary by the fit of Egan and Hilgeman 1973). "Linear" scattering takes a = 1 in the
// denominator: reflections inside do not change the hue.

#include "core/render/facet_albedo.h"
#include "core/render/fresnel.h"
#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

namespace {

/// What a smooth boundary reflects of diffuse light from an inside with the index eta >= 1.
float innerReflectance(float eta) {
  const float inverse = 1 / eta;
  return -1.4399f * inverse * inverse + 0.7099f * inverse + 0.6681f + 0.0636f * eta;
}

struct CoatedDiffuse {
  static constexpr std::string_view name = "coated_diffuse_bsdf";
  static constexpr std::string_view doc = "Matte matter below a boundary of a dielectric";
  static constexpr bool transmits = false;
  static constexpr ClosureTraits traits{.hasExactAlbedo = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal, on the side that scatters"},
      {.name = "albedo", .type = FieldType::color, .unit = "", .doc = "What is scattered below, without the boundary"},
      {.name = "ior", .unit = "", .minimum = 1.05f, .maximum = 2.5f, .doc = "Index of the inside"},
      {.name = "roughness", .unit = "", .maximum = 1, .doc = "Width of the slopes of the boundary"},
      {.name = "nonlinear", .unit = "", .doc = "1: reflections inside deepen the colour"},
      {.name = "distribution",
       .type = FieldType::choice,
       .unit = "",
       .doc = "Of the microfacets",
       .choices = microfacetFinishes}};

  explicit CoatedDiffuse(std::span<const float> p)
      : normal(directionAt(p, 0)),
        color(colorAt(p, 3)),
        eta(std::max(p[6], 1.0f)),
        alpha(p[7]),
        isNonlinear(p[8] != 0),
        shape(Microfacets::finishAt(p[9]).shape) {}

  template <class Setting>
  Color value(const Setting& s) const {
    return inside() * (passes(s.viewer) * passes(s.light) * inversePi / (eta * eta));
  }
  Color albedo(float cosine) const {
    const Color below = inside() * (passes(cosine) * (1 - back()));
    return {std::min(below.r, 1.0f), std::min(below.g, 1.0f), std::min(below.b, 1.0f)};
  }

 private:
  bool isSmooth() const { return alpha < 1e-3f; }
  float passes(float cosine) const {
    return isSmooth() ? 1 - fresnelDielectric(cosine, eta) : coatTransmittance(shape, alpha, eta, cosine);
  }
  float back() const { return isSmooth() ? innerReflectance(eta) : coatInnerReflectance(shape, alpha, eta); }
  Color inside() const {
    Color c;
    const float reflected = back();
    for (int i = 0; i < 3; ++i) c[i] = color[i] / (1 - reflected * (isNonlinear ? color[i] : 1));
    return c;
  }

 public:
  Vector<World> normal;
  Color color;
  float eta, alpha;
  bool isNonlinear;
  Microfacets::Shape shape;
};

}  // namespace

void registerClosure_coated_diffuse_bsdf(Registry& registry) { registerLobe<CosineLobe<CoatedDiffuse>>(registry); }

}  // namespace aerosol::render
