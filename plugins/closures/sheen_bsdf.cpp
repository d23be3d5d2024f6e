// Fibres that stand out of cloth and shine at its edges.
//
// Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF": normals with the density (2 + 1/r) sin^(1/r) /
// 2π, with the visibility of Neubelt and Pettineo 2013, 1 / (4 (l + v - l v)). Where that gains energy (r below 0.15,
// at grazing views) it is divided by its albedo.

#include "plugins/closures/cosine_albedo.h"
#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

namespace {

constexpr float leastRoughness = 0.05f;

/// π f.
float sheen(float roughness, float viewer, float light, float between) {
  const float r = std::clamp(roughness, leastRoughness, 1.0f);
  const float half = std::max(2 + 2 * between, 1e-6f), sum = viewer + light;
  const float sine2 = std::max(0.0f, 1 - sum * sum / half);
  const float density = 0.5f * (2 + 1 / r) * std::pow(sine2, 0.5f / r);
  return density / (4 * std::max(light + viewer - light * viewer, 1e-6f));
}

struct Sheen {
  static constexpr std::string_view name = "sheen_bsdf";
  static constexpr std::string_view doc = "The shine of cloth at its edges";
  static constexpr bool transmits = false;
  static constexpr ClosureTraits traits{.isReciprocal = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal, on the side that scatters"},
      {.name = "albedo", .type = FieldType::color, .unit = "", .doc = "Factor of what is scattered"},
      {.name = "roughness",
       .unit = "",
       .minimum = leastRoughness,
       .maximum = 1,
       .doc = "0.05 a thin rim, 1 a wide one"}};

  explicit Sheen(std::span<const float> p) : normal(directionAt(p, 0)), color(colorAt(p, 3)), roughness(p[6]) {}

  template <class Setting>
  Color value(const Setting& s) const {
    const float shape = sheen(roughness, s.viewer, s.light, s.between);
    return color * (inversePi * shape / table().excess(std::max(roughness, leastRoughness), s.viewer));
  }
  Color albedo(float cosine) const {
    return color * std::clamp(table()(std::max(roughness, leastRoughness), cosine), 1e-4f, 1.0f);
  }

  static const CosineAlbedo& table() {
    static const CosineAlbedo known(sheen);
    return known;
  }

  Vector<World> normal;
  Color color;
  float roughness;
};

}  // namespace

void registerClosure_sheen_bsdf(Registry& registry) { registerLobe<CosineLobe<Sheen>>(registry); }

}  // namespace aerosol::render
