#include <nanovdb/NanoVDB.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/util/logging.h>

#include <exception>
#include <fstream>
#include <vector>

#include "core/grid/module/coarse.h"
#include "core/grid/module/continued.h"
#include "core/grid/module/dense_file.h"
#include "core/grid/module/nano_grid.h"
#include "core/grid/module/table.h"
#include "core/grid/module/vdb_check.h"
#include "core/grid/module/writer.h"

namespace aerosol::grid {

namespace {

class File final : public VoxelFile {
 public:
  explicit File(std::vector<std::unique_ptr<VoxelGrid>> grids) : grids_(std::move(grids)) {}
  std::span<const std::unique_ptr<VoxelGrid>> grids() const override { return grids_; }

 private:
  std::vector<std::unique_ptr<VoxelGrid>> grids_;
};

/// The grid itself, or the longer one that is asked for.
openvdb::GridBase::Ptr gridOrLonger(openvdb::GridBase::Ptr grid, const VoxelFileName& name) {
  if (name.continuedVoxels > 0 && grid->getName() == name.continuedGrid && grid->isType<openvdb::Vec3SGrid>())
    return continued(static_cast<const openvdb::Vec3SGrid&>(*grid), name.continuedVoxels);
  return grid;
}

/// Lays the box of the active voxels into the unit cube.
openvdb::GridBase::Ptr inUnitCube(openvdb::GridBase::Ptr grid) {
  const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
  if (box.empty()) return grid;
  const openvdb::Vec3d size = box.extents().asVec3d();
  openvdb::Mat4d toUnit = openvdb::Mat4d::identity();
  toUnit.setToTranslation(openvdb::Vec3d(0.5) - box.min().asVec3d());
  toUnit.postScale(openvdb::Vec3d(1) / size);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(toUnit));
  return grid;
}

/// What the file's name asks of each of its grids.
std::unique_ptr<VoxelGrid> makeAsNamed(openvdb::GridBase::Ptr grid, const VoxelFileName& name) {
  grid = gridOrLonger(std::move(grid), name);
  if (name.isUnit) grid = inUnitCube(std::move(grid));
  return makeGrid(*coarsened(std::move(grid), name.level));
}

std::unique_ptr<const VoxelFile> read(const VoxelFileName& name, std::string& message) {
  try {
    openvdb::initialize();
    openvdb::logging::setLevel(openvdb::logging::Level::Fatal);
    // OpenVDB does not look whether its reads succeed: the stream does.
    std::ifstream stream(name.path, std::ios::binary);
    stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    std::vector<std::unique_ptr<VoxelGrid>> grids;
    if (isDenseFile(stream)) {
      grids.push_back(makeAsNamed(readDenseFile(stream), name));
    } else {
      checkVdb(stream);
      openvdb::io::Stream file(stream, false);
      const auto all = file.getGrids();
      for (const auto& grid : *all) grids.push_back(makeAsNamed(grid, name));
    }
    if (grids.empty()) {
      message = "the file has no grids";
      return nullptr;
    }
    return std::make_unique<const File>(std::move(grids));
  } catch (const std::ios_base::failure&) {
    message = "cannot read the voxel file: it ends too early or cannot be opened";
  } catch (const std::exception& error) {
    message = std::string("cannot read the voxel file: ") + error.what();
  }
  return nullptr;
}

std::vector<std::string> versions() {
  return {std::string("OpenVDB ") + openvdb::getLibraryVersionString(),
          "NanoVDB " + std::to_string(NANOVDB_MAJOR_VERSION_NUMBER) + "." +
              std::to_string(NANOVDB_MINOR_VERSION_NUMBER) + "." + std::to_string(NANOVDB_PATCH_VERSION_NUMBER)};
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const ModuleTable* aerosolGridModule() {
  static constexpr ModuleTable table{read, versions, write};
  return &table;
}

}  // namespace aerosol::grid
