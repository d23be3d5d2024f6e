// The members of SampleTree.
#pragma once

#include "core/render/sample_tree.h"

namespace aerosol::render {

template <class Sums, class Sample>
std::size_t SampleTree<Sums, Sample>::findNode(std::uint32_t block) const {
  std::size_t i = nodeCount();
  while (i > 0 && (node(i - 1).block >= block || node(i - 1).covers(block))) --i;
  return i;
}

template <class Sums, class Sample>
void SampleTree<Sums, Sample>::insertNode(std::size_t at, const Node& inserted) {
  if (!hasFirst_) {
    first_ = inserted;
    hasFirst_ = 1;
    return;
  }
  if (!more_) more_ = std::make_unique<More>();
  const Node second = at == 0 ? std::exchange(first_, inserted) : inserted;
  const auto offset = static_cast<std::ptrdiff_t>(at == 0 ? 0 : at - 1);
  more_->nodes.insert(more_->nodes.begin() + offset, second);
}

template <class Sums, class Sample>
void SampleTree<Sums, Sample>::eraseNode(std::size_t at) {
  if (nodeCount() == 1) {
    first_ = {};
    hasFirst_ = 0;
    return;
  }
  if (at == 0) first_ = more_->nodes.front();
  more_->nodes.erase(more_->nodes.begin() + static_cast<std::ptrdiff_t>(at == 0 ? 0 : at - 1));
}

template <class Sums, class Sample>
void SampleTree<Sums, Sample>::releaseUnused() {
  if (more_ && more_->samples.empty()) std::vector<OpenSample>().swap(more_->samples);
  if (more_ && more_->nodes.empty() && more_->samples.empty()) more_.reset();
}

template <class Sums, class Sample>
bool SampleTree<Sums, Sample>::add(std::uint32_t index, const Sample& sample) {
  if (!place(index, sample)) return false;
  if (sample.isFinite()) {
    ++count_;
  } else {
    dropped_ = (dropped_ + 1) & 0x7fffffffu;
  }
  return true;
}

template <class Sums, class Sample>
bool SampleTree<Sums, Sample>::place(std::uint32_t index, const Sample& sample) {
  const std::uint32_t block = index / blockSize, offset = index % blockSize;
  const std::size_t at = findNode(block);
  const bool found = at < nodeCount() && node(at).covers(block);
  if (found && (node(at).isComplete() || offset < node(at).prefix)) return false;
  if (offset > 0 && !(found && offset == node(at).prefix)) return placeOpen(index, sample);
  if (!found) insertNode(at, {.sums = {}, .block = block});
  Node& grown = node(at);
  if (sample.isFinite()) grown.sums.add(sample, index);
  ++grown.prefix;
  absorbOpen(at);
  return true;
}

template <class Sums, class Sample>
bool SampleTree<Sums, Sample>::placeOpen(std::uint32_t index, const Sample& sample) {
  if (!more_) more_ = std::make_unique<More>();
  auto& samples = more_->samples;
  const auto at = std::lower_bound(samples.begin(), samples.end(), index,
                                   [](const OpenSample& open, std::uint32_t i) { return open.index < i; });
  if (at != samples.end() && at->index == index) return false;
  samples.insert(at, {index, sample});
  return true;
}

/// Carries a prefix on with the open samples that follow it; a full block becomes a node of the tree.
template <class Sums, class Sample>
void SampleTree<Sums, Sample>::absorbOpen(std::size_t at) {
  Node& grown = node(at);
  if (more_ && !more_->samples.empty()) {
    auto& samples = more_->samples;
    const std::uint32_t start = grown.block * blockSize;
    const auto from = std::lower_bound(samples.begin(), samples.end(), start + grown.prefix,
                                       [](const OpenSample& open, std::uint32_t i) { return open.index < i; });
    auto to = from;
    for (; to != samples.end() && grown.prefix < blockSize && to->index == start + grown.prefix; ++to) {
      if (to->sample.isFinite()) grown.sums.add(to->sample, to->index);
      ++grown.prefix;
    }
    samples.erase(from, to);
  }
  if (grown.prefix == blockSize) {
    grown.prefix = 0;
    joinSiblings(at);
  }
  releaseUnused();
}

template <class Sums, class Sample>
void SampleTree<Sums, Sample>::joinSiblings(std::size_t at) {
  while (true) {
    const Node& here = node(at);
    const bool isLeft = ((here.block >> here.level) & 1u) == 0;
    if (!isLeft && at == 0) return;
    const std::size_t left = isLeft ? at : at - 1;
    if (left + 1 >= nodeCount()) return;
    const Node &a = node(left), &b = node(left + 1);
    const bool areSiblings =
        a.isComplete() && b.isComplete() && a.level == b.level && (a.block >> a.level) + 1 == (b.block >> b.level);
    if (!areSiblings) return;
    node(left).sums = a.sums + b.sums;
    ++node(left).level;
    eraseNode(left + 1);
    at = left;
  }
}

template <class Sums, class Sample>
void SampleTree<Sums, Sample>::insertPart(const Node& part) {
  const std::size_t at = findNode(part.block);
  insertNode(at, part);
  if (part.isComplete()) {
    joinSiblings(at);
    releaseUnused();
  } else {
    absorbOpen(at);
  }
}

template <class Sums, class Sample>
bool SampleTree<Sums, Sample>::overlaps(const SampleTree& other) const {
  const std::vector<Range> mine = ranges(), theirs = other.ranges();
  for (std::size_t i = 0, j = 0; i < mine.size() && j < theirs.size();) {
    if (mine[i].end <= theirs[j].first) {
      ++i;
    } else if (theirs[j].end <= mine[i].first) {
      ++j;
    } else {
      return true;
    }
  }
  return false;
}

template <class Sums, class Sample>
bool SampleTree<Sums, Sample>::merge(const SampleTree& other) {
  if (overlaps(other)) return false;
  for (std::size_t i = 0; i < other.nodeCount(); ++i) insertPart(other.node(i));
  if (other.more_) {
    for (const OpenSample& open : other.more_->samples) place(open.index, open.sample);
  }
  count_ += other.count_;
  dropped_ = (dropped_ + other.dropped_) & 0x7fffffffu;
  return true;
}

template <class Sums, class Sample>
Sums SampleTree<Sums, Sample>::total() const {
  const std::size_t openCount = more_ ? more_->samples.size() : 0;
  Sums sum;
  std::size_t nodes = nodeCount(), open = openCount;
  while (nodes > 0 || open > 0) {
    const std::uint32_t openBlock = open > 0 ? more_->samples[open - 1].index / blockSize : 0;
    const bool hasOpen = open > 0 && (nodes == 0 || openBlock >= node(nodes - 1).block);
    const bool hasNode = nodes > 0 && (!hasOpen || openBlock == node(nodes - 1).block);
    Sums part = hasNode ? node(--nodes).sums : Sums{};
    if (hasOpen) {
      std::size_t first = open;
      while (first > 0 && more_->samples[first - 1].index / blockSize == openBlock) --first;
      for (std::size_t i = first; i < open; ++i) {
        const OpenSample& each = more_->samples[i];
        if (each.sample.isFinite()) part.add(each.sample, each.index);
      }
      open = first;
    }
    sum = part + sum;
  }
  return sum;
}

template <class Sums, class Sample>
std::vector<IndexRange> SampleTree<Sums, Sample>::ranges() const {
  std::vector<Range> all;
  for (std::size_t i = 0; i < nodeCount(); ++i) all.push_back(node(i).range());
  if (more_) {
    for (const OpenSample& open : more_->samples) all.push_back({open.index, std::uint64_t{open.index} + 1});
  }
  std::sort(all.begin(), all.end(), [](const Range& a, const Range& b) { return a.first < b.first; });
  std::vector<Range> joined;
  for (const Range& range : all) {
    if (!joined.empty() && joined.back().end == range.first) {
      joined.back().end = range.end;
    } else {
      joined.push_back(range);
    }
  }
  return joined;
}

template <class Sums, class Sample>
SampleTreeContent<Sums, Sample> SampleTree<Sums, Sample>::content() const {
  Content content;
  content.nodes.reserve(nodeCount());
  for (std::size_t i = 0; i < nodeCount(); ++i) content.nodes.push_back(node(i));
  if (more_) content.open = more_->samples;
  content.dropped = dropped_;
  return content;
}

template <class Sums, class Sample>
std::optional<SampleTree<Sums, Sample>> SampleTree<Sums, Sample>::fromContent(const Content& content) {
  constexpr std::uint64_t blockCount = (std::uint64_t{1} << 32) / blockSize;
  SampleTree sum;
  std::uint64_t next = 0, covered = 0;
  for (const Node& node : content.nodes) {
    if (node.level > 26 || node.prefix >= blockSize || (node.prefix > 0 && node.level > 0)) return {};
    const std::uint64_t size = std::uint64_t{1} << node.level;
    if (node.block < next || node.block % size != 0 || node.block + size > blockCount) return {};
    next = node.block + size;
    const Range range = node.range();
    covered += range.end - range.first;
    sum.insertPart(node);
  }
  for (const OpenSample& open : content.open) {
    if (!sum.place(open.index, open.sample)) return {};
    ++covered;
  }
  if (content.dropped > covered || content.dropped > 0x7fffffffu || covered >= std::uint64_t{1} << 32) return {};
  sum.dropped_ = content.dropped & 0x7fffffffu;
  sum.count_ = static_cast<std::uint32_t>(covered - content.dropped);
  return sum;
}

template <class Sums, class Sample>
std::size_t SampleTree<Sums, Sample>::bytes() const {
  if (!more_) return sizeof(SampleTree);
  return sizeof(SampleTree) + sizeof(More) + more_->nodes.capacity() * sizeof(Node) +
         more_->samples.capacity() * sizeof(OpenSample);
}

}  // namespace aerosol::render
