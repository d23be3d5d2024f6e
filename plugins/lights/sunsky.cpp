// The sun and a clear sky. Below the horizon it is black.
//
// Directions are drawn from the disc of the sun, evenly, or from cells of the upper half sphere by the sky's luminance:
// a mixture by what the two light.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/cell_choice.h"
#include "core/render/clear_sky.h"
#include "core/render/registry.h"
#include "core/render/rotation.h"

namespace aerosol::render {

namespace {

constexpr double pi = std::numbers::pi;
constexpr int columns = 64, rows = 32;
constexpr double trueAperture = ClearSky::aperture * pi / 180;

double solidAngleOf(double aperture) {
  const double sine = std::sin(aperture / 4);
  return 4 * pi * sine * sine;
}

double luminance(Color c) {
  return 0.2126 * static_cast<double>(c.r) + 0.7152 * static_cast<double>(c.g) + 0.0722 * static_cast<double>(c.b);
}

struct Direction {
  double x = 0, y = 0, z = 0;

  friend double dot(const Direction& a, const Direction& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
};

struct Settings {
  Direction sun;  ///< Towards it, unit, in the sky's own space.
  double turbidity = 3, sunScale = 1, skyScale = 1;
  double aperture = trueAperture;  ///< Radians.
  bool isDarkerAtLimb = false;
  Color albedo;  ///< Of the ground.
};

class SunSky final : public Light {
 public:
  SunSky(const Settings& settings, const Matrix4& toWorld)
      : settings_(settings),
        toWorld_(toWorld),
        sky_(std::acos(std::clamp(settings.sun.z, 0.0, 1.0)), settings.turbidity, settings.albedo),
        solidAngle_(solidAngleOf(settings.aperture)),
        cosine_(std::cos(settings.aperture / 2)),
        sunRadiance_(sky_.sun() * static_cast<float>(settings.sunScale * solidAngleOf(trueAperture) / solidAngle_)),
        choice_(makeChoice()) {
    const double bySun = luminance(sunRadiance_) * solidAngle_, bySky = luminance(skyMean_) * 2 * pi;
    if (!(bySky > 0)) {
      sunShare_ = 1;
    } else if (bySun > 0) {
      sunShare_ = std::clamp(bySun / (bySun + bySky), 0.25, 0.75);
    }
  }

  std::optional<LightSample> sample(Point<World>, const LightUniforms& u) const override {
    const auto choice = static_cast<double>(u.choice);
    const Direction local = choice < sunShare_ ? inDisc(u.place) : inSky(u.place);
    const auto row = [&](std::size_t i) {
      return static_cast<float>(toWorld_[i][0] * local.x + toWorld_[i][1] * local.y + toWorld_[i][2] * local.z);
    };
    const Vector<World> direction = normalize(Vector<World>(row(0), row(1), row(2)));
    // By the rounded direction, as for one that is met.
    const float density = pdfEscaped({}, direction);
    if (!(density > 0)) return {};
    return LightSample{.direction = direction, .value = escaped(direction), .pdf = density, .point = {}, .normal = {}};
  }

  float pdfEscaped(Point<World>, Vector<World> direction) const override {
    const Direction d = toLocal(direction);
    double density = isInDisc(d) ? sunShare_ / solidAngle_ : 0;
    if (d.z > 0 && sunShare_ < 1) {
      double u = std::atan2(d.y, d.x) / (2 * pi);
      u -= std::floor(u);
      density += (1 - sunShare_) * choice_.density(std::min(u, 0x1.fffffffffffffp-1), d.z) / (2 * pi);
    }
    return static_cast<float>(density);
  }

  Color escaped(Vector<World> direction) const override {
    const Direction d = toLocal(direction);
    if (!(d.z > 0)) return Color();
    return isInDisc(d) ? sunAt(d) + skyAt(d) : skyAt(d);
  }

  /// Through a sphere around the scene.
  Color power(float sceneRadius) const override {
    return arriving() * (std::numbers::pi_v<float> * sceneRadius * sceneRadius);
  }
  float importance(Point<World>) const override { return average(arriving()); }
  bool isDelta() const override { return false; }
  bool isInfinite() const override { return true; }

 private:
  /// Radiance over all directions.
  Color arriving() const {
    return sunRadiance_ * static_cast<float>(solidAngle_) + skyMean_ * static_cast<float>(2 * pi);
  }

  /// The matrix is a rotation: its transpose is its inverse.
  Direction toLocal(Vector<World> direction) const {
    const double x = static_cast<double>(direction.x), y = static_cast<double>(direction.y),
                 z = static_cast<double>(direction.z);
    const auto column = [&](std::size_t i) { return toWorld_[0][i] * x + toWorld_[1][i] * y + toWorld_[2][i] * z; };
    return {column(0), column(1), column(2)};
  }

  bool isInDisc(const Direction& d) const { return settings_.sunScale > 0 && dot(d, settings_.sun) >= cosine_; }
  Color skyAt(const Direction& d) const {
    if (!(settings_.skyScale > 0)) return Color();
    const double angle = std::acos(std::clamp(dot(d, settings_.sun), -1.0, 1.0));
    return sky_.sky(d.z, angle) * static_cast<float>(settings_.skyScale);
  }

  Color sunAt(const Direction& d) const {
    if (!settings_.isDarkerAtLimb) return sunRadiance_;
    const double cosine = std::min(dot(d, settings_.sun), 1.0), edge = std::sin(settings_.aperture / 2);
    return sunRadiance_ * ClearSky::limbDarkening(std::min(std::sqrt(1 - cosine * cosine) / edge, 1.0));
  }

  Direction inDisc(std::array<float, 2> u) const {
    const double c = static_cast<double>(u[0]) * solidAngle_ / (2 * pi), r = std::sqrt(c * (2 - c));
    const double phi = 2 * pi * static_cast<double>(u[1]);
    const Direction& z = settings_.sun;
    const double sign = z.z < 0 ? -1 : 1, a = -1 / (sign + z.z), b = z.x * z.y * a;
    const Direction x{1 + sign * z.x * z.x * a, sign * b, -sign * z.x}, y{b, sign + z.y * z.y * a, -z.y};
    const double p = r * std::cos(phi), q = r * std::sin(phi), s = 1 - c;
    return {x.x * p + y.x * q + z.x * s, x.y * p + y.y * q + z.y * s, x.z * p + y.z * q + z.z * s};
  }
  Direction inSky(std::array<float, 2> u) const {
    const auto [turn, height] = choice_.sample(u);
    const double r = std::sqrt(std::max(0.0, 1 - height * height)), phi = 2 * pi * turn;
    return {r * std::cos(phi), r * std::sin(phi), height};
  }

  /// Cells of equal solid angle, by azimuth and height.
  CellChoice makeChoice() {
    std::vector<double> weights;
    Color sum;
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        const double height = (j + 0.5) / rows, phi = 2 * pi * (i + 0.5) / columns;
        const double r = std::sqrt(1 - height * height);
        const Color radiance = skyAt({r * std::cos(phi), r * std::sin(phi), height});
        sum += radiance;
        weights.push_back(std::max(luminance(radiance), 1e-30));
      }
    }
    skyMean_ = sum / static_cast<float>(rows * columns);
    return {columns, rows, weights};
  }

  Settings settings_;
  Matrix4 toWorld_;
  ClearSky sky_;
  double solidAngle_, cosine_;  ///< Of the sun's disc.
  Color sunRadiance_, skyMean_;
  double sunShare_ = 0;  ///< Of the samples.
  CellChoice choice_;
};

std::unique_ptr<const Light> make(const LightArguments& arguments) {
  const auto fail = [&](std::string problem) {
    if (arguments.problem) *arguments.problem = std::move(problem);
    return nullptr;
  };
  const Matrix4 toWorld = withoutScale(arguments.get<Matrix4>("to_world"));
  if (!isRotation(toWorld)) return fail("'to_world' of a sky may turn, mirror and evenly scale it, nothing else");
  const auto towards = arguments.get<Vector<scene::Unplaced>>("sun_direction");
  const double x = static_cast<double>(towards.x), y = static_cast<double>(towards.y),
               z = static_cast<double>(towards.z);
  const double length = std::hypot(x, y, z);
  if (!(length > 0)) return fail("'sun_direction' of no length points nowhere");
  const auto column = [&](std::size_t i) {
    return (toWorld[0][i] * x + toWorld[1][i] * y + toWorld[2][i] * z) / length;
  };
  const auto number = [&](const char* name) { return static_cast<double>(arguments.get<float>(name)); };
  Settings settings{{column(0), column(1), column(2)},
                    number("turbidity"),
                    number("sun_scale"),
                    number("sky_scale"),
                    number("sun_aperture") * pi / 180,
                    arguments.get<bool>("complex_sun"),
                    arguments.get<Color>("albedo")};
  if (settings.sun.z < 0) return fail("the sun is below the horizon, which is the plane z = 0 before 'to_world'");
  return std::make_unique<SunSky>(settings, toWorld);
}

}  // namespace

void registerLight_sunsky(Registry& registry) {
  using scene::ValueType;
  const auto factor = [](const char* name, const char* doc) {
    return scene::ParameterSpec{
        .name = name, .type = ValueType::number, .doc = doc, .defaultValue = 1.0f, .range = scene::Range::atLeast(0)};
  };
  registry.add(LightType{.name = "sunsky",
                         .doc = "The sun and a clear sky",
                         .parameters = {{.name = "turbidity",
                                         .type = ValueType::number,
                                         .doc = "Of the air",
                                         .defaultValue = 3.0f,
                                         .range = {.minimum = 1, .maximum = 10}},
                                        {.name = "sun_direction",
                                         .type = ValueType::vector,
                                         .doc = "Towards the sun in the world",
                                         .defaultValue = Vector<scene::Unplaced>(0, 0, 1)},
                                        factor("sun_scale", "Factor on the sun"),
                                        factor("sky_scale", "Factor on the sky"),
                                        {.name = "sun_aperture",
                                         .type = ValueType::number,
                                         .unit = "degrees",
                                         .doc = "Across the disc of the sun",
                                         .defaultValue = static_cast<float>(ClearSky::aperture),
                                         .range = {.minimum = 0, .maximum = 180, .openMinimum = true}},
                                        {.name = "complex_sun",
                                         .type = ValueType::boolean,
                                         .doc = "Whether the disc of the sun is darker towards its edge",
                                         .defaultValue = false},
                                        {.name = "albedo",
                                         .type = ValueType::color,
                                         .doc = "Of the ground",
                                         .defaultValue = Color(0.3f),
                                         .range = {.minimum = 0, .maximum = 1}},
                                        {.name = "to_world",
                                         .type = ValueType::transform,
                                         .doc = "Turns the sky, whose zenith is +z and whose north is -x",
                                         .defaultValue = identityMatrix()}},
                         .make = make});
}

}  // namespace aerosol::render
