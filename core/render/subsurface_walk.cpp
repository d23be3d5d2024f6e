// Random walks guided towards the boundary, and safe where that is wrong.
//
// Křivánek and d'Eon 2014, "A Zero-Variance-Based Sampling Scheme for Monte Carlo Subsurface Scattering": far from
// sources light in half a space falls off as exp(-κ σ z), so free paths are stretched by 1 - κ w_z and directions drawn
// in proportion to 1 / (1 - κ w_z), w_z being the cosine to the outward normal. Without anisotropy all weights of the
// half-space cancel. Where scattering is anisotropic part of the directions comes from the phase function, and κ is
// that of the medium to which similarity reduces it.
//
// Curved and thin bodies are not half-spaces, and each channel has its own κ. So a walk is drawn by one of six
// strategies (three channels, guided or not), kept to its end, and weighted by the balance heuristic over the densities
// with which all six would have drawn the whole walk (Veach 1997; Meng, Hanika and Dachsbacher 2016, "Improving the
// Dwivedi Sampling Scheme", combine by step instead). But for roulette no weight exceeds the inverse of the chance of
// the plain strategy of its channel.

#include "core/render/subsurface_walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/fresnel.h"
#include "core/render/warp.h"

namespace aerosol::render {

namespace {

constexpr std::size_t strategyCount = 6;
constexpr double guidedShare = 0.75;
/// Walks longer than this play roulette in any case: nothing else ends them where nothing is absorbed.
constexpr int patience = 256;
constexpr float lateSurvival = 0.98f;

double phaseDensity(double g, double cosine) {
  const double d = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * std::numbers::pi * d * std::sqrt(d));
}

double phaseCosine(double g, double u) {
  if (std::fabs(g) < 1e-3) return 1 - 2 * u;
  const double f = (1 - g * g) / (1 + g - 2 * g * u);
  return std::clamp((1 + g * g - f * f) / (2 * g), -1.0, 1.0);
}

/// How directions and distances are drawn in one channel.
class Guide {
 public:
  Guide(double albedo, double g, bool isGuided) : g_(g), phaseShare_(isGuided ? std::sqrt(std::fabs(g)) : 1) {
    if (!isGuided) return;
    // The fit of Křivánek and d'Eon to the diffusion length of the reduced medium.
    const double reduced = albedo * (1 - g) / (1 - albedo * g);
    if (reduced < 1e-3) return;
    const double power = 2.44294 - 0.0215813 * reduced + 0.578637 / reduced;
    const double kappa = std::sqrt(std::max(0.0, 1 - std::pow(reduced, power)));
    kappa_ = std::min(kappa * (1 - albedo * g), 0.99);
    if (kappa_ < 1e-3) kappa_ = 0;
    if (kappa_ > 0) logarithm_ = std::log((1 + kappa_) / (1 - kappa_));
  }

  /// Of free paths, over the extinction.
  double stretch(double outwards) const { return 1 - kappa_ * outwards; }

  /// Per steradian; cosines to the direction before and to the outward normal.
  double density(double phase, double outwards) const {
    return phaseShare_ < 1 ? phaseShare_ * phase + (1 - phaseShare_) * guided(outwards) : phase;
  }

  Vector<World> sample(Vector<World> before, Vector<World> outward, float choice, std::array<float, 2> u) const {
    const double v = static_cast<double>(u[0]);
    const bool byPhase = static_cast<double>(choice) < phaseShare_;
    const double cosine = byPhase       ? phaseCosine(g_, v)
                          : kappa_ == 0 ? 1 - 2 * v
                                        : (1 - (1 + kappa_) * std::exp(-v * logarithm_)) / kappa_;
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double phi = 2 * std::numbers::pi * static_cast<double>(u[1]);
    return alongFrame(Frame<World>(byPhase ? before : outward), {sine * std::cos(phi), sine * std::sin(phi), cosine});
  }

 private:
  double guided(double outwards) const {
    if (kappa_ == 0) return 1 / (4 * std::numbers::pi);
    return kappa_ / (2 * std::numbers::pi * (1 - kappa_ * outwards) * logarithm_);
  }

  double g_, phaseShare_;
  double kappa_ = 0, logarithm_ = 0;
};

/// The densities of a walk by all strategies, and what it carries; all over the density of the strategy that draws it.
class WalkWeights {
 public:
  WalkWeights(const SubsurfaceBody& body, float choice)
      : guides_{makeGuide(body, 0, false), makeGuide(body, 1, false), makeGuide(body, 2, false),
                makeGuide(body, 0, true),  makeGuide(body, 1, true),  makeGuide(body, 2, true)} {
    for (std::size_t c = 0; c < 3; ++c) {
      extinction_[c] = static_cast<double>(body.extinction[static_cast<int>(c)]);
      albedo_[c] = static_cast<double>(body.albedo[static_cast<int>(c)]);
    }
    const double at = static_cast<double>(choice) * 3;
    const auto channel = std::min<std::size_t>(static_cast<std::size_t>(at), 2);
    chosen_ = channel + (at - static_cast<double>(channel) < guidedShare ? 3 : 0);
  }

  const Guide& guide() const { return guides_[chosen_]; }
  double rate(double outwards) const { return rateOf(chosen_, outwards); }

  /// The walk went so far without a collision, or with one.
  void goOn(double distance, double outwards, bool collides) {
    const double own = rateOf(chosen_, outwards);
    for (std::size_t k = 0; k < strategyCount; ++k) {
      const double other = rateOf(k, outwards);
      densities_[k] *= std::exp((own - other) * distance) * (collides ? other / own : 1);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      carried_[c] *= std::exp((own - extinction_[c]) * distance) * (collides ? albedo_[c] * extinction_[c] / own : 1);
    }
  }

  /// And was turned.
  void turn(double phase, double outwards) {
    const double own = guides_[chosen_].density(phase, outwards);
    for (std::size_t k = 0; k < strategyCount; ++k) densities_[k] *= guides_[k].density(phase, outwards) / own;
    for (double& c : carried_) c *= phase / own;
  }

  void scale(double factor) {
    for (double& c : carried_) c *= factor;
  }

  Color weight() const {
    double density = 0;
    for (std::size_t k = 0; k < strategyCount; ++k)
      density += densities_[k] * ((k < 3 ? 1 - guidedShare : guidedShare) / 3);
    return {static_cast<float>(carried_[0] / density), static_cast<float>(carried_[1] / density),
            static_cast<float>(carried_[2] / density)};
  }

 private:
  static Guide makeGuide(const SubsurfaceBody& body, int channel, bool isGuided) {
    return {static_cast<double>(body.albedo[channel]), static_cast<double>(body.anisotropy), isGuided};
  }
  double rateOf(std::size_t strategy, double outwards) const {
    return extinction_[strategy % 3] * guides_[strategy].stretch(outwards);
  }

  std::array<Guide, strategyCount> guides_;
  std::array<double, 3> extinction_{}, albedo_{}, carried_{1, 1, 1};
  std::array<double, strategyCount> densities_{1, 1, 1, 1, 1, 1};
  std::size_t chosen_ = 0;
};

Vector<World> reflectInside(Vector<World> direction, Normal<World> normal) {
  return normalize(direction - normal.vector() * (2 * dot(direction, normal)));
}

/// Even light that leaves a boundary on its outer side. Parameters: outward normal, index of the body (0: matte), part
/// of even light that passes.
class ExitLobe final : public Closure {
 public:
  std::string_view name() const override { return "exit"; }
  std::string_view doc() const override { return "Light that leaves a body"; }
  std::span<const DescribedField> fields() const override { return {}; }
  ClosureKind kind() const override { return ClosureKind::scattering; }

  float pdf(std::span<const float> p, const ClosurePoint& point, Vector<World> toLight) const override {
    const float cosine = dot(Vector<World>(p[0], p[1], p[2]), toLight);
    // The viewer of such a point is inside.
    const bool isOutside = dot(point.toViewer, point.geometricNormal) * dot(toLight, point.geometricNormal) < 0;
    return cosine > 0 && isOutside ? cosine * std::numbers::inv_pi_v<float> : 0;
  }
  Color evaluate(std::span<const float> p, const ClosurePoint& point, Vector<World> toLight) const override {
    const float even = pdf(p, point, toLight);
    if (p[3] == 0 || even == 0) return Color(even);
    const float cosine = dot(Vector<World>(p[0], p[1], p[2]), toLight);
    return Color(even * (1 - fresnelDielectric(cosine, p[3])) / p[4]);
  }
  std::optional<ClosureSample> sample(std::span<const float> p, const ClosurePoint& point,
                                      const ClosureUniforms& u) const override {
    const Frame<World> frame(Vector<World>(p[0], p[1], p[2]));
    ClosureSample sample{.direction = alongFrame(frame, toCosineHemisphere(u.place))};
    sample.pdf = pdf(p, point, sample.direction);
    if (!(sample.pdf > 0)) return {};
    sample.weight = evaluate(p, point, sample.direction) / sample.pdf;
    return sample;
  }
  Color albedo(std::span<const float>, const ClosurePoint&) const override { return Color(1); }
};

const ExitLobe exitLobe;

}  // namespace

float evenTransmittance(float ior) {
  // Gauss-Legendre in the sine squared, where the integrand is smooth but for the end.
  constexpr double nodes[] = {0.0130467357414141, 0.0674683166555077, 0.1602952158504878, 0.2833023029353764,
                              0.4255628305091844, 0.5744371694908156, 0.7166976970646236, 0.8397047841495122,
                              0.9325316833444923, 0.9869532642585859};
  constexpr double weights[] = {0.0333356721543441, 0.0747256745752903, 0.1095431812579911, 0.1346333596549981,
                                0.1477621123573764, 0.1477621123573764, 0.1346333596549981, 0.1095431812579911,
                                0.0747256745752903, 0.0333356721543441};
  double sum = 0;
  for (std::size_t i = 0; i < std::size(nodes); ++i) {
    const double cosine = nodes[i];
    sum += weights[i] * 2 * cosine * (1 - static_cast<double>(fresnelDielectric(static_cast<float>(cosine), ior)));
  }
  return static_cast<float>(sum);
}

std::optional<WayThroughBody> walkThroughBody(const accel::Scene& scene, const BodyEntry& entry, SampleStream& random,
                                              accel::Counters& counters) {
  HashSource numbers(random);
  WalkWeights walk(entry.body, numbers.next());
  const Normal<World> outer = entry.hit.entering ? entry.hit.geometricNormal : -entry.hit.geometricNormal;
  const Vector<World> outward = outer.vector();
  Ray<World> ray;
  ray.time = entry.time;
  ray.direction = entry.direction;
  ray.origin = entry.hit.originTowards(entry.direction);
  for (int step = 0;; ++step) {
    if (step > patience) {
      if (!(numbers.next() < lateSurvival)) return {};
      walk.scale(1 / static_cast<double>(lateSurvival));
    }
    const double outwards = static_cast<double>(dot(ray.direction, outward));
    const double free = -std::log1p(-static_cast<double>(numbers.next())) / walk.rate(outwards);
    ray.tMax = static_cast<float>(free);
    const auto hit = scene.closestHitOn(entry.hit.object, ray, counters);
    if (hit && hit->t < free) {
      walk.goOn(hit->t, outwards, false);
      const float cosine = std::fabs(dot(ray.direction, hit->geometricNormal));
      const float kept = entry.body.ior > 0 ? fresnelDielectric(cosine, 1 / entry.body.ior) : 0;
      if (!(numbers.next() < kept)) return WayThroughBody{*hit, walk.weight()};
      ray.direction = reflectInside(ray.direction, hit->geometricNormal);
      ray.origin = hit->originTowards(ray.direction);
      continue;
    }
    walk.goOn(free, outwards, true);
    const double survival = std::min(static_cast<double>(maximum(walk.weight())), 1.0);
    if (step > 8) {
      if (!(static_cast<double>(numbers.next()) < survival)) return {};
      walk.scale(1 / survival);
    } else if (survival == 0) {
      return {};
    }
    ray.origin = accel::pointAt(ray, free);
    const float choice = numbers.next();
    const Vector<World> before = ray.direction;
    const std::array<float, 2> place{numbers.next(), numbers.next()};
    ray.direction = walk.guide().sample(before, outward, choice, place);
    const double cosine = std::clamp(static_cast<double>(dot(before, ray.direction)), -1.0, 1.0);
    walk.turn(phaseDensity(static_cast<double>(entry.body.anisotropy), cosine),
              static_cast<double>(dot(ray.direction, outward)));
  }
}

BodyExit::BodyExit(const SubsurfaceBody& body, const accel::SurfaceHit& hit) {
  // The side to which the walk went.
  const Vector<World> outward = (hit.entering ? -hit.shadingNormal : hit.shadingNormal).vector();
  const Normal<World> outer = hit.entering ? -hit.geometricNormal : hit.geometricNormal;
  parameters_ = {outward.x, outward.y, outward.z, body.ior, body.ior > 0 ? evenTransmittance(body.ior) : 1};
  term_ = {&exitLobe, Color(1), parameters_};
  mix_.emplace(std::span<const WeightedClosure>(&term_, 1), ClosurePoint{-outer.vector(), outer});
}

}  // namespace aerosol::render
