// What lies inside a surface: a homogeneous medium with an index of refraction and a priority.

#include <algorithm>
#include <cmath>

#include "core/render/closure.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

constexpr DescribedField mediumFields[] = {
    {.name = "albedo", .type = FieldType::color, .unit = "", .doc = "Part of the extinction that scatters"},
    {.name = "transmission_depth",
     .unit = "scene units",
     .maximum = 10,
     .doc = "Distance after which white light has transmission_color; 0: no extinction"},
    {.name = "transmission_color", .type = FieldType::color, .unit = "", .doc = "What is left there"},
    {.name = "anisotropy", .unit = "", .minimum = -1, .maximum = 1, .doc = "Mean cosine of scattering"},
    {.name = "ior", .unit = "", .minimum = 1, .maximum = 3, .doc = "Index of refraction"},
    {.name = "priority", .unit = "", .maximum = 100, .doc = "Which of two overlapping media rules; 0: off"}};

/// Extinction from the colour that white light has after a distance (0: none).
Color extinctionOf(Color transmission, float depth) {
  if (!(depth > 0)) return Color();
  Color sigma;
  for (int i = 0; i < 3; ++i) sigma[i] = -std::log(std::clamp(transmission[i], 1e-6f, 1.0f)) / depth;
  return sigma;
}

class Medium final : public Closure {
 public:
  std::string_view name() const override { return "medium_vdf"; }
  std::string_view doc() const override { return "The medium inside the surface"; }
  std::span<const DescribedField> fields() const override { return mediumFields; }
  ClosureKind kind() const override { return ClosureKind::interior; }
  InteriorMatter interior(std::span<const float> p) const override {
    const Color sigmaT = extinctionOf({p[4], p[5], p[6]}, p[3]);
    return {sigmaT, sigmaT * Color(p[0], p[1], p[2]), p[7], p[8], static_cast<int>(p[9])};
  }
};

}  // namespace

void registerClosure_medium_vdf(Registry& registry) { registry.add(std::make_unique<Medium>()); }

}  // namespace aerosol::render
