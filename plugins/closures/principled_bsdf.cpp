// Disney's material: diffuse reflection with sheen, microfacets between dielectric and metal, a clear coat, and
// refraction. An artist's model, whose parts know nothing of each other: where their sum would be more than arrives,
// all of them are dimmed alike. Elsewhere it loses what several facets scatter, as in Mitsuba.

#include "core/render/fresnel.h"
#include "core/render/microfacet.h"
#include "plugins/closures/disney_albedo.h"
#include "plugins/closures/lobe_closure.h"

namespace aerosol::render {

namespace {

/// The highlight of the clear coat: GTR with exponent 1 (2012, appendix B), masked as GGX of width 0.25.
class ClearCoat {
 public:
  explicit ClearCoat(float gloss) {
    const float width = disney::mix(0.1f, 0.001f, gloss);
    square_ = width * width;
  }
  float density(Vector<Local> h) const {
    return inversePi * (square_ - 1) / (std::log(square_) * (1 + (square_ - 1) * h.z * h.z));
  }
  Vector<Local> sample(std::array<float, 2> u) const {
    const float cos2 = (1 - std::pow(square_, 1 - u[1])) / (1 - square_);
    const float turn = 2 * std::numbers::pi_v<float> * u[0];
    const float sine = std::sqrt(std::max(0.0f, 1 - cos2)), cosine = std::sqrt(std::max(0.0f, cos2));
    return {sine * std::cos(turn), sine * std::sin(turn), cosine};
  }
  static float seen(Vector<Local> w) { return Microfacets({}, 0.25f, 0.25f).seen(w); }
  /// f |cos|. `half` is the cosine to the halfway vector.
  float evaluate(Vector<Local> viewer, Vector<Local> light, Vector<Local> h, float half) const {
    const float fresnel = disney::mix(0.04f, 1, disney::grazing(half));
    return 0.25f * fresnel * density(h) * seen(viewer) * seen(light) * light.z;
  }

  /// What it scatters, by gloss and the viewer's cosine. (The density at the halfway vector's tip is that of `sample`
  /// over the cosine there.)
  static float albedo(float gloss, float cosine) {
    static const GridTable<2> table({12, 32}, [](std::array<float, 2> x) {
      constexpr int count = 512;
      const ClearCoat coat(x[0]);
      const float z = std::max(x[1] * x[1], 1e-3f);
      const Vector<Local> viewer(std::sqrt(1 - z * z), 0, z);
      double sum = 0;
      for (int i = 0; i < count; ++i) {
        const double a = 0.5 + 0.7548776662466927 * i, b = 0.5 + 0.5698402909980532 * i;
        const Vector<Local> h =
            coat.sample({static_cast<float>(a - std::floor(a)), static_cast<float>(b - std::floor(b))});
        const float half = dot(viewer, h);
        const Vector<Local> light = reflectAt(viewer, h);
        if (!(half > 0) || !(light.z > 0)) continue;
        sum += static_cast<double>(coat.evaluate(viewer, light, h, half) * 4 * half / (coat.density(h) * h.z));
      }
      return static_cast<float>(sum / count);
    });
    return table({gloss, std::sqrt(cosine)});
  }

 private:
  float square_ = 0;
};

class Principled {
 public:
  static constexpr std::string_view name = "principled_bsdf";
  static constexpr std::string_view doc = "Disney's material";
  static constexpr ClosureTraits traits{.isReciprocal = false, .hasExactAlbedo = false};
  static constexpr DescribedField fields[] = {
      {.name = "N", .type = FieldType::direction, .unit = "", .doc = "Shading normal"},
      {.name = "U", .type = FieldType::direction, .unit = "", .doc = "Direction in which highlights are long"},
      {.name = "base_color", .type = FieldType::color, .unit = "", .doc = "Colour of everything but highlights"},
      {.name = "roughness", .unit = "", .doc = "0 polished"},
      {.name = "anisotropic", .unit = "", .doc = "How long highlights are"},
      {.name = "metallic", .unit = "", .doc = "0 dielectric, 1 metal"},
      {.name = "spec_trans", .unit = "", .doc = "0 opaque, 1 clear"},
      {.name = "ior", .unit = "", .minimum = 1.05f, .maximum = 2.5f, .doc = "Index of the inside"},
      {.name = "spec_tint", .unit = "", .doc = "How much highlights take of the base colour"},
      {.name = "sheen", .unit = "", .doc = "Shine at the edges"},
      {.name = "sheen_tint", .unit = "", .doc = "How much it takes of the base colour"},
      {.name = "flatness", .unit = "", .doc = "Towards scattering below the surface"},
      {.name = "clearcoat", .unit = "", .doc = "A second, polished highlight"},
      {.name = "clearcoat_gloss", .unit = "", .doc = "How small that is"}};

  Principled(std::span<const float> p, const ClosurePoint& point)
      : point_(point),
        frame_(directionAt(p, 0), directionAt(p, 3), point.toViewer),
        viewer_(frame_.toLocal(point.toViewer)),
        isFront_(dot(directionAt(p, 0), point.toViewer) > 0),
        base_(colorAt(p, 6)),
        metallic_(p[11]),
        specTint_(p[14]),
        sheet_{p[9], p[17], p[15], p[16]},
        coatWeight_(p[18]),
        coat_(p[19]),
        opaque_((1 - metallic_) * (1 - p[12])),
        clear_((1 - metallic_) * p[12]),
        eta_(isFront_ ? p[13] : 1 / p[13]),
        facets_(Microfacets::Finish{Microfacets::Shape::ggx, true}, disney::widths(p[10], p[9])[0],
                disney::widths(p[10], p[9])[1]),
        coatGloss_(p[19]) {
    if (isVisible() && isFront_) factor_ = 1 / disney::excess(sumOfParts(), viewer_.z);
  }

  bool isVisible() const { return viewer_.z > 1e-6f && (isFront_ || clear_ > 0); }

  Color evaluate(Vector<World> toLight) const {
    const std::optional<Meeting> m = meetingOf(toLight);
    if (!m) return {};
    const float vh = dot(viewer_, m->h), lh = dot(m->light, m->h);
    const float f = fresnelDielectric(vh, eta_);
    const float shape = m->agrees ? facets_.density(m->h) * facets_.seenByBoth(viewer_, m->light) : 0;
    if (!m->reflects) {
      const float sum = vh + eta_ * lh;
      return root() * (factor_ * clear_ * (1 - f) * shape * std::fabs(vh * lh) / (viewer_.z * sum * sum));
    }
    Color value = reflectance(vh, f) * (shape / (4 * viewer_.z));
    if (!isFront_) return value;
    if (coatWeight_ > 0 && m->agrees) value += Color(coatWeight_ * coat_.evaluate(viewer_, m->light, m->h, vh));
    return value * factor_ + matte(*m);
  }

  Color evaluateDiffuse(Vector<World> toLight) const {
    const std::optional<Meeting> m = meetingOf(toLight);
    return m && m->reflects && isFront_ ? matte(*m) : Color();
  }

  float pdf(Vector<World> toLight) const {
    const std::optional<Meeting> m = meetingOf(toLight);
    if (!m) return 0;
    const float vh = dot(viewer_, m->h), lh = dot(m->light, m->h);
    const Chances c = chancesAt(fresnelDielectric(std::max(vh, 0.0f), eta_));
    if (!m->reflects) {
      const float sum = vh + eta_ * lh;
      return m->agrees ? c.refract * facets_.visibleDensity(viewer_, m->h) * eta_ * eta_ * std::fabs(lh) / (sum * sum)
                       : 0;
    }
    float sum = c.diffuse * m->light.z * inversePi;
    if (m->agrees) {
      const float toDirection = 1 / (4 * std::max(vh, 1e-12f));
      sum += c.reflect * facets_.visibleDensity(viewer_, m->h) * toDirection;
      if (c.coat > 0) sum += c.coat * coat_.density(m->h) * m->h.z * toDirection;
    }
    return sum;
  }

  std::optional<ClosureSample> sample(const ClosureUniforms& u) const {
    // The facet is drawn first: by it the chance between reflection and refraction is known.
    const Vector<Local> h = facets_.sampleVisible(viewer_, u.place);
    const Chances c = chancesAt(fresnelDielectric(std::max(dot(viewer_, h), 0.0f), eta_));
    Vector<Local> light;
    bool reflects = true;
    if (u.choice < diffuseChance()) {
      const auto d = toCosineHemisphere(u.place);
      light = {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])};
    } else if (u.choice < diffuseChance() + coatChance()) {
      light = reflectAt(viewer_, coat_.sample(u.place));
    } else if (u.choice < diffuseChance() + coatChance() + c.refract) {
      const auto bent = refractAt(viewer_, h, eta_);
      if (!bent) return {};
      light = *bent;
      reflects = false;
    } else {
      light = reflectAt(viewer_, h);
    }
    if ((light.z > 0) != reflects) return {};
    std::optional<ClosureSample> sample = sampleTowards(*this, normalize(frame_.toWorld(light)));
    if (sample && !reflects) sample->radianceScale = 1 / (eta_ * eta_);
    return sample;
  }

  Color albedo() const {
    const float f = fresnelDielectric(viewer_.z, eta_);
    Color sum = reflectance(viewer_.z, f) + Color(clear_ * (1 - f));
    if (isFront_) sum += base_ * opaque_ + Color(0.02f * coatWeight_);
    return {std::clamp(sum.r, 0.0f, 1.0f), std::clamp(sum.g, 0.0f, 1.0f), std::clamp(sum.b, 0.0f, 1.0f)};
  }

 private:
  struct Meeting {
    Vector<Local> light, h;
    bool reflects = false;
    bool agrees = false;  ///< Viewer and light are on the right sides of the facet.
  };
  struct Chances {
    float diffuse = 0, coat = 0, refract = 0, reflect = 0;
  };

  std::optional<Meeting> meetingOf(Vector<World> toLight) const {
    Meeting m;
    m.light = frame_.toLocal(toLight);
    if (m.light.z == 0) return {};
    m.reflects = m.light.z > 0;
    if (!isOnItsSide(point_, toLight, m.reflects) || (!m.reflects && !(clear_ > 0))) return {};
    const Vector<Local> h = m.reflects ? viewer_ + m.light : -(viewer_ + m.light * eta_);
    if (!(squaredLength(h) > 1e-12f)) return {};
    m.h = normalize(h);
    if (m.h.z < 0) m.h = -m.h;
    m.agrees = dot(viewer_, m.h) > 0 && (dot(m.light, m.h) > 0) == m.reflects;
    return m;
  }

  /// Diffuse reflection and sheen, on the front.
  Color matte(const Meeting& m) const {
    if (!(opaque_ > 0)) return {};
    const disney::Sheet& s = sheet_;
    const float lh = dot(m.light, m.h);
    const Color sheen = disney::mix(Color(1), disney::tintOf(base_), s.sheenTint);
    const Color matte = disney::diffuse({s.roughness, s.flatness, 0, 0}, base_, viewer_.z, m.light.z, lh) * opaque_;
    return (matte + sheen * (s.sheen * (1 - metallic_) * disney::grazing(lh))) * (factor_ * m.light.z);
  }

  /// Dielectric, its tinted kind and metal, by their parts.
  Color reflectance(float cosine, float dielectric) const {
    if (!isFront_) return Color(clear_ * dielectric);
    Color sum(dielectric * (1 - metallic_) * (1 - specTint_));
    if (metallic_ > 0) sum += disney::schlick(base_, cosine, eta_) * metallic_;
    if (specTint_ > 0) {
      const Color facing = disney::tintOf(base_) * disney::facingReflectance(eta_);
      sum += disney::schlick(facing, cosine, eta_) * ((1 - metallic_) * specTint_);
    }
    return sum;
  }

  Color root() const { return {std::sqrt(base_.r), std::sqrt(base_.g), std::sqrt(base_.b)}; }

  /// What all parts scatter of light from everywhere, as they are; on the front.
  Color sumOfParts() const {
    const disney::FacetAlbedo facets = disney::facetAlbedo(facets_, eta_, viewer_);
    Color sum = Color(facets.reflected * (1 - metallic_) * (1 - specTint_)) + root() * (clear_ * facets.transmitted);
    if (metallic_ > 0) sum += facets.schlick(base_) * metallic_;
    if (specTint_ > 0) {
      const Color facing = disney::tintOf(base_) * disney::facingReflectance(eta_);
      sum += facets.schlick(facing) * ((1 - metallic_) * specTint_);
    }
    if (coatWeight_ > 0) sum += Color(coatWeight_ * ClearCoat::albedo(coatGloss_, viewer_.z));
    const disney::Sheet& s = sheet_;
    if (!(opaque_ > 0)) return sum;
    sum += base_ * (opaque_ * disney::diffuseAlbedo(s.roughness, s.flatness, viewer_.z));
    if (!(s.sheen > 0)) return sum;
    return sum + disney::mix(Color(1), disney::tintOf(base_), s.sheenTint) *
                     (s.sheen * (1 - metallic_) * disney::sheenAlbedo(viewer_.z));
  }

  // Highlights and refraction share what they take together, which does not depend on the facet.
  float total() const { return isFront_ ? 1 + 0.25f * coatWeight_ + opaque_ : 1; }
  float diffuseChance() const { return isFront_ ? opaque_ / total() : 0; }
  float coatChance() const { return isFront_ ? 0.25f * coatWeight_ / total() : 0; }
  Chances chancesAt(float f) const {
    const float refract = (isFront_ ? clear_ : 1) * (1 - f);
    return {diffuseChance(), coatChance(), refract / total(), (1 - refract) / total()};
  }

  const ClosurePoint& point_;
  LocalFrame frame_;
  Vector<Local> viewer_;
  bool isFront_;
  Color base_;
  float metallic_, specTint_;
  disney::Sheet sheet_;
  float coatWeight_;
  ClearCoat coat_;
  float opaque_, clear_, eta_;
  Microfacets facets_;
  float coatGloss_;
  float factor_ = 1;
};

}  // namespace

void registerClosure_principled_bsdf(Registry& registry) { registerLobe<Principled>(registry); }

}  // namespace aerosol::render
