// A volume primitive where voxel grids are.

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/accel/double3.h"
#include "core/grid/active_tree.h"
#include "core/render/registry.h"
#include "plugins/volumes/frame_files.h"
#include "plugins/volumes/frustum_volume.h"

namespace aerosol::render {

namespace {

Matrix4 indexToFile(const VoxelGridInfo& info) {
  Matrix4 m;
  for (std::size_t i = 0; i < 16; ++i) m[i / 4][i % 4] = info.indexToFile[i];
  return m;
}

/// The image of a box, by its rows' extents.
struct BoxImage {
  std::array<double, 3> lower, upper;

  BoxImage(const Matrix4& m, const std::array<double, 3>& a, const std::array<double, 3>& b) {
    for (std::size_t r = 0; r < 3; ++r) {
      lower[r] = upper[r] = m[r][3];
      for (std::size_t c = 0; c < 3; ++c) {
        lower[r] += std::min(m[r][c] * a[c], m[r][c] * b[c]);
        upper[r] += std::max(m[r][c] * a[c], m[r][c] * b[c]);
      }
    }
  }

  template <class Space>
  Box<Space> outwards() const {
    Box<Space> box;
    for (int r = 0; r < 3; ++r) {
      const auto i = static_cast<std::size_t>(r);
      box.lower[r] = std::nextafter(static_cast<float>(lower[i]), -std::numeric_limits<float>::infinity());
      box.upper[r] = std::nextafter(static_cast<float>(upper[i]), std::numeric_limits<float>::infinity());
    }
    return box;
  }
};

/// The blocks around active voxels, whatever way the grid's map turns and shears them.
class GridVolume final : public accel::VolumeShape {
 public:
  GridVolume(const Transform<World, Object>& toWorld, const Matrix4& toFile, const Matrix4& toIndex,
             grid::ActiveTree active)
      : worldToIndex_(multiply(toIndex, toWorld.inverseMatrix())), active_(std::move(active)) {
    worldBounds_ = BoxImage(multiply(toWorld.matrix(), toFile), active_.lower(), active_.upper()).outwards<World>();
    objectBounds_ = BoxImage(toFile, active_.lower(), active_.upper()).outwards<Object>();
  }

  Box<World> worldBounds() const override { return worldBounds_; }
  Box<Object> objectBounds() const override { return objectBounds_; }

  bool intersect(const Ray<World>& ray, accel::IntervalSink& intervals) const override {
    const accel::Double3 o = accel::mapPoint(worldToIndex_, accel::toDouble(ray.origin));
    const accel::Double3 d = accel::mapVector(worldToIndex_, accel::toDouble(ray.direction));
    Taker taker(intervals);
    active_.walk({o.x, o.y, o.z}, {d.x, d.y, d.z}, taker);
    return true;
  }

 private:
  class Taker final : public grid::IntervalTaker {
   public:
    explicit Taker(accel::IntervalSink& sink) : sink_(sink) {}
    void add(double t0, double t1) override { sink_.add({t0, t1}); }

   private:
    accel::IntervalSink& sink_;
  };

  Matrix4 worldToIndex_;
  grid::ActiveTree active_;
  Box<World> worldBounds_;
  Box<Object> objectBounds_;
};

/// A frame of which nothing is active: it takes no room.
class EmptyVolume final : public accel::VolumeShape {
 public:
  Box<World> worldBounds() const override { return {}; }
  Box<Object> objectBounds() const override { return {}; }
  bool intersect(const Ray<World>&, accel::IntervalSink&) const override { return true; }
};

Diagnostic problem(const VolumeArguments& arguments, std::string message) {
  return {Severity::error, arguments.volume.origin.location, std::move(message), {}, {}};
}

/// The names in a list with commas; one empty name for an empty list.
std::vector<std::string> namesIn(const std::string& list) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    std::string name = list.substr(begin, end - begin);
    name.erase(0, std::min(name.find_first_not_of(' '), name.size()));
    name.erase(name.find_last_not_of(' ') + 1);
    names.push_back(std::move(name));
    begin = end + 1;
  }
  return names;
}

/// Collects active voxels of several grids in the index space of the first, and the places that they are carried to.
class ActiveVoxels {
 public:
  explicit ActiveVoxels(const CarriedMatter& carried) : carried_(carried) {}

  /// What is wrong with the grid; empty when nothing is.
  std::string add(const VoxelGrid& grid) {
    const VoxelGridInfo& info = grid.info();
    if (!info.problem.empty()) return info.problem;
    if (!hasFirst_) frustum_ = info.frustum;
    if (info.frustum || frustum_) return addFrustum(grid);
    Matrix4 inverse;
    if (!invert(indexToFile(info), inverse)) return "its map has no inverse";
    if (!hasFirst_) {
      toFile_ = indexToFile(info);
      toIndex_ = inverse;
      hasFirst_ = true;
    }
    const Matrix4 map = multiply(toIndex_, indexToFile(info));
    const bool isSame = toFile_ == indexToFile(info);
    for (VoxelBox box : grid.activeBoxes()) {
      if (!isSame && !carry(map, box)) return "its voxels lie too far from those of the first grid";
      if (carried_.velocity && !sweep(box)) return "its velocities carry it too far";
      boxes_.push_back(box);
    }
    return {};
  }

  const std::vector<VoxelBox>& boxes() const { return boxes_; }
  /// The map of all of them, where they stand in a frustum.
  const std::optional<VoxelMap>& frustum() const { return frustum_; }
  const Matrix4& toFile() const { return toFile_; }
  const Matrix4& toIndex() const { return toIndex_; }

 private:
  std::string addFrustum(const VoxelGrid& grid) {
    if (grid.info().frustum != frustum_) return "its frustum is not that of the first grid";
    hasFirst_ = true;
    for (const VoxelBox& box : grid.activeBoxes()) boxes_.push_back(box);
    return {};
  }

  /// The voxels around the box's supports; one more, as a support of one grid's voxel is not that of the other's.
  static bool carry(const Matrix4& map, VoxelBox& box) {
    std::array<double, 3> lower{}, upper{};
    for (std::size_t r = 0; r < 3; ++r) {
      lower[r] = box.least[r] - 2.0;
      upper[r] = box.greatest[r] + 2.0;
    }
    const BoxImage image(map, lower, upper);
    for (std::size_t r = 0; r < 3; ++r) {
      if (!(std::fabs(image.lower[r]) < 1e9) || !(std::fabs(image.upper[r]) < 1e9)) return false;
      box.least[r] = static_cast<std::int32_t>(std::floor(image.lower[r]));
      box.greatest[r] = static_cast<std::int32_t>(std::ceil(image.upper[r]));
    }
    return true;
  }

  /// The voxels where the box's matter may be while the shutter is open.
  bool sweep(VoxelBox& box) const {
    std::array<double, 3> lower{}, upper{};
    for (std::size_t r = 0; r < 3; ++r) {
      lower[r] = box.least[r] - 1.0;
      upper[r] = box.greatest[r] + 1.0;
    }
    BoxImage image(toFile_, lower, upper);
    carried_.carry(image.lower, image.upper);
    const BoxImage back(toIndex_, image.lower, image.upper);
    for (std::size_t r = 0; r < 3; ++r) {
      if (!(std::fabs(back.lower[r]) < 1e9) || !(std::fabs(back.upper[r]) < 1e9)) return false;
      box.least[r] = static_cast<std::int32_t>(std::floor(back.lower[r]));
      box.greatest[r] = static_cast<std::int32_t>(std::ceil(back.upper[r]));
    }
    return true;
  }

  const CarriedMatter& carried_;
  std::vector<VoxelBox> boxes_;
  std::optional<VoxelMap> frustum_;
  Matrix4 toFile_ = identityMatrix(), toIndex_ = identityMatrix();
  bool hasFirst_ = false;
};

VoxelInterpolation interpolationOf(const std::string& word) {
  if (word == "nearest") return VoxelInterpolation::nearest;
  return word == "trilinear" ? VoxelInterpolation::trilinear : VoxelInterpolation::tricubic;
}

/// None where the names are wrong, which `make` reports.
VolumeFiles frameFilesOf(const scene::Volume& volume) {
  auto names = frameFiles(volume);
  const float frame = volume.get<float>("frame") + volume.get<float>("frame_offset");
  return names ? VolumeFiles{std::move(*names), frame - std::floor(frame)} : VolumeFiles{};
}

Result<std::unique_ptr<const accel::VolumeShape>> make(const VolumeArguments& arguments) {
  const auto files = frameFiles(arguments.volume);
  if (!files) return files.errors();
  ActiveVoxels active(arguments.carried);
  for (const std::string& path : *files) {
    std::string message;
    const VoxelFile* file = arguments.voxels(path, message);
    if (!file) return problem(arguments, message);
    for (const std::string& name : namesIn(arguments.volume.get<std::string>("grid"))) {
      const VoxelGrid* chosen = file->find(name);
      if (!chosen) {
        std::string known;
        for (const auto& each : file->grids()) known += fmt::format(" '{}'", each->info().name);
        return problem(arguments, fmt::format("'{}' has no grid '{}'; it has{}", path, name, known));
      }
      const VoxelGridInfo& info = chosen->info();
      if (const std::string reason = active.add(*chosen); !reason.empty())
        return problem(arguments, fmt::format("grid '{}' of '{}': {}", info.name, path, reason));
      if (info.nanValues + info.infiniteValues > 0) {
        arguments.warnings.warning(
            arguments.volume.origin.location,
            fmt::format("grid '{}' of '{}' holds {} values that are no number and {} infinite ones", info.name, path,
                        info.nanValues, info.infiniteValues),
            {"a medium that reads them is empty there: write the file without them"});
      }
    }
  }
  if (active.boxes().empty()) {
    const std::string& name = arguments.volume.get<std::string>("grid");
    const std::string grid = name.empty() ? std::string("the first grid") : fmt::format("grid '{}'", name);
    arguments.warnings.warning(
        arguments.volume.origin.location,
        fmt::format("{} of '{}' has no active voxels: this volume is empty", grid, files->front()),
        {"aerosol info lists the file's grids; 'grid' names another one"});
    return {std::make_unique<EmptyVolume>()};
  }
  const std::int32_t cells = arguments.volume.get<std::int32_t>("overlay_cells");
  if (active.frustum()) {
    grid::KdTree blocks(active.boxes(), interpolationOf(arguments.volume.get<std::string>("interpolation")));
    return {std::make_unique<FrustumVolume>(arguments.toWorld, *active.frustum(), std::move(blocks), cells)};
  }
  if (cells > 0) {
    arguments.warnings.warning(arguments.volume.origin.of("overlay_cells"),
                               "'overlay_cells' means nothing here: the voxels do not stand in a frustum",
                               {"remove it"});
  }
  if (arguments.makesRoomForCarried) *arguments.makesRoomForCarried = true;
  grid::ActiveTree tree(active.boxes(), interpolationOf(arguments.volume.get<std::string>("interpolation")));
  return {std::make_unique<GridVolume>(arguments.toWorld, active.toFile(), active.toIndex(), std::move(tree))};
}

std::vector<scene::ParameterSpec> parameters() {
  std::vector<scene::ParameterSpec> all = frameParameters();
  all.push_back({.name = "grid",
                 .type = scene::ValueType::string,
                 .doc = "name of the grid, or names with commas between: where any of them is; empty: the first one",
                 .defaultValue = std::string()});
  all.push_back({.name = "interpolation",
                 .type = scene::ValueType::string,
                 .doc = "the widest with which the medium reads the grid: how far beyond active voxels it is seen",
                 .defaultValue = std::string("tricubic"),
                 .choices = {"nearest", "trilinear", "tricubic"}});
  all.push_back({.name = "overlay_cells",
                 .type = scene::ValueType::integer,
                 .doc = "for voxels in a frustum: a regular grid with so many cells along its longest side stands for "
                        "their blocks; 0: the blocks themselves",
                 .defaultValue = std::int32_t{0},
                 .range = scene::Range::atLeast(0)});
  return all;
}

}  // namespace

void registerVolume_grid(Registry& registry) {
  registry.add(VolumeType{
      .described = {.type = "grid",
                    .doc = "where voxel grids of a file have active voxels; its shader's object space is the file's, "
                           "where texture3d reads it",
                    .parameters = parameters()},
      .place = [](const scene::Volume& volume) { return volume.toWorld; },
      .make = make,
      .files = frameFilesOf});
}

}  // namespace aerosol::render
