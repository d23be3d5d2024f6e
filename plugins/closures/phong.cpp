// Phong's highlight around the mirrored direction, with the norm of Lewis 1994, "Making Shaders More Physically
// Plausible": f = (n + 2) / 2π cosⁿ; it never reflects more than arrives.

#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

namespace {

class Phong {
 public:
  static constexpr std::string_view name = "phong";
  static constexpr std::string_view doc = "Phong's highlight";
  static constexpr ClosureTraits traits{.hasExactAlbedo = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal, on the side that scatters"},
      {.name = "exponent", .unit = "", .maximum = 60, .doc = "The higher the smaller the highlight"}};

  Phong(std::span<const float> p, const ClosurePoint& point)
      : point_(point), normal_(directionAt(p, 0)), exponent_(std::max(p[3], 0.0f)) {
    const float cosine = dot(normal_, point.toViewer);
    isVisible_ = cosine > 0;
    mirrored_ = normalize(normal_ * (2 * cosine) - point.toViewer);
  }

  bool isVisible() const { return isVisible_; }
  Color evaluate(Vector<World> toLight) const {
    const float cosine = dot(normal_, toLight);
    if (!(cosine > 0) || !isOnItsSide(point_, toLight, true)) return {};
    return Color(0.5f * inversePi * (exponent_ + 2) * peak(toLight) * cosine);
  }
  float pdf(Vector<World> toLight) const {
    if (!(dot(normal_, toLight) > 0) || !isOnItsSide(point_, toLight, true)) return 0;
    return 0.5f * inversePi * (exponent_ + 1) * peak(toLight);
  }
  std::optional<ClosureSample> sample(const ClosureUniforms& u) const {
    const float cosine = std::pow(1 - u.place[0], 1 / (exponent_ + 1));
    const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
    const float turn = 2 * std::numbers::pi_v<float> * u.place[1];
    const Frame<World> frame(mirrored_);
    return sampleTowards(*this, normalize(frame.at(sine * std::cos(turn), sine * std::sin(turn), cosine)));
  }
  Color albedo() const { return Color(1); }

 private:
  float peak(Vector<World> toLight) const { return std::pow(std::max(dot(mirrored_, toLight), 0.0f), exponent_); }

  const ClosurePoint& point_;
  Vector<World> normal_, mirrored_;
  float exponent_;
  bool isVisible_ = false;
};

}  // namespace

void registerClosure_phong(Registry& registry) { registerLobe<Phong>(registry); }

}  // namespace aerosol::render
