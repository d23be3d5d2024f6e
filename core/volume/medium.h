// One medium as trackers see it, and the evaluator through which they ask for its coefficients.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "core/base/geometry.h"
#include "core/base/motion.h"
#include "core/volume/bounds/bound_tree.h"
#include "core/volume/coefficients.h"
#include "core/volume/frame_stack.h"

namespace aerosol::volume {

enum class DistanceMethod : std::uint8_t {
  closedForm,     ///< Constant coefficients.
  analytic,       ///< Voxels times constants, solved cell by cell.
  marching,       ///< Ray marching: biased, no noise of its own in transmittance.
  nullScattering  ///< Delta and ratio tracking under a bound: unbiased.
};

/// What null scattering does at its tentative collisions; see trackers/collision_odds.h.
enum class Collisions : std::uint8_t {
  weighted,    ///< Scattering or a null collision; absorption stays in the weights.
  analogue,    ///< Absorption is a random event as well.
  decomposed,  ///< The least extinction of a leaf is a control, real at once; the rest is tracked.
  listed       ///< None is real: one of all is chosen in the end.
};

enum class TransmittanceMethod : std::uint8_t {
  closedForm,        ///< Constant coefficients.
  analytic,          ///< Voxels times constants, solved cell by cell.
  marching,          ///< Ray marching.
  ratioTracking,     ///< Residual ratio tracking under a bound: unbiased.
  twoCombs,          ///< Two jittered marches of twice the step: a smaller bias.
  unbiasedMarching,  ///< A power series of jittered marches: unbiased.
  deltaTracking      ///< All of the light or none: unbiased.
};

/// Extinction below this counts as none: 1 / pdf would not fit into a float, and no scene is 1e30 units long.
inline constexpr float negligibleExtinction = 1e-30f;

class PhaseFunction;
struct VoxelMedium;

/// A medium placed in the scene. Const after preparation.
struct Medium {
  std::uint32_t index = 0;  ///< The evaluator's key.
  DistanceMethod method = DistanceMethod::marching;
  DistanceMethod besideOthers = DistanceMethod::marching;  ///< Where media overlap, in place of `analytic`.
  TransmittanceMethod transmittance = TransmittanceMethod::marching;
  std::optional<Coefficients> constant;  ///< Set when the compiled shader reads nothing that varies.
  std::optional<ExtinctionBound> bound;  ///< On the largest channel of extinction, everywhere in the medium.
  const MovingTransform<World, Object>* motion = nullptr;  ///< Of its object space, where that moves.
  const VoxelMedium* voxels = nullptr;                     ///< Set when the coefficients are voxels times constants.
  const BoundTree* tree = nullptr;  ///< Bounds place by place, if there are any; then `bound` is the largest.
  float stepSize = std::numeric_limits<float>::infinity();  ///< Scene units, > 0; for marching and the relaxed bound.
  bool mayScatter = true;                                   ///< False where it is known that it nowhere does.
  bool mayEmit = true;                                      ///< Likewise.
  bool relaxesBound = false;                                ///< Null scattering works with max(bound, 1 / stepSize).
  bool isHoldout = false;           ///< A path from the camera that scatters here ends, as if nothing was there.
  std::uint32_t lightLinks = 0;     ///< Which lights light it (the renderer's key); 0: all.
  bool integratesEmission = false;  ///< Null scattering looks for emission once a step, not at its collisions.
  Collisions collisions = Collisions::weighted;  ///< Of null scattering.
  const PhaseFunction* phase = nullptr;  ///< Of all lobes, whatever their anisotropy; null: Henyey–Greenstein with it.

  /// The medium as one leaf, without its tree. A bound of 0 that nobody proved is not taken at its word: emission, and
  /// extinction that should not be there, are still looked for once a step.
  BoundNode whole() const {
    if (constant) {
      const float largest = maximum(constant->sigmaT);
      return {largest > negligibleExtinction ? largest : 0.0f, minimum(constant->sigmaT), largest,
              BoundNode::makeLink(LeafKind::uniform, Provenance::proven, 0)};
    }
    const float given = bound ? bound->value : 0.0f;
    const float majorant = given > negligibleExtinction ? given : 1.0f / stepSize;
    return {majorant, 0, majorant,
            BoundNode::makeLink(LeafKind::bounded, bound ? bound->provenance : Provenance::estimated, 0)};
  }
  /// Rate of a path's tentative collisions in a leaf where coefficients vary (talk: "relaxing to max(μ̄, 1/stepsize)").
  /// Not the working bound: where that is exceeded a collision weighs up to 3, which is little once, but the weights of
  /// a path of fifty vertices are multiplied.
  float collisionRate(const BoundNode& leaf) const {
    return relaxesBound ? std::max(leaf.limit, 1.0f / stepSize) : leaf.limit;
  }
  /// The same along shadow rays, by the working bound: no factor of transmittance exceeds 1 in size.
  float shadowRate(const BoundNode& leaf) const {
    return relaxesBound ? std::max(leaf.majorant, 1.0f / stepSize) : leaf.majorant;
  }
};

/// What a query wants computed.
enum class Quantity : std::uint8_t { coefficients, extinction };

/// Counts of one thread's trackers.
struct TrackerStatistics {
  std::uint64_t points = 0;           ///< Shader points asked for by trackers.
  std::uint64_t boundViolations = 0;  ///< Points whose extinction exceeded what was known of their leaf.
  float worstViolation = 0;           ///< Largest extinction / collision rate among them.
  std::uint32_t worstMedium = 0;      ///< Where it was seen,
  float worstExtinction = 0;          ///< and the extinction there.
  std::uint64_t stepLimits = 0;       ///< Segments with more than `maximumSteps` collisions or cells.
};

inline constexpr int maximumSteps =
    1 << 22;  ///< Tentative collisions in one segment before it is given up and counted; marching cells at most.

/// The trackers' door to the shaders. A tracker asks for any number of points, suspends once, and reads the answers in
/// the order of the questions. They stay valid until the next `ask`. For `Quantity::extinction` only sigmaT is set;
/// of the lobes only the first `lobeCount` are.
template <class E>
concept Evaluator =
    HasFrames<E> && requires(E& evaluator, const Medium& medium, Point<World> point, Quantity quantity) {
      evaluator.ask(medium, point, quantity);
      { evaluator.answers().await_resume() } -> std::convertible_to<std::span<const Coefficients>>;
      { evaluator.trackerStatistics() } -> std::same_as<TrackerStatistics&>;
    };

/// A stream of numbers in [0, 1).
template <class R>
concept UniformSource = requires(R& random) {
  { random.next() } -> std::convertible_to<float>;
};

}  // namespace aerosol::volume
