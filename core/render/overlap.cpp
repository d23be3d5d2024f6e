#include "core/render/overlap.h"

#include "core/volume/bounds/occupied.h"

namespace aerosol::render {

void partitionVolumes(PreparedScene& scene) {
  if (scene.geometry->overlapDesign() != accel::OverlapDesign::partition) return;
  std::vector<Box<World>> occupied;
  for (accel::VolumeId i = 0; i < scene.volumes.size(); ++i) {
    Box<World> box = scene.geometry->volume(i).worldBounds();
    if (const volume::BoundTree* tree = scene.volumes[i]->tree; tree && !scene.volumes[i]->constant) {
      const Box<World> content = volume::occupiedBounds(*tree);
      for (int k = 0; k < 3; ++k) {
        box.lower[k] = std::max(box.lower[k], content.lower[k]);
        box.upper[k] = std::min(box.upper[k], content.upper[k]);
      }
    }
    occupied.push_back(box);
  }
  scene.geometry->refinePartition(occupied, [&](accel::VolumeId volume, const Box<World>& box) {
    const volume::Medium& medium = *scene.volumes[volume];
    return medium.tree && !medium.constant && volume::isEmptyIn(*medium.tree, box);
  });
}

}  // namespace aerosol::render
