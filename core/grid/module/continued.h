// Vector grids continued beyond their active voxels. Internal to the module.
#pragma once

#include <openvdb/openvdb.h>

namespace aerosol::grid {

/// A copy whose active voxels reach `voxels` or more further in all directions. Ring after ring, each new voxel gets
/// the mean of those of its 26 neighbours that were active before, from the eighth ring on leaf by leaf: what is
/// carried out of a cloud keeps its velocity.
openvdb::Vec3SGrid::Ptr continued(const openvdb::Vec3SGrid& source, int voxels);

}  // namespace aerosol::grid
