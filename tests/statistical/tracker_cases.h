// Densities along a ray with their integrals, and the trackers that are run on them.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "core/volume/trackers/candidate_list.h"
#include "core/volume/trackers/homogeneous.h"
#include "core/volume/trackers/null_scattering.h"
#include "core/volume/trackers/ray_marching.h"
#include "core/volume/trackers/transmittance.h"
#include "tests/statistical/statistics.h"
#include "tests/support/density_evaluator.h"

namespace aerosol::test {

using volume::Coefficients;
using volume::DistanceEvent;
using volume::DistanceSample;
using volume::Medium;

inline constexpr std::array<int, 3> channels{0, 1, 2};
inline constexpr int bins = 10;  ///< Parts of a segment in histograms.

using DistanceSampler = std::function<DistanceSample()>;

/// One medium along the ray: coefficients as a function of the distance.
struct Profile {
  std::function<Coefficients(double)> at;
  double maximum = 0;  ///< Largest channel of extinction, exactly.
  bool isConstant = false;
};

/// A segment of a ray.
struct TrackerCase {
  std::string name;
  double t0 = 0, t1 = 1;
  std::vector<Profile> media;
  Color throughput{1.0f};
  int steps = 40;         ///< Marching cells that make the bias vanish beside the resolution.
  double sharpness = 20;  ///< 1 / step of the relaxed bound.

  bool isConstant() const {
    return std::all_of(media.begin(), media.end(), [](const Profile& p) { return p.isConstant; });
  }
  friend std::ostream& operator<<(std::ostream& out, const TrackerCase& c) { return out << c.name; }
};

/// Coefficients of a medium with one lobe.
inline Coefficients coefficients(Color sigmaT, Color albedo, Color emission = Color()) {
  Coefficients c;
  c.sigmaT = sigmaT;
  c.sigmaS = sigmaT * albedo;
  c.emission = emission;
  c.lobeCount = 1;
  c.lobes[0] = {c.sigmaS, 0.5f};
  return c;
}

/// `density(t)` times a colour of extinction, with an albedo and emission in proportion to `emission(t)`.
inline Profile profile(std::function<double(double)> density, double maximum, Color tint, Color albedo,
                       std::function<double(double)> emission = {}) {
  return {.at =
              [=](double t) {
                const Color glow = emission ? Color(1.0f, 0.5f, 0.25f) * static_cast<float>(emission(t)) : Color();
                return coefficients(tint * static_cast<float>(density(t)), albedo, glow);
              },
          .maximum = maximum * static_cast<double>(aerosol::maximum(tint))};
}

inline Profile constantProfile(Color sigmaT, Color albedo, Color emission = Color()) {
  return {.at = [=](double) { return coefficients(sigmaT, albedo, emission); },
          .maximum = static_cast<double>(aerosol::maximum(sigmaT)),
          .isConstant = true};
}

inline std::vector<TrackerCase> trackerCases() {
  const Color white(1.0f), grey(0.8f), tinted(0.9f, 0.6f, 0.3f), chromatic(0.3f, 0.8f, 1.6f);
  const auto linear = [](double t) { return 0.2 + 0.9 * t; };
  const auto spike = [](double t) { return 0.1 + 7 * std::exp(-std::pow((t - 1.1) / 0.06, 2)); };
  const auto wave = [](double t) { return 1 + std::sin(5 * t); };
  const auto step = [](double t) { return t < 1 ? 0.0 : 2.0; };
  const auto gentle = [](double t) { return 1 + 0.4 * std::sin(5 * t); };
  std::vector<TrackerCase> cases;
  const auto add = [&](std::string name, double t0, double t1, std::vector<Profile> media) -> TrackerCase& {
    return cases.emplace_back(TrackerCase{.name = std::move(name), .t0 = t0, .t1 = t1, .media = std::move(media)});
  };
  add("constant", 0.5, 2, {constantProfile(white, grey)});
  add("constantChromatic", 0, 1.5, {constantProfile(chromatic, tinted, Color(0.5f, 1, 2))});
  add("constantAbsorbing", 1, 3, {constantProfile(Color(0.7f), Color())});
  add("constantChannelWithoutExtinction", 0, 2, {constantProfile(Color(0, 0.5f, 8), tinted, Color(1, 1, 1))});
  add("empty", 0, 2, {constantProfile(Color(), white)});
  add("dense", 2, 3, {constantProfile(Color(1e4f), grey, Color(3e3f))});
  add("twoConstants", 0, 2, {constantProfile(Color(0.4f), white), constantProfile(chromatic * 0.3f, tinted)});
  add("linear", 0, 2, {profile(linear, 2, white, grey)});
  add("linearEmitting", 0, 2, {profile(linear, 2, white, grey, linear)});
  add("absorbing", 0, 2, {profile(linear, 2, white, Color(), linear)});
  add("chromatic", 0, 1.5, {profile(wave, 2, chromatic, tinted, wave)});
  add("chromaticUnevenThroughput", 0, 1.5, {profile(wave, 2, chromatic, tinted, wave)}).throughput = {1, 0.2f, 0.6f};
  add("chromaticBlackChannel", 0, 1.5, {profile(wave, 2, chromatic, tinted, wave)}).throughput = {0, 1, 0.5f};
  add("gentle", 0, 1.5, {profile(gentle, 1.4, white, grey)});
  add("gentleChromatic", 0, 1.5, {profile(gentle, 1.4, chromatic, tinted)});
  add("spiky", 0, 2, {profile(spike, 7.1, white, grey)}).steps = 200;
  add("emptyUnderABound", 0, 2, {profile([](double) { return 0.0; }, 1, white, white)});
  add("partlyEmpty", 0, 2, {profile(step, 2, white, white)}).steps = 60;
  add("emissionWithoutExtinction", 0, 2, {profile(step, 2, white, grey, [](double t) { return 2 - t; })}).steps = 60;
  add("varyingInConstant", 0, 2, {constantProfile(Color(0.3f), white), profile(wave, 2, chromatic * 0.4f, tinted)});
  add("threeVarying", 0, 1,
      {profile(wave, 2, white * 0.3f, white), profile(linear, 1.1, chromatic * 0.4f, tinted, linear),
       profile(step, 2, white, Color())})
      .steps = 60;
  TrackerCase& denseLinear =
      add("denseLinear", 0, 1, {profile([](double t) { return 1e3 + 1e3 * t; }, 2e3, white, grey)});
  denseLinear.steps = 20000;
  denseLinear.sharpness = 1;
  return cases;
}

inline TrackerCase findCase(const std::string& name) {
  for (const TrackerCase& c : trackerCases()) {
    if (c.name == name) return c;
  }
  ADD_FAILURE() << "no case " << name;
  return {};
}

/// A case as trackers see it: media, an evaluator, the segment, the ray along x.
class TrackerSetup {
 public:
  /// `boundScale` times the true maximum is each varying medium's bound.
  explicit TrackerSetup(const TrackerCase& c, double boundScale = 1, bool suspends = false)
      : evaluator_([&c](const Medium& m, Point<World> p) { return c.media[m.index].at(static_cast<double>(p.x)); },
                   suspends),
        media_(c.media.size()) {
    for (std::size_t i = 0; i < media_.size(); ++i) {
      media_[i].index = static_cast<std::uint32_t>(i);
      if (c.media[i].isConstant) media_[i].constant = c.media[i].at(0);
      // Rounded up: the profile's values are rounded to float as well.
      media_[i].bound = {static_cast<float>(c.media[i].maximum * boundScale * (1 + 1e-6)), volume::Provenance::proven};
      media_[i].stepSize = static_cast<float>(1 / c.sharpness);
      pointers_.push_back(&media_[i]);
    }
    segment_ = {static_cast<float>(c.t0), static_cast<float>(c.t1), pointers_};
    ray_.direction = {1, 0, 0};
  }
  TrackerSetup(const TrackerSetup&) = delete;
  TrackerSetup& operator=(const TrackerSetup&) = delete;

  DensityEvaluator& evaluator() { return evaluator_; }
  const volume::Segment& segment() const { return segment_; }
  const Ray<World>& ray() const { return ray_; }
  Medium& medium(std::size_t i) { return media_[i]; }
  volume::MediumSpan span(std::size_t i) const { return {segment_.t0, segment_.t1, &media_[i]}; }

 private:
  DensityEvaluator evaluator_;
  std::vector<Medium> media_;
  std::vector<const Medium*> pointers_;
  volume::Segment segment_;
  Ray<World> ray_;
};

/// All distance trackers. A new one is tested by a line here.
enum class Tracker : std::uint8_t {
  closedForm,
  marching,
  nullScattering,
  relaxedNullScattering,
  analogue,
  decomposition,
  candidates,
  lineEmission
};
inline constexpr std::array allTrackers{
    Tracker::closedForm, Tracker::marching,      Tracker::nullScattering, Tracker::relaxedNullScattering,
    Tracker::analogue,   Tracker::decomposition, Tracker::candidates,     Tracker::lineEmission};

inline const char* name(Tracker tracker) {
  constexpr std::array names{"closedForm", "marching",      "nullScattering", "relaxedNullScattering",
                             "analogue",   "decomposition", "candidates",     "lineEmission"};
  return names[static_cast<std::size_t>(tracker)];
}

inline std::ostream& operator<<(std::ostream& out, Tracker tracker) { return out << name(tracker); }

inline void prepare(Tracker tracker, Medium& medium) {
  medium.relaxesBound = tracker == Tracker::relaxedNullScattering;
  medium.collisions = tracker == Tracker::analogue        ? volume::Collisions::analogue
                      : tracker == Tracker::decomposition ? volume::Collisions::decomposed
                      : tracker == Tracker::candidates    ? volume::Collisions::listed
                                                          : volume::Collisions::weighted;
  medium.integratesEmission = tracker == Tracker::lineEmission;
}

inline void prepare(Tracker tracker, TrackerSetup& setup, const TrackerCase& c) {
  for (std::size_t i = 0; i < c.media.size(); ++i) {
    prepare(tracker, setup.medium(i));
    if (tracker == Tracker::lineEmission) setup.medium(i).stepSize = static_cast<float>((c.t1 - c.t0) / 8);
  }
}

/// Any of the trackers that null scattering has.
template <class Random>
DistanceSample sampleCollision(Tracker tracker, DensityEvaluator& evaluator, const Ray<World>& ray,
                               const volume::Segment& segment, Color throughput, Random& random,
                               volume::GivenDistance* given = nullptr, bool tracks = true) {
  return evaluator.finish(
      tracker == Tracker::candidates
          ? volume::sampleFromCandidates(evaluator, ray, segment, throughput, random, given, tracks)
          : volume::sampleByNullScattering(evaluator, ray, segment, throughput, random, given, tracks));
}

template <class Random>
DistanceSample sampleDistance(Tracker tracker, TrackerSetup& setup, const TrackerCase& c, Random& random) {
  switch (tracker) {
    case Tracker::closedForm:
      return volume::sampleHomogeneous(setup.segment(), c.throughput, random);
    case Tracker::marching: {
      volume::MarchingTable table;
      const auto step = static_cast<float>((c.t1 - c.t0) / c.steps);
      return setup.evaluator().finish(
          volume::sampleByMarching(setup.evaluator(), setup.ray(), setup.segment(), step, c.throughput, random, table));
    }
    default:
      return sampleCollision(tracker, setup.evaluator(), setup.ray(), setup.segment(), c.throughput, random);
  }
}

/// The closed form serves constant media alone; how emission is met makes no difference where there is none.
inline bool serves(Tracker tracker, const TrackerCase& c) {
  const bool emits = c.name == "linearEmitting" || c.name == "absorbing" || c.name == "constantChromatic" ||
                     c.name == "chromatic" || c.name == "emissionWithoutExtinction" || c.name == "threeVarying";
  return tracker == Tracker::lineEmission ? emits : tracker != Tracker::closedForm || c.isConstant();
}

/// The integrals of a case by quadrature: Gauss–Legendre on cells that are fine beside everything in the cases.
class Reference {
 public:
  static constexpr int cells = 8000;

  explicit Reference(const TrackerCase& c) : case_(c), width_((c.t1 - c.t0) / cells) {
    for (const int channel : channels) {
      auto& depth = depth_[static_cast<std::size_t>(channel)];
      depth.push_back(0);
      for (int i = 0; i < cells; ++i) {
        depth.push_back(depth.back() +
                        integrate([&](double t) { return sigmaT(t, channel); }, edge(i), edge(i + 1), 1));
      }
    }
  }

  double sigmaT(double t, int channel) const {
    return sum(t, [&](const Coefficients& c) { return c.sigmaT[channel]; });
  }
  double sigmaS(double t, int channel) const {
    return sum(t, [&](const Coefficients& c) { return c.sigmaS[channel]; });
  }
  double emission(double t, int channel) const {
    return sum(t, [&](const Coefficients& c) { return c.emission[channel]; });
  }

  /// Optical depth from the segment's start.
  double depth(double t, int channel) const {
    const int i = std::clamp(static_cast<int>((t - case_.t0) / width_), 0, cells - 1);
    return depth_[static_cast<std::size_t>(channel)][static_cast<std::size_t>(i)] +
           integrate([&](double s) { return sigmaT(s, channel); }, edge(i), t, 1);
  }
  double transmittance(double t, int channel) const { return std::exp(-depth(t, channel)); }

  /// ∫ f(t) T(t) dt over part `part` of `parts` of the segment.
  template <class Function>
  double integral(Function f, int channel, int part = 0, int parts = 1) const {
    double total = 0;
    for (int i = part * cells / parts; i < (part + 1) * cells / parts; ++i) {
      total += integrate([&](double t) { return f(t, channel) * transmittance(t, channel); }, edge(i), edge(i + 1), 1);
    }
    return total;
  }
  double scattered(int channel, int part = 0, int parts = 1) const {
    return integral([&](double t, int k) { return sigmaS(t, k); }, channel, part, parts);
  }
  double emitted(int channel) const {
    return integral([&](double t, int k) { return emission(t, k); }, channel);
  }

 private:
  double edge(int i) const { return case_.t0 + width_ * i; }

  template <class Take>
  double sum(double t, Take take) const {
    double total = 0;
    for (const Profile& medium : case_.media) total += static_cast<double>(take(medium.at(t)));
    return total;
  }

  const TrackerCase& case_;
  double width_;
  std::array<std::vector<double>, 3> depth_;
};

}  // namespace aerosol::test
