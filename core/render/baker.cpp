#include "core/render/baker.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <thread>

#include "core/render/coefficient_layout.h"
#include "core/shading/batch.h"
#include "core/shading/bounds.h"

namespace aerosol::render {

namespace {

constexpr std::int64_t side = 8;
constexpr std::size_t voxels = 512;
/// Blocks along an axis of what one thread takes at a time, and what a single range is tried on first.
constexpr std::int64_t blocksPerPart = 8;

std::int64_t floorDivide(std::int64_t a, std::int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

bool isSound(Color c) { return isFinite(c) && minimum(c) >= 0; }

}  // namespace

std::array<std::int64_t, 2> BakeLattice::range(int axis) const {
  if (frustum) return {0, frustum->size[static_cast<std::size_t>(axis)] - 1};
  // A point on the edge belongs to the box though the quotient may be rounded away from it.
  constexpr double slack = 1e-6;
  return {static_cast<std::int64_t>(std::ceil(static_cast<double>(bounds.lower[axis]) / voxelSize - slack)),
          static_cast<std::int64_t>(std::floor(static_cast<double>(bounds.upper[axis]) / voxelSize + slack))};
}

double BakeLattice::size() const {
  double product = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [first, last] = range(axis);
    product *= static_cast<double>(std::max<std::int64_t>(0, last - first + 1));
  }
  return product;
}

Point<Object> BakeLattice::at(const std::array<std::int64_t, 3>& index) const {
  Point<Object> point;
  VoxelMap::Triple place;
  for (std::size_t i = 0; i < 3; ++i) place[i] = static_cast<double>(index[i]) * (frustum ? 1 : voxelSize);
  if (frustum) place = frustum->map.toFile(place).value_or(VoxelMap::Triple{});
  for (std::size_t i = 0; i < 3; ++i) point[static_cast<int>(i)] = static_cast<float>(place[i]);
  return point;
}

Box<Object> BakeLattice::boxAround(const std::array<std::int64_t, 3>& first,
                                   const std::array<std::int64_t, 3>& last) const {
  if (!frustum) return {at(first), at(last)};
  VoxelMap::Triple least, greatest, lower, upper;
  for (std::size_t i = 0; i < 3; ++i) {
    least[i] = static_cast<double>(first[i]);
    greatest[i] = static_cast<double>(last[i]);
  }
  frustum->map.fileBox(least, greatest, lower, upper);
  Box<Object> box;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double slack = 1e-9 * (std::fabs(lower[k]) + std::fabs(upper[k]));
    box.lower[i] = std::nextafter(static_cast<float>(lower[k] - slack), -std::numeric_limits<float>::infinity());
    box.upper[i] = std::nextafter(static_cast<float>(upper[k] + slack), std::numeric_limits<float>::infinity());
  }
  return box;
}

/// What one thread works with.
class Baker::Worker {
 public:
  Worker(const Baker& baker, const BakeLattice& lattice, const std::vector<float>& times)
      : baker_(baker),
        lattice_(lattice),
        times_(times),
        family_(baker.shading_.family(baker.shader_)),
        host_(baker.spaces_, baker.loopBudget_, &baker.services_),
        batch_(static_cast<int>(voxels)) {
    points_.bind(family_, shading::Variant::coefficients);
    for (int axis = 0; axis < 3; ++axis) ranges_[static_cast<std::size_t>(axis)] = lattice.range(axis);
  }

  BakeCounts counts;
  double anisotropyWeight = 0;
  std::optional<float> firstAnisotropy;

  /// Blocks number `first` up to `end` along each axis, counted in blocks of the lattice's index space.
  void bakePart(const std::array<std::int64_t, 3>& first, const std::array<std::int64_t, 3>& end, std::size_t part,
                const TakeBlock& take) {
    const bool isEmpty = isProvenEmpty(boxOf(first, end));
    for (std::int64_t x = first[0]; x < end[0]; ++x) {
      for (std::int64_t y = first[1]; y < end[1]; ++y) {
        for (std::int64_t z = first[2]; z < end[2]; ++z) {
          ++counts.blocks;
          if (isEmpty || isProvenEmpty(boxOf({x, y, z}, {x + 1, y + 1, z + 1}))) {
            ++counts.proven;
          } else if (auto block = bakeBlock({x, y, z})) {
            take(part, std::move(*block));
          }
        }
      }
    }
  }

 private:
  Box<Object> boxOf(const std::array<std::int64_t, 3>& first, const std::array<std::int64_t, 3>& end) const {
    std::array<std::int64_t, 3> least{}, greatest{};
    for (std::size_t k = 0; k < 3; ++k) {
      least[k] = std::max(first[k] * side, ranges_[k][0]);
      greatest[k] = std::min(end[k] * side - 1, ranges_[k][1]);
    }
    return lattice_.boxAround(least, greatest);
  }

  bool isProvenEmpty(const Box<Object>& box) {
    for (int i = 0; i < 3; ++i) {
      if (box.lower[i] > lattice_.bounds.upper[i] || box.upper[i] < lattice_.bounds.lower[i]) return true;
    }
    if (!family_.bounds) return false;
    const shading::VolumeBox asked{box, times_.front(), times_.back()};
    shading::CoefficientBounds bounds;
    boxes_.evaluate(host_, family_, baker_.shader_.index, {&asked, 1}, {&bounds, 1});
    const auto isNothing = [](const shading::Bound& b) { return b.high <= 1e-30f; };
    const auto isDark = [](const shading::Bound& b) { return b.low >= -1e-30f && b.high <= 1e-30f; };
    return !bounds.mayBeNan && std::ranges::all_of(bounds.sigmaT, isNothing) &&
           std::ranges::all_of(bounds.emission, isDark);
  }

  std::optional<BakedBlock> bakeBlock(const std::array<std::int64_t, 3>& block) {
    BakedBlock baked;
    for (std::size_t i = 0; i < 3; ++i) baked.origin[i] = static_cast<std::int32_t>(block[i] * side);
    const std::size_t numbers = 3 * voxels * times_.size();
    baked.extinction.assign(numbers, 0);
    baked.scattering.assign(numbers, 0);
    baked.emission.assign(numbers, 0);
    bool isEmpty = true;
    for (std::size_t t = 0; t < times_.size(); ++t) {
      places_.clear();
      for (std::size_t n = 0; n < voxels; ++n) addPoint(baked.origin, n, times_[t]);
      batch_.run(host_, points_, 0);
      host_.records().clear();
      for (std::size_t lane = 0; lane < places_.size(); ++lane)
        isEmpty = !keep(readCoefficients(batch_, lane), baked, 3 * (t * voxels + places_[lane])) && isEmpty;
      counts.points += places_.size();
      points_.shrink(0);
    }
    return isEmpty ? std::nullopt : std::optional(std::move(baked));
  }

  void addPoint(const std::array<std::int32_t, 3>& origin, std::size_t n, float time) {
    const std::array<std::int64_t, 3> index{origin[0] + static_cast<std::int64_t>(n / 64),
                                            origin[1] + static_cast<std::int64_t>(n / 8 % 8),
                                            origin[2] + static_cast<std::int64_t>(n % 8)};
    for (std::size_t i = 0; i < 3; ++i) {
      if (index[i] < ranges_[i][0] || index[i] > ranges_[i][1]) return;
    }
    const Point<Object> p = lattice_.at(index);
    for (int i = 0; i < 3 && lattice_.frustum; ++i) {
      if (p[i] < lattice_.bounds.lower[i] || p[i] > lattice_.bounds.upper[i]) return;
    }
    points_.push(shading::VolumePoint{Point<World>(p.x, p.y, p.z), Vector<World>(0, 0, 1), time}, baker_.shader_.index);
    places_.push_back(n);
  }

  /// Whether anything is there.
  bool keep(volume::Coefficients c, BakedBlock& baked, std::size_t at) {
    if (!isSound(c.sigmaT) || !isSound(c.sigmaS) || !isFinite(c.emission)) {
      ++counts.unsound;
      for (Color* color : {&c.sigmaT, &c.sigmaS, &c.emission}) {
        for (int i = 0; i < 3; ++i) {
          if (!std::isfinite((*color)[i]) || ((*color)[i] < 0 && color != &c.emission)) (*color)[i] = 0;
        }
      }
    }
    for (std::uint32_t l = 0; l < c.lobeCount; ++l) {
      const volume::Lobe& lobe = c.lobes[l];
      const double weight = static_cast<double>(maximum(lobe.sigmaS));
      if (!(weight > 0) || !std::isfinite(lobe.anisotropy)) continue;
      counts.anisotropy += static_cast<float>(weight) * lobe.anisotropy;
      anisotropyWeight += weight;
      if (!firstAnisotropy) firstAnisotropy = lobe.anisotropy;
      counts.sameAnisotropy = counts.sameAnisotropy && *firstAnisotropy == lobe.anisotropy;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const int channel = static_cast<int>(i);
      baked.extinction[at + i] = c.sigmaT[channel];
      baked.scattering[at + i] = c.sigmaS[channel];
      baked.emission[at + i] = c.emission[channel];
    }
    return !isBlack(c.sigmaT) || !isBlack(c.emission);
  }

  const Baker& baker_;
  const BakeLattice& lattice_;
  const std::vector<float>& times_;
  const shading::Family& family_;
  shading::KernelHost host_;
  shading::Batch batch_;
  shading::BoundsBatch boxes_;
  shading::PointArrays points_;
  std::vector<std::size_t> places_;  ///< Of the points: numbers of their voxels.
  std::array<std::array<std::int64_t, 2>, 3> ranges_{};
};

Result<std::unique_ptr<const Baker>> Baker::make(const scene::ShaderUse& use, const ShaderSources& sources,
                                                 shading::Services& services, const BakeOptions& options,
                                                 Diagnostics& warnings) {
  std::unique_ptr<Baker> baker(new Baker(services, options.loopBudget));
  baker->spaces_.add("camera", identityMatrix(), identityMatrix());
  const auto bound = bindShader(use, "volume", {}, sources, baker->shading_, warnings);
  if (!bound) return bound.errors();
  baker->shader_ = *bound;
  Diagnostics errors = baker->shading_.compile(*options.compiler, {options.target, false});
  if (errors.hasErrors()) return errors;
  // Without them nothing is proven empty, and that is all.
  static_cast<void>(baker->shading_.compileBounds(*options.compiler, {options.target, false}));
  return {std::unique_ptr<const Baker>(std::move(baker))};
}

bool Baker::readsTime() const {
  const int time = jit::globalPointer(lang::Global::time);
  const auto& interface = shading_.family(shader_).kernel(shading::Variant::coefficients).interface();
  return (interface.globalsRead >> time & 1u) != 0;
}

namespace {

/// Blocks of a lattice, and the parts that threads take.
struct Parts {
  std::array<std::int64_t, 3> begin{}, end{}, parts{};
  std::int64_t count = 1;

  explicit Parts(const BakeLattice& lattice) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [first, last] = lattice.range(static_cast<int>(i));
      begin[i] = floorDivide(first, side);
      end[i] = first > last ? begin[i] : floorDivide(last, side) + 1;
      parts[i] = (end[i] - begin[i] + blocksPerPart - 1) / blocksPerPart;
      count *= parts[i];
    }
  }
};

}  // namespace

std::size_t Baker::partCount(const BakeLattice& lattice) { return static_cast<std::size_t>(Parts(lattice).count); }

std::vector<BakedBlock> Baker::bake(const BakeLattice& lattice, const std::vector<float>& times, int threads,
                                    const std::function<void(double, std::uint64_t)>& progress,
                                    const std::atomic<bool>* stop, BakeCounts& counts) const {
  std::vector<std::vector<BakedBlock>> found(partCount(lattice));
  const TakeBlock take = [&](std::size_t part, BakedBlock&& block) { found[part].push_back(std::move(block)); };
  bake(lattice, times, threads, take, progress, stop, counts);
  std::vector<BakedBlock> all;
  for (auto& part : found) std::ranges::move(part, std::back_inserter(all));
  return all;
}

void Baker::bake(const BakeLattice& lattice, const std::vector<float>& times, int threads, const TakeBlock& take,
                 const std::function<void(double, std::uint64_t)>& progress, const std::atomic<bool>* stop,
                 BakeCounts& counts) const {
  const Parts parts(lattice);
  std::atomic<std::int64_t> next{0}, done{0};
  std::atomic<std::uint64_t> points{0};
  std::mutex mutex;
  double weight = 0;
  std::optional<float> anisotropy;
  const auto work = [&] {
    Worker worker(*this, lattice, times);
    for (std::int64_t i = next++; i < parts.count && !(stop && stop->load(std::memory_order_relaxed)); i = next++) {
      const std::array<std::int64_t, 3> part{i / (parts.parts[1] * parts.parts[2]), i / parts.parts[2] % parts.parts[1],
                                             i % parts.parts[2]};
      std::array<std::int64_t, 3> from{}, to{};
      for (std::size_t k = 0; k < 3; ++k) {
        from[k] = parts.begin[k] + part[k] * blocksPerPart;
        to[k] = std::min(from[k] + blocksPerPart, parts.end[k]);
      }
      const std::uint64_t before = worker.counts.points;
      worker.bakePart(from, to, static_cast<std::size_t>(i), take);
      points += worker.counts.points - before;
      ++done;
      const std::lock_guard lock(mutex);
      if (progress) progress(static_cast<double>(done) / static_cast<double>(parts.count), points);
    }
    const std::lock_guard lock(mutex);
    counts.blocks += worker.counts.blocks;
    counts.proven += worker.counts.proven;
    counts.points += worker.counts.points;
    counts.unsound += worker.counts.unsound;
    counts.anisotropy += worker.counts.anisotropy;
    weight += worker.anisotropyWeight;
    if (!anisotropy) anisotropy = worker.firstAnisotropy;
    counts.sameAnisotropy = counts.sameAnisotropy && worker.counts.sameAnisotropy &&
                            (!worker.firstAnisotropy || worker.firstAnisotropy == anisotropy);
  };
  {
    std::vector<std::jthread> others;
    for (int i = 1; i < std::min<std::int64_t>(threads, parts.count); ++i) others.emplace_back(work);
    work();
  }
  if (counts.sameAnisotropy && anisotropy) {
    counts.anisotropy = *anisotropy;
  } else if (weight > 0) {
    counts.anisotropy = static_cast<float>(static_cast<double>(counts.anisotropy) / weight);
  }
}

}  // namespace aerosol::render
