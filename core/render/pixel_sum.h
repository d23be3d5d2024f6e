// The samples of one pixel, added so that no order of rendering or merging changes a bit of the sum.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/color.h"

namespace aerosol::render {

/// What one sample of a pixel adds; signed. `alpha` is the coverage.
struct PixelSample {
  Color color;
  float alpha = 0;

  bool isFinite() const { return aerosol::isFinite(color) && std::isfinite(alpha); }
};

/// Sums over samples, in double.
struct SampleSums {
  std::array<double, 3> color{};
  double alpha = 0;
  std::array<double, 3> squares{};

  void add(const PixelSample& sample);
  friend SampleSums operator+(const SampleSums& a, const SampleSums& b);
  friend bool operator==(const SampleSums&, const SampleSums&) = default;
};

template <class A>
void describe(A& archive, SampleSums& sums) {
  for (double& value : sums.color) archive(value);
  archive(sums.alpha);
  for (double& value : sums.squares) archive(value);
}

/// Any set of samples of one pixel. Samples fall into aligned blocks of 64, which are added in index order; complete
/// blocks join in one binary tree, each node the sum of its two halves, whoever rendered them. So what is kept of a set
/// of samples, and its total, depends on the set alone:
/// - a *node* for every largest complete subtree,
/// - a *prefix* for a block of which the first samples are there and not all: it can be carried on in order,
/// - an *open sample* for each one whose predecessors in its block are missing.
/// A range that starts at 0 has no open samples, and a power of two of blocks is a single node.
class PixelSum {
 public:
  static constexpr std::uint32_t blockSize = 64;

  /// Adds one sample; samples that are not finite take their place in the order but add nothing. False, and nothing
  /// is changed, when the sample is there already.
  bool add(std::uint32_t index, const PixelSample& sample);

  /// Whether the two sets have a sample in common.
  bool overlaps(const PixelSum& other) const;

  /// Adds the samples of another set. False, and nothing is changed, when the two have a sample in common.
  bool merge(const PixelSum& other);

  /// The sums over all samples: the parts, from the last to the first.
  SampleSums total() const;

  std::uint32_t count() const { return count_; }      ///< Finite samples.
  std::uint32_t dropped() const { return dropped_; }  ///< Samples that were not finite.
  std::size_t bytes() const;                          ///< Memory, this object included.

  /// Samples first ≤ i < end.
  struct Range {
    std::uint64_t first = 0, end = 0;
    friend bool operator==(const Range&, const Range&) = default;
  };
  /// The samples held, ascending, as few ranges as possible.
  std::vector<Range> ranges() const;

  friend bool operator==(const PixelSum& a, const PixelSum& b);

  /// A complete subtree of 2^level blocks, or the first `prefix` samples of a block (then level is 0).
  struct Node {
    SampleSums sums;
    std::uint32_t block = 0;
    std::uint16_t level = 0;
    std::uint16_t prefix = 0;  ///< 0: complete.

    bool isComplete() const { return prefix == 0; }
    bool covers(std::uint32_t b) const { return (b >> level) == (block >> level); }
    Range range() const;
    friend bool operator==(const Node&, const Node&) = default;
  };
  struct OpenSample {
    std::uint32_t index = 0;
    PixelSample sample;
  };
  /// Everything that is kept, to be written to a file and read back.
  struct Content {
    std::vector<Node> nodes;       ///< Ascending.
    std::vector<OpenSample> open;  ///< Ascending.
    std::uint32_t dropped = 0;
  };
  Content content() const;
  /// None when no sum has this content.
  static std::optional<PixelSum> fromContent(const Content& content);

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
  bool place(std::uint32_t index, const PixelSample& sample);
  bool placeOpen(std::uint32_t index, const PixelSample& sample);
  void absorbOpen(std::size_t at);
  void joinSiblings(std::size_t at);
  void releaseUnused();

  Node first_;
  std::unique_ptr<More> more_;
  std::uint32_t count_ = 0;
  std::uint32_t dropped_ : 31 = 0;
  std::uint32_t hasFirst_ : 1 = 0;
};

template <class A>
void describe(A& archive, PixelSum::Node& node) {
  archive(node.sums, node.block, node.level, node.prefix);
}

template <class A>
void describe(A& archive, PixelSum::OpenSample& open) {
  archive(open.index, open.sample.color.r, open.sample.color.g, open.sample.color.b, open.sample.alpha);
}

template <class A>
void describe(A& archive, PixelSum::Content& content) {
  archive(content.nodes, content.open, content.dropped);
}

}  // namespace aerosol::render
