#include "core/grid/module/coarse.h"

#include <openvdb/tools/MultiResGrid.h>

#include <algorithm>

namespace aerosol::grid {

namespace {

template <class Grid>
openvdb::GridBase::Ptr coarsenedAs(const Grid& grid, int level) {
  openvdb::tools::MultiResGrid<typename Grid::TreeType> levels(static_cast<std::size_t>(level) + 1, grid);
  const auto coarse = levels.grid(static_cast<std::size_t>(level));
  const typename openvdb::GridBase::Ptr result = coarse;
  result->setName(grid.getName());
  result->setGridClass(grid.getGridClass());
  result->setSaveFloatAsHalf(grid.saveFloatAsHalf());
  return result;
}

}  // namespace

openvdb::GridBase::Ptr coarsened(openvdb::GridBase::Ptr grid, int level) {
  if (level <= 0 || !grid->transform().isLinear() || grid->empty()) return grid;
  if (grid->isType<openvdb::FloatGrid>()) return coarsenedAs(static_cast<const openvdb::FloatGrid&>(*grid), level);
  if (grid->isType<openvdb::DoubleGrid>()) return coarsenedAs(static_cast<const openvdb::DoubleGrid&>(*grid), level);
  if (grid->isType<openvdb::Vec3SGrid>()) return coarsenedAs(static_cast<const openvdb::Vec3SGrid&>(*grid), level);
  return grid;
}

}  // namespace aerosol::grid
