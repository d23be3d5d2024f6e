// The same radiance from every direction: an overcast sky all around. A density that is compensated for the directions
// that surfaces and media choose (Karlík, Šik, Vivoda, Skřivan and Křivánek 2019, "MIS Compensation: Optimizing
// Sampling Techniques in Multiple Importance Sampling") is nowhere above 0 here, so none is chosen for it.

#include <numbers>

#include "core/render/registry.h"
#include "core/render/warp.h"

namespace aerosol::render {

namespace {

constexpr float density = 1 / (4 * std::numbers::pi_v<float>);

class ConstantLight final : public Light {
 public:
  explicit ConstantLight(Color radiance) : radiance_(radiance) {}

  std::optional<LightSample> sample(Point<World>, const LightUniforms& u) const override {
    const std::array<double, 3> d = toSphere(u.place);
    return LightSample{.direction = {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])},
                       .value = radiance_,
                       .pdf = density,
                       .point = {},
                       .normal = {}};
  }

  float pdfEscaped(Point<World>, Vector<World>) const override { return density; }
  Color escaped(Vector<World>) const override { return radiance_; }

  /// Through a sphere around the scene: π per area, 4π r² of it.
  Color power(float sceneRadius) const override {
    constexpr float pi = std::numbers::pi_v<float>;
    return radiance_ * (4 * pi * pi * sceneRadius * sceneRadius);
  }
  float importance(Point<World>) const override { return average(abs(radiance_)) * (4 * std::numbers::pi_v<float>); }
  bool isDelta() const override { return false; }
  bool isSampled() const override { return false; }
  bool isInfinite() const override { return true; }

 private:
  Color radiance_;
};

std::unique_ptr<const Light> make(const LightArguments& arguments) {
  return std::make_unique<ConstantLight>(arguments.get<Color>("radiance"));
}

}  // namespace

void registerLight_constant(Registry& registry) {
  registry.add(LightType{.name = "constant",
                         .doc = "The same radiance from every direction",
                         .parameters = {{.name = "radiance",
                                         .type = scene::ValueType::color,
                                         .unit = "W/(m² sr)",
                                         .doc = "Radiance of the surroundings",
                                         .defaultValue = Color(1)}},
                         .make = make});
}

}  // namespace aerosol::render
