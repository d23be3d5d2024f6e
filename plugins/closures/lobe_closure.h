// What closures have in common whose evaluations share a set-up: the lobe, built once for each question.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>

#include "core/render/closure.h"
#include "core/render/registry.h"
#include "core/render/warp.h"

namespace aerosol::render {

inline constexpr float inversePi = std::numbers::inv_pi_v<float>;

/// Three floats of a closure's parameters.
inline Vector<World> directionAt(std::span<const float> p, std::size_t i) { return {p[i], p[i + 1], p[i + 2]}; }
inline Color colorAt(std::span<const float> p, std::size_t i) { return {p[i], p[i + 1], p[i + 2]}; }

/// The geometry agrees with the shading normal on which side a direction is: light does not leak.
inline bool isOnItsSide(const ClosurePoint& point, Vector<World> toLight, bool reflects) {
  const bool sameSide = dot(point.toViewer, point.geometricNormal) * dot(toLight, point.geometricNormal) > 0;
  return sameSide == reflects;
}

/// A scattering closure of a `Lobe`: a class with `name`, `doc`, `fields` and `traits`, made of parameters and point,
/// that is asked for `isVisible`, `evaluate`, `pdf`, `sample` and `albedo`, and for `evaluateDiffuse` where only a part
/// of it is matte.
template <class Lobe>
class LobeClosure final : public Closure {
 public:
  std::string_view name() const override { return Lobe::name; }
  std::string_view doc() const override { return Lobe::doc; }
  std::span<const DescribedField> fields() const override { return Lobe::fields; }
  ClosureKind kind() const override { return ClosureKind::scattering; }
  ClosureTraits traits() const override { return Lobe::traits; }

  Color evaluate(std::span<const float> parameters, const ClosurePoint& point, Vector<World> toLight) const override {
    const Lobe lobe(parameters, point);
    return lobe.isVisible() ? lobe.evaluate(toLight) : Color();
  }
  Color evaluateDiffuse(std::span<const float> parameters, const ClosurePoint& point,
                        Vector<World> toLight) const override {
    if constexpr (requires(const Lobe& lobe) { lobe.evaluateDiffuse(toLight); }) {
      const Lobe lobe(parameters, point);
      return lobe.isVisible() ? lobe.evaluateDiffuse(toLight) : Color();
    } else {
      return Closure::evaluateDiffuse(parameters, point, toLight);
    }
  }
  float pdf(std::span<const float> parameters, const ClosurePoint& point, Vector<World> toLight) const override {
    const Lobe lobe(parameters, point);
    return lobe.isVisible() ? lobe.pdf(toLight) : 0;
  }
  std::optional<ClosureSample> sample(std::span<const float> parameters, const ClosurePoint& point,
                                      const ClosureUniforms& u) const override {
    const Lobe lobe(parameters, point);
    return lobe.isVisible() ? lobe.sample(u) : std::nullopt;
  }
  Color albedo(std::span<const float> parameters, const ClosurePoint& point) const override {
    const Lobe lobe(parameters, point);
    return lobe.isVisible() ? lobe.albedo() : Color();
  }
};

template <class Lobe>
void registerLobe(Registry& registry) {
  registry.add(std::make_unique<LobeClosure<Lobe>>());
}

/// Directions of a lobe's `evaluate` and `pdf` made into a sample.
template <class Lobe>
std::optional<ClosureSample> sampleTowards(const Lobe& lobe, Vector<World> direction) {
  const float density = lobe.pdf(direction);
  if (!(density > 0)) return {};
  ClosureSample sample;
  sample.direction = direction;
  sample.pdf = density;
  sample.weight = lobe.evaluate(direction) / density;
  return sample;
}

/// A lobe over a whole hemisphere, sampled by the cosine. `Model` has the names of a lobe, `transmits`, a `normal`, and
/// gives `value(setting)`, the scattering function itself, and `albedo(cosViewer)`. Such sheets of paper look alike
/// from both sides when they transmit; what reflects does so on the normal's side.
template <class Model>
class CosineLobe {
 public:
  static constexpr std::string_view name = Model::name;
  static constexpr std::string_view doc = Model::doc;
  static constexpr auto& fields = Model::fields;
  static constexpr ClosureTraits traits = [] {
    ClosureTraits matte = Model::traits;
    matte.isDiffuse = true;
    return matte;
  }();

  /// Cosines to the normal, which is on the viewer's side, and between viewer and light.
  struct Setting {
    float viewer = 0, light = 0, between = 0;
  };

  CosineLobe(std::span<const float> p, const ClosurePoint& point) : model_(p), point_(point), normal_(model_.normal) {
    viewer_ = dot(normal_, point.toViewer);
    if (Model::transmits && viewer_ < 0) {
      normal_ = -normal_;
      viewer_ = -viewer_;
    }
  }

  bool isVisible() const { return viewer_ > 0; }
  Color evaluate(Vector<World> toLight) const {
    const float light = cosineOf(toLight);
    if (!(light > 0)) return {};
    return model_.value(Setting{viewer_, light, dot(point_.toViewer, toLight)}) * light;
  }
  float pdf(Vector<World> toLight) const { return std::max(cosineOf(toLight), 0.0f) * inversePi; }
  std::optional<ClosureSample> sample(const ClosureUniforms& u) const {
    const Vector<World> axis = Model::transmits ? -normal_ : normal_;
    return sampleTowards(*this, alongFrame(Frame<World>(axis), toCosineHemisphere(u.place)));
  }
  Color albedo() const { return model_.albedo(viewer_); }

 private:
  float cosineOf(Vector<World> toLight) const {
    if (!isOnItsSide(point_, toLight, !Model::transmits)) return 0;
    return Model::transmits ? -dot(normal_, toLight) : dot(normal_, toLight);
  }

  Model model_;
  const ClosurePoint& point_;
  Vector<World> normal_;
  float viewer_ = 0;
};

}  // namespace aerosol::render
