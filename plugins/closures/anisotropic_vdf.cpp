// What lies inside a surface, as MaterialX says it below a dielectric: a homogeneous medium. Bending is up to the
// dielectric.

#include <algorithm>

#include "core/render/closure.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

constexpr DescribedField mediumFields[] = {
    {.name = "albedo", .type = FieldType::color, .unit = "", .doc = "Part of the extinction that scatters"},
    {.name = "extinction",
     .type = FieldType::color,
     .unit = "1/scene unit",
     .maximum = 10,
     .doc = "Collisions per distance; below 0 counts as 0"},
    {.name = "anisotropy", .unit = "", .minimum = -1, .maximum = 1, .doc = "Mean cosine of scattering"}};

class AnisotropicMedium final : public Closure {
 public:
  std::string_view name() const override { return "anisotropic_vdf"; }
  std::string_view doc() const override { return "The medium inside the surface, by its extinction"; }
  std::span<const DescribedField> fields() const override { return mediumFields; }
  ClosureKind kind() const override { return ClosureKind::interior; }
  InteriorMatter interior(std::span<const float> p) const override {
    InteriorMatter matter;
    for (int i = 0; i < 3; ++i) {
      matter.sigmaT[i] = std::max(p[static_cast<std::size_t>(3 + i)], 0.0f);
      matter.sigmaS[i] = matter.sigmaT[i] * std::max(p[static_cast<std::size_t>(i)], 0.0f);
    }
    matter.anisotropy = p[6];
    return matter;
  }
};

}  // namespace

void registerClosure_anisotropic_vdf(Registry& registry) { registry.add(std::make_unique<AnisotropicMedium>()); }

}  // namespace aerosol::render
