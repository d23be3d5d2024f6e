// Light that goes through a body below a matte sheet: skin, wax, marble. Where it leaves,
// core/render/subsurface_walk.h.

#include "plugins/closures/body_entry.h"

namespace aerosol::render {

namespace {

constexpr DescribedField bodyFields[] = {
    {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
    {.name = "albedo", .type = FieldType::color, .unit = "", .doc = "What a thick body reflects of even light"},
    {.name = "radius", .type = FieldType::color, .unit = "scene units", .doc = "Mean free path in the body"},
    {.name = "anisotropy", .unit = "", .minimum = -0.9f, .maximum = 0.9f, .doc = "Mean cosine of its scattering"}};

class MatteBody final : public Closure {
 public:
  std::string_view name() const override { return "subsurface_bssrdf"; }
  std::string_view doc() const override { return "Subsurface scattering below a matte sheet"; }
  std::span<const DescribedField> fields() const override { return bodyFields; }
  ClosureKind kind() const override { return ClosureKind::subsurface; }

  Color albedo(std::span<const float> p, const ClosurePoint&) const override { return unitColor(colorAt(p, 3)); }
  SubsurfaceBody body(std::span<const float> p) const override {
    return bodyThatReflects(colorAt(p, 3), colorAt(p, 6), p[9]);
  }
  std::optional<ClosureSample> sample(std::span<const float> p, const ClosurePoint& point,
                                      const ClosureUniforms& u) const override {
    const Vector<World> n = directionAt(p, 0);
    const Vector<World> inward = dot(n, point.toViewer) > 0 ? -n : n;
    return entering(point, alongFrame(Frame<World>(inward), toCosineHemisphere(u.place)), 1);
  }
};

}  // namespace

void registerClosure_subsurface_bssrdf(Registry& registry) { registry.add(std::make_unique<MatteBody>()); }

}  // namespace aerosol::render
