// Lambert's law: f = 1/π on the side of the normal.

#include <cmath>
#include <numbers>

#include "core/render/closure.h"
#include "core/render/registry.h"
#include "core/render/warp.h"

namespace aerosol::render {

namespace {

constexpr DescribedField diffuseFields[] = {
    {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal, on the side that scatters"}};

Vector<World> shadingNormal(std::span<const float> parameters) { return {parameters[0], parameters[1], parameters[2]}; }

/// The viewer and the light are on one side of the surface, whatever the shading normal says: light does not leak.
bool isReflected(const ClosurePoint& point, Vector<World> toLight) {
  return dot(point.toViewer, point.geometricNormal) * dot(toLight, point.geometricNormal) > 0;
}

class Diffuse final : public Closure {
 public:
  std::string_view name() const override { return "diffuse"; }
  std::string_view doc() const override { return "Ideal matte reflection"; }
  std::span<const DescribedField> fields() const override { return diffuseFields; }
  ClosureKind kind() const override { return ClosureKind::scattering; }
  ClosureTraits traits() const override { return {.isDiffuse = true}; }

  Color evaluate(std::span<const float> parameters, const ClosurePoint& point, Vector<World> toLight) const override {
    return Color(pdf(parameters, point, toLight));
  }

  float pdf(std::span<const float> parameters, const ClosurePoint& point, Vector<World> toLight) const override {
    const float cosine = dot(shadingNormal(parameters), toLight);
    return cosine > 0 && isReflected(point, toLight) ? cosine * (1 / std::numbers::pi_v<float>) : 0;
  }

  std::optional<ClosureSample> sample(std::span<const float> parameters, const ClosurePoint& point,
                                      const ClosureUniforms& u) const override {
    const Vector<World> direction = alongFrame(Frame<World>(shadingNormal(parameters)), toCosineHemisphere(u.place));
    const float density = pdf(parameters, point, direction);
    if (!(density > 0)) return {};
    return ClosureSample{.direction = direction, .weight = Color(1), .pdf = density};
  }

  Color albedo(std::span<const float>, const ClosurePoint&) const override { return Color(1); }
};

}  // namespace

void registerClosure_diffuse(Registry& registry) { registry.add(std::make_unique<Diffuse>()); }

}  // namespace aerosol::render
