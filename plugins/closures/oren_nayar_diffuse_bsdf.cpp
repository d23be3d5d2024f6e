// Rough matte reflection, with or without what is reflected several times between the facets.
//
// With: Portsmouth, Kutz and Hill 2025, "EON: A practical energy-preserving rough diffuse BRDF": Fujii's form of
// Oren-Nayar, of which the directional albedo E is known, and a reciprocal lobe (1 - E(v)) (1 - E(l)) for the rest.

#include "plugins/closures/lobe_closure.h"
#include "plugins/closures/oren_nayar_qualitative.h"

namespace aerosol::render {

namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr float first = 0.5f - 2 / (3 * pi);         // of the scale of the single lobe
constexpr float second = 2.0f / 3 - 28 / (15 * pi);  // of its mean albedo

float scaleOf(float roughness) { return 1 / (1 + first * roughness); }

/// Directional albedo of the single lobe (their equation 15).
float singleAlbedo(float cosine, float roughness) {
  const float c = std::clamp(cosine, 1e-4f, 1.0f), sine = std::sqrt(std::max(0.0f, 1 - c * c));
  const float g = sine * (std::acos(c) - sine * c) + 2.0f / 3 * ((sine / c) * (1 - sine * sine * sine) - sine);
  return scaleOf(roughness) * (1 + roughness / pi * g);
}

struct OrenNayarDiffuse {
  static constexpr std::string_view name = "oren_nayar_diffuse_bsdf";
  static constexpr std::string_view doc = "Rough matte reflection with a colour";
  static constexpr bool transmits = false;
  static constexpr ClosureTraits traits{.hasExactAlbedo = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal, on the side that scatters"},
      {.name = "albedo", .type = FieldType::color, .unit = "", .doc = "Part of the light that is scattered back"},
      {.name = "roughness", .unit = "", .maximum = 1, .doc = "0 is Lambert's law; 1 facets of all slopes"},
      {.name = "energy_compensation", .unit = "", .doc = "1: light between facets is not lost"}};

  explicit OrenNayarDiffuse(std::span<const float> p)
      : normal(directionAt(p, 0)),
        color(colorAt(p, 3)),
        roughness(std::clamp(p[6], 0.0f, 1.0f)),
        isPreserving(p[7] != 0) {}

  template <class Setting>
  Color value(const Setting& s) const {
    if (!isPreserving) return color * (inversePi * orenNayar(roughness, s.viewer, s.light, s.between));
    const float between = s.between - s.viewer * s.light;
    const float ratio = between > 0 ? between / std::max(s.viewer, s.light) : between;
    const float lost = (1 - singleAlbedo(s.viewer, roughness)) * (1 - singleAlbedo(s.light, roughness)) /
                       std::max(1 - meanAlbedo(), 1e-6f);
    return (color * (scaleOf(roughness) * (1 + roughness * ratio)) + several() * std::max(lost, 0.0f)) * inversePi;
  }
  Color albedo(float cosine) const {
    if (!isPreserving) return color;
    const float once = singleAlbedo(cosine, roughness);
    return color * once + several() * (1 - once);
  }

  float meanAlbedo() const { return scaleOf(roughness) * (1 + second * roughness); }
  /// Colour of what leaves after two or more reflections.
  Color several() const {
    const float mean = meanAlbedo();
    Color c;
    for (int i = 0; i < 3; ++i) c[i] = color[i] * color[i] * mean / std::max(1 - color[i] * (1 - mean), 1e-6f);
    return c;
  }

  Vector<World> normal;
  Color color;
  float roughness;
  bool isPreserving;
};

}  // namespace

void registerClosure_oren_nayar_diffuse_bsdf(Registry& registry) {
  registerLobe<CosineLobe<OrenNayarDiffuse>>(registry);
}

}  // namespace aerosol::render
