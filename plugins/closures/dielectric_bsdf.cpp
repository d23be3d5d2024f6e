// A boundary between two dielectrics, smooth or of microfacets: reflection and refraction.
//
// Walter, Marschner, Li and Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces", equations 20 and
// 21. Radiance that crosses into an index eta times as large is compressed into a smaller solid angle: going the other
// way, from the light to the viewer, it grows by eta² (their n_o² over n_t², which is in equation 21).

#include <algorithm>
#include <cmath>

#include "core/render/closure.h"
#include "core/render/fresnel.h"
#include "core/render/microfacet.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

constexpr DescribedField fields_[] = {
    {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
    {.name = "U", .type = FieldType::direction, .unit = "", .doc = "Direction of roughness_x"},
    {.name = "reflection_tint", .type = FieldType::color, .unit = "", .doc = "Factor of what is reflected"},
    {.name = "transmission_tint", .type = FieldType::color, .unit = "", .doc = "Factor of what is refracted"},
    {.name = "roughness_x", .unit = "", .minimum = 0.05f, .doc = "Width of the slopes along U"},
    {.name = "roughness_y", .unit = "", .minimum = 0.05f, .doc = "Width of the slopes across U"},
    {.name = "ior",
     .unit = "",
     .minimum = 1.05f,
     .maximum = 2.5f,
     .doc = "Index of refraction of the inside; the media's own where they say one"},
    {.name = "distribution",
     .type = FieldType::choice,
     .unit = "",
     .doc = "Of the microfacets",
     .choices = microfacetShapes}};

struct Parameters {
  Vector<World> normal, tangent;
  Color reflected, refracted;
  float roughnessX, roughnessY, ior;
  Microfacets::Shape shape;

  explicit Parameters(std::span<const float> p)
      : normal(p[0], p[1], p[2]),
        tangent(p[3], p[4], p[5]),
        reflected(p[6], p[7], p[8]),
        refracted(p[9], p[10], p[11]),
        roughnessX(p[12]),
        roughnessY(p[13]),
        ior(p[14]),
        shape(p[15] == 0 ? Microfacets::Shape::ggx : Microfacets::Shape::beckmann) {}

  bool isSmooth() const { return std::max(roughnessX, roughnessY) < 1e-3f; }
};

/// One evaluation: the boundary as the viewer sees it.
class Boundary {
 public:
  Boundary(std::span<const float> parameters, const ClosurePoint& point)
      : p_(parameters),
        point_(point),
        frame_(p_.normal, p_.tangent, point.toViewer),
        facets_(p_.shape, p_.roughnessX, p_.roughnessY),
        viewer_(frame_.toLocal(point.toViewer)),
        eta_(point.relativeIor(p_.ior)) {}

  /// Polished, or between equal indices, where facets bend nothing.
  bool isSmooth() const { return p_.isSmooth() || std::fabs(eta_ - 1) < 1e-3f; }
  /// Shading normals that the viewer sees from behind scatter nothing.
  bool isVisible() const { return viewer_.z > 1e-6f && eta_ > 0; }

  Color albedo() const {
    const float f = fresnelDielectric(viewer_.z, eta_);
    return p_.reflected * f + p_.refracted * (1 - f);
  }

  Color evaluate(Vector<World> toLight) const {
    const std::optional<Facet> facet = facetOf(toLight);
    if (!facet) return Color();
    const float shape = facets_.density(facet->h) * facets_.seenByBoth(viewer_, facet->light);
    if (facet->reflects) return p_.reflected * (facet->fresnel * shape / (4 * viewer_.z));
    const float vh = dot(viewer_, facet->h), lh = dot(facet->light, facet->h), sum = vh + eta_ * lh;
    return p_.refracted * ((1 - facet->fresnel) * shape * std::fabs(vh * lh) / (viewer_.z * sum * sum));
  }

  float pdf(Vector<World> toLight) const {
    const std::optional<Facet> facet = facetOf(toLight);
    if (!facet) return 0;
    const float chosen = facets_.visibleDensity(viewer_, facet->h);
    const float reflection = reflectionChance(facet->fresnel);
    const float vh = dot(viewer_, facet->h);
    if (facet->reflects) return reflection * chosen / (4 * std::max(vh, 1e-12f));
    const float lh = dot(facet->light, facet->h), sum = vh + eta_ * lh;
    return (1 - reflection) * chosen * eta_ * eta_ * std::fabs(lh) / (sum * sum);
  }

  std::optional<ClosureSample> sample(const ClosureUniforms& u) const {
    const Vector<Local> h = isSmooth() ? Vector<Local>(0, 0, 1) : facets_.sampleVisible(viewer_, u.place);
    const float cosine = dot(viewer_, h);
    if (!(cosine > 0)) return {};
    const float fresnel = fresnelDielectric(cosine, eta_);
    const float reflection = reflectionChance(fresnel);
    const bool reflects = u.choice < reflection;
    const std::optional<Vector<Local>> light =
        reflects ? std::optional(reflectAt(viewer_, h)) : refractAt(viewer_, h, eta_);
    if (!light || (light->z > 0) != reflects) return {};
    ClosureSample sample;
    sample.direction = normalize(frame_.toWorld(*light));
    if (!staysOnItsSide(sample.direction, reflects)) return {};
    if (!reflects) sample.radianceScale = 1 / (eta_ * eta_);
    if (isSmooth()) {
      sample.isDelta = true;
      sample.pdf = reflects ? reflection : 1 - reflection;
      sample.weight = reflects ? p_.reflected * (fresnel / reflection)
                               : p_.refracted * ((1 - fresnel) / ((1 - reflection) * eta_ * eta_));
      return sample;
    }
    sample.pdf = pdf(sample.direction);
    if (!(sample.pdf > 0)) return {};
    sample.weight = evaluate(sample.direction) / sample.pdf;
    return sample;
  }

 private:
  /// The facet that sends light from one direction to the viewer.
  struct Facet {
    Vector<Local> light, h;
    float fresnel = 0;
    bool reflects = false;
  };

  std::optional<Facet> facetOf(Vector<World> toLight) const {
    Facet facet;
    facet.light = frame_.toLocal(toLight);
    if (facet.light.z == 0) return {};
    facet.reflects = facet.light.z > 0;
    if (!staysOnItsSide(toLight, facet.reflects)) return {};
    Vector<Local> h = facet.reflects ? viewer_ + facet.light : -(viewer_ + facet.light * eta_);
    if (!(squaredLength(h) > 1e-12f)) return {};
    h = normalize(h);
    facet.h = h.z < 0 ? -h : h;
    const float vh = dot(viewer_, facet.h), lh = dot(facet.light, facet.h);
    // Facets seen from behind: nothing (Walter et al., the factor χ).
    if (!(vh > 0) || (lh > 0) != facet.reflects) return {};
    facet.fresnel = fresnelDielectric(vh, eta_);
    return facet;
  }

  /// Whether the geometry agrees with the shading normal on which side a direction is: light does not leak.
  bool staysOnItsSide(Vector<World> toLight, bool reflects) const {
    const bool sameSide = dot(point_.toViewer, point_.geometricNormal) * dot(toLight, point_.geometricNormal) > 0;
    return sameSide == reflects;
  }

  float reflectionChance(float fresnel) const {
    const float r = fresnel * average(p_.reflected), t = (1 - fresnel) * average(p_.refracted);
    return r + t > 0 ? r / (r + t) : 0;
  }

  Parameters p_;
  const ClosurePoint& point_;
  LocalFrame frame_;
  Microfacets facets_;
  Vector<Local> viewer_;
  float eta_;
};

class Dielectric final : public Closure {
 public:
  std::string_view name() const override { return "dielectric_bsdf"; }
  std::string_view doc() const override { return "Reflection and refraction by a boundary of dielectrics"; }
  std::span<const DescribedField> fields() const override { return fields_; }
  ClosureKind kind() const override { return ClosureKind::scattering; }

  Color evaluate(std::span<const float> parameters, const ClosurePoint& point, Vector<World> toLight) const override {
    const Boundary boundary(parameters, point);
    return boundary.isVisible() && !boundary.isSmooth() ? boundary.evaluate(toLight) : Color();
  }
  float pdf(std::span<const float> parameters, const ClosurePoint& point, Vector<World> toLight) const override {
    const Boundary boundary(parameters, point);
    return boundary.isVisible() && !boundary.isSmooth() ? boundary.pdf(toLight) : 0;
  }
  std::optional<ClosureSample> sample(std::span<const float> parameters, const ClosurePoint& point,
                                      const ClosureUniforms& u) const override {
    const Boundary boundary(parameters, point);
    return boundary.isVisible() ? boundary.sample(u) : std::nullopt;
  }
  Color albedo(std::span<const float> parameters, const ClosurePoint& point) const override {
    const Boundary boundary(parameters, point);
    return boundary.isVisible() ? boundary.albedo() : Color();
  }
};

}  // namespace

void registerClosure_dielectric_bsdf(Registry& registry) { registry.add(std::make_unique<Dielectric>()); }

}  // namespace aerosol::render
