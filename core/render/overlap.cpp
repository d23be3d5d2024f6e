#include "core/render/overlap.h"

#include "core/volume/bounds/occupied.h"

namespace aerosol::render {

namespace {

/// Where the medium of a volume is empty, as far as is known; null where nothing is, or only at one time.
const volume::BoundTree* emptinessOf(const volume::Medium& medium) {
  return medium.constant || medium.motion ? nullptr : medium.tree;
}

}  // namespace

void partitionVolumes(PreparedScene& scene) {
  if (scene.geometry->overlapDesign() != accel::OverlapDesign::partition) return;
  std::vector<Box<World>> occupied;
  for (accel::VolumeId i = 0; i < scene.volumes.size(); ++i) {
    Box<World> box = scene.geometry->volume(i).worldBounds();
    if (const volume::BoundTree* tree = emptinessOf(*scene.volumes[i])) {
      const Box<World> content = volume::occupiedBounds(*tree);
      for (int k = 0; k < 3; ++k) {
        box.lower[k] = std::max(box.lower[k], content.lower[k]);
        box.upper[k] = std::min(box.upper[k], content.upper[k]);
      }
    }
    occupied.push_back(box);
  }
  scene.geometry->refinePartition(occupied, [&](accel::VolumeId volume, const Box<World>& box) {
    const volume::BoundTree* tree = emptinessOf(*scene.volumes[volume]);
    return tree && volume::isEmptyIn(*tree, box);
  });
}

}  // namespace aerosol::render
