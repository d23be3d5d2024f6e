// Light from all around, as an image tells it by latitude and longitude.
//
// Directions are drawn by the luminance of the image above its mean: what is even is left to the directions that
// surfaces and media choose themselves (Karlík, Šik, Vivoda, Skřivan and Křivánek 2019, "MIS Compensation: Optimizing
// Sampling Techniques in Multiple Importance Sampling"). +y is up; the middle of the image lies at -z before
// `to_world`; columns of texels lie between, rows on the lines of equal steps from pole to pole.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/image/image.h"
#include "core/render/cell_choice.h"
#include "core/render/registry.h"
#include "core/render/rotation.h"

namespace aerosol::render {

namespace {

constexpr double pi = std::numbers::pi;

double luminance(Color c) {
  return 0.2126 * static_cast<double>(c.r) + 0.7152 * static_cast<double>(c.g) + 0.0722 * static_cast<double>(c.b);
}

/// A picture that wraps around in x, interpolated linearly; u and v in [0, 1].
class Panorama {
 public:
  Panorama(int width, int height, std::vector<Color> texels)
      : width_(width), height_(height), texels_(std::move(texels)) {}

  int columns() const { return width_; }
  int rows() const { return height_ - 1; }
  /// `x` may be any whole number.
  Color texel(int x, int y) const {
    const int column = ((x % width_) + width_) % width_;
    return texels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column)];
  }
  Color operator()(double u, double v) const {
    const double x = u * width_ - 0.5, y = std::clamp(v, 0.0, 1.0) * rows();
    const int i = static_cast<int>(std::floor(x)), j = std::min(static_cast<int>(y), rows() - 1);
    const auto a = static_cast<float>(x - i), b = static_cast<float>(y - j);
    return (texel(i, j) * (1 - a) + texel(i + 1, j) * a) * (1 - b) +
           (texel(i, j + 1) * (1 - a) + texel(i + 1, j + 1) * a) * b;
  }

 private:
  int width_, height_;
  std::vector<Color> texels_;
};

class EnvironmentMap final : public Light {
 public:
  EnvironmentMap(Panorama image, const Matrix4& toWorld, float scale)
      : image_(std::move(image)), toWorld_(toWorld), scale_(scale), choice_(makeChoice()) {}

  std::optional<LightSample> sample(Point<World>, const LightUniforms& u) const override {
    const auto [x, y] = choice_.sample(u.place);
    const double theta = y * pi, phi = x * 2 * pi, sine = std::sin(theta);
    const double d[3] = {std::sin(phi) * sine, std::cos(theta), -std::cos(phi) * sine};
    const auto row = [&](std::size_t i) {
      return static_cast<float>(toWorld_[i][0] * d[0] + toWorld_[i][1] * d[1] + toWorld_[i][2] * d[2]);
    };
    const Vector<World> direction = normalize(Vector<World>(row(0), row(1), row(2)));
    // By the rounded direction, as for one that is met.
    const Place place = placeOf(direction);
    const float density = densityAt(place);
    if (!(density > 0)) return {};
    const Color value = radianceAt(place);
    return LightSample{.direction = direction, .value = value, .pdf = density, .point = {}, .normal = {}};
  }

  float pdfEscaped(Point<World>, Vector<World> direction) const override { return densityAt(placeOf(direction)); }
  Color escaped(Vector<World> direction) const override { return radianceAt(placeOf(direction)); }
  Escaped escapedWithPdf(Point<World>, Vector<World> direction) const override {
    const Place place = placeOf(direction);
    return {radianceAt(place), densityAt(place)};
  }

  /// Through a sphere around the scene.
  Color power(float sceneRadius) const override {
    return mean_ * (4 * std::numbers::pi_v<float> * std::numbers::pi_v<float> * sceneRadius * sceneRadius);
  }
  float importance(Point<World>) const override { return average(abs(mean_)) * (4 * std::numbers::pi_v<float>); }
  bool isDelta() const override { return false; }
  bool isInfinite() const override { return true; }

 private:
  struct Place {
    double u = 0, v = 0, sine = 0;
  };

  Color radianceAt(const Place& place) const { return image_(place.u, place.v) * scale_; }
  float densityAt(const Place& place) const {
    if (!(place.sine > 0)) return 0;
    return static_cast<float>(choice_.density(place.u, place.v) / (2 * pi * pi * place.sine));
  }

  /// The matrix is a rotation: its transpose is its inverse. The angles are floats, as directions are.
  Place placeOf(Vector<World> direction) const {
    const double x = static_cast<double>(direction.x), y = static_cast<double>(direction.y),
                 z = static_cast<double>(direction.z);
    const auto column = [&](std::size_t i) { return toWorld_[0][i] * x + toWorld_[1][i] * y + toWorld_[2][i] * z; };
    const double lx = column(0), ly = column(1), lz = column(2);
    const double sine = std::sqrt(lx * lx + lz * lz);
    const float around = std::atan2(static_cast<float>(lx), static_cast<float>(-lz));
    const float down = std::atan2(static_cast<float>(sine), static_cast<float>(ly));
    double u = static_cast<double>(around) / (2 * pi);
    u -= std::floor(u);
    return {std::min(u, 0x1.fffffffffffffp-1), std::min(static_cast<double>(down) / pi, 1.0), sine};
  }

  /// Cells between neighbouring texels. Sampling is for light on top of the mean; an even sky is drawn evenly.
  CellChoice makeChoice() {
    const int columns = image_.columns(), rows = image_.rows();
    std::vector<double> weights;
    Color sum;
    double sines = 0, luminances = 0;
    const auto sineOf = [&](int j) { return std::sin((j + 0.5) / rows * pi); };
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        // Columns begin half a texel before the first one's middle.
        const Color mean = (image_.texel(i, j) * 2 + image_.texel(i - 1, j) + image_.texel(i + 1, j) +
                            image_.texel(i, j + 1) * 2 + image_.texel(i - 1, j + 1) + image_.texel(i + 1, j + 1)) *
                           0.125f;
        sum += mean * static_cast<float>(sineOf(j));
        sines += sineOf(j);
        luminances += luminance(abs(mean)) * sineOf(j);
        weights.push_back(luminance(abs(mean)));
      }
    }
    mean_ = sum * (scale_ / static_cast<float>(sines));
    const double offset = luminances / sines;
    double left = 0;
    for (const double weight : weights) left += std::max(weight - offset, 0.0);
    const bool isEven = !(left > 1e-3 * offset * static_cast<double>(weights.size()));
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const double above = isEven ? std::max(weights[k], 1e-30) : std::max(weights[k] - offset, 0.0);
      weights[k] = above * sineOf(static_cast<int>(k / static_cast<std::size_t>(columns)));
    }
    return {columns, rows, weights};
  }

  Panorama image_;
  Matrix4 toWorld_;
  float scale_;
  Color mean_;
  CellChoice choice_;
};

double decode(float encoded) {
  const auto x = static_cast<double>(encoded);
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

/// Images of bytes hold sRGB colours.
bool isLinear(const std::string& file) {
  for (const char* ending : {".exr", ".hdr", ".pfm", ".rgbe", ".EXR", ".HDR"}) {
    if (file.ends_with(ending)) return true;
  }
  return false;
}

std::unique_ptr<const Light> make(const LightArguments& arguments) {
  const auto fail = [&](std::string problem) {
    if (arguments.problem) *arguments.problem = std::move(problem);
    return nullptr;
  };
  const Matrix4 toWorld = withoutScale(arguments.get<Matrix4>("to_world"));
  if (!isRotation(toWorld))
    return fail("'to_world' of an environment may turn, mirror and evenly scale it, nothing else");
  if (const SkyPicture* picture = arguments.picture) {
    return std::make_unique<EnvironmentMap>(Panorama(picture->width, picture->height, picture->texels), toWorld,
                                            arguments.get<float>("scale"));
  }
  const auto file = arguments.get<std::string>("filename");
  auto image = image::readImage(file);
  if (!image) return fail(image.errors().entries().front().message);
  if (image->width < 2 || image->height < 3) return fail("an environment needs an image of 2 by 3 pixels at least");
  const std::size_t channels = image->channels.size(), first = 0;
  const bool isGrey = channels < 3, isDecoded = isLinear(file);
  std::vector<Color> texels;
  for (std::size_t at = first; at + channels <= image->pixels.size(); at += channels) {
    Color c;
    for (int i = 0; i < 3; ++i) {
      const float value = image->pixels[at + (isGrey ? 0 : static_cast<std::size_t>(i))];
      c[i] = isDecoded ? value : static_cast<float>(decode(value));
    }
    if (!isFinite(c)) return fail("the image has pixels that are not finite");
    texels.push_back(c);
  }
  return std::make_unique<EnvironmentMap>(Panorama(image->width, image->height, std::move(texels)), toWorld,
                                          arguments.get<float>("scale"));
}

}  // namespace

void registerLight_envmap(Registry& registry) {
  registry.add(LightType{
      .name = "envmap",
      .doc = "Light from all around, from an image by latitude and longitude",
      .parameters = {{.name = "filename", .type = scene::ValueType::string, .doc = "The image", .required = true},
                     {.name = "scale",
                      .type = scene::ValueType::number,
                      .doc = "Factor on the image, whose values are radiance in W/(m² sr)",
                      .defaultValue = 1.0f},
                     {.name = "to_world",
                      .type = scene::ValueType::transform,
                      .doc = "Turns the image, whose middle lies at -z",
                      .defaultValue = identityMatrix()}},
      .make = make});
}

}  // namespace aerosol::render
