// A picture that is projected from one point: the reverse of a perspective camera. A plane that faces it at a distance
// is lit as the picture says, without falloff towards the corners: radiant intensity grows as 1 / cos³.

#include <cmath>
#include <limits>
#include <numbers>

#include "core/render/registry.h"

namespace aerosol::render {

namespace {

constexpr double pi = std::numbers::pi;

class Projector final : public Light {
 public:
  /// Tangents of half the angles across the picture. `mean` is what its texture is in the mean.
  Projector(const Transform<World, Object>& toWorld, Color irradiance, double tangentX, double tangentY, Color mean)
      : position_(toWorld(Point<Object>(0, 0, 0))),
        toObject_(toWorld.inverse()),
        irradiance_(irradiance),
        mean_(irradiance * mean),
        cone_(coneAlongZ(toWorld.matrix(), std::hypot(tangentX, tangentY))),
        tangentX_(tangentX),
        tangentY_(tangentY) {}

  std::optional<LightSample> sample(Point<World> from, const LightUniforms&) const override {
    const Seen seen = seenFrom(from);
    if (!seen.isLit) return {};
    const auto difference = [](float a, float b) { return static_cast<double>(a) - static_cast<double>(b); };
    const double x = difference(position_.x, from.x), y = difference(position_.y, from.y),
                 z = difference(position_.z, from.z);
    const double squared = x * x + y * y + z * z, distance = std::sqrt(squared);
    const Color value = irradiance_ * static_cast<float>(intensity(seen) / squared);
    if (!isFinite(value)) return {};
    LightSample sample;
    sample.direction = {static_cast<float>(x / distance), static_cast<float>(y / distance),
                        static_cast<float>(z / distance)};
    sample.distance = static_cast<float>(distance);
    sample.value = value;
    sample.pdf = 1;
    sample.isDelta = true;
    sample.point = position_;
    sample.u = static_cast<float>(seen.u);
    sample.v = static_cast<float>(seen.v);
    return sample;
  }

  Color power(float) const override { return mean_ * static_cast<float>(4 * pi * tangentX_ * tangentY_); }
  float importance(Point<World> at) const override {
    const Seen seen = seenFrom(at);
    if (!seen.isLit) return 0;
    return average(abs(mean_)) * static_cast<float>(intensity(seen)) /
           std::max(squaredLength(position_ - at), std::numeric_limits<float>::min());
  }
  std::optional<LightPlace> place() const override {
    return LightPlace{.centre = position_, .intensity = meanIntensity(), .hasSingularity = true, .cone = cone_};
  }
  std::optional<LightBounds> partBounds(std::uint32_t) const override { return boundsOfPoint(*place()); }
  bool isDelta() const override { return true; }
  bool isInfinite() const override { return false; }

 private:
  struct Seen {
    bool isLit = false;
    double u = 0, v = 0;  ///< On the picture, from its upper left corner.
    double cosine = 0;    ///< To the axis.
  };

  Seen seenFrom(Point<World> at) const {
    const Point<Object> p = toObject_(at);
    const double x = static_cast<double>(p.x), y = static_cast<double>(p.y), z = static_cast<double>(p.z);
    if (!(z > 0)) return {};
    const double u = 0.5 - 0.5 * x / (z * tangentX_), v = 0.5 - 0.5 * y / (z * tangentY_);
    return {u >= 0 && u <= 1 && v >= 0 && v <= 1, u, v, z / std::sqrt(x * x + y * y + z * z)};
  }
  float meanIntensity() const { return average(abs(mean_)) * static_cast<float>(pi); }
  /// For an irradiance of 1.
  static double intensity(const Seen& seen) { return pi / (seen.cosine * seen.cosine * seen.cosine); }

  Point<World> position_;
  Transform<Object, World> toObject_;
  Color irradiance_, mean_;
  LightCone cone_;
  double tangentX_, tangentY_;
};

std::unique_ptr<const Light> make(const LightArguments& arguments) {
  const auto matrix = arguments.get<Matrix4>("to_world");
  Matrix4 inverse;
  if (!invert(matrix, inverse)) {
    if (arguments.problem) *arguments.problem = "'to_world' cannot be inverted";
    return nullptr;
  }
  const double tangentX = std::tan(static_cast<double>(arguments.get<float>("fov")) * pi / 360);
  const double tangentY = tangentX / static_cast<double>(arguments.get<float>("aspect"));
  return std::make_unique<Projector>(Transform<World, Object>(matrix, inverse),
                                     arguments.get<Color>("irradiance") * arguments.get<float>("scale"), tangentX,
                                     tangentY, arguments.texture);
}

}  // namespace

void registerLight_projector(Registry& registry) {
  using scene::ValueType;
  registry.add(LightType{
      .name = "projector",
      .doc = "A picture that is projected from one point",
      .parameters = {{.name = "irradiance",
                      .type = ValueType::color,
                      .unit = "W/m² / π",
                      .doc = "What a plane at distance 1 that faces the light gets, over π",
                      .defaultValue = Color(1)},
                     {.name = "scale", .type = ValueType::number, .doc = "Factor on it", .defaultValue = 1.0f},
                     {.name = "to_world",
                      .type = ValueType::transform,
                      .doc = "Places the light, which shines along +z with +y up",
                      .defaultValue = identityMatrix()},
                     {.name = "fov",
                      .type = ValueType::number,
                      .unit = "degrees",
                      .doc = "Angle across the width of the picture",
                      .defaultValue = 34.0f,
                      .range = {.minimum = 0, .maximum = 180, .openMinimum = true, .openMaximum = true}},
                     {.name = "aspect",
                      .type = ValueType::number,
                      .doc = "Width of the picture over its height",
                      .defaultValue = 1.0f,
                      .range = scene::Range::positive()}},
      .make = make});
}

}  // namespace aerosol::render
