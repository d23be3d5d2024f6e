// Rough matte reflection, classic.

#include "plugins/closures/lobe_closure.h"
#include "plugins/closures/oren_nayar_qualitative.h"

namespace aerosol::render {

namespace {

struct OrenNayar {
  static constexpr std::string_view name = "oren_nayar";
  static constexpr std::string_view doc = "Rough matte reflection";
  static constexpr bool transmits = false;
  static constexpr ClosureTraits traits{.hasExactAlbedo = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal, on the side that scatters"},
      {.name = "sigma", .unit = "radians", .maximum = 1, .doc = "Standard deviation of the angle of the facets"}};

  explicit OrenNayar(std::span<const float> p) : normal(directionAt(p, 0)), sigma(p[3]) {}
  template <class Setting>
  Color value(const Setting& s) const {
    return Color(inversePi * orenNayar(sigma, s.viewer, s.light, s.between));
  }
  Color albedo(float) const { return Color(1); }

  Vector<World> normal;
  float sigma;
};

}  // namespace

void registerClosure_oren_nayar(Registry& registry) { registerLobe<CosineLobe<OrenNayar>>(registry); }

}  // namespace aerosol::render
