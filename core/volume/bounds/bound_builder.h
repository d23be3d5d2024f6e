// Builds trees of bounds: where it pays, until the budget is spent.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/volume/bounds/bound_tree.h"

namespace aerosol::volume {

/// What ranges say of a medium over a box. `extinctionHigh` is infinite where nothing finite is proven.
struct BoxKnowledge {
  BoundRanges ranges;
  bool isEmpty = false;          ///< Surely no extinction and no emission.
  bool isUniform = false;        ///< Surely the same coefficients everywhere, which are finite and not negative.
  std::uint64_t uniformKey = 0;  ///< Equal for boxes of equal uniform coefficients.
};

/// Extinction at some points of a box.
struct BoxSamples {
  float low = 0;   ///< Of all channels of all points.
  float high = 0;  ///< Of the largest channels.
  float mean = 0;  ///< Of the largest channels.
};

/// The medium that a tree is built for. Work is split over threads inside; results do not depend on how.
class BoundSource {
 public:
  virtual ~BoundSource() = default;
  /// What is proven over each box.
  virtual void prove(std::span<const Box<Object>> boxes, std::span<BoxKnowledge> knowledge) = 0;
  /// Extinction at `pointsPerBox` well spread points of each box.
  virtual void sample(std::span<const Box<Object>> boxes, int pointsPerBox, std::span<BoxSamples> samples) = 0;
  /// Coefficients at a point.
  virtual Coefficients at(Point<Object> point) = 0;
};

struct BoundBudget {
  std::uint64_t boxes = 1u << 17;  ///< Evaluations of boxes.
  std::uint64_t bytes = 1u << 23;  ///< Of the tree.

  friend bool operator==(const BoundBudget&, const BoundBudget&) = default;
};

struct BoundRequest {
  Box<Object> domain;
  Transform<World, Object> objectToWorld;
  std::optional<float> declared;    ///< Upper bound on extinction that scene or shader declare.
  std::optional<float> everywhere;  ///< Proven upper bound on extinction that holds outside of the domain too.
  bool rangesAreDeclared = false;   ///< What is proven rests on what plugins say of themselves.
  float stepSize = 1;               ///< World units: how often to look where nothing is known, or only emission.
  double pointCost = 32;            ///< Of asking for a point, in steps over faces between leaves, > 0.
  bool mayLeaveOut = true;          ///< Whether points of known coefficients need not be asked for.
  BoundBudget budget;
};

/// Counts of one tree.
struct BoundStatistics {
  std::uint64_t boxes = 0;   ///< Evaluated.
  std::uint64_t points = 0;  ///< Sampled.
  std::uint64_t bytes = 0;
  std::uint64_t empty = 0, uniform = 0, proven = 0, declared = 0, estimated = 0;  ///< Leaves; the last three: bounded.
  double emptyVolume = 0, uniformVolume = 0;                                      ///< Parts of the domain.
  double tightness = 0;     ///< Working bound over the mean of samples, both integrated over the bounded leaves.
  double workingShare = 0;  ///< Working over proven bound, likewise.
  double meanBound = 0;     ///< Working bound, over all of the domain; 0 outside of the bounded leaves.
  double chord = 0;         ///< Mean length of a random ray in the domain, world units.
  double seconds = 0;
};

/// The box made larger by what rounding the world coordinates of its points to float can move them.
Box<Object> withRounding(const Box<Object>& box, const Transform<World, Object>& objectToWorld);

/// Level by level, each cell where tracking wastes most comes first. What a cell wastes is the number of tentative
/// collisions that find nothing: on a random ray through it (working bound - mean extinction) times the chord, and over
/// all rays in proportion to its volume. A cell that wastes less than a fraction of a collision on a chord is not
/// divided. After all, parts are joined that save less than the steps over their faces cost.
BoundTree buildBoundTree(BoundSource& source, const BoundRequest& request, BoundStatistics& statistics);

}  // namespace aerosol::volume
