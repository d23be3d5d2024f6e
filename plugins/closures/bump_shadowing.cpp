// Light that reaches a turned normal although the surface itself nearly turns away from it, dimmed: without this the
// edge of the light on bumps is hard.
//
// Conty Estevez, Lecocq and Stein 2019, "A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem":
// the turned normal is taken for one of a GGX distribution, of which it is as likely as one in eight; its masking for
// the light is the factor.

#include <algorithm>
#include <cmath>

#include "core/render/closure.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

constexpr DescribedField shadowingFields[] = {
    {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Normal before it was turned"},
    {.name = "bumped", .type = FieldType::direction, .unit = "", .doc = "And after that"}};

float squaredTangent(float cosine) {
  const float c = std::clamp(std::fabs(cosine), 1e-6f, 1.0f);
  return (1 - c * c) / (c * c);
}

class BumpShadowing final : public Closure {
 public:
  std::string_view name() const override { return "bump_shadowing"; }
  std::string_view doc() const override { return "Dims what lies below where light reaches its turned normal alone"; }
  std::span<const DescribedField> fields() const override { return shadowingFields; }
  ClosureKind kind() const override { return ClosureKind::shadowing; }

  float shadowing(std::span<const float> p, Vector<World> toLight) const override {
    const Vector<World> normal(p[0], p[1], p[2]), bumped(p[3], p[4], p[5]);
    const float square = std::min(0.125f * squaredTangent(dot(normal, bumped)), 1.0f);
    return 2 / (1 + std::sqrt(1 + square * squaredTangent(dot(normal, toLight))));
  }
};

}  // namespace

void registerClosure_bump_shadowing(Registry& registry) { registry.add(std::make_unique<BumpShadowing>()); }

}  // namespace aerosol::render
