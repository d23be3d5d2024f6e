// Parallel light from infinitely far away: a sun without size.

#include <numbers>

#include "core/render/registry.h"

namespace aerosol::render {

namespace {

class DirectionalLight final : public Light {
 public:
  DirectionalLight(Vector<World> travel, Color irradiance) : toLight_(-normalize(travel)), irradiance_(irradiance) {}

  std::optional<LightSample> sample(Point<World>, const LightUniforms&) const override {
    return LightSample{
        .direction = toLight_, .value = irradiance_, .pdf = 1, .isDelta = true, .point = {}, .normal = {}};
  }

  Color power(float sceneRadius) const override {
    return irradiance_ * (std::numbers::pi_v<float> * sceneRadius * sceneRadius);
  }
  float importance(Point<World>) const override { return average(abs(irradiance_)); }
  bool isDelta() const override { return true; }
  bool isInfinite() const override { return true; }

 private:
  Vector<World> toLight_;
  Color irradiance_;
};

std::unique_ptr<const Light> make(const LightArguments& arguments) {
  const auto d = arguments.get<Vector<scene::Unplaced>>("direction");
  return std::make_unique<DirectionalLight>(Vector<World>{d.x, d.y, d.z}, arguments.get<Color>("irradiance"));
}

}  // namespace

void registerLight_directional(Registry& registry) {
  registry.add(LightType{.name = "directional",
                         .doc = "Parallel light from infinitely far away",
                         .parameters = {{.name = "irradiance",
                                         .type = scene::ValueType::color,
                                         .unit = "W/m²",
                                         .doc = "Irradiance on a plane at right angles to the light",
                                         .defaultValue = Color(1)},
                                        {.name = "direction",
                                         .type = scene::ValueType::vector,
                                         .doc = "Where the light travels",
                                         .defaultValue = Vector<scene::Unplaced>(0, 0, 1)}},
                         .make = make});
}

}  // namespace aerosol::render
