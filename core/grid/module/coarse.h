// Coarser levels of a grid. Internal to the module.
#pragma once

#include <openvdb/openvdb.h>

namespace aerosol::grid {

/// The grid with voxels that are 2^level times as long along each axis; their sum times their volume stays what it was.
/// Values are averaged over the 27 around each (full weighting), those outside of active voxels counting as background.
/// Grids of floats, doubles and vectors of floats in affine maps; any other comes back as it is.
openvdb::GridBase::Ptr coarsened(openvdb::GridBase::Ptr grid, int level);

}  // namespace aerosol::grid
