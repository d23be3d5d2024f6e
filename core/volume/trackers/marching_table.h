// What marching found along a part of a ray, and the density of distances made from it.
//
// Kulla 2019 ("Path Tracing in Production – Volumes"): the cells of one ray are kept as a piecewise exponential
// transmittance, together with a pdf in proportion to σs T, so that any other pdf can be used on top: given a distance,
// the cell is found by binary search. Over the channels both are mixtures. With S = ∫ mix(σs T) and P = mix(T at the
// end), the light is scattered with probability S / (S + P), at distances with density mix(σs T) / S, and passes
// otherwise: absorption is never a random event, it stays in the weights.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/volume/distance_sample.h"
#include "core/volume/light_columns.h"
#include "core/volume/trackers/channels.h"

namespace aerosol::volume {

/// Cells in order along a ray; keeps its memory. `begin`, any number of `add`, then ask.
class MarchingTable {
 public:
  /// With so many cells, or less than this share of the light left, the table is to be closed: the way behind it gets
  /// one of its own, so memory stays bounded and dense media end early.
  static constexpr std::size_t largestCount = 1024;
  static constexpr double smallestRest = 1e-3;

  void begin(const ChannelMixture& channels) {
    channels_ = &channels;
    cells_.clear();
    lobes_.clear();
    transmittance_ = {1, 1, 1};
    scattering_ = 0;
    emission_ = {};
  }

  /// A homogeneous cell at `t`; its lobes are added behind it. `length` may be infinite.
  void add(const CoefficientSum& sum, double t, double length) {
    Cell& cell = cells_.emplace_back();
    cell.t = t;
    cell.length = length;
    // What is no extinction scatters nothing either.
    cell.sigmaT = withoutNegligible(sum.sigmaT);
    for (int c = 0; c < 3; ++c) cell.sigmaS[c] = cell.sigmaT[c] > 0 ? sum.sigmaS[c] : 0.0f;
    cell.firstLobe = lobes_.size();
    for (std::size_t c = 0; c < 3; ++c) {
      const int channel = static_cast<int>(c);
      const auto sigma = static_cast<double>(cell.sigmaT[channel]);
      // Grey media need one exponential for the three.
      const bool isRepeated = c > 0 && cell.sigmaT[channel] == cell.sigmaT[channel - 1];
      fraction_[c] = isRepeated ? fraction_[c - 1] : sigma > 0 ? -std::expm1(-sigma * length) : 0;
      const double through = sigma > 0 && sigma * length > 1e-12 ? fraction_[c] / sigma : length;
      cell.transmittance[c] = transmittance_[c];
      if (cell.sigmaS[channel] != 0) {
        const auto weight = static_cast<double>(std::fabs(channels_->probability[channel] * cell.sigmaS[channel]));
        scattering_ += weight * transmittance_[c] * through;
      }
      if (sum.emission[channel] != 0) {
        emission_[c] += static_cast<double>(sum.emission[channel]) * transmittance_[c] * through;
      }
      transmittance_[c] *= 1 - fraction_[c];
    }
    cell.scattering = scattering_;
  }
  void addLobes(const Medium& medium, const Coefficients& coefficients) {
    for (std::uint32_t k = 0; k < coefficients.lobeCount; ++k) lobes_.push_back({&medium, coefficients.lobes[k]});
  }

  bool isFull() const { return cells_.size() >= largestCount || passing() < smallestRest; }
  bool isEmpty() const { return cells_.empty(); }
  double end() const { return cells_.back().t + cells_.back().length; }

  /// ∫ T ε over the table.
  Color emission() const { return toColor(emission_); }
  Color transmittance() const { return toColor(transmittance_); }
  /// P and S of the introduction; P / (S + P) is the probability of passing.
  double passing() const { return mix(transmittance_); }
  double scattering() const { return scattering_; }
  double passProbability() const {
    const double passes = passing(), sum = scattering_ + passes;
    return sum > 0 ? passes / sum : 0;
  }

  /// A distance for u in [0, 1), with everything that DistanceSample says except for emission; `random` serves the
  /// choice of a lobe.
  template <UniformSource R>
  void sample(double u, R& random, DistanceSample& sample) const {
    const double sum = scattering_ + passing();
    if (!(sum > 0)) {
      sample.event = DistanceEvent::absorbed;
      sample.weight = Color();
      return;
    }
    const double mass = u * sum;
    if (mass >= scattering_) {
      multiply(sample, passProbability());
      for (int c = 0; c < 3; ++c) {
        sample.weight[c] *= static_cast<float>(transmittance_[static_cast<std::size_t>(c)] / passProbability());
      }
      return;
    }
    const auto cell = std::upper_bound(cells_.begin(), cells_.end(), mass,
                                       [](double m, const Cell& each) { return m < each.scattering; });
    const double before = cell == cells_.begin() ? 0 : (cell - 1)->scattering;
    sample.t = placeIn(*cell, mass - before);
    const std::array<double, 3> transmittance = at(*cell, sample.t);
    const double pdf = density(*cell, transmittance) / sum;
    multiply(sample, pdf);
    const Color weight =
        sample.weight * toColor({transmittance[0] / pdf, transmittance[1] / pdf, transmittance[2] / pdf});
    chooseLobe(*cell, weight, random.next(), sample);
  }

  /// What is at a given distance within the table, or on the way past it.
  template <UniformSource R>
  void find(GivenDistance& given, R& random) const {
    if (given.t >= end()) return given.pass(transmittance(), passProbability());
    const Cell& cell = cellAt(given.t);
    const std::array<double, 3> transmittance = at(cell, given.t);
    const double sum = scattering_ + passing();
    given.sample.t = given.t;
    given.sample.choicePdf *= sum > 0 ? density(cell, transmittance) / sum : 0;
    chooseLobe(cell, given.sample.weight * toColor(transmittance), random.next(), given.sample);
  }

  /// Takes the table's cells into what tabulated lights choose from. `left` is the light left where the table begins,
  /// `passed` the probability with which the tracker comes there.
  template <UniformSource R>
  void tabulate(TabulatedLight& lights, Color left, double passed, R& random) const {
    const double before = static_cast<double>(channels_->mix(abs(left)));
    const LightColumns& columns = *lights.columns;
    light_.clear();
    double sum = 0;
    for (const Cell& cell : cells_) {
      const double scale = before * meanScattering(cell);
      for (std::size_t i = 0; i < columns.count; ++i) {
        const LightColumn& column = columns.columns[i];
        // Where the light stands in the cell itself, without any extent, there is no mass that could be sampled.
        const double mass = scale > 0 && column.intensity > 0
                                ? scale * column.intensity * column.over(cell.t, cell.t + cell.length).integral
                                : 0;
        sum += std::isfinite(mass) ? mass : 0;
        light_.push_back(sum);
      }
    }
    if (!(sum > 0) || !std::isfinite(sum)) return;
    lights.mass += sum;
    if (!(static_cast<double>(random.next()) * lights.mass < sum)) return;
    const double wanted = static_cast<double>(lights.u[0]) * sum;
    const auto place =
        static_cast<std::size_t>(std::upper_bound(light_.begin(), light_.end(), wanted) - light_.begin());
    const std::size_t chosen = std::min(place, light_.size() - 1);
    const Cell& cell = cells_[chosen / columns.count];
    lights.column = chosen % columns.count;
    const LightColumn& column = columns.columns[lights.column];
    const double t =
        column.projection + column.over(cell.t, cell.t + cell.length).sample(static_cast<double>(lights.u[1]));
    const std::array<double, 3> transmittance = at(cell, t);
    const double total = scattering_ + passing();
    lights.scale = before * meanScattering(cell);
    lights.found = {};
    lights.found.t = t;
    lights.found.choicePdf = total > 0 ? passed * density(cell, transmittance) / total : 0;
    chooseLobe(cell, left * toColor(transmittance), random.next(), lights.found);
  }
  /// What `tabulate` calls scale, of a place within the table.
  double lightScaleAt(double t, Color left) const {
    return static_cast<double>(channels_->mix(abs(left))) * meanScattering(cellAt(t));
  }

 private:
  struct Cell {
    double t = 0, length = 0;
    std::array<double, 3> transmittance{};  ///< Where it begins.
    double scattering = 0;                  ///< ∫ mix(σs T) up to its end.
    Color sigmaT, sigmaS;
    std::size_t firstLobe = 0;
  };
  struct PlacedLobe {
    const Medium* medium = nullptr;
    Lobe lobe;
  };

  const Cell& cellAt(double t) const {
    const auto behind = std::upper_bound(cells_.begin(), cells_.end(), t,
                                         [](double place, const Cell& each) { return place < each.t; });
    return behind == cells_.begin() ? *behind : *(behind - 1);
  }
  /// The mean of mix(σs T) over a cell.
  double meanScattering(const Cell& cell) const {
    const double before = &cell == cells_.data() ? 0 : (&cell - 1)->scattering;
    return std::isfinite(cell.length) && cell.length > 0 ? (cell.scattering - before) / cell.length : 0;
  }

  static Color toColor(const std::array<double, 3>& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  }
  static void multiply(DistanceSample& sample, double probability) {
    sample.choicePdf *= probability;
    sample.logPdf += std::log(probability);
  }
  double mix(const std::array<double, 3>& v) const {
    const Color& p = channels_->probability;
    return static_cast<double>(p.r) * v[0] + static_cast<double>(p.g) * v[1] + static_cast<double>(p.b) * v[2];
  }
  std::array<double, 3> at(const Cell& cell, double t) const {
    std::array<double, 3> transmittance = cell.transmittance;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto sigma = static_cast<double>(cell.sigmaT[static_cast<int>(c)]);
      if (sigma > 0) transmittance[c] *= std::exp(-sigma * std::max(t - cell.t, 0.0));
    }
    return transmittance;
  }
  double density(const Cell& cell, const std::array<double, 3>& transmittance) const {
    const Color s = abs(cell.sigmaS);
    return mix({static_cast<double>(s.r) * transmittance[0], static_cast<double>(s.g) * transmittance[1],
                static_cast<double>(s.b) * transmittance[2]});
  }

  /// The place in a cell up to which it has the given part of its mass: of the channel that this part leads to, by the
  /// inverse of its truncated exponential.
  double placeIn(const Cell& cell, double mass) const {
    double place = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const int channel = static_cast<int>(c);
      const auto scattered = static_cast<double>(std::fabs(channels_->probability[channel] * cell.sigmaS[channel]));
      const auto sigma = static_cast<double>(cell.sigmaT[channel]);
      const double fraction = sigma > 0 ? -std::expm1(-sigma * cell.length) : 0;
      const double through = sigma > 0 && sigma * cell.length > 1e-12 ? fraction / sigma : cell.length;
      const double part = scattered > 0 ? scattered * cell.transmittance[c] * through : 0;
      if (!(part > 0)) continue;
      const double share = std::min(mass / part, 1 - 1e-16);
      place = fraction > 1e-12 ? -std::log1p(-share * fraction) / sigma : share * cell.length;
      if (mass < part) break;
      mass -= part;
    }
    return cell.t + std::clamp(place, 0.0, cell.length);
  }

  void chooseLobe(const Cell& cell, Color weight, float u, DistanceSample& sample) const {
    const std::size_t index = static_cast<std::size_t>(&cell - cells_.data());
    const std::size_t end = index + 1 < cells_.size() ? cells_[index + 1].firstLobe : lobes_.size();
    const auto forEach = [&](auto&& use) {
      for (std::size_t i = cell.firstLobe; i < end; ++i) use(*lobes_[i].medium, lobes_[i].lobe);
    };
    chooseAmongLobes(forEach, weight, u, sample);
  }

  const ChannelMixture* channels_ = nullptr;
  std::vector<Cell> cells_;
  std::vector<PlacedLobe> lobes_;
  mutable std::vector<double> light_;  ///< Sums of masses of tabulated lights, cell by cell; scratch.
  std::array<double, 3> transmittance_{}, fraction_{}, emission_{};
  double scattering_ = 0;
};

}  // namespace aerosol::volume
