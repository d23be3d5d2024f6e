// Programs to machine code: kernels for one set of outputs, folded parameters and lanes, from the cache where it has
// them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/jit/kernel_interface.h"
#include "core/jit/object_cache.h"
#include "core/jit/target.h"
#include "core/lang/abi.h"
#include "core/lang/program.h"

namespace aerosol::jit {

/// A parameter that has one value in all instances. Empty value: no instance gives one, and the program computes its
/// default (only where the parameter has no constant default).
struct FoldedParameter {
  std::uint32_t parameter = 0;
  lang::ConstantValue value;
};

/// Bounds on what one program may ask for. Beyond them compilation fails with the position of the culprit.
struct Limits {
  std::uint64_t frameBytes = 2u << 20;  ///< Variables of one kernel, at its width.
  std::uint64_t instructions = 200000;  ///< After inlining.

  bool operator==(const Limits&) const = default;
};

/// Everything that decides the code of a kernel.
struct KernelRequest {
  std::shared_ptr<const lang::Program> program;
  /// `hashProgram(*program)`; may be left empty when `program` is set.
  std::string programHash;
  std::vector<lang::Output>
      outputs;  ///< Some of `program->outputs`, in the order wanted. What only others need is dropped.
  std::vector<FoldedParameter> folded;  ///< The others are read from instance blocks.
  bool severalInstances = false;  ///< Blocks are picked per point by `instances`; otherwise all points use block 0.
  Domain domain = Domain::wide;
  bool counters = false;  ///< Keep AerosolKernelCounters.
  bool messages = true;   ///< Leave messages and reports; otherwise they and what only they need are dropped.
  Target target;
  Limits limits;
};

/// Where the time of one compilation went, in seconds.
struct CompileTimes {
  double lowering = 0;
  double linkRuntime = 0;
  double optimisation = 0;
  double codeGeneration = 0;
  double loading = 0;
  bool fromCache = false;
};

namespace detail {
struct LoadedCode;
}

/// A function in memory. Copies share the code, which lives as long as one of them.
class Kernel {
 public:
  Kernel(std::shared_ptr<const detail::LoadedCode> code, AerosolKernel function,
         std::shared_ptr<const KernelInterface> interface, CompileTimes times)
      : code_(std::move(code)), function_(function), interface_(std::move(interface)), times_(times) {}

  AerosolKernel function() const { return function_; }
  void operator()(const AerosolKernelArguments& arguments) const { function_(&arguments); }
  const KernelInterface& interface() const { return *interface_; }
  const CompileTimes& times() const { return times_; }

 private:
  std::shared_ptr<const detail::LoadedCode> code_;
  AerosolKernel function_;
  std::shared_ptr<const KernelInterface> interface_;
  CompileTimes times_;
};

struct CompilerOptions {
  std::filesystem::path
      runtimeFolder;  ///< Holds runtime_wide_<W>.bc and runtime_range_<W>.bc; empty: the installed one.
  std::shared_ptr<ObjectCache> cache;  ///< May be null: nothing is kept.
};

/// Compiles kernels. All functions may be called from many threads at once and run in parallel.
class Compiler {
 public:
  static Result<std::shared_ptr<Compiler>> create(CompilerOptions options);
  ~Compiler();
  Compiler(const Compiler&) = delete;
  Compiler& operator=(const Compiler&) = delete;

  /// From the cache, or compiled and put there. `request.program` must be set.
  Result<Kernel> compile(const KernelRequest& request);

  /// From the cache alone; `request.programHash` is enough, `request.program` may be null.
  std::optional<Kernel> load(const KernelRequest& request);

  /// The optimised IR, or the assembly, of what `compile` would make, as text: for people and tests.
  Result<std::string> intermediateText(const KernelRequest& request);
  Result<std::string> assemblyText(const KernelRequest& request);

 private:
  struct State;
  explicit Compiler(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Identity of a program: equal hashes, equal kernels. Positions and texts of messages count.
std::string hashProgram(const lang::Program& program);

/// "19.1.7"
std::string llvmVersion();

}  // namespace aerosol::jit
