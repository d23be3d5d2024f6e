// The classic closure of microfacets: reflection (refract 0), refraction (1) or both (2) by a dielectric; with an index
// of 0, facets of perfect mirrors.

#include "core/render/fresnel.h"
#include "plugins/closures/facet_boundary.h"

namespace aerosol::render {

namespace {

constexpr float indexOfMirrors = 1e4f;  // Lets nothing through at a second meeting either.

struct Microfacet {
  static constexpr std::string_view name = "microfacet";
  static constexpr std::string_view doc = "Reflection or refraction by microfacets";
  static constexpr ClosureTraits traits{.isReciprocal = false, .hasExactAlbedo = false};
  static constexpr DescribedField fields[] = {
      {.name = "distribution",
       .type = FieldType::choice,
       .unit = "",
       .doc = "Of the microfacets",
       .choices = microfacetFinishes},
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
      {.name = "T", .type = FieldType::direction, .unit = "", .doc = "Direction of xalpha"},
      {.name = "xalpha", .unit = "", .minimum = 0.05f, .doc = "Width of the slopes along T"},
      {.name = "yalpha", .unit = "", .minimum = 0.05f, .doc = "Width of the slopes across T"},
      {.name = "alpha",
       .unit = "",
       .minimum = 0.05f,
       .doc = "Width of the slopes in all directions",
       .defaultValue = -1},
      {.name = "eta", .unit = "", .maximum = 3, .doc = "Index of the inside; 0: mirrors"},
      {.name = "refract", .unit = "", .maximum = 2, .doc = "0 reflection, 1 refraction, 2 both"}};

  Microfacet(std::span<const float> p, const ClosurePoint& point)
      : normal(directionAt(p, 1)),
        tangent(directionAt(p, 4)),
        alphaX(p[9] >= 0 ? p[9] : p[7]),
        alphaY(p[9] >= 0 ? p[9] : p[8]),
        isMirror(p[10] <= 0),
        eta(isMirror ? indexOfMirrors : point.relativeIor(std::max(p[10], 0.1f))),
        reflectionTint(isMirror || static_cast<int>(p[11]) != 1 ? 1 : 0),
        transmissionTint(!isMirror && static_cast<int>(p[11]) >= 1 ? 1 : 0),
        finish(Microfacets::finishAt(p[0])) {}

  bool hasOwnCurve() const { return isMirror; }
  Color curve(float cosine) const { return Color(isMirror ? 1 : fresnelDielectric(cosine, eta)); }

  Vector<World> normal, tangent;
  float alphaX, alphaY;
  bool isMirror;
  float eta;
  Color reflectionTint, transmissionTint;
  Microfacets::Finish finish;
};

}  // namespace

void registerClosure_microfacet(Registry& registry) { registerLobe<FacetBoundary<Microfacet>>(registry); }

}  // namespace aerosol::render
