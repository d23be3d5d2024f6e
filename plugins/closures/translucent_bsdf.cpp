// Lambert's law for what passes through a thin sheet, with a colour.

#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

namespace {

struct TranslucentBsdf {
  static constexpr std::string_view name = "translucent_bsdf";
  static constexpr std::string_view doc = "Ideal matte transmission with a colour";
  static constexpr bool transmits = true;
  static constexpr ClosureTraits traits{};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
      {.name = "albedo", .type = FieldType::color, .unit = "", .doc = "Part of the light that passes"}};

  explicit TranslucentBsdf(std::span<const float> p) : normal(directionAt(p, 0)), color(colorAt(p, 3)) {}
  template <class Setting>
  Color value(const Setting&) const {
    return color * inversePi;
  }
  Color albedo(float) const { return color; }

  Vector<World> normal;
  Color color;
};

}  // namespace

void registerClosure_translucent_bsdf(Registry& registry) { registerLobe<CosineLobe<TranslucentBsdf>>(registry); }

}  // namespace aerosol::render
