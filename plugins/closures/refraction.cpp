// What a polished dielectric refracts.

#include "core/render/fresnel.h"
#include "plugins/closures/facet_boundary.h"

namespace aerosol::render {

namespace {

struct Refraction {
  static constexpr std::string_view name = "refraction";
  static constexpr std::string_view doc = "Refraction by a polished boundary";
  static constexpr ClosureTraits traits{};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
      {.name = "eta", .unit = "", .minimum = 1.05f, .maximum = 3, .doc = "Index of the inside"}};

  Refraction(std::span<const float> p, const ClosurePoint& point)
      : normal(directionAt(p, 0)), eta(p[3] > 0 ? point.relativeIor(p[3]) : 1) {}

  bool hasOwnCurve() const { return false; }
  Color curve(float cosine) const { return Color(fresnelDielectric(cosine, eta)); }

  Color reflectionTint{0.0f}, transmissionTint{1.0f};
  Vector<World> normal, tangent;
  float alphaX = 0, alphaY = 0, eta;
  Microfacets::Finish finish;
};

}  // namespace

void registerClosure_refraction(Registry& registry) { registerLobe<FacetBoundary<Refraction>>(registry); }

}  // namespace aerosol::render
