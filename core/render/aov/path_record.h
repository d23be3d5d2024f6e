// What one path gathers for AOVs while it is traced.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/color.h"
#include "core/base/geometry.h"
#include "core/render/aov/aov_plan.h"
#include "core/render/aov/deep_record.h"

namespace aerosol::render {

/// One kind of scattering at a vertex, and its part in the weight.
struct ScatterShare {
  PathEvent event = PathEvent::volume;
  Color share{1.0f};
  std::uint32_t label = 0;  ///< Of the closure.
};

/// A path follows all expressions at once. Where closures of several kinds scatter into one direction, it goes on as
/// all of them: `weights_` says how much of the path's throughput is in which state of the automaton. So no random
/// choice of a kind adds noise, and what expressions that exclude each other gather adds up to the picture.
class PathRecord {
  using State = LightPathAutomaton::State;
  struct Weight {
    State state = LightPathAutomaton::dead;
    Color weight;
  };

 public:
  explicit PathRecord(const AovPlan& plan) : plan_(plan), values_(plan.layout.width) {
    if (plan.layout.deep.isWanted()) deep_.emplace(plan.layout.deep);
  }

  /// A path leaves the camera.
  void begin();

  // In step with the path's throughput:
  void weaken(Color factor);
  /// Goes on with `weight` times the throughput; the shares add up to 1.
  void scatter(std::span<const ScatterShare> shares, Color weight);

  /// Where a path stands that goes on in several branches.
  class Place {
    friend class PathRecord;
    std::vector<Weight> weights_;
    bool wentStraight_ = false;
  };
  Place place() const;
  void returnTo(const Place& place);

  // In step with what is added to the picture; each is for unit throughput:
  /// The path's end at a source of light.
  void add(Color light, PathSymbol source);
  void addFromLight(Color light, std::uint32_t index) { add(light, plan_.lightSymbols[index]); }
  void addFromObject(Color light, std::uint32_t object) { add(light, plan_.objectSymbols[object]); }
  void addFromMedia(Color light) { add(light, plan_.symbol(PathEvent::medium)); }
  /// The light that `noteLight` was about, scattered here.
  void addSampled(Color light, std::span<const ScatterShare> shares);
  /// Where the last light sample came from, in which direction; `wentStraight`: through surfaces that let it pass.
  void noteLight(std::uint32_t index, Vector<World> direction, bool wentStraight) {
    lit_ = {plan_.lightSymbols[index], direction, wentStraight};
  }
  Vector<World> litDirection() const { return lit_.direction; }

  /// Null where there is no deep image.
  DeepRecord* deep() { return deep_ ? &*deep_ : nullptr; }
  /// What is added to the picture from media before the path has a vertex: from a place, or from all along the ray.
  void addInFront(float distance, Color light) {
    if (deep_ && !hasSeen_) deep_->addLight(distance, light);
  }
  void addInFront(Color emission) {
    if (deep_ && !hasSeen_) deep_->addEmission(emission);
  }

  /// What the path sees first; later vertices change nothing. The weight is the path's throughput up to there.
  struct Seen {
    Color weight, albedo;
    Normal<World> normal;
    float distance = 0;             ///< From where the camera's ray begins.
    std::array<float, 2> motion{};  ///< In pixels, where it is asked for.
    bool isMedium = false;
    std::uint32_t index = 0;  ///< Of the object, or of the medium.
  };
  bool hasSeen() const { return hasSeen_; }
  void see(const Seen& seen);

  // What shaders of media are asked for this record, between question and answer:
  Color& shown(std::size_t i) {
    if (shown_.size() <= i) shown_.resize(i + 1);
    return shown_[i];
  }
  Vector<World>& velocity() { return velocity_; }

  void addValue(std::uint32_t slot, Color value) {
    for (int c = 0; c < 3; ++c) values_[slot + static_cast<std::uint32_t>(c)] += value[c];
  }
  void set(std::uint32_t slot, std::span<const float> values);
  const AovPlan& plan() const { return plan_; }

  /// What the rest of the values come from, once the path is at its end.
  struct Sample {
    Color color;  ///< Without the filter's weight.
    float filterWeight = 1;
    bool isInFirstHalf = false;
    float cost = 0;
  };
  std::span<const float> finish(const Sample& sample);

 private:
  struct Lit {
    PathSymbol source = 0;
    Vector<World> direction;
    bool wentStraight = false;
  };

  static void put(std::vector<Weight>& weights, State state, Color weight);
  void deposit(State state, Color light);

  const AovPlan& plan_;
  std::vector<float> values_;
  std::vector<Weight> weights_, before_;
  Lit lit_;
  bool wentStraight_ = false;  ///< The last event was a straight one.
  bool hasSeen_ = false, sawMedium_ = false;
  std::uint32_t seenIndex_ = 0;
  float seenWeight_ = 0, seenDistance_ = 0;
  std::vector<Color> shown_;
  Vector<World> velocity_;
  std::optional<DeepRecord> deep_;
};

}  // namespace aerosol::render
