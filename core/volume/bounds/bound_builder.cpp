#include "core/volume/bounds/bound_builder.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace aerosol::volume {

namespace {

constexpr int samplesPerBox = 16;
/// Of the spread of the samples, added to the largest: a leaf's true maximum lies a little above what points find.
constexpr float sampleMargin = 0.25f;
/// Tentative collisions in vain on a chord of a cell from which its division pays.
constexpr float worthwhileWaste = 0.4f;
/// Steps over faces that a chord of a divided cell has more of.
constexpr double stepsOfParts = 2;
constexpr std::uint32_t bytesPerNode = sizeof(BoundNode) + sizeof(BoundRanges);

/// A node while the tree grows.
struct Cell {
  std::array<std::int32_t, 3> place{};  ///< In cells of its level.
  int level = 0;
  BoxKnowledge knowledge;
  BoxSamples samples;
  float provenHigh = 0;
  float working = 0;
  Provenance provenance = Provenance::proven;
  std::uint32_t parts = 0;  ///< Index of the first; 0: none.
};

/// Shader points are rounded to float in world space: in object space they are off by so much along each axis.
std::array<double, 3> roundingIn(const Box<Object>& box, const Transform<World, Object>& objectToWorld) {
  std::array<double, 3> world{}, object{};
  const Matrix4& m = objectToWorld.matrix();
  const Matrix4& inverse = objectToWorld.inverseMatrix();
  for (std::size_t i = 0; i < 3; ++i) {
    world[i] = std::fabs(m[i][3]);
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      world[i] += std::fabs(m[i][k]) * std::max(std::fabs(static_cast<double>(box.lower[axis])),
                                                std::fabs(static_cast<double>(box.upper[axis])));
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) object[i] += std::fabs(inverse[i][k]) * world[k] * 0x1p-23;
  }
  return object;
}

/// The box from `low` to `high`, larger by `rounding`.
Box<Object> boxAround(const std::array<double, 3>& low, const std::array<double, 3>& high,
                      const std::array<double, 3>& rounding) {
  Box<Object> box;
  for (std::size_t i = 0; i < 3; ++i) {
    const int axis = static_cast<int>(i);
    box.lower[axis] = std::nextafter(static_cast<float>(low[i] - rounding[i]), -HUGE_VALF);
    box.upper[axis] = std::nextafter(static_cast<float>(high[i] + rounding[i]), HUGE_VALF);
  }
  return box;
}

class Builder {
 public:
  Builder(BoundSource& source, const BoundRequest& request, BoundStatistics& statistics)
      : source_(source), request_(request), statistics_(statistics) {
    const Matrix4& m = request.objectToWorld.matrix();
    for (std::size_t i = 0; i < 3; ++i) {
      const double side = static_cast<double>(request.domain.upper[static_cast<int>(i)]) -
                          static_cast<double>(request.domain.lower[static_cast<int>(i)]);
      sides_[i] = side * std::sqrt(m[0][i] * m[0][i] + m[1][i] * m[1][i] + m[2][i] * m[2][i]);
    }
    rounding_ = roundingIn(request.domain, request.objectToWorld);
  }

  BoundTree build() {
    cells_.resize(BoundTree::parts);
    for (std::uint32_t i = 0; i < BoundTree::parts; ++i) cells_[i].place = partPlace(i);
    evaluate(0, 0);
    for (std::size_t first = 0; first < cells_.size();) {
      const std::size_t end = cells_.size();
      if (cells_[first].level + 1 < BoundTree::maximumLevels) divide(first, end);
      first = end;
    }
    for (std::uint32_t i = 0; i < BoundTree::parts; ++i) join(i);
    return write();
  }

 private:
  static std::array<std::int32_t, 3> partPlace(std::uint32_t part) {
    return {static_cast<std::int32_t>(part & 3u), static_cast<std::int32_t>(part >> 2 & 3u),
            static_cast<std::int32_t>(part >> 4)};
  }

  static double cellsPerSide(int level) { return static_cast<double>(1 << BoundTree::levelBits * (level + 1)); }

  double edge(std::size_t axis, std::int32_t place, int level) const {
    const int a = static_cast<int>(axis);
    const double lower = static_cast<double>(request_.domain.lower[a]),
                 upper = static_cast<double>(request_.domain.upper[a]);
    return lower + (upper - lower) * place / cellsPerSide(level);
  }

  Box<Object> boxOf(const Cell& cell) const {
    std::array<double, 3> low{}, high{};
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = edge(i, cell.place[i], cell.level);
      high[i] = edge(i, cell.place[i] + 1, cell.level);
    }
    return boxAround(low, high, rounding_);
  }

  /// Mean length of a random chord: four times the volume over the surface (Cauchy). World units.
  double chord(int level) const { return chordOf(cellsPerSide(level)); }

  double chordOf(double n) const {
    const double a = sides_[0] / n, b = sides_[1] / n, c = sides_[2] / n;
    return 2 * a * b * c / (a * b + b * c + c * a);
  }

  bool isKnown(const Cell& cell) const {
    return request_.mayLeaveOut && (cell.knowledge.isEmpty || cell.knowledge.isUniform);
  }

  /// Tentative collisions in vain on a chord.
  double waste(const Cell& cell) const {
    return isKnown(cell) ? 0 : static_cast<double>(rateOf(cell) - cell.samples.mean) * chord(cell.level);
  }

  void evaluate(std::size_t first, int level) {
    const std::size_t count = cells_.size() - first;
    std::vector<Box<Object>> boxes(count);
    std::vector<BoxKnowledge> knowledge(count);
    for (std::size_t i = 0; i < count; ++i) {
      cells_[first + i].level = level;
      boxes[i] = boxOf(cells_[first + i]);
    }
    source_.prove(boxes, knowledge);
    statistics_.boxes += count;

    std::vector<std::size_t> varying;
    std::vector<Box<Object>> sampled;
    for (std::size_t i = 0; i < count; ++i) {
      Cell& cell = cells_[first + i];
      cell.knowledge = knowledge[i];
      if (isKnown(cell)) continue;
      varying.push_back(first + i);
      sampled.push_back(boxes[i]);
    }
    std::vector<BoxSamples> samples(sampled.size());
    source_.sample(sampled, samplesPerBox, samples);
    statistics_.points += sampled.size() * samplesPerBox;
    for (std::size_t i = 0; i < varying.size(); ++i) {
      cells_[varying[i]].samples = samples[i];
      chooseBound(cells_[varying[i]]);
    }
  }

  /// The working bound of shadow rays: what samples suggest, no more than what is proven or declared, and no less than
  /// half the way from the least extinction to that, so that no weight of ratio tracking exceeds 1 in size.
  void chooseBound(Cell& cell) const {
    BoundRanges& ranges = cell.knowledge.ranges;
    const BoxSamples& samples = cell.samples;
    float limit = cell.provenHigh = ranges.extinctionHigh;
    cell.provenance = request_.rangesAreDeclared ? Provenance::declared : Provenance::proven;
    if (request_.declared && *request_.declared < limit) {
      limit = *request_.declared;
      cell.provenance = Provenance::declared;
    }
    const float floor = 1.0f / request_.stepSize;
    const float suggested = samples.high + sampleMargin * (samples.high - samples.low);
    if (!std::isfinite(limit)) {
      cell.provenance = Provenance::estimated;
      ranges.extinctionHigh = cell.working = std::max(2 * suggested, floor);
      return;
    }
    ranges.extinctionHigh = limit;
    ranges.extinctionLow = std::min(ranges.extinctionLow, limit);
    cell.working = std::clamp(suggested, 0.5f * (ranges.extinctionLow + limit), limit);
    // Emission alone, or so little that it counts as nothing, is looked for once a step.
    if (!(cell.working > negligibleWorking)) cell.working = floor;
  }

  /// Divides the best of the cells [first, end), all of one level, as far as the budget goes.
  void divide(std::size_t first, std::size_t end) {
    struct Candidate {
      double waste;
      std::size_t cell;
    };
    std::vector<Candidate> candidates;
    for (std::size_t i = first; i < end; ++i) {
      const double wasted = waste(cells_[i]);
      if (wasted > static_cast<double>(worthwhileWaste)) candidates.push_back({wasted, i});
    }
    const std::uint64_t boxesLeft = request_.budget.boxes - std::min(request_.budget.boxes, statistics_.boxes);
    const std::uint64_t nodesMost = request_.budget.bytes / bytesPerNode;
    const std::uint64_t nodesLeft = nodesMost - std::min<std::uint64_t>(nodesMost, cells_.size());
    const std::uint64_t most = std::min(boxesLeft, nodesLeft) / BoundTree::parts;
    if (candidates.size() > most) {
      std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return a.waste != b.waste ? a.waste > b.waste : a.cell < b.cell;
      });
      candidates.resize(most);
    }
    if (candidates.empty()) return;
    const int level = cells_[first].level + 1;
    for (const Candidate& candidate : candidates) {
      cells_[candidate.cell].parts = static_cast<std::uint32_t>(cells_.size());
      const std::array<std::int32_t, 3> place = cells_[candidate.cell].place;
      for (std::uint32_t part = 0; part < BoundTree::parts; ++part) {
        Cell& cell = cells_.emplace_back();
        const std::array<std::int32_t, 3> inside = partPlace(part);
        for (std::size_t i = 0; i < 3; ++i) cell.place[i] = 4 * place[i] + inside[i];
      }
    }
    evaluate(end, level);
  }

  /// Takes parts back that do not earn what stepping over them costs. Parts first.
  void join(std::uint32_t index) {
    const std::uint32_t parts = cells_[index].parts;
    if (parts == 0) return;
    bool isLeaf = true, isEmpty = true;
    double rate = 0;
    BoundRanges all{HUGE_VALF, 0, 0, HUGE_VALF, 0};
    for (std::uint32_t i = parts; i < parts + BoundTree::parts; ++i) {
      join(i);
      const Cell& part = cells_[i];
      isLeaf = isLeaf && part.parts == 0;
      isEmpty = isEmpty && isKnown(part) && part.knowledge.isEmpty;
      rate += static_cast<double>(rateOf(part)) / BoundTree::parts;
      const BoundRanges& r = part.knowledge.ranges;
      all = {std::min(all.extinctionLow, r.extinctionLow), std::max(all.extinctionHigh, r.extinctionHigh),
             std::max(all.scatteringHigh, r.scatteringHigh), std::min(all.emissionLow, r.emissionLow),
             std::max(all.emissionHigh, r.emissionHigh)};
    }
    if (!isLeaf) return;
    Cell& cell = cells_[index];
    if (isEmpty) {
      cell.knowledge = {.ranges = all, .isEmpty = true};
      cell.parts = 0;
    } else if ((static_cast<double>(rateOf(cell)) - rate) * chord(cell.level) * request_.pointCost < stepsOfParts) {
      cell.parts = 0;
    }
  }

  /// Of paths' collisions.
  float rateOf(const Cell& cell) const {
    const float high = cell.knowledge.ranges.extinctionHigh;
    return isKnown(cell) ? high : std::max(high, cell.working);
  }

  BoundTree write() {
    BoundTree tree;
    tree.domain = request_.domain;
    tree.objectToWorld = request_.objectToWorld;
    tree.nodes.resize(BoundTree::parts);
    tree.ranges.resize(BoundTree::parts);
    tree.levels = 1;
    writeParts(tree, 0, 0);
    writeOutside(tree);
    statistics_.bytes = tree.nodes.size() * bytesPerNode + tree.uniform.size() * sizeof(Coefficients);
    statistics_.meanBound = workingIntegral_;
    statistics_.chord = chordOf(1);
    statistics_.tightness = samplesIntegral_ > 0 ? workingIntegral_ / samplesIntegral_ : 0;
    statistics_.workingShare = provenIntegral_ > 0 ? workingIntegral_ / provenIntegral_ : 0;
    return tree;
  }

  /// Children stand behind their parents' level order: near cells near each other.
  void writeParts(BoundTree& tree, std::uint32_t cells, std::uint32_t nodes) {
    for (std::uint32_t i = 0; i < BoundTree::parts; ++i) {
      const Cell& cell = cells_[cells + i];
      if (cell.parts == 0) {
        tree.nodes[nodes + i] = leafOf(tree, cell);
        tree.ranges[nodes + i] = cell.knowledge.ranges;
        tree.levels = std::max(tree.levels, cell.level + 1);
        continue;
      }
      const auto first = static_cast<std::uint32_t>(tree.nodes.size());
      tree.nodes.resize(first + BoundTree::parts);
      tree.ranges.resize(first + BoundTree::parts);
      writeParts(tree, cell.parts, first);
      tree.nodes[nodes + i].link = BoundNode::makeLink(LeafKind::inner, Provenance::proven, first);
      tree.ranges[nodes + i] = cell.knowledge.ranges;
    }
  }

  BoundNode leafOf(BoundTree& tree, const Cell& cell) {
    const double volume = std::pow(1.0 / BoundTree::parts, cell.level + 1);
    if (isKnown(cell) && cell.knowledge.isEmpty) {
      ++statistics_.empty;
      statistics_.emptyVolume += volume;
      return {0, 0, 0, BoundNode::makeLink(LeafKind::empty, Provenance::proven, 0)};
    }
    if (isKnown(cell)) {
      ++statistics_.uniform;
      statistics_.uniformVolume += volume;
      const std::uint32_t index = uniformIndex(tree, cell);
      const Color sigmaT = tree.uniform[index].sigmaT;
      const float largest = maximum(sigmaT);
      return {largest > negligibleWorking ? largest : 0.0f, minimum(sigmaT), largest,
              BoundNode::makeLink(LeafKind::uniform, Provenance::proven, index)};
    }
    (cell.provenance == Provenance::proven     ? statistics_.proven
     : cell.provenance == Provenance::declared ? statistics_.declared
                                               : statistics_.estimated) += 1;
    const BoundRanges& ranges = cell.knowledge.ranges;
    workingIntegral_ += volume * static_cast<double>(cell.working);
    provenIntegral_ += volume * static_cast<double>(ranges.extinctionHigh);
    samplesIntegral_ += volume * static_cast<double>(cell.samples.mean);
    // The control leaves something to collide with, and where a declared bound may be wrong so much that weights stay
    // as small as without it.
    const float sound = std::min(ranges.extinctionLow, 2 * cell.working - cell.provenHigh);
    const float control = sound > 0 ? std::min(sound, 0.99f * cell.working) : 0.0f;
    return {cell.working, control, std::max(cell.working, ranges.extinctionHigh),
            BoundNode::makeLink(LeafKind::bounded, cell.provenance, 0)};
  }

  std::uint32_t uniformIndex(BoundTree& tree, const Cell& cell) {
    Point<Object> centre;
    for (std::size_t i = 0; i < 3; ++i) {
      centre[static_cast<int>(i)] =
          static_cast<float>(0.5 * (edge(i, cell.place[i], cell.level) + edge(i, cell.place[i] + 1, cell.level)));
    }
    const auto [place, isNew] =
        uniform_.emplace(cell.knowledge.uniformKey, static_cast<std::uint32_t>(tree.uniform.size()));
    if (isNew) tree.uniform.push_back(source_.at(centre));
    return place->second;
  }

  /// Outside nothing was looked at: what holds everywhere, or else the largest that is known inside.
  void writeOutside(BoundTree& tree) const {
    float largest = 0;
    for (const BoundNode& node : tree.nodes) largest = std::max(largest, node.limit);
    const float proven = request_.everywhere.value_or(HUGE_VALF), declared = request_.declared.value_or(HUGE_VALF);
    const float known = std::min(proven, declared);
    const Provenance provenance = !std::isfinite(known)                               ? Provenance::estimated
                                  : proven <= declared && !request_.rangesAreDeclared ? Provenance::proven
                                                                                      : Provenance::declared;
    const float majorant = std::max(std::isfinite(known) ? known : largest, 1.0f / request_.stepSize);
    tree.outside = {majorant, 0, majorant, BoundNode::makeLink(LeafKind::bounded, provenance, 0)};
  }

  static constexpr float negligibleWorking = 1e-30f;

  BoundSource& source_;
  const BoundRequest& request_;
  BoundStatistics& statistics_;
  std::array<double, 3> sides_{};     ///< Of the domain, world units.
  std::array<double, 3> rounding_{};  ///< Object space.
  std::vector<Cell> cells_;           ///< Level by level.
  std::map<std::uint64_t, std::uint32_t> uniform_;
  double workingIntegral_ = 0, provenIntegral_ = 0, samplesIntegral_ = 0;
};

}  // namespace

Box<Object> withRounding(const Box<Object>& box, const Transform<World, Object>& objectToWorld) {
  const auto corner = [](Point<Object> p) {
    return std::array<double, 3>{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  };
  return boxAround(corner(box.lower), corner(box.upper), roundingIn(box, objectToWorld));
}

BoundTree buildBoundTree(BoundSource& source, const BoundRequest& request, BoundStatistics& statistics) {
  return Builder(source, request, statistics).build();
}

}  // namespace aerosol::volume
