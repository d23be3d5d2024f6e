#include "core/render/aov/path_record.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/base/cie_xyz.h"

namespace aerosol::render {

void PathRecord::begin() {
  std::fill(values_.begin(), values_.end(), 0.0f);
  weights_.clear();
  if (plan_.followsPaths) {
    const State state = plan_.automaton.next(plan_.automaton.start(), plan_.symbol(PathEvent::camera));
    put(weights_, state, Color(1));
  }
  wentStraight_ = hasSeen_ = false;
}

void PathRecord::put(std::vector<Weight>& weights, State state, Color weight) {
  if (state == LightPathAutomaton::dead) return;
  for (Weight& each : weights) {
    if (each.state != state) continue;
    each.weight += weight;
    return;
  }
  weights.push_back({state, weight});
}

void PathRecord::weaken(Color factor) {
  for (Weight& each : weights_) each.weight *= factor;
}

void PathRecord::scatter(std::span<const ScatterShare> shares, Color weight) {
  const bool isStraight = shares.size() == 1 && shares[0].event == PathEvent::straight;
  if (isStraight && wentStraight_) {
    weaken(weight);
    return;
  }
  wentStraight_ = isStraight;
  before_.swap(weights_);
  weights_.clear();
  for (const Weight& each : before_) {
    for (const ScatterShare& share : shares) {
      put(weights_, plan_.automaton.next(each.state, plan_.symbol(share.event, share.label)),
          each.weight * weight * share.share);
    }
  }
}

PathRecord::Place PathRecord::place() const {
  Place result;
  result.weights_ = weights_;
  result.wentStraight_ = wentStraight_;
  return result;
}

void PathRecord::returnTo(const Place& place) {
  weights_ = place.weights_;
  wentStraight_ = place.wentStraight_;
}

void PathRecord::deposit(State state, Color light) {
  for (const std::uint32_t expression : plan_.automaton.matches(state)) {
    const std::uint32_t slot = plan_.expressionSlots[expression];
    for (std::uint32_t c = 0; c < 3; ++c) values_[slot + c] += light[static_cast<int>(c)];
  }
}

void PathRecord::add(Color light, PathSymbol source) {
  for (const Weight& each : weights_) deposit(plan_.automaton.next(each.state, source), each.weight * light);
}

void PathRecord::addSampled(Color light, std::span<const ScatterShare> shares) {
  for (const Weight& each : weights_) {
    for (const ScatterShare& share : shares) {
      State state = plan_.automaton.next(each.state, plan_.symbol(share.event, share.label));
      if (lit_.wentStraight) state = plan_.automaton.next(state, plan_.symbol(PathEvent::straight));
      deposit(plan_.automaton.next(state, lit_.source), each.weight * light * share.share);
    }
  }
}

void PathRecord::set(std::uint32_t slot, std::span<const float> values) {
  std::copy(values.begin(), values.end(), values_.begin() + static_cast<std::ptrdiff_t>(slot));
}

void PathRecord::see(const Seen& seen) {
  if (hasSeen_) return;
  hasSeen_ = true;
  const float weight = average(seen.weight);
  seenWeight_ = weight;
  seenDistance_ = seen.distance;
  sawMedium_ = seen.isMedium;
  seenIndex_ = seen.index;
  const Color albedo = seen.weight * seen.albedo;
  for (const AovPlan::FeatureSlot& slot : plan_.firstSeen) {
    if (slot.feature == AovFeature::visibleAlbedo) {
      set(slot.slot, std::array{albedo.r, albedo.g, albedo.b});
    } else if (slot.feature == AovFeature::visibleNormal) {
      const Vector<World> normal = seen.normal.vector() * weight;
      set(slot.slot, std::array{normal.x, normal.y, normal.z});
    } else if (slot.feature == AovFeature::visibleMotion) {
      set(slot.slot, std::array{seen.motion[0] * weight, seen.motion[1] * weight, weight});
    } else {
      set(slot.slot, std::array{seen.distance * weight, weight});
    }
  }
}

std::span<const float> PathRecord::finish(const Sample& sample) {
  for (const AovPlan::FeatureSlot& slot : plan_.picture) {
    const Color color = sample.color;
    const bool isIn = (slot.feature == AovFeature::halfA) == sample.isInFirstHalf;
    if (slot.feature == AovFeature::pictureXyz) set(slot.slot, toXyz(color));
    if (slot.feature == AovFeature::halfA || slot.feature == AovFeature::halfB)
      set(slot.slot, isIn ? std::array{color.r, color.g, color.b, 1.0f} : std::array{0.0f, 0.0f, 0.0f, 0.0f});
  }
  if (sample.filterWeight != 1) {
    for (float& value : values_) value *= sample.filterWeight;
  }
  if (deep_) deep_->finish(sample.color, hasSeen_ ? seenDistance_ : -1, sample.filterWeight, values_);
  // What is no light goes into the picture's filter unweighted.
  for (const AovPlan::FeatureSlot& slot : plan_.picture) {
    if (slot.feature == AovFeature::cost) values_[slot.slot] = sample.cost;
    const bool isHalf = slot.feature == AovFeature::halfA || slot.feature == AovFeature::halfB;
    const bool isIn = isHalf && (slot.feature == AovFeature::halfA) == sample.isInFirstHalf;
    if (isHalf) values_[slot.slot + 3] = isIn ? 1.0f : 0.0f;
  }
  if (hasSeen_ && !plan_.mattes.empty()) {
    values_[plan_.matteWeightSlot] = seenWeight_ * sample.filterWeight;
    for (const AovPlan::Matte& matte : plan_.mattes) {
      const auto& ids = sawMedium_ ? matte.media : matte.objects;
      values_[matte.slot] = seenIndex_ < ids.size() ? std::bit_cast<float>(ids[seenIndex_]) : 0.0f;
    }
  }
  for (const AovPlan::SquareSlots& squares : plan_.squares) {
    for (std::uint32_t i = 0; i < squares.count; ++i) {
      const float value = values_[squares.from + i];
      values_[squares.to + i] = value * value;
    }
  }
  return values_;
}

}  // namespace aerosol::render
