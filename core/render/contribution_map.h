// What a path may still bring to its pixel, as far as a small render of the same scene tells: by it Russian roulette
// decides.
//
// Vorba and Křivánek 2016, "Adjoint-Driven Russian Roulette and Splitting in Light Transport Simulation": a path at x
// with throughput τ is expected to add τ V(x) to a pixel of value I, V(x) being the mean radiance that paths gather
// behind x. Where that is below a part of I, the path goes on with the probability τ V / (I c), so that survivors bring
// about c I: neither is time spent on what hardly shows, nor weight lost that does. They guide V by direction, from
// photons learned before; here V is a mean over places, of the paths of a pilot with random numbers of its own, so that
// it depends on the scene and its seed alone. A wrong V costs noise, never bias, and not much: survivors never get a
// throughput above a limit, so what the pilot has missed makes no fireflies. Where τ V is far above I, as in a bright
// room seen through a door, the path goes on in several directions, each with its part of τ.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/color.h"
#include "core/base/geometry.h"

namespace aerosol::render {

/// A vertex of a path of the pilot, and what came after it.
struct PilotVertex {
  Point<World> place;
  float throughput = 0;  ///< Mean of the channels' magnitudes, before roulette.
  float before = 0;      ///< What the path had brought up to there, as mean of the channels.
};

/// A path of the pilot.
struct PilotPath {
  int x = 0, y = 0;  ///< Pixel of the pilot's film.
  std::uint32_t sample = 0;
  float value = 0;  ///< What it brought altogether.
  std::vector<PilotVertex> vertices;
};

/// Const once made. Depends on the paths, not on their order.
class ContributionMap {
 public:
  /// Survivors bring about this part of the pixel's value.
  static constexpr float wanted = 1.0f / 3;
  /// Paths that would bring more than this many times the pixel's value are split,
  static constexpr float splitAbove = 8;
  /// into so many that each brings about this many times as much,
  static constexpr float splitTo = 4;
  /// but not into more than these.
  static constexpr int mostBranches = 4;
  /// Survivors have no larger throughput on account of that.
  static constexpr float largestThroughput = 4;

  ContributionMap() = default;
  /// `width` × `height` is the size of the pilot's film, of which `paths` came; `filmWidth` × `filmHeight` that of the
  /// picture.
  ContributionMap(std::vector<PilotPath> paths, int width, int height, int filmWidth, int filmHeight);

  bool isEmpty() const { return places_.empty(); }
  /// V: radiance that paths with throughput 1 gather behind a place, in the mean; at least 0.
  float expected(Point<World> place) const { return places_[cellOf(place)]; }
  /// I: about the value of a pixel of the picture, a mean over its surroundings; positive.
  float pixel(int x, int y) const;

  /// Probability with which a path goes on from `place`, for the throughput that it has.
  float survival(Point<World> place, Color throughput, int x, int y) const {
    const float brings = average(abs(throughput)) * expected(place), needed = wanted * pixel(x, y);
    return std::min(std::max(brings / needed, maximum(abs(throughput)) / largestThroughput), 1.0f);
  }

  /// Into how many branches a path is split at `place`, at least 1.
  int branches(Point<World> place, Color throughput, int x, int y) const {
    const float brings = average(abs(throughput)) * expected(place) / pixel(x, y);
    if (!(brings > splitAbove)) return 1;
    return static_cast<int>(std::min(brings / splitTo, static_cast<float>(mostBranches)));
  }

 private:
  static constexpr int cells = 16;  ///< Along each axis.
  static constexpr int coarse = 4;  ///< The same of the coarser grid that fills gaps.
  static constexpr int blocks = 8;  ///< Of the picture, along each axis.

  std::size_t cellOf(Point<World> place) const;
  void gatherPlaces(std::span<const PilotPath> paths);
  void gatherPicture(std::span<const PilotPath> paths, int width, int height);

  Point<World> origin_;
  Vector<World> scale_;        ///< Cells per scene unit.
  std::vector<float> places_;  ///< V, by cell.
  std::array<float, blocks * blocks> picture_{};
  int filmWidth_ = 1, filmHeight_ = 1;
};

}  // namespace aerosol::render
