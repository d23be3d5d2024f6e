// Runs kernels on batches and keeps what they leave.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/jit/compiler.h"

namespace aerosol::jit::test {

/// One record of a kernel, with its values resolved by the site's table.
struct Record {
  std::uint32_t kind = 0;
  int line = 0;
  std::uint32_t lane = 0;
  std::vector<std::uint64_t> values;

  bool operator==(const Record&) const = default;
};

/// n points. Globals not set are zero.
struct Batch {
  std::size_t count = 0;
  std::array<std::vector<float>, globalPointerCount> globals;
  std::vector<std::int32_t> instances;
  std::vector<std::uint32_t> active;  ///< Empty: all.
  std::vector<unsigned char> instanceData;
  std::uint32_t loopBudget = 100000;

  static Batch random(std::size_t count, std::uint64_t seed);
  std::vector<float>& global(lang::Global global, int component = 0) {
    return globals[static_cast<std::size_t>(globalPointer(global) + component)];
  }
  /// The points of these indices, in that order.
  Batch pick(const std::vector<std::size_t>& points) const;
};

struct Outcome {
  std::vector<std::vector<std::uint64_t>> outputs;  ///< By output pointer, then by point: bits. Untouched: `untouched`.
  std::vector<Record> records;                      ///< In the order of the calls.
  AerosolKernelCounters counters{};

  /// The records of one point, in their order; lanes are taken off.
  std::vector<Record> recordsOf(std::size_t point) const;
};
inline constexpr std::uint64_t untouched = 0x7badbadb;

/// Matrices that the host gives for space names, by hash.
using HostSpaces = std::map<std::uint64_t, std::array<float, 16>>;

/// Answers calls of host functions. None by default: kernels that call some need one.
class HostAnswers {
 public:
  /// Leaves a report of a host site about a point: the hash of its text.
  using Report = std::function<void(std::uint32_t site, std::uint32_t point, std::uint64_t text)>;

  virtual ~HostAnswers() = default;
  virtual void begin(const KernelInterface& interface, std::size_t count, Report report) = 0;
  virtual void call(const AerosolHostCall& call) = 0;
};

Outcome run(const Kernel& kernel, const Batch& batch, const HostSpaces& spaces = {}, HostAnswers* answers = nullptr);

/// n boxes of points.
struct Boxes {
  std::size_t count = 0;
  std::array<std::vector<float>, globalPointerCount> low, high;
  std::vector<unsigned char> instanceData;
  std::uint32_t loopBudget = 100000;
};

/// Bounds of one output component over a box. Ints are in doubles, which hold them exactly.
struct Bounds {
  double low = 0, high = 0;
  bool mayBeNan = false;

  bool holds(double value) const { return value != value ? mayBeNan : low <= value && value <= high; }
};

/// Runs a range kernel: bounds by box, then by component of the outputs (floats and ints). No host function reports
/// anything of a box.
std::vector<std::vector<Bounds>> runRange(const Kernel& kernel, const Boxes& boxes, HostAnswers* answers = nullptr);

/// Bits, but one pattern for all NaNs.
std::uint64_t canonical(std::uint64_t bits, lang::BaseType type);

/// Where the build puts the run-time library's bitcode.
std::filesystem::path runtimeFolder();

/// The compiler that tests share; without a cache.
Compiler& compiler();

/// Parameter values by index; empty: the instance gives none.
using Values = std::vector<lang::ConstantValue>;

/// One instance's block: what is not given has its default.
std::vector<unsigned char> instanceBlock(const KernelInterface& interface, const lang::Program& program,
                                         const Values& values, const AerosolInstanceHeader& header = {});

/// All outputs of the program at a width of the host's instruction set (or another).
KernelRequest requestFor(std::shared_ptr<const lang::Program> program, int width, std::optional<Isa> isa = {});
Kernel compileOrFail(const KernelRequest& request);

}  // namespace aerosol::jit::test
