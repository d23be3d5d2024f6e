#include "core/render/aov/first_seen.h"

#include <cmath>

#include "core/render/aov/seen_motion.h"
#include "core/render/prepared_scene.h"

namespace aerosol::render {

volume::Task<> seeMedium(PathContext& path, const volume::Medium& medium, Point<World> point, float distance,
                         Color throughput) {
  PathRecord& record = *path.record;
  if (record.hasSeen()) co_return;
  PathRecord::Seen seen{.weight = throughput,
                        .albedo = Color(1),
                        .normal = {},
                        .distance = distance,
                        .isMedium = true,
                        .index = medium.index};
  if (record.plan().wants(AovFeature::visibleNormal) && !medium.constant) {
    const float step = std::isfinite(medium.stepSize) ? 0.5f * medium.stepSize : 0.01f * distance;
    const Vector<World> axes[] = {{step, 0, 0}, {0, step, 0}, {0, 0, step}};
    for (const Vector<World>& axis : axes) {
      path.ask(medium, point + axis, volume::Quantity::extinction);
      path.ask(medium, point - axis, volume::Quantity::extinction);
    }
    const std::span<const volume::Coefficients> answers = co_await path.answers();
    Vector<World> thinner;
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<std::size_t>(2 * i);
      thinner[i] = average(answers[at + 1].sigmaT) - average(answers[at].sigmaT);
    }
    const float steepness = length(thinner);
    if (steepness > 0 && std::isfinite(steepness)) seen.normal = Normal<World>(thinner / steepness);
  }
  if (record.plan().wants(AovFeature::visibleMotion)) {
    Vector<World> velocity;
    if (path.scene().velocityOf(medium.index)) {
      co_await path.askAbout(medium, point, MediumFact::velocity);
      velocity = record.velocity();
    }
    seen.motion = motionOf(path, medium, point, path.time(), velocity);
  }
  record.see(seen);
  const auto outputs = record.plan().outputsOf(medium);
  if (outputs.empty()) co_return;
  co_await path.askAbout(medium, point, MediumFact::outputs);
  for (std::size_t i = 0; i < outputs.size(); ++i) record.addValue(outputs[i].slot, throughput * record.shown(i));
}

void seeSurface(PathContext& path, const ClosureMix& closures, const accel::SurfaceHit& hit, float distance,
                Color throughput) {
  if (path.record->hasSeen()) return;
  const bool showsMotion = path.record->plan().wants(AovFeature::visibleMotion);
  path.record->see({.weight = throughput,
                    .albedo = closures.albedo(),
                    .normal = hit.shadingNormal,
                    .distance = distance,
                    .motion = showsMotion ? motionOf(path, hit, path.time()) : std::array<float, 2>{},
                    .index = hit.object});
  const auto& outputs = path.record->plan().outputs;
  if (hit.object >= outputs.size()) return;
  for (const AovPlan::OutputSlot& output : outputs[hit.object])
    path.record->addValue(output.slot, throughput * path.surfaceAnswer().sites[output.site].weight);
}

ScatterShares::ScatterShares(const ClosureMix& closures, Vector<World> direction, bool reflects) {
  split(closures, direction, reflects);
}

ScatterShares::ScatterShares(const ClosureMix& closures, const ClosureSample& sample, bool reflects) {
  if (sample.isPassing) {
    shares_[0].event = PathEvent::straight;
    shares_[0].label = closures.labelOf(sample);
  } else if (sample.isDelta) {
    shares_[0].label = closures.labelOf(sample);
    shares_[0].event = reflects ? PathEvent::reflectSpecular : PathEvent::transmitSpecular;
  } else {
    split(closures, sample.direction, reflects);
  }
}

void ScatterShares::add(PathEvent event, std::uint32_t label, Color part) {
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    if (shares_[i].event != event || shares_[i].label != label) continue;
    shares_[i].share += part;
    return;
  }
  shares_.resize(shares_.size() + 1);
  shares_[shares_.size() - 1] = {event, part, label};
}

void ScatterShares::splitByLabel(const ClosureMix& closures, Vector<World> direction, bool reflects) {
  const PathEvent matte = reflects ? PathEvent::reflectDiffuse : PathEvent::transmitDiffuse;
  const PathEvent glossy = reflects ? PathEvent::reflectGlossy : PathEvent::transmitGlossy;
  shares_.truncate(0);
  Color all;
  for (std::size_t i = 0; i < closures.termCount(); ++i) {
    const ClosureMix::TermShare term = closures.evaluateTerm(i, direction);
    all += term.all;
    if (!isBlack(term.diffuse)) add(matte, term.label, term.diffuse);
    if (const Color rest = term.all - term.diffuse; !isBlack(rest)) add(glossy, term.label, rest);
  }
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      float& share = shares_[i].share[c];
      share = all[c] != 0 ? share / all[c] : 0;
    }
  }
}

void ScatterShares::split(const ClosureMix& closures, Vector<World> direction, bool reflects) {
  if (closures.hasLabels()) return splitByLabel(closures, direction, reflects);
  const Color all = closures.evaluate(direction), matte = closures.evaluateDiffuse(direction);
  Color diffuse;
  for (int c = 0; c < 3; ++c) diffuse[c] = all[c] != 0 ? matte[c] / all[c] : (isBlack(matte) ? 0.0f : 1.0f);
  shares_.resize(2);
  shares_[0] = {reflects ? PathEvent::reflectDiffuse : PathEvent::transmitDiffuse, diffuse};
  shares_[1] = {reflects ? PathEvent::reflectGlossy : PathEvent::transmitGlossy, Color(1) - diffuse};
  if (isBlack(shares_[1].share)) shares_.truncate(1);
  if (isBlack(diffuse)) {
    shares_[0] = shares_[1];
    shares_.truncate(1);
  }
}

}  // namespace aerosol::render
