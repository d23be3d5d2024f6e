// Lambert's law for what passes through a thin sheet: f = 1/π towards the other side, from either.

#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

namespace {

struct Translucent {
  static constexpr std::string_view name = "translucent";
  static constexpr std::string_view doc = "Ideal matte transmission";
  static constexpr bool transmits = true;
  static constexpr ClosureTraits traits{};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"}};

  explicit Translucent(std::span<const float> p) : normal(directionAt(p, 0)) {}
  template <class Setting>
  Color value(const Setting&) const {
    return Color(inversePi);
  }
  Color albedo(float) const { return Color(1); }

  Vector<World> normal;
};

}  // namespace

void registerClosure_translucent(Registry& registry) { registerLobe<CosineLobe<Translucent>>(registry); }

}  // namespace aerosol::render
