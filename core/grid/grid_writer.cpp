#include "core/grid/grid_writer.h"

#include "core/grid/module_access.h"

namespace aerosol::grid {

Diagnostics writeGrids(const std::string& path, std::span<const NewGrid> grids, bool asHalf) {
  if (!moduleTable()) return moduleTable().errors();
  const std::string problem = (*moduleTable())->write(path, grids, asHalf);
  Diagnostics errors;
  if (!problem.empty()) errors.error({path, 0, 0}, problem);
  return errors;
}

}  // namespace aerosol::grid
