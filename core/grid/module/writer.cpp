#include "core/grid/module/writer.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <exception>
#include <fstream>

namespace aerosol::grid {

namespace {

template <class TreeT>
openvdb::GridBase::Ptr makeGrid(const NewGrid& source) {
  using Value = typename TreeT::ValueType;
  using Leaf = typename TreeT::LeafNodeType;
  static_assert(Leaf::SIZE == 512);
  const Value background = openvdb::zeroVal<Value>();
  auto grid = openvdb::Grid<TreeT>::create(background);
  for (const VoxelBlock& block : source.blocks) {
    const openvdb::Coord origin(block.origin[0], block.origin[1], block.origin[2]);
    auto* const leaf = grid->tree().touchLeaf(origin);
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
      Value value;
      std::memcpy(&value, block.values.data() + n * (sizeof(Value) / sizeof(float)), sizeof value);
      if (value != background) leaf->setValueOn(n, value);
    }
  }
  return grid;
}

/// OpenVDB multiplies row vectors.
openvdb::math::Mat4d transposed(const std::array<double, 16>& matrix) {
  openvdb::math::Mat4d map;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) map(c, r) = matrix[static_cast<std::size_t>(4 * r + c)];
  return map;
}

void setMap(openvdb::GridBase& grid, const NewGrid& source) {
  using openvdb::math::Transform;
  if (!source.frustum) {
    grid.setTransform(Transform::createLinearTransform(transposed(source.indexToFile)));
  } else if (const auto& matrix = source.frustum->fileToIndex) {
    grid.insertMeta(projectionName, openvdb::Mat4DMetadata(transposed(*matrix)));
  } else {
    const NewFrustum& f = *source.frustum;
    const openvdb::BBoxd box({f.least[0], f.least[1], f.least[2]}, {f.greatest[0], f.greatest[1], f.greatest[2]});
    const openvdb::math::MapBase::Ptr second(new openvdb::math::AffineMap(transposed(f.secondToFile)));
    grid.setTransform(Transform::Ptr(new Transform(
        openvdb::math::MapBase::Ptr(new openvdb::math::NonlinearFrustumMap(box, f.taper, f.depth, second)))));
  }
}

}  // namespace

std::string write(const std::string& path, std::span<const NewGrid> grids, bool asHalf) {
  try {
    openvdb::initialize();
    openvdb::GridPtrVec written;
    for (const NewGrid& source : grids) {
      auto grid = source.channels == 3 ? makeGrid<openvdb::Vec3STree>(source) : makeGrid<openvdb::FloatTree>(source);
      setMap(*grid, source);
      grid->setName(source.name);
      if (source.isFog) grid->setGridClass(openvdb::GRID_FOG_VOLUME);
      grid->setSaveFloatAsHalf(asHalf);
      grid->addStatsMetadata();
      written.push_back(grid);
    }
    std::ofstream stream(path, std::ios::binary);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::Stream file(stream);
    file.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
    file.write(written);
    stream.close();
    return {};
  } catch (const std::ios_base::failure&) {
    return "cannot write the OpenVDB file: the disk is full or the folder is not there";
  } catch (const std::exception& error) {
    return std::string("cannot write the OpenVDB file: ") + error.what();
  }
}

}  // namespace aerosol::grid
