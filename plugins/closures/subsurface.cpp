// The language's older closure of subsurface scattering: the body lies below a polished dielectric boundary, which
// bends light that enters, and sends part of what would leave back inside. What the boundary reflects at once is not
// part of it: a reflection beside it shows that.

#include "core/render/fresnel.h"
#include "plugins/closures/body_entry.h"

namespace aerosol::render {

namespace {

constexpr DescribedField bodyFields[] = {
    {.name = "eta", .unit = "", .minimum = 1.05f, .maximum = 2.5f, .doc = "Index of refraction of the body"},
    {.name = "g", .unit = "", .minimum = -0.9f, .maximum = 0.9f, .doc = "Mean cosine of its scattering"},
    {.name = "mfp", .type = FieldType::color, .unit = "scene units", .doc = "Mean free path in the body"},
    {.name = "albedo",
     .type = FieldType::color,
     .unit = "",
     .doc = "What a thick body would reflect of even light without its boundary"}};

class PolishedBody final : public Closure {
 public:
  std::string_view name() const override { return "subsurface"; }
  std::string_view doc() const override { return "Subsurface scattering below a dielectric boundary"; }
  std::span<const DescribedField> fields() const override { return bodyFields; }
  ClosureKind kind() const override { return ClosureKind::subsurface; }

  Color albedo(std::span<const float> p, const ClosurePoint& point) const override {
    return unitColor(colorAt(p, 5)) * (1 - reflected(p, point));
  }
  SubsurfaceBody body(std::span<const float> p) const override {
    SubsurfaceBody body = bodyThatReflects(colorAt(p, 5), colorAt(p, 2), p[1]);
    body.ior = std::max(p[0], 1e-3f);
    return body;
  }
  std::optional<ClosureSample> sample(std::span<const float> p, const ClosurePoint& point,
                                      const ClosureUniforms&) const override {
    const Vector<World> n = outwardNormal(point);
    const float cosine = dot(n, point.toViewer), eta = std::max(p[0], 1e-3f);
    const float passed = 1 - reflected(p, point);
    const float square = ((eta - 1) * (eta + 1) + cosine * cosine) / (eta * eta);
    if (!(passed > 0) || !(square > 0)) return {};
    const Vector<World> bent = (n * cosine - point.toViewer) / eta - n * std::sqrt(square);
    return entering(point, normalize(bent), passed);
  }

 private:
  static Vector<World> outwardNormal(const ClosurePoint& point) {
    const Vector<World> n = point.geometricNormal.vector();
    return dot(n, point.toViewer) > 0 ? n : -n;
  }
  static float reflected(std::span<const float> p, const ClosurePoint& point) {
    return fresnelDielectric(dot(outwardNormal(point), point.toViewer), std::max(p[0], 1e-3f));
  }
};

}  // namespace

void registerClosure_subsurface(Registry& registry) { registry.add(std::make_unique<PolishedBody>()); }

}  // namespace aerosol::render
