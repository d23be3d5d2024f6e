// The diffuse part of Disney's material.
//
// Burley 2012, "Physically Based Shading at Disney", section 5.3. Its albedo passes 1 at grazing views of rough
// surfaces; there it is divided by its albedo, which costs reciprocity where the model gains energy and nowhere else.

#include "plugins/closures/cosine_albedo.h"
#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

namespace {

float grazing(float cosine) {
  const float m = std::clamp(1 - cosine, 0.0f, 1.0f), square = m * m;
  return square * square * m;
}

/// π f. The squared cosine between light and halfway vector is (1 + between) / 2.
float burley(float roughness, float viewer, float light, float between) {
  const float more = roughness * (1 + between) - 0.5f;
  return (1 + more * grazing(viewer)) * (1 + more * grazing(light));
}

struct BurleyDiffuse {
  static constexpr std::string_view name = "burley_diffuse_bsdf";
  static constexpr std::string_view doc = "Matte reflection with bright or dark edges";
  static constexpr bool transmits = false;
  static constexpr ClosureTraits traits{.isReciprocal = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal, on the side that scatters"},
      {.name = "albedo", .type = FieldType::color, .unit = "", .doc = "Part of the light that is scattered back"},
      {.name = "roughness", .unit = "", .maximum = 1, .doc = "0: dark edges; 1: bright ones"}};

  explicit BurleyDiffuse(std::span<const float> p)
      : normal(directionAt(p, 0)), color(colorAt(p, 3)), roughness(std::clamp(p[6], 0.0f, 1.0f)) {}

  template <class Setting>
  Color value(const Setting& s) const {
    const float shape = burley(roughness, s.viewer, s.light, s.between);
    return color * (inversePi * shape / table().excess(roughness, s.viewer));
  }
  Color albedo(float cosine) const { return color * std::min(1.0f, table()(roughness, cosine)); }

  static const CosineAlbedo& table() {
    static const CosineAlbedo known(burley);
    return known;
  }

  Vector<World> normal;
  Color color;
  float roughness;
};

}  // namespace

void registerClosure_burley_diffuse_bsdf(Registry& registry) { registerLobe<CosineLobe<BurleyDiffuse>>(registry); }

}  // namespace aerosol::render
