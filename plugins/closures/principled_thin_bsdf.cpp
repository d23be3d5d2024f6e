// Disney's material for thin sheets: both sides are alike, light that passes is not bent. An artist's model, whose
// parts know nothing of each other: where their sum would be more than arrives, all of them are dimmed alike.

#include "core/render/fresnel.h"
#include "core/render/microfacet.h"
#include "plugins/closures/disney_albedo.h"
#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

namespace {

class PrincipledThin {
 public:
  static constexpr std::string_view name = "principled_thin_bsdf";
  static constexpr std::string_view doc = "Disney's material for thin sheets";
  static constexpr ClosureTraits traits{.isReciprocal = false, .hasExactAlbedo = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
      {.name = "U", .type = FieldType::direction, .unit = "", .doc = "Direction in which highlights are long"},
      {.name = "base_color", .type = FieldType::color, .unit = "", .doc = "Colour of everything but highlights"},
      {.name = "roughness", .unit = "", .doc = "0 polished"},
      {.name = "anisotropic", .unit = "", .doc = "How long highlights are"},
      {.name = "spec_trans", .unit = "", .doc = "0 matte, 1 clear"},
      {.name = "ior", .unit = "", .minimum = 1.05f, .maximum = 2.5f, .doc = "Index of the sheet"},
      {.name = "spec_tint", .unit = "", .doc = "How much highlights take of the base colour"},
      {.name = "sheen", .unit = "", .doc = "Shine at the edges"},
      {.name = "sheen_tint", .unit = "", .doc = "How much it takes of the base colour"},
      {.name = "flatness", .unit = "", .doc = "Towards scattering below the surface"},
      {.name = "diff_trans", .unit = "", .maximum = 2, .doc = "0 all diffuse light is reflected, 2 all passes"}};

  PrincipledThin(std::span<const float> p, const ClosurePoint& point)
      : point_(point),
        frame_(directionAt(p, 0), directionAt(p, 3), point.toViewer),
        viewer_(frame_.toLocal(point.toViewer)),
        base_(colorAt(p, 6)),
        clear_(p[11]),
        eta_(p[12]),
        specTint_(p[13]),
        sheet_{p[9], p[16], p[14], p[15]},
        passing_(0.5f * p[17]),
        reflecting_(facetsOf(p[10], p[9])),
        // Burley 2015, figure 15: how much rougher or smoother what passes looks.
        transmitting_(facetsOf(p[10], (0.65f * eta_ - 0.35f) * p[9])) {
    if (isVisible()) factor_ = 1 / disney::excess(sumOfParts(), viewer_.z);
  }

  bool isVisible() const { return viewer_.z > 1e-6f; }

  Color evaluate(Vector<World> toLight) const {
    const std::optional<Meeting> m = meetingOf(toLight);
    if (!m) return {};
    const float vh = dot(viewer_, m->h), f = fresnelDielectric(vh, eta_);
    const Microfacets& facets = m->reflects ? reflecting_ : transmitting_;
    const float shape = facets.density(m->h) * facets.seenByBoth(viewer_, m->mirrored) * factor_ / (4 * viewer_.z);
    if (!m->reflects) return base_ * (clear_ * (1 - f) * shape) + matte(*m);
    const Color reflected = disney::mix(Color(f), disney::schlick(facing(), vh, eta_), specTint_);
    return reflected * (clear_ * shape) + matte(*m);
  }

  Color evaluateDiffuse(Vector<World> toLight) const {
    const std::optional<Meeting> m = meetingOf(toLight);
    return m ? matte(*m) : Color();
  }

  float pdf(Vector<World> toLight) const {
    const std::optional<Meeting> m = meetingOf(toLight);
    if (!m) return 0;
    const float diffuse = (1 - clear_) * (m->reflects ? 1 - passing_ : passing_) * m->mirrored.z * inversePi;
    const Microfacets& facets = m->reflects ? reflecting_ : transmitting_;
    const float vh = std::max(dot(viewer_, m->h), 1e-12f);
    return diffuse + 0.5f * clear_ * facets.visibleDensity(viewer_, m->h) / (4 * vh);
  }

  std::optional<ClosureSample> sample(const ClosureUniforms& u) const {
    Vector<Local> light;
    bool reflects = false;
    if (u.choice < clear_) {
      reflects = u.choice < 0.5f * clear_;
      light = reflectAt(viewer_, (reflects ? reflecting_ : transmitting_).sampleVisible(viewer_, u.place));
      if (!(light.z > 0)) return {};
    } else {
      reflects = u.choice < clear_ + (1 - clear_) * (1 - passing_);
      const auto d = toCosineHemisphere(u.place);
      light = {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])};
    }
    if (!reflects) light.z = -light.z;
    return sampleTowards(*this, normalize(frame_.toWorld(light)));
  }

  Color albedo() const { return disney::mix(base_, Color(1), clear_); }

 private:
  struct Meeting {
    Vector<Local> mirrored, h;  ///< The light on the viewer's side.
    bool reflects = false;
  };

  Color matte(const Meeting& m) const {
    const float cosine = m.mirrored.z * factor_ * (1 - clear_);
    if (!m.reflects) return base_ * (passing_ * inversePi * cosine);
    return disney::diffuse(sheet_, base_, viewer_.z, m.mirrored.z, dot(m.mirrored, m.h)) * (cosine * (1 - passing_));
  }

  Color facing() const { return disney::tintOf(base_) * disney::facingReflectance(eta_); }

  /// What all parts scatter of light from everywhere, as they are.
  Color sumOfParts() const {
    const disney::FacetAlbedo over = disney::facetAlbedo(reflecting_, eta_, viewer_);
    const disney::FacetAlbedo below = disney::facetAlbedo(transmitting_, eta_, viewer_);
    const Color shiny = disney::mix(Color(over.reflected), over.schlick(facing()), specTint_) +
                        base_ * std::max(0.0f, below.mirror - below.reflected);
    const float diffuse = disney::diffuseAlbedo(sheet_.roughness, sheet_.flatness, viewer_.z);
    const Color sheen = disney::mix(Color(1), disney::tintOf(base_), sheet_.sheenTint) *
                        (sheet_.sheen * disney::sheenAlbedo(viewer_.z));
    return shiny * clear_ + ((base_ * diffuse + sheen) * (1 - passing_) + base_ * passing_) * (1 - clear_);
  }

  static Microfacets facetsOf(float anisotropic, float roughness) {
    const auto [x, y] = disney::widths(anisotropic, roughness);
    return {Microfacets::Finish{Microfacets::Shape::ggx, true}, x, y};
  }

  std::optional<Meeting> meetingOf(Vector<World> toLight) const {
    Meeting m;
    m.mirrored = frame_.toLocal(toLight);
    if (m.mirrored.z == 0) return {};
    m.reflects = m.mirrored.z > 0;
    if (!isOnItsSide(point_, toLight, m.reflects)) return {};
    m.mirrored.z = std::fabs(m.mirrored.z);
    m.h = normalize(viewer_ + m.mirrored);
    return m;
  }

  const ClosurePoint& point_;
  LocalFrame frame_;
  Vector<Local> viewer_;
  Color base_;
  float clear_, eta_, specTint_;
  disney::Sheet sheet_;
  float passing_;
  Microfacets reflecting_, transmitting_;
  float factor_ = 1;
};

}  // namespace

void registerClosure_principled_thin_bsdf(Registry& registry) { registerLobe<PrincipledThin>(registry); }

}  // namespace aerosol::render
