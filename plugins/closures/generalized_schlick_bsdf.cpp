// Microfacets whose reflectance is Schlick's curve between two colours: an artist's metal, glass or coat. What refracts
// bends by the index that reflects f0.

#include "core/render/fresnel.h"
#include "core/render/thin_film.h"
#include "plugins/closures/facet_boundary.h"

namespace aerosol::render {

namespace {

float indexThatReflects(float f0) {
  const float root = std::sqrt(std::clamp(f0, 0.0f, 0.95f));
  return (1 + root) / (1 - root);
}

struct GeneralizedSchlick {
  static constexpr std::string_view name = "generalized_schlick_bsdf";
  static constexpr std::string_view doc = "Reflection and refraction by microfacets with Schlick's reflectance";
  static constexpr ClosureTraits traits{.isReciprocal = false, .hasExactAlbedo = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
      {.name = "U", .type = FieldType::direction, .unit = "", .doc = "Direction of roughness_x"},
      {.name = "reflection_tint", .type = FieldType::color, .unit = "", .doc = "Factor of what is reflected"},
      {.name = "transmission_tint", .type = FieldType::color, .unit = "", .doc = "Factor of what is refracted"},
      {.name = "roughness_x", .unit = "", .minimum = 0.05f, .doc = "Width of the slopes along U"},
      {.name = "roughness_y", .unit = "", .minimum = 0.05f, .doc = "Width of the slopes across U"},
      {.name = "f0", .type = FieldType::color, .unit = "", .doc = "Reflectance seen straight on"},
      {.name = "f90", .type = FieldType::color, .unit = "", .doc = "Reflectance at grazing angles"},
      {.name = "exponent",
       .unit = "",
       .minimum = 1,
       .maximum = 10,
       .doc = "How late one becomes the other; 5 is glass"},
      {.name = "distribution",
       .type = FieldType::choice,
       .unit = "",
       .doc = "Of the microfacets",
       .choices = microfacetFinishes},
      {.name = "thinfilm_thickness", .unit = "nm", .maximum = 1000, .doc = "Of a film on top; 0: none"},
      {.name = "thinfilm_ior", .unit = "", .minimum = 1, .maximum = 2.5f, .doc = "Index of refraction of the film"}};

  GeneralizedSchlick(std::span<const float> p, const ClosurePoint& point)
      : normal(directionAt(p, 0)),
        tangent(directionAt(p, 3)),
        reflectionTint(colorAt(p, 6)),
        transmissionTint(colorAt(p, 9)),
        f0(colorAt(p, 14)),
        f90(colorAt(p, 17)),
        alphaX(p[12]),
        alphaY(p[13]),
        exponent(p[20]),
        eta(point.relativeIor(indexThatReflects(average(f0)))),
        finish(Microfacets::finishAt(p[21])),
        film(filmAt(point, p[22], p[23], eta)) {}

  Color curve(float cosine) const {
    if (film.isThere()) return filmReflectance(film, cosine, baseIndex(), Color());
    const Color reflectance = fresnelSchlick(cosineOutside(cosine), f0, f90, exponent);
    return {std::clamp(reflectance.r, 0.0f, 1.0f), std::clamp(reflectance.g, 0.0f, 1.0f),
            std::clamp(reflectance.b, 0.0f, 1.0f)};
  }

  Vector<World> normal, tangent;
  Color reflectionTint, transmissionTint, f0, f90;
  float alphaX, alphaY, exponent, eta;
  Microfacets::Finish finish;
  ThinFilm film;

 private:
  /// From the denser side by the angle on the other one, which is 90 degrees where reflection is total.
  float cosineOutside(float cosine) const {
    return eta >= 1 ? cosine : std::sqrt(std::max(0.0f, 1 - (1 - cosine * cosine) / (eta * eta)));
  }
  /// Below a film f0 says what the base is made of, by channel.
  Color baseIndex() const {
    Color index;
    for (int c = 0; c < 3; ++c) index[c] = indexThatReflects(f0[c]);
    return eta >= 1 ? index : Color(1 / index.r, 1 / index.g, 1 / index.b);
  }
};

}  // namespace

void registerClosure_generalized_schlick_bsdf(Registry& registry) {
  registerLobe<FacetBoundary<GeneralizedSchlick>>(registry);
}

}  // namespace aerosol::render
