// A weighted sum of closures at one surface point.
#pragma once

#include <optional>
#include <span>

#include "core/base/small_array.h"
#include "core/render/closure.h"

namespace aerosol::render {

/// One term of a material: weight (signed) times a closure with its parameters.
struct WeightedClosure {
  const Closure* closure = nullptr;
  Color weight;
  std::span<const float> parameters;
  const Closure* shadowing = nullptr;  ///< Lies on top and dims it; null: nothing does.
  std::span<const float> shadowingParameters = {};
  std::uint32_t label = 0;  ///< By which light path expressions know it; 0: none.

  float shadow(Vector<World> toLight) const {
    return shadowing ? shadowing->shadowing(shadowingParameters, toLight) : 1;
  }
};

/// The sum of the terms, sampled by |weight| × albedo; where several could have returned a direction, the densities add
/// (one-sample multiple importance sampling with the balance heuristic, Veach 1997). Refers to its terms, no copy.
class ClosureMix {
 public:
  /// What most materials have at most.
  static constexpr std::size_t usualTerms = 16;

  explicit ClosureMix(std::span<const WeightedClosure> terms, const ClosurePoint& point);

  /// As `Closure::evaluate` and `pdf`.
  Color evaluate(Vector<World> toLight) const;
  /// The part of it that is diffuse.
  Color evaluateDiffuse(Vector<World> toLight) const;
  float pdf(Vector<World> toLight) const;
  /// What one term scatters, and the part of it that is diffuse.
  struct TermShare {
    std::uint32_t label = 0;
    Color all, diffuse;
  };
  std::size_t termCount() const { return terms_.size(); }
  TermShare evaluateTerm(std::size_t term, Vector<World> toLight) const;
  std::uint32_t labelOf(const ClosureSample& sample) const { return terms_[sample.term].label; }
  /// Whether some term has a label.
  bool hasLabels() const;
  /// The part of light that the terms scatter, those that let it pass straight left out.
  Color albedo() const;
  std::optional<ClosureSample> sample(const ClosureUniforms& u) const;
  /// What a sample enters that says so.
  SubsurfaceBody bodyOf(const ClosureSample& sample) const;
  /// Radiance towards the viewer.
  Color emitted() const;
  /// The part that passes straight on.
  Color transparency() const;
  /// The part that is a hole in the image.
  Color holdout() const;
  /// Nothing but transparency and emission.
  bool isPassing() const;

 private:
  std::span<const WeightedClosure> terms_;
  ClosurePoint point_;
  SmallArray<float, usualTerms> shares_;  ///< By term: |weight| × albedo.
  float total_ = 0;
  std::size_t sampled_ = 0;  ///< Terms with a share.
};

}  // namespace aerosol::render
