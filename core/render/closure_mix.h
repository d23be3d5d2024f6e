// A weighted sum of closures at one surface point.
#pragma once

#include <optional>
#include <span>

#include "core/render/closure.h"

namespace aerosol::render {

/// One term of a material: weight (signed) times a closure with its parameters.
struct WeightedClosure {
  const Closure* closure = nullptr;
  Color weight;
  std::span<const float> parameters;
};

/// The sum of the terms, sampled by |weight| × albedo; where several could have returned a direction, the densities add
/// (one-sample multiple importance sampling with the balance heuristic, Veach 1997). Refers to its terms, no copy.
class ClosureMix {
 public:
  explicit ClosureMix(std::span<const WeightedClosure> terms, const ClosurePoint& point);

  /// As `Closure::evaluate` and `pdf`.
  Color evaluate(Vector<World> toLight) const;
  float pdf(Vector<World> toLight) const;
  std::optional<ClosureSample> sample(const ClosureUniforms& u) const;
  /// Radiance towards the viewer.
  Color emitted() const;
  /// The part that passes straight on.
  Color transparency() const;
  /// Nothing but transparency and emission.
  bool isPassing() const;

 private:
  float share(const WeightedClosure& term) const;

  std::span<const WeightedClosure> terms_;
  ClosurePoint point_;
  float total_ = 0;
};

}  // namespace aerosol::render
