// Samples of one pixel, added so that no order of rendering or merging changes a bit of the sum.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace aerosol::render {

/// Samples first ≤ i < end.
struct IndexRange {
  std::uint64_t first = 0, end = 0;
  friend bool operator==(const IndexRange&, const IndexRange&) = default;
};

inline constexpr std::uint32_t sampleBlockSize = 64;

/// A complete subtree of 2^level blocks, or the first `prefix` samples of a block (then level is 0).
template <class Sums>
struct SampleNode {
  Sums sums;
  std::uint32_t block = 0;
  std::uint16_t level = 0;
  std::uint16_t prefix = 0;  ///< 0: complete.

  bool isComplete() const { return prefix == 0; }
  bool covers(std::uint32_t b) const { return (b >> level) == (block >> level); }
  IndexRange range() const {
    const std::uint64_t first = std::uint64_t{block} * sampleBlockSize;
    return {first, first + (isComplete() ? std::uint64_t{sampleBlockSize} << level : prefix)};
  }
  friend bool operator==(const SampleNode&, const SampleNode&) = default;
};

template <class Sample>
struct OpenSampleOf {
  std::uint32_t index = 0;
  Sample sample;
};

/// Everything that is kept, to be written to a file and read back.
template <class Sums, class Sample>
struct SampleTreeContent {
  std::vector<SampleNode<Sums>> nodes;     ///< Ascending.
  std::vector<OpenSampleOf<Sample>> open;  ///< Ascending.
  std::uint32_t dropped = 0;
};

/// Any set of samples of one pixel. Samples fall into aligned blocks of 64, which are added in index order; complete
/// blocks join in one binary tree, each node the sum of its two halves, whoever rendered them. So what is kept of a set
/// of samples, and its total, depends on the set alone:
/// - a *node* for every largest complete subtree,
/// - a *prefix* for a block of which the first samples are there and not all: it can be carried on in order,
/// - an *open sample* for each one whose predecessors in its block are missing.
/// A range that starts at 0 has no open samples, and a power of two of blocks is a single node.
///
/// `Sums` is empty when it is default-constructed, has `add(const Sample&, std::uint32_t index)`, `operator+` and `==`;
/// a `Sample` knows whether it `isFinite`. The members are defined in sample_tree_impl.h, for one place each that
/// instantiates them.
template <class Sums, class Sample>
class SampleTree {
 public:
  static constexpr std::uint32_t blockSize = sampleBlockSize;

  using Range = IndexRange;
  using Node = SampleNode<Sums>;
  using OpenSample = OpenSampleOf<Sample>;
  using Content = SampleTreeContent<Sums, Sample>;

  /// Adds one sample; samples that are not finite take their place in the order but add nothing. False, and nothing
  /// is changed, when the sample is there already.
  bool add(std::uint32_t index, const Sample& sample);

  /// Whether the two sets have a sample in common.
  bool overlaps(const SampleTree& other) const;

  /// Adds the samples of another set. False, and nothing is changed, when the two have a sample in common.
  bool merge(const SampleTree& other);

  /// The sums over all samples: the parts, from the last to the first.
  Sums total() const;

  std::uint32_t count() const { return count_; }      ///< Finite samples.
  std::uint32_t dropped() const { return dropped_; }  ///< Samples that were not finite.
  std::size_t bytes() const;                          ///< Memory, this object included.

  /// The samples held, ascending, as few ranges as possible.
  std::vector<Range> ranges() const;

  friend bool operator==(const SampleTree& a, const SampleTree& b) {
    return a.count() == b.count() && a.dropped() == b.dropped() && a.ranges() == b.ranges() && a.total() == b.total();
  }

  /// Everything that is kept.
  Content content() const;
  /// None when no sum has this content.
  static std::optional<SampleTree> fromContent(const Content& content);

 private:
  /// What the common case does without.
  struct More {
    std::vector<Node> nodes;  ///< After the first, ascending.
    std::vector<OpenSample> samples;
  };

  std::size_t nodeCount() const { return hasFirst_ ? 1 + (more_ ? more_->nodes.size() : 0) : 0; }
  Node& node(std::size_t i) { return i == 0 ? first_ : more_->nodes[i - 1]; }
  const Node& node(std::size_t i) const { return i == 0 ? first_ : more_->nodes[i - 1]; }
  /// The first node that does not lie before `block`.
  std::size_t findNode(std::uint32_t block) const;
  void insertNode(std::size_t at, const Node& node);
  void eraseNode(std::size_t at);
  void insertPart(const Node& node);
  bool place(std::uint32_t index, const Sample& sample);
  bool placeOpen(std::uint32_t index, const Sample& sample);
  void absorbOpen(std::size_t at);
  void joinSiblings(std::size_t at);
  void releaseUnused();

  Node first_;
  std::unique_ptr<More> more_;
  std::uint32_t count_ = 0;
  std::uint32_t dropped_ : 31 = 0;
  std::uint32_t hasFirst_ : 1 = 0;
};

template <class A, class Sums>
void describe(A& archive, SampleNode<Sums>& node) {
  archive(node.sums, node.block, node.level, node.prefix);
}

template <class A, class Sample>
void describe(A& archive, OpenSampleOf<Sample>& open) {
  archive(open.index, open.sample);
}

template <class A, class Sums, class Sample>
void describe(A& archive, SampleTreeContent<Sums, Sample>& content) {
  archive(content.nodes, content.open, content.dropped);
}

}  // namespace aerosol::render
