#include "core/render/preparation/deep.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/render/medium_facts.h"

namespace aerosol::render {

namespace {

constexpr int surfaceSlices = 8;

struct DepthRange {
  double front = std::numeric_limits<double>::infinity(), back = -std::numeric_limits<double>::infinity();

  bool isEmpty() const { return !(front < back); }
  void extend(double depth) {
    front = std::fmin(front, depth);
    back = std::fmax(back, depth);
  }
};

bool isFinite(const Box<World>& box) {
  for (int i = 0; i < 3; ++i) {
    if (!(std::fabs(box.lower[i]) < 1e18f && std::fabs(box.upper[i]) < 1e18f)) return false;
  }
  return true;
}

class DepthRanges {
 public:
  explicit DepthRanges(const Preparation& state)
      : state_(state), toCamera_(state.scene->camera->toWorld(state.scene->shutter.open).inverse()) {
    const PreparedScene& scene = *state.scene;
    add(scene.geometry->bounds(), all_);
    bool isEverywhere = scene.cameraMedium != nullptr;
    for (accel::VolumeId i = 0; i < scene.geometry->volumeCount(); ++i) {
      const Box<World> box = scene.geometry->volume(i).worldBounds();
      isEverywhere = isEverywhere || (!box.isEmpty() && !isFinite(box));
      add(box, media_);
    }
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      const PreparedObject& object = scene.objects[i];
      isEverywhere = isEverywhere || object.exterior;
      const bool mayHold = object.interior || object.body || scene.nestsMedia;
      if (mayHold) add(boundsOf(i), media_);
    }
    if (isEverywhere) media_ = all_;
    const double nearest = scene.camera->nearClip();
    for (DepthRange* range : {&all_, &media_}) range->front = std::fmax(range->front, nearest);
  }

  const DepthRange& all() const { return all_; }
  const DepthRange& media() const { return media_; }

 private:
  /// When the shutter opens.
  Box<World> boundsOf(std::size_t object) const {
    const Box<World> box = state_.scene->geometry->surfaceBounds(static_cast<accel::ObjectId>(object));
    const scene::Shape& shape = state_.description.shapes[object];
    if (!shape.toWorld.motionDuring(state_.scene->shutter)) return box;
    return placed(box, state_.atOpening(shape.toWorld));
  }

  void add(const Box<World>& box, DepthRange& range) const {
    if (box.isEmpty() || !isFinite(box)) return;
    for (int corner = 0; corner < 8; ++corner) {
      const auto end = [&](int axis) { return corner >> axis & 1 ? box.upper[axis] : box.lower[axis]; };
      range.extend(static_cast<double>(toCamera_(Point<World>(end(0), end(1), end(2))).z));
    }
  }

  const Preparation& state_;
  Transform<aerosol::Camera, World> toCamera_;
  DepthRange all_, media_;
};

/// Steps in proportion to depth, without the first end: what is far away needs no fine ones.
void addGrowing(std::vector<float>& depths, double front, double back, int count) {
  for (int i = 1; i <= count; ++i)
    depths.push_back(static_cast<float>(front * std::pow(back / front, static_cast<double>(i) / count)));
}

}  // namespace

AovDeep deepLayout(const Preparation& state, int slices) {
  const DepthRanges ranges(state);
  DepthRange all = ranges.all(), media = ranges.media();
  AovDeep deep;
  // Depths in a picture change with the angle by rounding: no slice begins just where something is.
  constexpr double margin = 1e-4;
  if (all.isEmpty()) all = {1, 2};
  all = {all.front * (1 - margin), all.back * (1 + margin)};
  if (media.isEmpty()) {
    deep.depths = {static_cast<float>(all.front)};
    addGrowing(deep.depths, all.front, all.back, slices);
  } else {
    media = {media.front * (1 - margin), media.back * (1 + margin)};
    deep.depths = {static_cast<float>(std::fmin(all.front, media.front))};
    if (all.front < media.front) addGrowing(deep.depths, all.front, media.front, surfaceSlices);
    deep.depths.back() = static_cast<float>(media.front);
    for (int i = 1; i <= slices; ++i)
      deep.depths.push_back(static_cast<float>(media.front + (media.back - media.front) * i / slices));
    if (media.back < all.back) addGrowing(deep.depths, media.back, all.back, surfaceSlices);
  }
  deep.isChromatic = std::ranges::any_of(state.scene->media, [&](const volume::Medium& medium) {
    return factsOf(*state.scene, medium).isColoured != Answer::no;
  });
  return deep;
}

}  // namespace aerosol::render
