#include "core/shading/bounds.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>

namespace aerosol::shading {

namespace {

constexpr std::size_t alignment = 64;
constexpr float infinity = std::numeric_limits<float>::infinity();
/// Kernels transform points by float matrices, in sums of four products: some units in the last place of the sum of
/// the magnitudes.
constexpr double transformError = 8.0 / (1 << 24);

struct Free {
  void operator()(void* p) const { std::free(p); }
};

float below(double x) {
  const auto nearest = static_cast<float>(x);
  return static_cast<double>(nearest) <= x ? nearest : std::nextafter(nearest, -infinity);
}
float above(double x) { return -below(-x); }

using Corner = std::array<double, 3>;

template <class Space>
Corner corner(Point<Space> p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}

/// Range of row `row` of the map over the box, and the sum of magnitudes that its rounding is in proportion to.
struct RowRange {
  double low, high, magnitude;
};
RowRange rowRange(const Matrix4& map, std::size_t row, const Corner& low, const Corner& high) {
  RowRange range{map[row][3], map[row][3], std::abs(map[row][3])};
  for (std::size_t i = 0; i < 3; ++i) {
    const double a = map[row][i] * low[i];
    const double b = map[row][i] * high[i];
    range.low += std::min(a, b);
    range.high += std::max(a, b);
    range.magnitude += std::max(std::abs(a), std::abs(b));
  }
  return range;
}

/// The places of an instance that moves, over the time of some boxes. What lies between two of the times that are
/// looked at is covered by the largest second difference.
class Places {
 public:
  Places(const Instance& instance, std::span<const VolumeBox> boxes) : first_(instance.objectToWorld.matrix()) {
    if (!instance.motion || boxes.empty()) return;
    float begin = infinity, end = -infinity;
    for (const VolumeBox& box : boxes) {
      begin = std::min(begin, box.timeLow);
      end = std::max(end, box.timeHigh);
    }
    for (int i = 0; i < looks; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(looks - 1);
      const Transform<World, Object> place = instance.motion->at(begin + u * (end - begin));
      matrices_.push_back(place.matrix());
      inverses_.push_back(place.inverseMatrix());
    }
  }
  bool isStill() const { return matrices_.empty(); }

  /// Of a coordinate of the world, at all times.
  RowRange world(std::size_t row, const Corner& low, const Corner& high) const {
    RowRange all{infinity, -infinity, 0};
    RowRange before{}, last{};
    double bend = 0;
    for (std::size_t i = 0; i < matrices_.size(); ++i) {
      const RowRange next = rowRange(matrices_[i], row, low, high);
      all = {std::min(all.low, next.low), std::max(all.high, next.high), std::max(all.magnitude, next.magnitude)};
      if (i > 1) {
        bend = std::max(
            {bend, std::abs(before.low - 2 * last.low + next.low), std::abs(before.high - 2 * last.high + next.high)});
      }
      before = last;
      last = next;
    }
    return {all.low - bend, all.high + bend, all.magnitude + bend};
  }

  /// How far a coordinate of the world may be from where the first place puts it.
  double deviation(std::size_t row, const Corner& low, const Corner& high) const {
    double most = 0, step = 0, last = 0;
    for (const Matrix4& m : matrices_) {
      double off = std::abs(m[row][3] - first_[row][3]);
      for (std::size_t i = 0; i < 3; ++i)
        off += std::abs(m[row][i] - first_[row][i]) * std::max(std::abs(low[i]), std::abs(high[i]));
      step = std::max(step, std::abs(off - last));
      most = std::max(most, off);
      last = off;
    }
    return most + step;
  }

  /// The sum of magnitudes on the way of a coordinate back to the object.
  double magnitude(std::size_t row, const Corner& low, const Corner& high) const {
    double most = 0;
    for (const Matrix4& m : inverses_) most = std::max(most, rowRange(m, row, low, high).magnitude);
    return most;
  }

 private:
  static constexpr int looks = 33;
  const Matrix4& first_;
  std::vector<Matrix4> matrices_, inverses_;
};

void join(Bound& bound, const Bound& other) {
  bound.low = std::max(bound.low, other.low);
  bound.high = std::max(bound.high, other.high);
}

bool areUniform(std::span<const Bound> bounds, float tolerance) {
  return std::ranges::all_of(bounds, [tolerance](const Bound& bound) { return bound.isUniform(tolerance); });
}

bool areZero(std::span<const Bound> bounds) {
  return std::ranges::all_of(bounds, [](const Bound& bound) { return bound.low == 0 && bound.high == 0; });
}

}  // namespace

bool Bound::isUniform(float tolerance) const {
  return std::isfinite(low) && std::isfinite(high) && high - low <= tolerance * std::max(std::abs(low), std::abs(high));
}

Bound CoefficientBounds::extinction() const {
  Bound largest{0, 0};
  for (const Bound& channel : sigmaT) join(largest, channel);
  if (mayBeNan) largest.low = 0;
  return largest;
}

bool CoefficientBounds::isEmpty() const {
  const bool absorbsNothing = std::ranges::all_of(sigmaT, [](const Bound& bound) { return bound.high <= 0; });
  return !mayBeNan && absorbsNothing && areZero(emission);
}

bool CoefficientBounds::isUniform(float tolerance) const {
  if (mayBeNan || !areUniform(sigmaT, tolerance) || !areUniform(sigmaS, tolerance) ||
      !areUniform(emission, tolerance)) {
    return false;
  }
  for (std::uint32_t i = 0; i < lobeCount; ++i) {
    const Lobe& lobe = lobes[i];
    if (!areUniform(lobe.sigmaS, tolerance)) return false;
    // The shape of a lobe without weight is of no interest; mean cosines are compared on their own scale of 1.
    const bool isFlat = lobe.anisotropy.high - lobe.anisotropy.low <= tolerance;
    if (!isFlat && !areZero(lobe.sigmaS)) return false;
  }
  return true;
}

/// One allocation: inputs, instances, outputs, an array of `capacity` numbers each.
struct BoundsBatch::Arrays {
  std::unique_ptr<std::byte, Free> memory;
  std::size_t inputs = 0;
  std::size_t outputs = 0;
  std::vector<const float*> inputPointers;
  std::int32_t* instances = nullptr;
  std::vector<void*> outputPointers;

  void reserve(std::size_t capacity, std::size_t outputCount) {
    if (memory && outputCount <= outputs) return;
    outputs = outputCount;
    inputs = jit::rangeInputCount;
    const std::size_t bytes = (inputs + 1 + 2 * outputs) * capacity * sizeof(float);
    memory.reset(static_cast<std::byte*>(std::aligned_alloc(alignment, bytes)));
    if (!memory) throw std::bad_alloc();
    std::memset(memory.get(), 0, bytes);
    auto* next = reinterpret_cast<float*>(memory.get());
    inputPointers.clear();
    for (std::size_t i = 0; i < inputs; ++i, next += capacity) inputPointers.push_back(next);
    instances = reinterpret_cast<std::int32_t*>(next);
    next += capacity;
    outputPointers.clear();
    for (std::size_t i = 0; i < outputs; ++i, next += 2 * capacity) outputPointers.push_back(next);
  }
  float* input(std::size_t pointer) { return const_cast<float*>(inputPointers[pointer]); }
};

BoundsBatch::BoundsBatch(int capacity)
    : capacity_((static_cast<std::size_t>(std::max(capacity, 1)) + AEROSOL_MAXIMUM_WIDTH - 1) / AEROSOL_MAXIMUM_WIDTH *
                AEROSOL_MAXIMUM_WIDTH),
      arrays_(std::make_unique<Arrays>()) {}

BoundsBatch::~BoundsBatch() = default;

/// Globals of volume points are P, I and time, and how they change from pixel to pixel; all others are 0; P is given in
/// both spaces, and as a line over the object's box.
void BoundsBatch::gather(const Instance& placed, std::span<const VolumeBox> boxes) {
  const auto put = [&](int component, std::size_t box, float low, float high) {
    arrays_->input(2 * static_cast<std::size_t>(component))[box] = low;
    arrays_->input(2 * static_cast<std::size_t>(component) + 1)[box] = high;
  };
  gatherFootprints(boxes.size());
  const Places places(placed, boxes);
  const Matrix4& toWorld = placed.objectToWorld.matrix();
  const Matrix4& toObject = placed.objectToWorld.inverseMatrix();
  const int p = jit::globalPointer(lang::Global::P);
  const int direction = jit::globalPointer(lang::Global::I);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const VolumeBox& box = boxes[i];
    Corner low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner boxLow = corner(box.box.lower), boxHigh = corner(box.box.upper);
      const RowRange world =
          places.isStill() ? rowRange(toWorld, k, boxLow, boxHigh) : places.world(k, boxLow, boxHigh);
      const double slack = world.magnitude * 1e-14;  // The two matrices are each other's inverses in doubles.
      const float lower = below(world.low - slack), upper = above(world.high + slack);
      low[k] = static_cast<double>(lower);
      high[k] = static_cast<double>(upper);
      put(p + static_cast<int>(k), i, lower, upper);
      put(direction + static_cast<int>(k), i, -1.0001f, 1.0001f);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const RowRange object = rowRange(toObject, k, low, high);
      const double slack = std::max(object.magnitude, places.magnitude(k, low, high)) * transformError;
      const int axis = static_cast<int>(k);
      put(jit::globalPointerCount + axis, i, below(static_cast<double>(box.box.lower[axis]) - slack),
          above(static_cast<double>(box.box.upper[axis]) + slack));
    }
    put(jit::globalPointer(lang::Global::time), i, box.timeLow, box.timeHigh);
    gatherLine(toWorld, box.box, i);
    if (places.isStill()) continue;
    for (std::size_t row = 0; row < 3; ++row) {
      float& rest = arrays_->input(jit::rangeLineStart + row * jit::rangeLineParts + 4)[i];
      const double more = places.deviation(row, corner(box.box.lower), corner(box.box.upper));
      rest = above(static_cast<double>(rest) + more);
    }
  }
}

/// Rounding may make a change that was cut off at the largest one longer.
void BoundsBatch::gatherFootprints(std::size_t boxes) {
  if (largestFootprint_ == 0) return;
  using lang::Global;
  constexpr float rounding = 1.0001f;
  for (const Global global : {Global::dPdx, Global::dPdy, Global::dPdz, Global::dIdx, Global::dIdy}) {
    const bool isTurn = global == Global::dIdx || global == Global::dIdy;
    const float largest = isTurn ? 1 : largestFootprint_;
    for (int i = 0; i < 3; ++i) {
      const auto component = static_cast<std::size_t>(jit::globalPointer(global) + i);
      std::fill_n(arrays_->input(2 * component), boxes, -largest * rounding);
      std::fill_n(arrays_->input(2 * component + 1), boxes, largest * rounding);
    }
  }
}

void BoundsBatch::gatherLine(const Matrix4& toWorld, const Box<Object>& box, std::size_t at) {
  const Corner low = corner(box.lower), high = corner(box.upper);
  for (std::size_t row = 0; row < 3; ++row) {
    const auto put = [&](std::size_t part, float value) {
      arrays_->input(jit::rangeLineStart + row * jit::rangeLineParts + part)[at] = value;
    };
    double centre = toWorld[row][3];
    double rest = std::abs(centre) * 1e-14;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double term = toWorld[row][axis] * (0.5 * (low[axis] + high[axis]));
      const double slope = toWorld[row][axis] * (0.5 * (high[axis] - low[axis]));
      const auto rounded = static_cast<float>(slope);
      put(1 + axis, rounded);
      centre += term;
      rest += std::abs(slope - static_cast<double>(rounded)) + (std::abs(term) + std::abs(slope)) * 1e-14;
    }
    const auto rounded = static_cast<float>(centre);
    put(0, rounded);
    put(4, above(rest + std::abs(centre - static_cast<double>(rounded))));
  }
}

void BoundsBatch::scatter(const jit::KernelInterface& interface, std::span<CoefficientBounds> bounds) const {
  for (CoefficientBounds& each : bounds) each = {};
  const auto fieldOf = [](CoefficientBounds& b, const jit::OutputComponent& output) -> Bound* {
    switch (output.kind) {
      case lang::OutputKind::sigmaT:
        return &b.sigmaT[output.component];
      case lang::OutputKind::sigmaS:
        return &b.sigmaS[output.component];
      case lang::OutputKind::emission:
        return &b.emission[output.component];
      case lang::OutputKind::lobeSigmaS:
        return &b.lobes[output.index].sigmaS[output.component];
      case lang::OutputKind::lobeAnisotropy:
        return &b.lobes[output.index].anisotropy;
      default:
        return nullptr;
    }
  };
  for (std::size_t k = 0; k < interface.outputs.size(); ++k) {
    const jit::OutputComponent& output = interface.outputs[k];
    const auto* floats = static_cast<const float*>(arrays_->outputPointers[k]);
    const auto* flags = static_cast<const std::uint32_t*>(arrays_->outputPointers[k]);
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      if (output.part == jit::OutputPart::mayBeNan) {
        bounds[i].mayBeNan = bounds[i].mayBeNan || flags[i] != 0;
        continue;
      }
      Bound* const field = fieldOf(bounds[i], output);
      if (!field) continue;
      (output.part == jit::OutputPart::low ? field->low : field->high) = floats[i];
      if (output.kind == lang::OutputKind::lobeAnisotropy)
        bounds[i].lobeCount = std::max(bounds[i].lobeCount, output.index + 1);
    }
  }
  // A single lobe has all the scattering, and the kernel does not say it twice.
  for (CoefficientBounds& each : bounds) {
    if (each.lobeCount == 1) each.lobes[0].sigmaS = each.sigmaS;
  }
}

template <class Scatter>
void BoundsBatch::run(KernelHost& host, const Family& family, const jit::Kernel& kernel, std::uint32_t instance,
                      std::span<const VolumeBox> boxes, Scatter scatter) {
  arrays_->reserve(capacity_, kernel.interface().outputs.size());
  std::fill_n(arrays_->instances, capacity_, static_cast<std::int32_t>(instance));
  for (std::size_t first = 0; first < boxes.size(); first += capacity_) {
    const std::size_t count = std::min(capacity_, boxes.size() - first);
    gather(family.instances[instance], boxes.subspan(first, count));
    AerosolKernelArguments arguments;
    arguments.context = host.context();
    arguments.globals = arrays_->inputPointers.data();
    arguments.instances = arrays_->instances;
    arguments.active = nullptr;
    arguments.instanceData = family.instanceData.data();
    arguments.outputs = arrays_->outputPointers.data();
    arguments.count = static_cast<std::int32_t>(count);
    if (!kernel.interface().hostSites.empty()) host.begin(kernel.interface(), family, count);
    kernel(arguments);
    scatter(first, count);
  }
}

void BoundsBatch::evaluate(KernelHost& host, const Family& family, std::uint32_t instance,
                           std::span<const VolumeBox> boxes, std::span<CoefficientBounds> bounds) {
  assert(family.bounds && bounds.size() == boxes.size());
  run(host, family, *family.bounds, instance, boxes,
      [&](std::size_t first, std::size_t count) { scatter(family.bounds->interface(), bounds.subspan(first, count)); });
}

void BoundsBatch::evaluateVelocity(KernelHost& host, const Family& family, std::uint32_t instance,
                                   std::span<const VolumeBox> boxes, std::span<VelocityBounds> bounds) {
  assert(family.velocityBounds && bounds.size() == boxes.size());
  run(host, family, *family.velocityBounds, instance, boxes, [&](std::size_t first, std::size_t count) {
    const auto& outputs = family.velocityBounds->interface().outputs;
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      const auto* floats = static_cast<const float*>(arrays_->outputPointers[k]);
      const auto* flags = static_cast<const std::uint32_t*>(arrays_->outputPointers[k]);
      for (std::size_t i = 0; i < count; ++i) {
        VelocityBounds& each = bounds[first + i];
        if (outputs[k].part == jit::OutputPart::mayBeNan) {
          each.mayBeNan = each.mayBeNan || flags[i] != 0;
        } else {
          Bound& bound = each.velocity[outputs[k].component];
          (outputs[k].part == jit::OutputPart::low ? bound.low : bound.high) = floats[i];
        }
      }
    }
  });
}

}  // namespace aerosol::shading
