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

/// Globals of volume points are P, I and time, all others are 0; P is given in both spaces, and as a line over the
/// object's box.
void BoundsBatch::gather(const Instance& placed, std::span<const VolumeBox> boxes) {
  const auto put = [&](int component, std::size_t box, float low, float high) {
    arrays_->input(2 * static_cast<std::size_t>(component))[box] = low;
    arrays_->input(2 * static_cast<std::size_t>(component) + 1)[box] = high;
  };
  const Matrix4& toWorld = placed.objectToWorld.matrix();
  const Matrix4& toObject = placed.objectToWorld.inverseMatrix();
  const int p = jit::globalPointer(lang::Global::P);
  const int direction = jit::globalPointer(lang::Global::I);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const VolumeBox& box = boxes[i];
    Corner low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      const RowRange world = rowRange(toWorld, k, corner(box.box.lower), corner(box.box.upper));
      const double slack = world.magnitude * 1e-14;  // The two matrices are each other's inverses in doubles.
      const float lower = below(world.low - slack), upper = above(world.high + slack);
      low[k] = static_cast<double>(lower);
      high[k] = static_cast<double>(upper);
      put(p + static_cast<int>(k), i, lower, upper);
      put(direction + static_cast<int>(k), i, -1.0001f, 1.0001f);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const RowRange object = rowRange(toObject, k, low, high);
      const double slack = object.magnitude * transformError;
      const int axis = static_cast<int>(k);
      put(jit::globalPointerCount + axis, i, below(static_cast<double>(box.box.lower[axis]) - slack),
          above(static_cast<double>(box.box.upper[axis]) + slack));
    }
    put(jit::globalPointer(lang::Global::time), i, box.timeLow, box.timeHigh);
    gatherLine(toWorld, box.box, i);
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

void BoundsBatch::evaluate(KernelHost& host, const Family& family, std::uint32_t instance,
                           std::span<const VolumeBox> boxes, std::span<CoefficientBounds> bounds) {
  assert(family.bounds && bounds.size() == boxes.size());
  const jit::KernelInterface& interface = family.bounds->interface();
  arrays_->reserve(capacity_, interface.outputs.size());
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
    (*family.bounds)(arguments);
    scatter(interface, bounds.subspan(first, count));
  }
}

}  // namespace aerosol::shading
