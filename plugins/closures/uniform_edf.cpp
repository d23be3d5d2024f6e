// Emission with a colour of its own.

#include "core/render/closure.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

constexpr DescribedField emissionFields[] = {
    {.name = "emittance", .type = FieldType::color, .unit = "W/(m² sr)", .doc = "Radiance in every direction"}};

class UniformEmission final : public Closure {
 public:
  std::string_view name() const override { return "uniform_edf"; }
  std::string_view doc() const override { return "Emits alike in every direction"; }
  std::span<const DescribedField> fields() const override { return emissionFields; }
  ClosureKind kind() const override { return ClosureKind::emission; }

  Color emitted(std::span<const float> p, const ClosurePoint&) const override { return {p[0], p[1], p[2]}; }
};

}  // namespace

void registerClosure_uniform_edf(Registry& registry) { registry.add(std::make_unique<UniformEmission>()); }

}  // namespace aerosol::render
