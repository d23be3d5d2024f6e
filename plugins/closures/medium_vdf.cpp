// What lies inside a surface: a homogeneous medium with an index of refraction and a priority.

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

class Medium final : public Closure {
 public:
  std::string_view name() const override { return "medium_vdf"; }
  std::string_view doc() const override { return "The medium inside the surface"; }
  std::span<const DescribedField> fields() const override { return mediumFields; }
  ClosureKind kind() const override { return ClosureKind::interior; }
};

}  // namespace

void registerClosure_medium_vdf(Registry& registry) { registry.add(std::make_unique<Medium>()); }

}  // namespace aerosol::render
