// Metal: microfacets that reflect as Fresnel's equations say for a complex index.

#include "core/render/fresnel.h"
#include "core/render/thin_film.h"
#include "plugins/closures/facet_lobe.h"

namespace aerosol::render {

namespace {

struct Conductor {
  static constexpr std::string_view name = "conductor_bsdf";
  static constexpr std::string_view doc = "Reflection by metal";
  static constexpr ClosureTraits traits{.isReciprocal = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
      {.name = "U", .type = FieldType::direction, .unit = "", .doc = "Direction of roughness_x"},
      {.name = "roughness_x", .unit = "", .minimum = 0.05f, .doc = "Width of the slopes along U"},
      {.name = "roughness_y", .unit = "", .minimum = 0.05f, .doc = "Width of the slopes across U"},
      {.name = "ior", .type = FieldType::color, .unit = "", .doc = "Real part of the index of refraction"},
      {.name = "extinction", .type = FieldType::color, .unit = "", .doc = "Imaginary part"},
      {.name = "distribution",
       .type = FieldType::choice,
       .unit = "",
       .doc = "Of the microfacets",
       .choices = microfacetFinishes},
      {.name = "thinfilm_thickness", .unit = "nm", .maximum = 1000, .doc = "Of a film on top; 0: none"},
      {.name = "thinfilm_ior", .unit = "", .minimum = 1, .maximum = 2.5f, .doc = "Index of refraction of the film"}};

  Conductor(std::span<const float> p, const ClosurePoint&)
      : normal(directionAt(p, 0)),
        tangent(directionAt(p, 3)),
        alphaX(p[6]),
        alphaY(p[7]),
        ior(colorAt(p, 8)),
        extinction(colorAt(p, 11)),
        finish(Microfacets::finishAt(p[14])),
        film{p[15], p[16]} {}

  Color fresnel(float cosine) const {
    if (film.isThere()) return filmReflectance(film, cosine, ior, extinction);
    Color f;
    for (int i = 0; i < 3; ++i) f[i] = fresnelConductor(cosine, ior[i], extinction[i]);
    return f;
  }

  Vector<World> normal, tangent;
  float alphaX, alphaY;
  Color ior, extinction;
  Microfacets::Finish finish;
  ThinFilm film;
};

}  // namespace

void registerClosure_conductor_bsdf(Registry& registry) { registerLobe<FacetLobe<Conductor>>(registry); }

}  // namespace aerosol::render
