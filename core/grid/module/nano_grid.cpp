#include "core/grid/module/nano_grid.h"

#include <nanovdb/util/OpenToNanoVDB.h>

#include <algorithm>
#include <cmath>

#include "core/grid/module/build_directory.h"
#include "core/grid/module/lookup.h"
#include "core/grid/module/range_query.h"
#include "core/grid/module/scalar_lookup.h"
#include "core/grid/module/writer.h"

namespace aerosol::grid {

namespace {

/// What can be said of any grid.
VoxelGridInfo describe(const openvdb::GridBase& grid) {
  VoxelGridInfo info;
  info.name = grid.getName();
  info.type = grid.saveFloatAsHalf() && grid.valueType() == "float" ? "half" : grid.valueType();
  info.purpose = openvdb::GridBase::gridClassToMenuName(grid.getGridClass());
  std::ranges::transform(info.purpose, info.purpose.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (info.purpose == "other") info.purpose = "unknown";
  info.activeVoxels = grid.activeVoxelCount();
  info.memoryBytes = grid.memUsage();
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  info.isEmpty = info.activeVoxels == 0;
  if (!info.isEmpty) {
    for (std::size_t r = 0; r < 3; ++r) {
      info.indexBounds[r] = box.min()[r];
      info.indexBounds[3 + r] = box.max()[r];
    }
    const openvdb::BBoxd cells(box.min().asVec3d() - 0.5, box.max().asVec3d() + 0.5);
    const openvdb::BBoxd bounds = grid.transform().indexToWorld(cells);
    for (std::size_t r = 0; r < 3; ++r) {
      info.bounds[r] = bounds.min()[static_cast<int>(r)];
      info.bounds[3 + r] = bounds.max()[static_cast<int>(r)];
    }
  }
  const openvdb::Vec3d voxel = grid.transform().voxelSize();
  for (std::size_t r = 0; r < 3; ++r) info.voxelSize[r] = voxel[static_cast<int>(r)];
  return info;
}

/// OpenVDB multiplies row vectors.
std::array<double, 16> columnVectorMap(const openvdb::math::Mat4d& map) {
  std::array<double, 16> result{};
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) result[static_cast<std::size_t>(4 * r + c)] = map(c, r);
  return result;
}

Matrix4 matrixOf(const openvdb::math::Mat4d& map) {
  Matrix4 m;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) m[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = map(c, r);
  return m;
}

/// The map of voxels that stand in a frustum; nothing of others. What is wrong with it goes to `problem`.
std::optional<VoxelMap> frustumOf(const openvdb::GridBase& grid, std::string& problem) {
  std::optional<VoxelMap> map;
  if (const auto projection = grid.getMetadata<openvdb::Mat4DMetadata>(projectionName)) {
    map = VoxelMap::projective(matrixOf(projection->value()));
  } else if (const auto frustum = grid.transform().constMap<openvdb::math::NonlinearFrustumMap>()) {
    const openvdb::BBoxd& box = frustum->getBBox();
    const openvdb::math::Mat4d second = frustum->secondMap().getMat4();
    const bool isSound = frustum->getTaper() > 0 && frustum->getDepth() > 0 && second.det() != 0 &&
                         (box.extents().x() > 0) && (box.extents().z() > 0);
    if (!isSound) {
      problem = "its frustum has no volume";
      return {};
    }
    const auto triple = [](const openvdb::Vec3d& v) { return VoxelMap::Triple{v.x(), v.y(), v.z()}; };
    map = VoxelMap::linearDepth(triple(box.min()), triple(box.max()), frustum->getTaper(), frustum->getDepth(),
                                matrixOf(second.inverse()));
  }
  if (!map) return {};
  for (const auto* forms : {&map->numerator, &map->denominator}) {
    for (const VoxelMap::Form& form : *forms) {
      if (!std::ranges::all_of(form, [](double x) { return std::isfinite(x); })) problem = "its frustum is not finite";
    }
  }
  return problem.empty() ? map : std::nullopt;
}

/// The size of a voxel in the middle; and where the map of the grid itself does not tell, the bounds of the active
/// voxels as cells.
void describeFrustum(VoxelGridInfo& info, bool hasBounds) {
  VoxelMap::Triple least, greatest, lower, upper, middle;
  for (std::size_t r = 0; r < 3; ++r) {
    least[r] = info.indexBounds[r] - 0.5;
    greatest[r] = info.indexBounds[3 + r] + 0.5;
    middle[r] = 0.5 * (least[r] + greatest[r]);
  }
  if (!hasBounds) {
    info.frustum->fileBox(least, greatest, lower, upper);
    std::ranges::copy(lower, info.bounds.begin());
    std::ranges::copy(upper, info.bounds.begin() + 3);
  }
  const auto centre = info.frustum->toFile(middle);
  for (std::size_t r = 0; r < 3 && centre; ++r) {
    VoxelMap::Triple next = middle;
    next[r] += 1;
    const auto place = info.frustum->toFile(next);
    if (place)
      info.voxelSize[r] =
          std::hypot((*place)[0] - (*centre)[0], (*place)[1] - (*centre)[1], (*place)[2] - (*centre)[2]);
  }
}

/// A grid of which nothing but its description is known.
class DescribedGrid final : public VoxelGrid {
 public:
  explicit DescribedGrid(VoxelGridInfo info) : info_(std::move(info)) {}
  const VoxelGridInfo& info() const override { return info_; }
  void sample(VoxelInterpolation, std::size_t, const float*, const float*, const float*, float*) const override {}
  VoxelRange range(VoxelInterpolation, const std::array<double, 3>&, const std::array<double, 3>&, int) const override {
    return {};
  }
  std::vector<VoxelBox> activeBoxes() const override { return {}; }

 private:
  VoxelGridInfo info_;
};

template <class ValueT>
class NanoGrid final : public VoxelGrid {
 public:
  static constexpr std::size_t channels = sizeof(ValueT) / sizeof(float);
  using Tree = nanovdb::NanoTree<ValueT>;

  NanoGrid(VoxelGridInfo info, nanovdb::GridHandle<> handle, const VoxelMap& map, bool isPadded)
      : info_(std::move(info)), handle_(std::move(handle)), grid_(handle_.grid<ValueT>()), isPadded_(isPadded) {
    for (std::size_t r = 0; r < 3; ++r) {
      std::ranges::copy(map.numerator[r], fileToIndex_ + 4 * r);
      std::ranges::copy(map.denominator[r], divisors_ + 4 * r);
    }
    directory_ = DirectoryBuilder<ValueT>(grid_->tree()).build();
    info_.channels = channels;
    std::memcpy(info_.background.data(), &grid_->tree().background(), sizeof(ValueT));
    countValues();
    info_.memoryBytes = handle_.size();
    if (directory_) {
      info_.memoryBytes += (directory_->entries.size() + directory_->blocks.size()) * sizeof(std::int32_t) +
                           (directory_->leafRanges.size() + directory_->tableRanges.size()) * sizeof(ChannelRanges);
    }
  }

  const VoxelGridInfo& info() const override { return info_; }

  void sample(VoxelInterpolation interpolation, std::size_t count, const float* x, const float* y, const float* z,
              float* results) const override {
    const LookupPoints points{.fileToIndex = fileToIndex_,
                              .divisors = info_.frustum ? divisors_ : nullptr,
                              .count = count,
                              .x = x,
                              .y = y,
                              .z = z,
                              .results = results};
    if (directory_) {
      lookUp(interpolation, *directory_, points);
    } else {
      ScalarLookup<ValueT>(*grid_).lookUp(interpolation, points);
    }
  }

  VoxelRange range(VoxelInterpolation interpolation, const std::array<double, 3>& lower,
                   const std::array<double, 3>& upper, int channel) const override {
    if (directory_ && info_.frustum)
      return findRange(*directory_, *info_.frustum, interpolation, lower, upper, channel);
    if (directory_) return findRange(*directory_, fileToIndex_, interpolation, lower, upper, channel);
    return widened(total_[static_cast<std::size_t>(channel)], interpolation);
  }

  std::vector<VoxelBox> activeBoxes() const override {
    std::vector<VoxelBox> boxes;
    const Tree& tree = grid_->tree();
    const auto* root = tree.root().data();
    for (std::uint32_t t = 0; t < root->mTableSize; ++t) {
      const auto* tile = root->tile(t);
      if (!tile->isChild() && tile->isActive()) addCube(tile->origin(), 4096, boxes);
    }
    for (std::uint32_t i = 0; i < tree.nodeCount(2); ++i) addActiveTiles(tree.template getFirstNode<2>()[i], boxes);
    for (std::uint32_t i = 0; i < tree.nodeCount(1); ++i) addActiveTiles(tree.template getFirstNode<1>()[i], boxes);
    for (std::uint32_t i = 0; i < tree.nodeCount(0); ++i) addLeaf(tree.template getFirstNode<0>()[i], boxes);
    return boxes;
  }

 private:
  static void addCube(const nanovdb::Coord& origin, std::int32_t edge, std::vector<VoxelBox>& boxes) {
    VoxelBox& box = boxes.emplace_back();
    for (std::size_t r = 0; r < 3; ++r) {
      box.least[r] = origin[static_cast<unsigned>(r)];
      box.greatest[r] = box.least[r] + edge - 1;
    }
  }

  template <class Node>
  static void addActiveTiles(const Node& node, std::vector<VoxelBox>& boxes) {
    for (std::uint32_t n = 0; n < Node::SIZE; ++n) {
      if (!node.data()->isChild(n) && node.data()->isActive(n))
        addCube(node.offsetToGlobalCoord(n), Node::ChildNodeType::DIM, boxes);
    }
  }

  template <class Leaf>
  static void addLeaf(const Leaf& leaf, std::vector<VoxelBox>& boxes) {
    VoxelBox box;
    bool isEmpty = true;
    for (std::uint32_t n = 0; n < Leaf::SIZE; ++n) {
      if (!leaf.data()->mValueMask.isOn(n)) continue;
      const nanovdb::Coord at = leaf.offsetToGlobalCoord(n);
      for (std::size_t r = 0; r < 3; ++r) {
        const std::int32_t place = at[static_cast<unsigned>(r)];
        box.least[r] = isEmpty ? place : std::min(box.least[r], place);
        box.greatest[r] = isEmpty ? place : std::max(box.greatest[r], place);
      }
      isEmpty = false;
    }
    if (!isEmpty) boxes.push_back(box);
  }

  /// One stored value that stands for `count` voxels.
  void addValue(const ValueT& value, bool isActive, std::uint64_t count) {
    float floats[channels];
    std::memcpy(floats, &value, sizeof value);
    for (std::size_t c = 0; c < channels; ++c) {
      total_[c].add(floats[c]);
      const std::uint64_t counted = isActive || !isPadded_ ? count : 0;
      if (std::isnan(floats[c])) {
        info_.nanValues += counted;
      } else if (std::isinf(floats[c])) {
        info_.infiniteValues += counted;
      } else if (isActive) {
        active_[c].add(floats[c]);
      }
    }
  }

  template <class Node>
  void addTiles(const Node& node) {
    const std::uint64_t voxels = std::uint64_t{1} << (3 * Node::ChildNodeType::TOTAL);
    for (std::uint32_t n = 0; n < Node::SIZE; ++n) {
      if (!node.data()->isChild(n)) addValue(node.data()->getValue(n), node.data()->isActive(n), voxels);
    }
  }

  void countValues() {
    const Tree& tree = grid_->tree();
    const auto* root = tree.root().data();
    addValue(tree.background(), false, 1);
    for (std::uint32_t t = 0; t < root->mTableSize; ++t) {
      if (!root->tile(t)->isChild()) addValue(root->tile(t)->value, root->tile(t)->isActive(), std::uint64_t{1} << 36);
    }
    for (std::uint32_t i = 0; i < tree.nodeCount(2); ++i) addTiles(tree.template getFirstNode<2>()[i]);
    for (std::uint32_t i = 0; i < tree.nodeCount(1); ++i) addTiles(tree.template getFirstNode<1>()[i]);
    for (std::uint32_t i = 0; i < tree.nodeCount(0); ++i) {
      const auto& leaf = tree.template getFirstNode<0>()[i];
      for (std::uint32_t n = 0; n < 512; ++n) addValue(leaf.data()->mValues[n], leaf.data()->mValueMask.isOn(n), 1);
    }
    for (std::size_t c = 0; c < channels; ++c) {
      const bool none = active_[c].least > active_[c].greatest;
      info_.least[c] = none ? 0 : active_[c].least;
      info_.greatest[c] = none ? 0 : active_[c].greatest;
    }
  }

  VoxelGridInfo info_;
  nanovdb::GridHandle<> handle_;
  const nanovdb::NanoGrid<ValueT>* grid_;
  bool isPadded_;
  double fileToIndex_[12] = {}, divisors_[12] = {};
  std::optional<Directory> directory_;
  ChannelRanges active_, total_;
};

template <class NanoT, class TreeT>
std::unique_ptr<VoxelGrid> convert(const openvdb::Grid<TreeT>& grid, VoxelGridInfo info) {
  using nanovdb::ChecksumMode;
  using nanovdb::StatsMode;
  VoxelMap map;
  openvdb::GridBase::ConstPtr source = grid.copyGrid();
  if (info.frustum) {
    // NanoVDB has no such map: lookups go by ours.
    map = *info.frustum;
    source = grid.copyGridReplacingTransform(openvdb::math::Transform::createLinearTransform());
  } else {
    const auto affine = grid.transform().baseMap()->getAffineMap()->getMat4();
    info.indexToFile = columnVectorMap(affine);
    map = VoxelMap::affine(matrixOf(affine.inverse()));
  }
  auto handle = nanovdb::openToNanoVDB<nanovdb::HostBuffer, TreeT, NanoT>(
      static_cast<const openvdb::Grid<TreeT>&>(*source), StatsMode::All, ChecksumMode::Disable);
  const bool isPadded = bool(grid.template getMetadata<openvdb::BoolMetadata>(paddedName));
  return std::make_unique<NanoGrid<NanoT>>(std::move(info), std::move(handle), map, isPadded);
}

/// A grid of another type of value, value by value to float (or three floats).
template <class TargetTree, class SourceTree>
typename openvdb::Grid<TargetTree>::Ptr withFloats(const openvdb::Grid<SourceTree>& source) {
  using Target = typename TargetTree::ValueType;
  const auto background = source.background();
  auto grid = openvdb::Grid<TargetTree>::create(Target(background));
  grid->setTransform(source.transform().copy());
  grid->setGridClass(source.getGridClass());
  auto accessor = grid->getAccessor();
  for (auto i = source.cbeginValueAll(); i; ++i) {
    if (!i.isValueOn() && *i == background) continue;
    if (i.isVoxelValue()) {
      accessor.setValue(i.getCoord(), Target(*i));
      if (!i.isValueOn()) accessor.setActiveState(i.getCoord(), false);
    } else {
      accessor.addTile(i.getLevel(), i.getCoord(), Target(*i), i.isValueOn());
    }
  }
  return grid;
}

template <class GridT>
const GridT* as(const openvdb::GridBase& grid) {
  return grid.isType<GridT>() ? &static_cast<const GridT&>(grid) : nullptr;
}

}  // namespace

std::unique_ptr<VoxelGrid> makeGrid(const openvdb::GridBase& grid) {
  VoxelGridInfo info = describe(grid);
  info.frustum = frustumOf(grid, info.problem);
  if (info.frustum && !info.isEmpty) describeFrustum(info, !grid.getMetadata<openvdb::Mat4DMetadata>(projectionName));
  if (info.problem.empty() && !info.frustum && !grid.transform().isLinear())
    info.problem = "its map is neither affine nor a frustum";
  if (!info.problem.empty()) return std::make_unique<DescribedGrid>(std::move(info));
  const double determinant = info.frustum ? 1 : grid.transform().baseMap()->determinant();
  if (determinant == 0 || !std::isfinite(determinant)) {
    info.problem = "its map has no inverse";
    return std::make_unique<DescribedGrid>(std::move(info));
  }
  using namespace openvdb;
  if (const auto* g = as<FloatGrid>(grid)) return convert<float>(*g, std::move(info));
  if (const auto* g = as<DoubleGrid>(grid)) return convert<float>(*withFloats<FloatTree>(*g), std::move(info));
  if (const auto* g = as<Int32Grid>(grid)) return convert<float>(*withFloats<FloatTree>(*g), std::move(info));
  if (const auto* g = as<Int64Grid>(grid)) return convert<float>(*withFloats<FloatTree>(*g), std::move(info));
  if (const auto* g = as<Vec3SGrid>(grid)) return convert<nanovdb::Vec3f>(*g, std::move(info));
  if (const auto* g = as<Vec3DGrid>(grid)) return convert<nanovdb::Vec3f>(*withFloats<Vec3STree>(*g), std::move(info));
  info.problem = "values of type '" + grid.valueType() + "' cannot be looked up";
  return std::make_unique<DescribedGrid>(std::move(info));
}

}  // namespace aerosol::grid
