// A boundary between two dielectrics, smooth or of microfacets: reflection and refraction.

#include "core/render/fresnel.h"
#include "core/render/thin_film.h"
#include "plugins/closures/facet_boundary.h"

namespace aerosol::render {

namespace {

struct Dielectric {
  static constexpr std::string_view name = "dielectric_bsdf";
  static constexpr std::string_view doc = "Reflection and refraction by a boundary of dielectrics";
  static constexpr ClosureTraits traits{.isReciprocal = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
      {.name = "U", .type = FieldType::direction, .unit = "", .doc = "Direction of roughness_x"},
      {.name = "reflection_tint", .type = FieldType::color, .unit = "", .doc = "Factor of what is reflected"},
      {.name = "transmission_tint", .type = FieldType::color, .unit = "", .doc = "Factor of what is refracted"},
      {.name = "roughness_x", .unit = "", .minimum = 0.05f, .doc = "Width of the slopes along U"},
      {.name = "roughness_y", .unit = "", .minimum = 0.05f, .doc = "Width of the slopes across U"},
      {.name = "ior",
       .unit = "",
       .minimum = 1.05f,
       .maximum = 2.5f,
       .doc = "Index of refraction of the inside; the media's own where they say one"},
      {.name = "distribution",
       .type = FieldType::choice,
       .unit = "",
       .doc = "Of the microfacets",
       .choices = microfacetFinishes},
      {.name = "thinfilm_thickness", .unit = "nm", .maximum = 1000, .doc = "Of a film on top; 0: none"},
      {.name = "thinfilm_ior", .unit = "", .minimum = 1, .maximum = 2.5f, .doc = "Index of refraction of the film"}};

  Dielectric(std::span<const float> p, const ClosurePoint& point)
      : normal(directionAt(p, 0)),
        tangent(directionAt(p, 3)),
        reflectionTint(colorAt(p, 6)),
        transmissionTint(colorAt(p, 9)),
        alphaX(p[12]),
        alphaY(p[13]),
        eta(point.relativeIor(p[14])),
        finish(Microfacets::finishAt(p[15])),
        film(filmAt(point, p[16], p[17], eta)) {}

  /// Whether facets do not reflect as Fresnel's equations say for `eta`.
  bool hasOwnCurve() const { return film.isThere(); }
  Color curve(float cosine) const {
    if (film.isThere()) return filmReflectance(film, cosine, Color(eta), Color());
    return Color(fresnelDielectric(cosine, eta));
  }

  Vector<World> normal, tangent;
  Color reflectionTint, transmissionTint;
  float alphaX, alphaY, eta;
  Microfacets::Finish finish;
  ThinFilm film;
};

}  // namespace

void registerClosure_dielectric_bsdf(Registry& registry) { registerLobe<FacetBoundary<Dielectric>>(registry); }

}  // namespace aerosol::render
