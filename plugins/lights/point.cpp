// A point that shines alike in all directions.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/render/registry.h"

namespace aerosol::render {

namespace {

class PointLight final : public Light {
 public:
  PointLight(Point<World> position, Color intensity, float radius)
      : position_(position), intensity_(intensity), radius_(radius) {}

  std::optional<LightSample> sample(Point<World> from, const LightUniforms&) const override {
    const auto difference = [](float a, float b) { return static_cast<double>(a) - static_cast<double>(b); };
    const double x = difference(position_.x, from.x), y = difference(position_.y, from.y),
                 z = difference(position_.z, from.z);
    const double squared = x * x + y * y + z * z, distance = std::sqrt(squared);
    const Color irradiance = intensity_ * static_cast<float>(1 / squared);
    if (!isFinite(irradiance)) return {};
    return LightSample{.direction = {static_cast<float>(x / distance), static_cast<float>(y / distance),
                                     static_cast<float>(z / distance)},
                       .distance = static_cast<float>(distance),
                       .value = irradiance,
                       .pdf = 1,
                       .isDelta = true,
                       .point = position_,
                       .normal = {}};
  }

  Color power(float) const override { return intensity_ * (4 * std::numbers::pi_v<float>); }
  float importance(Point<World> at) const override {
    return average(abs(intensity_)) / std::max(squaredLength(position_ - at), std::numeric_limits<float>::min());
  }
  std::optional<LightPlace> place() const override {
    return LightPlace{
        .centre = position_, .intensity = average(abs(intensity_)), .radius = radius_, .hasSingularity = true};
  }
  std::optional<LightBounds> partBounds(std::uint32_t) const override {
    LightBounds bounds{.intensity = average(abs(intensity_))};
    bounds.box.extend(position_);
    return bounds;
  }
  bool isDelta() const override { return true; }
  bool isInfinite() const override { return false; }

 private:
  Point<World> position_;
  Color intensity_;
  float radius_;
};

std::unique_ptr<const Light> make(const LightArguments& arguments) {
  const auto p = arguments.get<Point<scene::Unplaced>>("position");
  return std::make_unique<PointLight>(Point<World>{p.x, p.y, p.z}, arguments.get<Color>("intensity"),
                                      arguments.get<float>("radius"));
}

}  // namespace

void registerLight_point(Registry& registry) {
  registry.add(LightType{.name = "point",
                         .doc = "A point that shines alike in all directions",
                         .parameters = {{.name = "intensity",
                                         .type = scene::ValueType::color,
                                         .unit = "W/sr",
                                         .doc = "Radiant intensity",
                                         .defaultValue = Color(1)},
                                        {.name = "position",
                                         .type = scene::ValueType::point,
                                         .unit = "scene units",
                                         .doc = "Where it is",
                                         .defaultValue = Point<scene::Unplaced>()},
                                        {.name = "radius",
                                         .type = scene::ValueType::number,
                                         .unit = "scene units",
                                         .doc = "The light is no nearer to any ray than this; 0: only rays that meet "
                                                "it are kept off, by 1e-4 of their way through media",
                                         .defaultValue = 0.0f,
                                         .range = scene::Range::atLeast(0)}},
                         .make = make});
}

}  // namespace aerosol::render
