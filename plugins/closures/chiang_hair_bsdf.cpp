// Fibres of hair and fur.
//
// Chiang, Bitterli, Tappan and Burley 2016, "A Practical and Controllable Hair and Fur Model for Production Path
// Tracing", with the factored lobes of d'Eon et al. 2011, "An Energy-Conserving Hair Reflectance Model". Light is
// reflected (R), goes through (TT), is reflected inside once (TRT) or more often; each of the four has an attenuation,
// a distribution along the fibre around the cone of mirrored directions, and one around it, a logistic about the
// direction that a smooth fibre gives. The viewer's place across the fibre is the angle to the normal. Scales tilt the
// cones: sin(θ + 2α), sin(θ - α), sin(θ - 4α) for the first three, α towards the root.

#include <algorithm>

#include "core/render/fresnel.h"
#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr std::size_t lobeCount = 4;

/// Of the modified Bessel function of order 0 (Abramowitz and Stegun 1964, 9.8.1 and 9.8.2), for x >= 0.
float logarithmOfBessel(float x) {
  if (x < 3.75f) {
    const float t = x / 3.75f, y = t * t;
    return std::log1p(
        y * (3.5156229f + y * (3.0899424f + y * (1.2067492f + y * (0.2659732f + y * (0.0360768f + y * 0.0045813f))))));
  }
  const float y = 3.75f / x;
  const float series =
      0.39894228f +
      y * (0.01328592f +
           y * (0.00225319f +
                y * (-0.00157565f +
                     y * (0.00916281f +
                          y * (-0.02057706f + y * (0.02635537f + y * (-0.01647633f + y * 0.00392377f)))))));
  return x + std::log(series / std::sqrt(x));
}

/// A direction by its angle to the plane across the fibre.
struct Along {
  float sine = 0, cosine = 1;
};

/// Density along the fibre, so that its integral with cos θ over θ is 1 (d'Eon et al. 2011, equation 7). `v` > 0.
float alongDensity(Along light, Along viewer, float v) {
  const float a = light.cosine * viewer.cosine / v, b = -light.sine * viewer.sine / v;
  // 1 / (2 v sinh(1 / v)) = exp(-1 / v) / (v (1 - exp(-2 / v)))
  return std::exp(logarithmOfBessel(a) + b - 1 / v) / (v * -std::expm1(-2 / v));
}

float logisticIntegral(float x, float s) { return 1 / (1 + std::exp(-x / s)); }

/// Density around the fibre: a logistic cut off at ±π, `x` from its middle.
float aroundDensity(float x, float s) {
  x = std::fabs(std::remainder(x, 2 * pi));
  const float e = std::exp(-x / s);
  return e / (s * (1 + e) * (1 + e)) / (logisticIntegral(pi, s) - logisticIntegral(-pi, s));
}

float sampleAround(float u, float s) {
  const float low = logisticIntegral(-pi, s), high = logisticIntegral(pi, s);
  const float at = std::clamp(low + u * (high - low), 1e-7f, 1 - 1e-7f);
  return std::clamp(-s * std::log(1 / at - 1), -pi, pi);
}

class Fibre {
 public:
  static constexpr std::string_view name = "chiang_hair_bsdf";
  static constexpr std::string_view doc = "Scattering by fibres of hair and fur";
  static constexpr ClosureTraits traits{.isReciprocal = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Normal; across a fibre it turns around it"},
      {.name = "curve_direction", .type = FieldType::direction, .unit = "", .doc = "Along the fibre, to its tip"},
      {.name = "tint_R", .type = FieldType::color, .unit = "", .doc = "Factor of what is reflected"},
      {.name = "tint_TT", .type = FieldType::color, .unit = "", .doc = "Factor of what passes"},
      {.name = "tint_TRT", .type = FieldType::color, .unit = "", .doc = "Factor of what is reflected inside"},
      {.name = "ior", .unit = "", .minimum = 1.05f, .maximum = 2.5f, .doc = "Index of refraction of the fibre"},
      {.name = "longitudual_roughness_R", .unit = "", .minimum = 0.05f, .doc = "Variance along the fibre"},
      {.name = "longitudual_roughness_TT", .unit = "", .minimum = 0.05f, .doc = "Of what passes"},
      {.name = "longitudual_roughness_TRT", .unit = "", .minimum = 0.05f, .doc = "Of what is reflected inside"},
      {.name = "azimuthal_roughness_R", .unit = "", .minimum = 0.15f, .doc = "Width around the fibre"},
      {.name = "azimuthal_roughness_TT", .unit = "", .minimum = 0.15f, .doc = "Of what passes"},
      {.name = "azimuthal_roughness_TRT", .unit = "", .minimum = 0.15f, .doc = "Of what is reflected inside"},
      {.name = "cuticle_angle",
       .unit = "",
       .doc = "Tilt of the scales, 0.5: none; more: towards the root, by 180 degrees a unit"},
      {.name = "absorption_coefficient", .type = FieldType::color, .unit = "1/fibre radius", .doc = "Of the inside"}};

  Fibre(std::span<const float> p, const ClosurePoint& point) {
    along_ = directionAt(p, 3);
    normal_ = directionAt(p, 0);
    normal_ = normal_ - along_ * dot(normal_, along_);
    if (!(squaredLength(normal_) > 1e-12f)) normal_ = Frame<World>(along_).x;
    normal_ = normalize(normal_);
    if (dot(normal_, point.toViewer) < 0) normal_ = -normal_;
    across_ = cross(along_, normal_);
    viewer_ = placeAlong(point.toViewer);
    turn_ = std::atan2(dot(point.toViewer, across_), dot(point.toViewer, normal_));
    for (std::size_t i = 0; i < lobeCount; ++i) {
      // What is reflected more than once inside is as wide as what is once.
      const std::size_t own = std::min<std::size_t>(i, 2);
      variance_[i] = std::max(p[16 + own], 1e-4f);
      width_[i] = std::max(p[19 + own], 1e-3f);
    }
    const float tilt = (p[22] - 0.5f) * pi;
    for (std::size_t i = 0; i < lobeCount; ++i)
      tilted_[i] = i < 3 ? tiltedBy((2 - 3 * static_cast<float>(i)) * tilt) : viewer_;
    attenuate(p);
  }

  bool isVisible() const { return total_ > 0; }
  Color albedo() const {
    Color sum;
    for (const Color& part : parts_) sum += part;
    return {std::min(sum.r, 1.0f), std::min(sum.g, 1.0f), std::min(sum.b, 1.0f)};
  }
  Color evaluate(Vector<World> toLight) const {
    Color sum;
    const auto shapes = shapesTowards(toLight);
    for (std::size_t i = 0; i < lobeCount; ++i) sum += parts_[i] * shapes[i];
    return sum;
  }
  float pdf(Vector<World> toLight) const {
    float sum = 0;
    const auto shapes = shapesTowards(toLight);
    for (std::size_t i = 0; i < lobeCount; ++i) sum += average(parts_[i]) / total_ * shapes[i];
    return sum;
  }
  std::optional<ClosureSample> sample(const ClosureUniforms& u) const {
    float rest = u.choice * total_;
    std::size_t lobe = 0;
    while (lobe + 1 < lobeCount && rest >= average(parts_[lobe])) rest -= average(parts_[lobe++]);
    const float part = average(parts_[lobe]);
    const float within = part > 0 ? std::clamp(rest / part, 0.0f, 0x1.fffffep-1f) : 0;
    // Along the fibre (d'Eon, Marschner and Hanika 2013, "Importance Sampling for Physically-Based Hair Fiber Models").
    const float v = variance_[lobe];
    const float first = std::max(u.place[0], 1e-7f);
    const float cosine = std::clamp(1 + v * std::log(first + (1 - first) * std::exp(-2 / v)), -1.0f, 1.0f);
    const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
    const Along cone = tilted_[lobe];
    const float height =
        std::clamp(-cosine * cone.sine + sine * std::cos(2 * pi * u.place[1]) * cone.cosine, -1.0f, 1.0f);
    const float radius = std::sqrt(std::max(0.0f, 1 - height * height));
    const float turn = turn_ + (lobe < 3 ? smoothTurn(lobe) + sampleAround(within, width_[lobe]) : 2 * pi * within);
    const Vector<World> direction =
        normalize(along_ * height + normal_ * (radius * std::cos(turn)) + across_ * (radius * std::sin(turn)));
    return sampleTowards(*this, direction);
  }

 private:
  Along placeAlong(Vector<World> w) const {
    const float sine = std::clamp(dot(w, along_), -1.0f, 1.0f);
    return {sine, std::sqrt(1 - sine * sine)};
  }
  Along tiltedBy(float angle) const {
    const float s = std::sin(angle), c = std::cos(angle);
    return {viewer_.sine * c + viewer_.cosine * s, std::fabs(viewer_.cosine * c - viewer_.sine * s)};
  }

  /// Reflection and transmission by a smooth fibre, and what is absorbed on the way (Chiang et al. 2016, section 3).
  void attenuate(std::span<const float> p) {
    const float eta = std::max(p[15], 1.001f), place = std::sin(turn_);
    const float cosine = std::max(viewer_.cosine, 1e-4f);
    // Across the fibre light bends by an index that grows with the angle (Marschner et al. 2003).
    const float etaAcross = std::sqrt(eta * eta - viewer_.sine * viewer_.sine) / cosine;
    insideTurn_ = std::asin(std::clamp(place / etaAcross, -1.0f, 1.0f));
    const float sineInside = viewer_.sine / eta;
    const float way = 2 * std::cos(insideTurn_) / std::sqrt(1 - sineInside * sineInside);
    const float f = fresnelDielectric(viewer_.cosine * std::cos(turn_), eta);
    const Color passed = exp(colorAt(p, 23) * -way);
    parts_[0] = Color(f);
    parts_[1] = passed * ((1 - f) * (1 - f));
    parts_[2] = parts_[1] * passed * f;
    for (int c = 0; c < 3; ++c) {
      const float again = passed[c] * f;
      parts_[3][c] = again < 1 ? parts_[2][c] * again / (1 - again) : 0;
    }
    parts_[0] *= colorAt(p, 6);
    parts_[1] *= colorAt(p, 9);
    parts_[2] *= colorAt(p, 12);
    parts_[3] *= colorAt(p, 12);
    for (const Color& part : parts_) total_ += average(part);
  }

  /// By how much a smooth fibre turns what is reflected inside `lobe` - 1 times.
  float smoothTurn(std::size_t lobe) const {
    const auto n = static_cast<float>(lobe);
    return 2 * n * insideTurn_ - 2 * turn_ + n * pi;
  }

  std::array<float, lobeCount> shapesTowards(Vector<World> toLight) const {
    const Along light = placeAlong(toLight);
    const float turned = std::atan2(dot(toLight, across_), dot(toLight, normal_)) - turn_;
    std::array<float, lobeCount> shapes{};
    for (std::size_t i = 0; i < lobeCount; ++i) {
      const float around = i < 3 ? aroundDensity(turned - smoothTurn(i), width_[i]) : 1 / (2 * pi);
      shapes[i] = alongDensity(light, tilted_[i], variance_[i]) * around;
    }
    return shapes;
  }

  Vector<World> along_, normal_, across_;
  Along viewer_;
  float turn_ = 0;        ///< Of the viewer about the fibre, from the normal: in [-π/2, π/2].
  float insideTurn_ = 0;  ///< Of light that it sees inside.
  std::array<float, lobeCount> variance_{}, width_{};
  std::array<Along, lobeCount> tilted_;
  std::array<Color, lobeCount> parts_;
  float total_ = 0;
};

}  // namespace

void registerClosure_chiang_hair_bsdf(Registry& registry) { registerLobe<Fibre>(registry); }

}  // namespace aerosol::render
