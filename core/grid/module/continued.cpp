#include "core/grid/module/continued.h"

#include <openvdb/tools/Morphology.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace aerosol::grid {

namespace {

using openvdb::Coord;
using openvdb::MaskTree;
using openvdb::Vec3d;
using openvdb::Vec3f;
using openvdb::Vec3STree;

/// Ring after ring, each new voxel gets the mean of those of its 26 neighbours that were active before.
void addRings(Vec3STree& tree, int rings) {
  MaskTree known(tree, false, openvdb::TopologyCopy());
  for (int ring = 0; ring < rings; ++ring) {
    MaskTree grown(known);
    openvdb::tools::dilateActiveValues(grown, 1, openvdb::tools::NN_FACE_EDGE_VERTEX, openvdb::tools::EXPAND_TILES);
    MaskTree fresh(grown);
    fresh.topologyDifference(known);
    const openvdb::tree::ValueAccessor<const MaskTree> wasKnown(known);
    openvdb::tree::ValueAccessor<Vec3STree> values(tree);
    std::vector<std::pair<Coord, Vec3f>> added;
    for (auto i = fresh.cbeginValueOn(); i; ++i) {
      const Coord at = i.getCoord();
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
    if (added.empty()) return;
    for (const auto& [at, value] : added) values.setValue(at, value);
    known.topologyUnion(grown);
  }
}

constexpr int side = Vec3STree::LeafNodeType::DIM;

/// A voxel for each leaf: the mean of the leaf's active ones.
Vec3STree meansOfLeaves(const Vec3STree& tree) {
  Vec3STree means(Vec3f(0));
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    Vec3d sum(0);
    int count = 0;
    for (auto i = leaf->cbeginValueOn(); i; ++i, ++count) sum += Vec3d(*i);
    const Coord at = leaf->origin();
    if (count > 0) means.setValue(Coord(at.x() >> 3, at.y() >> 3, at.z() >> 3), Vec3f(sum / count));
  }
  return means;
}
static_assert(side == 1 << 3);

}  // namespace

openvdb::Vec3SGrid::Ptr continued(const openvdb::Vec3SGrid& source, int voxels) {
  openvdb::Vec3SGrid::Ptr grid = source.deepCopy();
  Vec3STree& tree = grid->tree();
  tree.voxelizeActiveTiles();
  addRings(tree, std::min(voxels, side));
  if (voxels <= side) return grid;
  // Farther away a leaf has one value, which costs no more than a voxel near by.
  Vec3STree leaves = meansOfLeaves(tree);
  addRings(leaves, (voxels - side) / side + 1);
  for (auto i = leaves.cbeginValueOn(); i; ++i) {
    const Coord at = i.getCoord(), origin(at.x() * side, at.y() * side, at.z() * side);
    if (auto* const leaf = tree.probeLeaf(origin)) {
      for (auto inactive = leaf->beginValueOff(); inactive; ++inactive) inactive.setValue(*i);
      leaf->setValuesOn();
    } else {
      tree.addTile(1, origin, *i, true);
    }
  }
  return grid;
}

}  // namespace aerosol::grid
