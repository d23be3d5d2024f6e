#include "core/grid/module/continued.h"

#include <openvdb/tools/Morphology.h>

#include <utility>
#include <vector>

namespace aerosol::grid {

openvdb::Vec3SGrid::Ptr continued(const openvdb::Vec3SGrid& source, int voxels) {
  using namespace openvdb;
  Vec3SGrid::Ptr grid = source.deepCopy();
  Vec3STree& tree = grid->tree();
  tree.voxelizeActiveTiles();
  MaskTree known(tree, false, TopologyCopy());
  for (int ring = 0; ring < voxels; ++ring) {
    tools::dilateActiveValues(tree, 1, tools::NN_FACE_EDGE_VERTEX, tools::EXPAND_TILES);
    tree::ValueAccessor<const MaskTree> wasKnown(known);
    tree::ValueAccessor<Vec3STree> values(tree);
    std::vector<std::pair<Coord, Vec3f>> added;
    for (auto i = tree.cbeginValueOn(); i; ++i) {
      const Coord at = i.getCoord();
      if (wasKnown.isValueOn(at)) continue;
      Vec3d sum(0);
      int count = 0;
      for (int n = 0; n < 27; ++n) {
        const Coord neighbour = at.offsetBy(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
        if (!wasKnown.isValueOn(neighbour)) continue;
        sum += Vec3d(values.getValue(neighbour));
        ++count;
      }
      if (count > 0) added.emplace_back(at, Vec3f(sum / count));
    }
    if (added.empty()) break;
    for (const auto& [at, value] : added) values.setValue(at, value);
    known.topologyUnion(tree);
  }
  return grid;
}

}  // namespace aerosol::grid
