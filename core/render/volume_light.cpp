#include "core/render/volume_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aerosol::render {

using volume::BoundNode;
using volume::BoundTree;
using volume::LeafKind;

std::unique_ptr<const VolumeLight> VolumeLight::make(const BoundTree& tree) {
  auto light = std::unique_ptr<VolumeLight>(new VolumeLight(tree));
  if (!light->gather()) return nullptr;
  return light;
}

std::unique_ptr<const VolumeLight> VolumeLight::make(const Box<Object>& domain, const Transform<World, Object>& toWorld,
                                                     Color emission) {
  const float most = maximum(emission);
  if (!(most > 0) || !std::isfinite(most)) return nullptr;
  auto tree = std::make_unique<BoundTree>();
  tree->domain = domain;
  tree->objectToWorld = toWorld;
  BoundNode node;
  node.link = BoundNode::makeLink(LeafKind::bounded, volume::Provenance::proven, 0);
  tree->nodes.assign(BoundTree::parts, node);
  tree->ranges.assign(BoundTree::parts, {.emissionLow = most, .emissionHigh = most});
  tree->outside.link = BoundNode::makeLink(LeafKind::empty, volume::Provenance::proven, 0);
  auto light = std::unique_ptr<VolumeLight>(new VolumeLight(*tree));
  light->own_ = std::move(tree);
  if (!light->gather()) return nullptr;
  return light;
}

bool VolumeLight::gather() {
  const Matrix4& m = tree_->objectToWorld.matrix();
  volume_ =
      std::fabs(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
  if (tree_->ranges.size() != tree_->nodes.size()) return false;
  gather(0, {0, 0, 0}, BoundTree::levelBits * (tree_->levels - 1));
  total_ = parts_.empty() ? 0 : parts_.back().cumulative;
  if (!isBounded_ || !(total_ > 0) || !std::isfinite(total_)) return false;
  Box<World> box;
  for (const Part& part : parts_) {
    for (int corner = 0; corner < 8; ++corner) {
      box.extend(tree_->objectToWorld(Point<Object>(part.lower.x + (corner & 1 ? part.size.x : 0),
                                                    part.lower.y + (corner & 2 ? part.size.y : 0),
                                                    part.lower.z + (corner & 4 ? part.size.z : 0))));
    }
  }
  const Vector<World> half = (box.upper - box.lower) * 0.5f;
  centre_ = box.lower + half;
  extent_ = length(half);
  return std::isfinite(extent_);
}

void VolumeLight::gather(std::uint32_t first, std::array<std::int32_t, 3> cell, int shift) {
  const Vector<Object> side =
      (tree_->domain.upper - tree_->domain.lower) * (1 / static_cast<float>(tree_->cellsPerSide()));
  for (std::uint32_t i = 0; i < BoundTree::parts; ++i) {
    const std::array<std::int32_t, 3> at{cell[0] + static_cast<std::int32_t>((i & 3u) << shift),
                                         cell[1] + static_cast<std::int32_t>((i >> 2 & 3u) << shift),
                                         cell[2] + static_cast<std::int32_t>((i >> 4 & 3u) << shift)};
    const BoundNode& node = tree_->nodes[first + i];
    if (node.kind() == LeafKind::inner) {
      gather(node.index(), at, shift - BoundTree::levelBits);
      continue;
    }
    const float most = tree_->ranges[first + i].emissionHigh;
    if (node.kind() == LeafKind::empty || !(most > 0)) continue;
    isBounded_ = isBounded_ && std::isfinite(most);
    const auto cells = static_cast<float>(1 << shift);
    Part part{.lower = tree_->domain.lower + Vector<Object>(side.x * static_cast<float>(at[0]),
                                                            side.y * static_cast<float>(at[1]),
                                                            side.z * static_cast<float>(at[2])),
              .size = side * cells};
    const double before = parts_.empty() ? 0 : parts_.back().cumulative;
    part.cumulative = before + static_cast<double>(most) * volume_ * static_cast<double>(part.size.x) *
                                   static_cast<double>(part.size.y) * static_cast<double>(part.size.z);
    parts_.push_back(part);
  }
}

std::optional<LightSample> VolumeLight::sample(Point<World> from, const LightUniforms& u) const {
  const double mass = static_cast<double>(u.choice) * total_;
  const auto found = std::upper_bound(parts_.begin(), parts_.end(), mass,
                                      [](double m, const Part& part) { return m < part.cumulative; });
  const auto part = found == parts_.end() ? parts_.end() - 1 : found;
  const double before = part == parts_.begin() ? 0 : (part - 1)->cumulative;
  const auto rest = static_cast<float>(std::clamp((mass - before) / (part->cumulative - before), 0.0, 1.0));
  const Point<World> point =
      tree_->objectToWorld(Point<Object>(part->lower.x + rest * part->size.x, part->lower.y + u.place[0] * part->size.y,
                                         part->lower.z + u.place[1] * part->size.z));
  const Vector<World> way = point - from;
  const float distance = length(way);
  if (!(distance > 0)) return {};
  LightSample sample{.direction = way / distance, .distance = distance, .point = point, .normal = {}};
  sample.pdf = pdfEscaped(from, sample.direction);
  if (!(sample.pdf > 0) || !std::isfinite(sample.pdf)) return {};
  return sample;
}

float VolumeLight::pdfEscaped(Point<World> from, Vector<World> direction) const {
  Ray<World> ray;
  ray.origin = from;
  ray.direction = direction;
  volume::BoundWalk walk(medium_, ray, 0);
  double sum = 0, t = 0;
  for (;; walk.next()) {
    const double end = walk.end();
    if (!std::isfinite(end)) break;
    if (const volume::BoundRanges* ranges = walk.ranges(); ranges && ranges->emissionHigh > 0) {
      sum += static_cast<double>(ranges->emissionHigh) * (end * end * end - t * t * t) / 3;
    }
    t = end;
  }
  return static_cast<float>(sum / total_);
}

Color VolumeLight::power(float) const { return Color(static_cast<float>(4 * std::numbers::pi * total_)); }

float VolumeLight::importance(Point<World> at) const {
  const float away = squaredLength(centre_ - at);
  return static_cast<float>(total_) / std::max(away, extent_ * extent_);
}

}  // namespace aerosol::render
