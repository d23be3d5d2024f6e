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

/// The viewer is on the side that scatters: that of the shading normal, or of the geometry below it, so that smooth
/// meshes have no dark rims where the shading normal turns away first.
bool isVisible(const ClosurePoint& point, Vector<World> normal) {
  return dot(normal, point.toViewer) > 0 ||
         dot(point.toViewer, point.geometricNormal) * dot(normal, point.geometricNormal) > 0;
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
    const Vector<World> normal = shadingNormal(parameters);
    const float cosine = dot(normal, toLight);
    const bool isLit = cosine > 0 && isReflected(point, toLight) && isVisible(point, normal);
    return isLit ? cosine * (1 / std::numbers::pi_v<float>) : 0;
  }

  std::optional<ClosureSample> sample(std::span<const float> parameters, const ClosurePoint& point,
                                      const ClosureUniforms& u) const override {
    const Vector<World> direction = alongFrame(Frame<World>(shadingNormal(parameters)), toCosineHemisphere(u.place));
    const float density = pdf(parameters, point, direction);
    if (!(density > 0)) return {};
    return ClosureSample{.direction = direction, .weight = Color(1), .pdf = density};
  }

  Color albedo(std::span<const float> parameters, const ClosurePoint& point) const override {
    return Color(isVisible(point, shadingNormal(parameters)) ? 1.0f : 0.0f);
  }
};

}  // namespace

void registerClosure_diffuse(Registry& registry) { registry.add(std::make_unique<Diffuse>()); }

}  // namespace aerosol::render
