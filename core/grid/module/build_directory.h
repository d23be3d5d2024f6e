// From a NanoVDB grid to its directory. Internal to the module.
#pragma once

#include <nanovdb/NanoVDB.h>

#include <cstring>
#include <map>
#include <optional>
#include <vector>

#include "core/grid/module/directory.h"

namespace aerosol::grid {

/// The values of what is stored, in the tree's order; nothing when there is more than its tables can number: the extent
/// is more than 2^24 blocks, or values are more than 2^31.
template <class ValueT>
class DirectoryBuilder {
 public:
  using Tree = nanovdb::NanoTree<ValueT>;
  using Lower = nanovdb::NanoLower<ValueT>;
  using Leaf = nanovdb::NanoLeaf<ValueT>;
  static constexpr int channels = static_cast<int>(sizeof(ValueT) / sizeof(float));

  explicit DirectoryBuilder(const Tree& tree) : tree_(tree) {}

  std::optional<Directory> build() {
    d_.channels = channels;
    addConstant(tree_.background());
    collect();
    if (!layOut()) return {};
    findLeafRanges();
    fill();
    findTableRanges();
    return std::move(d_);
  }

 private:
  /// 128^3 voxels that are not all background: a node, or one value.
  struct Block {
    nanovdb::Coord origin;
    const Lower* node = nullptr;
    std::int32_t table = 0;
  };

  std::int32_t addConstant(const ValueT& value) {
    std::array<std::uint32_t, 3> bits{};
    std::memcpy(bits.data(), &value, sizeof value);
    const auto [place, isNew] = constantNumbers_.try_emplace(bits, static_cast<std::int32_t>(d_.constants.size()));
    if (isNew) {
      const auto* floats = reinterpret_cast<const float*>(&value);
      d_.constants.insert(d_.constants.end(), floats, floats + channels);
    }
    return place->second;
  }

  /// A table that is one constant all over.
  std::int32_t constantTable(std::int32_t constant) {
    const auto [place, isNew] = constantTables_.try_emplace(constant, tableCount_);
    if (isNew) ++tableCount_;
    return place->second;
  }

  void collect() {
    constantTable(0);
    const auto& root = tree_.root();
    for (std::uint32_t t = 0; t < root.data()->mTableSize; ++t) {
      const auto* tile = root.data()->tile(t);
      if (tile->isChild()) {
        collectUpper(*root.data()->getChild(tile), tile->origin());
      } else {
        addConstantBlocks(tile->origin(), 32, tile->value);
      }
    }
  }

  /// Nodes know their place by their active voxels; there may be none.
  template <class Upper>
  void collectUpper(const Upper& node, const nanovdb::Coord& origin) {
    for (std::uint32_t n = 0; n < Upper::SIZE; ++n) {
      nanovdb::Coord place = Upper::OffsetToLocalCoord(n);
      place <<= blockBits;
      place += origin;
      if (node.data()->isChild(n)) {
        blocks_.push_back({place, node.data()->getChild(n), tableCount_++});
      } else {
        addConstantBlocks(place, 1, node.data()->getValue(n));
      }
    }
  }

  /// A cube of `edge` blocks along each axis.
  void addConstantBlocks(const nanovdb::Coord& origin, int edge, const ValueT& value) {
    // What nearly all of them are: empty.
    if (std::memcmp(&value, &tree_.background(), sizeof value) == 0) return;
    const std::int32_t constant = addConstant(value);
    if (constant == 0) return;
    const std::int32_t table = constantTable(constant);
    for (int x = 0; x < edge; ++x)
      for (int y = 0; y < edge; ++y)
        for (int z = 0; z < edge; ++z)
          blocks_.push_back({origin.offsetBy(x << blockBits, y << blockBits, z << blockBits), nullptr, table});
  }

  /// Extent, tables and numbers; false when they do not fit.
  bool layOut() {
    std::int32_t last[3] = {};
    for (unsigned r = 0; r < 3; ++r) {
      std::int32_t least = blocks_.empty() ? 0 : blocks_[0].origin[r], greatest = least;
      for (const Block& block : blocks_) {
        least = std::min(least, block.origin[r]);
        greatest = std::max(greatest, block.origin[r]);
      }
      // Numbers of voxels within 2^30, and far points outside of it: see `locate`.
      if (least < -(1 << 30) + 256 || greatest > (1 << 30) - 256) return false;
      d_.origin[r] = least - (1 << blockBits);
      last[r] = greatest + (1 << blockBits);
      d_.size[r] = ((last[r] - d_.origin[r]) >> blockBits) + 1;
    }
    constexpr double largest = 1 << 24;
    if (double(d_.size[0]) * d_.size[1] * d_.size[2] > largest) return false;
    const std::int64_t leafCount = tree_.nodeCount(0);
    static_assert(sizeof(Leaf) % sizeof(float) == 0);
    d_.leafStride = static_cast<std::int32_t>(sizeof(Leaf) / sizeof(float));
    if ((leafCount + 1) * d_.leafStride > INT32_MAX || std::int64_t{tableCount_} * tableSize > INT32_MAX) return false;
    if (leafCount > 0) {
      firstLeaf_ = tree_.template getFirstNode<0>();
      d_.values = reinterpret_cast<const float*>(firstLeaf_->data()->mValues);
    } else {
      d_.values = d_.constants.data();
    }
    return true;
  }

  void fill() {
    d_.blocks.assign(static_cast<std::size_t>(d_.size[0]) * static_cast<std::size_t>(d_.size[1]) *
                         static_cast<std::size_t>(d_.size[2]),
                     0);
    d_.entries.resize(static_cast<std::size_t>(tableCount_) * tableSize);
    for (const auto& [constant, table] : constantTables_)
      std::fill_n(d_.entries.begin() + std::ptrdiff_t{table} * tableSize, tableSize, ~constant);
    for (const Block& block : blocks_) {
      std::int32_t at[3];
      for (unsigned r = 0; r < 3; ++r) at[r] = (block.origin[r] - d_.origin[r]) >> blockBits;
      d_.blocks[static_cast<std::size_t>(at[0] + d_.size[0] * (at[1] + d_.size[1] * at[2]))] = block.table;
      if (block.node) fillTable(block);
    }
    if (d_.values == nullptr || !firstLeaf_) d_.values = d_.constants.data();
  }

  void fillTable(const Block& block) {
    std::int32_t* entry = d_.entries.data() + std::ptrdiff_t{block.table} * tableSize;
    for (std::uint32_t n = 0; n < tableSize; ++n, ++entry) {
      if (block.node->data()->isChild(n)) {
        *entry = static_cast<std::int32_t>(block.node->data()->getChild(n) - firstLeaf_) * d_.leafStride;
      } else {
        *entry = ~addConstant(block.node->data()->getValue(n));
      }
    }
  }

  static void addValues(const float* values, std::size_t count, ChannelRanges& ranges) {
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t c = 0; c < channels; ++c) ranges[c].add(values[i * channels + c]);
  }

  void findLeafRanges() {
    d_.leafRanges.resize(tree_.nodeCount(0));
    for (std::size_t i = 0; i < d_.leafRanges.size(); ++i)
      addValues(d_.values + i * static_cast<std::size_t>(d_.leafStride), Leaf::SIZE, d_.leafRanges[i]);
  }

  void findTableRanges() {
    d_.tableRanges.resize(static_cast<std::size_t>(tableCount_));
    addValues(d_.constants.data(), 1, d_.total);
    for (std::size_t t = 0; t < d_.tableRanges.size(); ++t) {
      ChannelRanges& ranges = d_.tableRanges[t];
      for (std::size_t n = 0; n < tableSize; ++n) {
        const std::int32_t entry = d_.entries[t * tableSize + n];
        if (entry < 0) {
          addValues(d_.constant(entry), 1, ranges);
        } else {
          for (std::size_t c = 0; c < 3; ++c)
            ranges[c].add(d_.leafRanges[static_cast<std::size_t>(entry / d_.leafStride)][c]);
        }
      }
      for (std::size_t c = 0; c < 3; ++c) d_.total[c].add(ranges[c]);
    }
  }

  const Tree& tree_;
  const Leaf* firstLeaf_ = nullptr;
  std::vector<Block> blocks_;
  std::map<std::array<std::uint32_t, 3>, std::int32_t> constantNumbers_;  ///< By bits; place in `constants`.
  std::map<std::int32_t, std::int32_t> constantTables_;                   ///< By constant.
  std::int32_t tableCount_ = 0;
  Directory d_;
};

}  // namespace aerosol::grid
