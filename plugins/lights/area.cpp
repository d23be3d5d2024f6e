// A shape that shines: the same radiance in every direction from every point of its outside, where no texture
// says otherwise.

#include <numbers>

#include "core/render/registry.h"

namespace aerosol::render {

namespace {

class AreaLight final : public Light {
 public:
  /// `texture` is the mean of what multiplies the radiance.
  AreaLight(std::shared_ptr<const LightSurface> surface, Color radiance, Color texture)
      : surface_(std::move(surface)), radiance_(radiance), mean_(radiance * texture) {}

  std::optional<LightSample> sample(Point<World> from, const LightUniforms& u) const override {
    return toLight(surface_->sample(from, u));
  }

  float pdf(Point<World> from, const LightHit& hit) const override { return surface_->pdf(from, hit); }
  Color emitted(const LightHit& hit) const override { return dot(hit.direction, hit.normal) < 0 ? radiance_ : Color(); }

  std::uint32_t partCount() const override { return surface_->partCount(); }
  std::optional<LightBounds> partBounds(std::uint32_t part) const override {
    const SurfacePart s = surface_->part(part);
    LightBounds bounds;
    bounds.box = s.box;
    bounds.axis = s.normal;
    bounds.cosSpread = s.isFlat ? 1.0f : -1.0f;
    bounds.intensity = average(abs(mean_)) * static_cast<float>(s.isFlat ? s.area : s.area / 4);
    return bounds;
  }
  std::optional<LightSample> samplePart(std::uint32_t part, Point<World> from, const LightUniforms& u) const override {
    return toLight(surface_->samplePart(part, from, u));
  }
  float pdfPart(std::uint32_t part, Point<World> from, const LightHit& hit) const override {
    return surface_->pdfPart(part, from, hit);
  }
  std::uint32_t partAt(const LightHit& hit) const override { return partCount() > 1 ? hit.primitive : 0; }

  Color power(float) const override {
    return mean_ * (std::numbers::pi_v<float> * static_cast<float>(surface_->area()));
  }
  /// Its area over the squared distance, but no more than half of the directions.
  float importance(Point<World> at) const override {
    const auto area = static_cast<float>(surface_->area());
    const float away = squaredLength(surface_->centre() - at);
    return average(abs(mean_)) * area / (away + area / (2 * std::numbers::pi_v<float>));
  }
  std::optional<LightPlace> place() const override {
    return LightPlace{.centre = surface_->centre(),
                      .extent = surface_->extent(),
                      .intensity = average(abs(mean_)) * static_cast<float>(surface_->area() / 4)};
  }
  bool isDelta() const override { return false; }
  bool isInfinite() const override { return false; }

 private:
  std::optional<LightSample> toLight(const std::optional<SurfaceSample>& s) const {
    if (!s) return {};
    return LightSample{.direction = s->direction,
                       .distance = s->distance,
                       .value = radiance_,
                       .pdf = s->pdf,
                       .point = s->point,
                       .normal = s->normal,
                       .u = s->u,
                       .v = s->v,
                       .place = s->place};
  }

  std::shared_ptr<const LightSurface> surface_;
  Color radiance_, mean_;
};

std::unique_ptr<const Light> make(const LightArguments& arguments) {
  return std::make_unique<AreaLight>(arguments.surface, arguments.get<Color>("radiance"), arguments.texture);
}

}  // namespace

void registerLight_area(Registry& registry) {
  registry.add(LightType{.name = "area",
                         .doc = "A shape that shines on the side of its normals",
                         .parameters = {{.name = "radiance",
                                         .type = scene::ValueType::color,
                                         .unit = "W/(m² sr)",
                                         .doc = "Radiance of its outside",
                                         .defaultValue = Color(1)}},
                         .needsSurface = true,
                         .make = make});
}

}  // namespace aerosol::render
