// A volume primitive where a voxel grid is.

#include <fmt/format.h>

#include "core/accel/convex_volume.h"
#include "core/grid/grid_file.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

/// Cells beyond the active voxels in which an interpolation of them can be seen: two for a cubic spline.
constexpr double margin = 2;

/// From [-1, 1]^3 to the box of the grid's cells in the file's space.
Matrix4 placeOfCells(const VoxelGridInfo& info) {
  Matrix4 cells = identityMatrix();
  for (std::size_t r = 0; r < 3; ++r) {
    const double lower = info.indexBounds[r] - margin, upper = info.indexBounds[3 + r] + margin;
    cells[r][r] = (upper - lower) / 2;
    cells[r][3] = (lower + upper) / 2;
  }
  Matrix4 toFile;
  for (std::size_t i = 0; i < 16; ++i) toFile[i / 4][i % 4] = info.indexToFile[i];
  return multiply(toFile, cells);
}

/// The box of the cells, whatever way the grid's map turns and shears it.
class GridVolume final : public accel::ConvexVolume {
 public:
  GridVolume(const Transform<World, Object>& toWorld, const Matrix4& cells, const Matrix4& inverseCells)
      : box_(Transform<World, Object>(multiply(toWorld.matrix(), cells),
                                      multiply(inverseCells, toWorld.inverseMatrix()))) {
    for (int r = 0; r < 3; ++r) {
      const auto i = static_cast<std::size_t>(r);
      const double half = std::fabs(cells[i][0]) + std::fabs(cells[i][1]) + std::fabs(cells[i][2]);
      bounds_.lower[r] = std::nextafter(static_cast<float>(cells[i][3] - half), -infinity);
      bounds_.upper[r] = std::nextafter(static_cast<float>(cells[i][3] + half), infinity);
    }
  }

  Box<World> worldBounds() const override { return box_.worldBounds(); }
  Box<Object> objectBounds() const override { return bounds_; }
  std::optional<accel::Interval> intersect(const Ray<World>& ray) const override { return box_.intersect(ray); }

 private:
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  accel::BoxVolume box_;
  Box<Object> bounds_;
};

Diagnostic problem(const VolumeArguments& arguments, std::string message) {
  return {Severity::error, arguments.volume.origin.location, std::move(message), {}, {}};
}

Result<std::unique_ptr<const accel::VolumeShape>> make(const VolumeArguments& arguments) {
  const std::string path = arguments.file("filename").string();
  const auto file = grid::readGrids(path);
  if (!file) return file.errors();
  const auto& name = arguments.volume.get<std::string>("grid");
  const VoxelGrid* chosen = (*file)->find(name);
  if (!chosen) {
    std::string known;
    for (const auto& each : (*file)->grids()) known += fmt::format(" '{}'", each->info().name);
    return problem(arguments, fmt::format("'{}' has no grid '{}'; it has{}", path, name, known));
  }
  const VoxelGridInfo& info = chosen->info();
  if (!info.problem.empty())
    return problem(arguments, fmt::format("grid '{}' of '{}': {}", info.name, path, info.problem));
  if (info.isEmpty) return problem(arguments, fmt::format("grid '{}' of '{}' has no active voxels", info.name, path));
  const Matrix4 cells = placeOfCells(info);
  Matrix4 inverse;
  if (!invert(cells, inverse)) return problem(arguments, fmt::format("the grid's map in '{}' has no inverse", path));
  return {std::make_unique<GridVolume>(arguments.toWorld, cells, inverse)};
}

}  // namespace

void registerVolume_grid(Registry& registry) {
  registry.add(VolumeType{
      .described = {.type = "grid",
                    .doc =
                        "the box around the active voxels of an OpenVDB grid; its shader's object space is the file's, "
                        "where texture3d reads it",
                    .parameters = {{.name = "filename",
                                    .type = scene::ValueType::string,
                                    .doc = "a .vdb file, looked up beside the scene",
                                    .required = true},
                                   {.name = "grid",
                                    .type = scene::ValueType::string,
                                    .doc = "name of the grid; empty: the first one",
                                    .defaultValue = std::string()}}},
      .place = [](const scene::Volume& volume) { return volume.toWorld; },
      .make = make});
}

}  // namespace aerosol::render
