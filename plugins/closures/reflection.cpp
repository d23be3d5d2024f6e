// A mirror, or with an index of refraction what a polished dielectric reflects.

#include "core/render/fresnel.h"
#include "plugins/closures/facet_lobe.h"

namespace aerosol::render {

namespace {

struct Reflection {
  static constexpr std::string_view name = "reflection";
  static constexpr std::string_view doc = "Mirror reflection";
  static constexpr ClosureTraits traits{};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
      {.name = "eta", .unit = "", .maximum = 3, .doc = "Index of the inside; 0: everything is reflected"}};

  Reflection(std::span<const float> p, const ClosurePoint& point)
      : normal(directionAt(p, 0)), eta(p[3] > 0 ? point.relativeIor(p[3]) : 0) {
    // From both sides, as glass does.
    if (dot(normal, point.toViewer) < 0) normal = -normal;
  }

  Color fresnel(float cosine) const { return Color(eta > 0 ? fresnelDielectric(cosine, eta) : 1); }

  Vector<World> normal, tangent;
  float alphaX = 0, alphaY = 0, eta;
  Microfacets::Finish finish;
};

}  // namespace

void registerClosure_reflection(Registry& registry) { registerLobe<FacetLobe<Reflection>>(registry); }

}  // namespace aerosol::render
