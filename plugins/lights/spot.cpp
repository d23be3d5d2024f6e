// A point that shines into a cone, with an edge that falls off by the angle, and a picture in it.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/render/registry.h"

namespace aerosol::render {

namespace {

constexpr double pi = std::numbers::pi;

class SpotLight final : public Light {
 public:
  /// Angles in radians.
  SpotLight(const Matrix4& toWorld, Color intensity, double cutoff, double beam)
      : position_{static_cast<float>(toWorld[0][3]), static_cast<float>(toWorld[1][3]),
                  static_cast<float>(toWorld[2][3])},
        intensity_(intensity),
        cutoff_(cutoff),
        beam_(beam) {
    const Transform<World, Object> forward(toWorld, inverseOf(toWorld));
    toObject_ = forward.inverse();
    cone_ = coneAlongZ(toWorld, std::tan(cutoff));
  }

  std::optional<LightSample> sample(Point<World> from, const LightUniforms&) const override {
    const Local local = localOf(from);
    const double fall = falloff(local);
    if (!(fall > 0)) return {};
    const auto difference = [](float a, float b) { return static_cast<double>(a) - static_cast<double>(b); };
    const double x = difference(position_.x, from.x), y = difference(position_.y, from.y),
                 z = difference(position_.z, from.z);
    const double squared = x * x + y * y + z * z, distance = std::sqrt(squared);
    const Color irradiance = intensity_ * static_cast<float>(fall / squared);
    if (!isFinite(irradiance)) return {};
    LightSample sample;
    sample.direction = {static_cast<float>(x / distance), static_cast<float>(y / distance),
                        static_cast<float>(z / distance)};
    sample.distance = static_cast<float>(distance);
    sample.value = irradiance;
    sample.pdf = 1;
    sample.isDelta = true;
    sample.point = position_;
    // The picture fills the square around the cone.
    const double reach = local.z * std::tan(cutoff_);
    sample.u = static_cast<float>(0.5 + 0.5 * local.x / reach);
    sample.v = static_cast<float>(0.5 + 0.5 * local.y / reach);
    return sample;
  }

  /// Of a linear edge, as if it was half as bright all over.
  Color power(float) const override {
    return intensity_ * static_cast<float>(2 * pi * (1 - 0.5 * (std::cos(cutoff_) + std::cos(beam_))));
  }
  float importance(Point<World> at) const override {
    return average(abs(intensity_)) * static_cast<float>(falloff(localOf(at))) /
           std::max(squaredLength(position_ - at), std::numeric_limits<float>::min());
  }
  std::optional<LightPlace> place() const override {
    return LightPlace{
        .centre = position_, .intensity = average(abs(intensity_)), .hasSingularity = true, .cone = cone_};
  }
  std::optional<LightBounds> partBounds(std::uint32_t) const override { return boundsOfPoint(*place()); }
  bool isDelta() const override { return true; }
  bool isInfinite() const override { return false; }

 private:
  struct Local {
    double x = 0, y = 0, z = 0;  ///< Unit; the light shines along +z.
  };

  static Matrix4 inverseOf(const Matrix4& matrix) {
    Matrix4 inverse = identityMatrix();
    invert(matrix, inverse);
    return inverse;
  }

  Local localOf(Point<World> at) const {
    const Point<Object> p = toObject_(at);
    const double x = static_cast<double>(p.x), y = static_cast<double>(p.y), z = static_cast<double>(p.z);
    const double size = std::sqrt(x * x + y * y + z * z);
    return size > 0 ? Local{x / size, y / size, z / size} : Local{};
  }
  double falloff(const Local& local) const {
    const double angle = std::atan2(std::hypot(local.x, local.y), local.z);
    if (angle <= beam_) return angle < cutoff_ || beam_ < cutoff_ ? 1 : 0;
    return angle < cutoff_ ? (cutoff_ - angle) / (cutoff_ - beam_) : 0;
  }

  Point<World> position_;
  Color intensity_;
  double cutoff_, beam_;
  Transform<Object, World> toObject_;
  LightCone cone_;
};

std::unique_ptr<const Light> make(const LightArguments& arguments) {
  const double cutoff = static_cast<double>(arguments.get<float>("cutoff_angle"));
  const double width = static_cast<double>(arguments.get<float>("beam_width"));
  const double beam = width < 0 ? 0.75 * cutoff : width;
  if (beam > cutoff) {
    if (arguments.problem) *arguments.problem = "'beam_width' is wider than 'cutoff_angle'";
    return nullptr;
  }
  return std::make_unique<SpotLight>(arguments.get<Matrix4>("to_world"), arguments.get<Color>("intensity"),
                                     cutoff * pi / 180, beam * pi / 180);
}

}  // namespace

void registerLight_spot(Registry& registry) {
  const scene::Range angle{.minimum = 0, .maximum = 90, .openMinimum = true, .openMaximum = true};
  registry.add(LightType{.name = "spot",
                         .doc = "A point that shines into a cone",
                         .parameters = {{.name = "intensity",
                                         .type = scene::ValueType::color,
                                         .unit = "W/sr",
                                         .doc = "Radiant intensity along its axis",
                                         .defaultValue = Color(1)},
                                        {.name = "to_world",
                                         .type = scene::ValueType::transform,
                                         .doc = "Places the light, which shines along +z",
                                         .defaultValue = identityMatrix()},
                                        {.name = "cutoff_angle",
                                         .type = scene::ValueType::number,
                                         .unit = "degrees",
                                         .doc = "From the axis to where the light ends",
                                         .defaultValue = 20.0f,
                                         .range = angle},
                                        {.name = "beam_width",
                                         .type = scene::ValueType::number,
                                         .unit = "degrees",
                                         .doc = "From the axis to where it begins to fall; -1: at three quarters",
                                         .defaultValue = -1.0f}},
                         .make = make});
}

}  // namespace aerosol::render
