#include "core/jit/backend.h"

#include <llvm-c/Core.h>
#include <llvm/Analysis/TargetLibraryInfo.h>
#include <llvm/Bitcode/BitcodeReader.h>
#include <llvm/IR/LegacyPassManager.h>
#include <llvm/IR/Verifier.h>
#include <llvm/Linker/Linker.h>
#include <llvm/MC/TargetRegistry.h>
#include <llvm/Passes/PassBuilder.h>
#include <llvm/Support/TargetSelect.h>
#include <llvm/Target/TargetMachine.h>
#include <llvm/Transforms/IPO/GlobalDCE.h>
#include <llvm/Transforms/InstCombine/InstCombine.h>
#include <llvm/Transforms/Scalar/ADCE.h>
#include <llvm/Transforms/Scalar/EarlyCSE.h>
#include <llvm/Transforms/Scalar/GVN.h>
#include <llvm/Transforms/Scalar/IndVarSimplify.h>
#include <llvm/Transforms/Scalar/LICM.h>
#include <llvm/Transforms/Scalar/LoopPassManager.h>
#include <llvm/Transforms/Scalar/LoopRotation.h>
#include <llvm/Transforms/Scalar/LoopUnrollPass.h>
#include <llvm/Transforms/Scalar/SROA.h>
#include <llvm/Transforms/Scalar/SimplifyCFG.h>
#include <llvm/Transforms/Utils/Cloning.h>
#include <llvm/Transforms/Vectorize/LoopVectorize.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "core/jit/exact_products.h"
#include "core/jit/kernel_builder.h"
#include "core/jit/native_code.h"

namespace aerosol::jit {

namespace {

constexpr const char* triple = "x86_64-unknown-linux-gnu";
/// Library functions are inlined where they are called as long as the kernel stays below so many instructions. Their
/// arguments and results then stay in registers, and what is uniform moves out of loops.
constexpr std::size_t inlinedInstructions = 6000;

Diagnostic internalError(const std::string& what) {
  Diagnostic error;
  error.message = "code generation failed: " + what;
  return error;
}

class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

const llvm::Target* findTarget() {
  static const llvm::Target* const target = [] {
    LLVMInitializeX86TargetInfo();
    LLVMInitializeX86Target();
    LLVMInitializeX86TargetMC();
    LLVMInitializeX86AsmPrinter();
    std::string error;
    return llvm::TargetRegistry::lookupTarget(triple, error);
  }();
  return target;
}

std::unique_ptr<llvm::TargetMachine> makeMachine(const Target& target) {
  llvm::TargetOptions options;
  options.AllowFPOpFusion = llvm::FPOpFusion::Strict;
  return std::unique_ptr<llvm::TargetMachine>(
      findTarget()->createTargetMachine(triple, std::string(name(target.isa)), "", options, llvm::Reloc::PIC_,
                                        llvm::CodeModel::Small, llvm::CodeGenOptLevel::Default));
}

/// All functions are compiled for the one target, whatever the library was compiled for.
void setTarget(llvm::Function& function, const Target& target) {
  llvm::AttributeList attributes = function.getAttributes();
  llvm::AttrBuilder keep(function.getContext());
  for (const llvm::Attribute& attribute : attributes.getFnAttrs()) {
    if (!attribute.isStringAttribute()) keep.addAttribute(attribute);
  }
  keep.removeAttribute(llvm::Attribute::UWTable);
  keep.addAttribute(llvm::Attribute::NoUnwind);
  // Signed zeros, denormals and NaNs as IEEE has them; vectors as wide as the lanes are.
  const bool is512 = target.isa == Isa::x86_64_v4 && target.width == 16;
  keep.addAttribute("target-cpu", name(target.isa));
  keep.addAttribute("prefer-vector-width", is512 ? "512" : "256");
  keep.addAttribute("min-legal-vector-width", is512 ? "512" : "256");
  keep.addAttribute("no-builtins");
  attributes = attributes.removeFnAttributes(function.getContext());
  function.setAttributes(attributes.addFnAttributes(function.getContext(), keep));
}

/// Links the library functions that the kernel calls. Gives what went wrong, if anything.
std::string linkRuntime(llvm::Module& module, std::unique_ptr<llvm::Module> library, const Target& target) {
  library->setTargetTriple(module.getTargetTriple());
  library->setDataLayout(module.getDataLayout());
  if (llvm::Linker::linkModules(module, std::move(library), llvm::Linker::LinkOnlyNeeded)) {
    return "the runtime library does not link";
  }
  if (llvm::GlobalVariable* avx512 = module.getNamedGlobal("aerosol_processor_avx512")) {
    const bool isThere = target.isa == Isa::x86_64_v4;
    avx512->setInitializer(llvm::ConstantInt::get(avx512->getValueType(), isThere ? 1 : 0));
    avx512->setConstant(true);
  }
  for (llvm::GlobalVariable& variable : module.globals()) {
    if (!variable.isDeclaration()) variable.setLinkage(llvm::GlobalValue::InternalLinkage);
  }
  for (llvm::Function& function : module) {
    if (function.isIntrinsic()) continue;
    if (function.isDeclaration()) {
      const llvm::StringRef called = function.getName();
      if (called != "memcpy" && called != "memset" && called != "memmove") {
        return "the runtime library has no function " + called.str();
      }
      continue;
    }
    setTarget(function, target);
    if (function.getName() != "kernel") {
      function.setLinkage(llvm::GlobalValue::InternalLinkage);
      function.setVisibility(llvm::GlobalValue::DefaultVisibility);
    }
  }
  return {};
}

/// Inlines library functions into the kernel, in the order of the calls, up to a size.
void inlineRuntime(llvm::Function& kernel) {
  std::size_t size = kernel.getInstructionCount();
  std::vector<llvm::CallBase*> calls;
  const auto collect = [&calls](llvm::BasicBlock& block) {
    for (llvm::Instruction& instruction : block) {
      auto* const call = llvm::dyn_cast<llvm::CallBase>(&instruction);
      const llvm::Function* const callee = call ? call->getCalledFunction() : nullptr;
      if (callee && !callee->isDeclaration() && !callee->hasFnAttribute(llvm::Attribute::NoInline))
        calls.push_back(call);
    }
  };
  for (llvm::BasicBlock& block : kernel) collect(block);
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const llvm::Function& callee = *calls[i]->getCalledFunction();
    const std::size_t added = callee.getInstructionCount();
    const bool always = callee.hasFnAttribute(llvm::Attribute::AlwaysInline);
    if (!always && size + added > inlinedInstructions) continue;
    llvm::InlineFunctionInfo info;
    if (!llvm::InlineFunction(*calls[i], info).isSuccess()) continue;
    size += added;
    for (llvm::CallBase* inner : info.InlinedCallSites) {
      const llvm::Function* const innerCallee = inner->getCalledFunction();
      if (innerCallee && !innerCallee->isDeclaration() && !innerCallee->hasFnAttribute(llvm::Attribute::NoInline)) {
        calls.push_back(inner);
      }
    }
  }
}

/// Loops over the lanes of a plugin's function become vector code: their length is a constant by now.
void addLaneLoops(llvm::FunctionPassManager& passes) {
  llvm::LoopPassManager rotate;
  rotate.addPass(llvm::LoopRotatePass());
  passes.addPass(llvm::createFunctionToLoopPassAdaptor(std::move(rotate)));
  passes.addPass(
      llvm::SimplifyCFGPass(llvm::SimplifyCFGOptions().hoistCommonInsts(true).convertSwitchToLookupTable(true)));
  passes.addPass(llvm::InstCombinePass());
  llvm::LoopPassManager simplify;
  simplify.addPass(llvm::LICMPass(llvm::LICMOptions()));
  simplify.addPass(llvm::IndVarSimplifyPass());
  passes.addPass(llvm::createFunctionToLoopPassAdaptor(std::move(simplify), true));
  passes.addPass(llvm::LoopVectorizePass());
  passes.addPass(llvm::InstCombinePass());
  passes.addPass(llvm::SimplifyCFGPass());
  passes.addPass(
      llvm::LoopUnrollPass(llvm::LoopUnrollOptions(2, false).setPartial(false).setRuntime(false).setPeeling(false)));
  passes.addPass(llvm::SROAPass(llvm::SROAOptions::ModifyCFG));
  passes.addPass(llvm::EarlyCSEPass(true));
  passes.addPass(llvm::SimplifyCFGPass());
}

/// Loops for which that was asked for are written out.
void addUnrolling(llvm::FunctionPassManager& passes) {
  llvm::LoopPassManager rotate;
  rotate.addPass(llvm::LoopRotatePass());
  passes.addPass(llvm::createFunctionToLoopPassAdaptor(std::move(rotate)));
  passes.addPass(llvm::LoopUnrollPass(llvm::LoopUnrollOptions(2, true)));
  passes.addPass(llvm::EarlyCSEPass(true));
}

void optimise(llvm::Module& module, llvm::TargetMachine& machine, bool hasNatives) {
  llvm::LoopAnalysisManager loops;
  llvm::FunctionAnalysisManager functions;
  llvm::CGSCCAnalysisManager components;
  llvm::ModuleAnalysisManager modules;
  llvm::PassBuilder builder(&machine);
  builder.registerModuleAnalyses(modules);
  builder.registerCGSCCAnalyses(components);
  builder.registerFunctionAnalyses(functions);
  builder.registerLoopAnalyses(loops);
  builder.crossRegisterProxies(loops, functions, components, modules);

  llvm::Function& kernel = *module.getFunction("kernel");
  llvm::FunctionPassManager before;
  before.addPass(llvm::SROAPass(llvm::SROAOptions::ModifyCFG));
  before.addPass(llvm::EarlyCSEPass());
  before.addPass(llvm::SimplifyCFGPass());
  before.run(kernel, functions);
  functions.invalidate(kernel, llvm::PreservedAnalyses::none());

  inlineRuntime(kernel);
  functions.invalidate(kernel, llvm::PreservedAnalyses::none());

  llvm::ModulePassManager pipeline;
  pipeline.addPass(llvm::GlobalDCEPass());
  llvm::FunctionPassManager after;
  after.addPass(llvm::SROAPass(llvm::SROAOptions::ModifyCFG));
  after.addPass(llvm::EarlyCSEPass(true));
  after.addPass(llvm::SimplifyCFGPass());
  after.addPass(llvm::InstCombinePass());
  if (hasNatives) addLaneLoops(after);
  addUnrolling(after);
  llvm::LoopPassManager hoist;
  hoist.addPass(llvm::LICMPass(llvm::LICMOptions()));
  after.addPass(llvm::createFunctionToLoopPassAdaptor(std::move(hoist), true));
  after.addPass(llvm::GVNPass());
  after.addPass(llvm::InstCombinePass());
  after.addPass(llvm::ADCEPass());
  after.addPass(llvm::SimplifyCFGPass());
  pipeline.addPass(llvm::createModuleToFunctionPassAdaptor(std::move(after)));
  pipeline.addPass(llvm::GlobalDCEPass());
  pipeline.run(module, modules);
  for (llvm::Function& function : module) fuseExactProducts(function);
}

std::string emitMachineCode(llvm::Module& module, llvm::TargetMachine& machine, CodeForm form) {
  llvm::SmallVector<char, 0> bytes;
  llvm::raw_svector_ostream stream(bytes);
  llvm::legacy::PassManager passes;
  const auto type =
      form == CodeForm::assembly ? llvm::CodeGenFileType::AssemblyFile : llvm::CodeGenFileType::ObjectFile;
  if (machine.addPassesToEmitFile(passes, stream, nullptr, type, true)) return {};
  passes.run(module);
  return std::string(bytes.begin(), bytes.end());
}

}  // namespace

Result<GeneratedCode> generateCode(const KernelRequest& request, std::string_view runtime, CodeForm form) {
  Stopwatch watch;
  GeneratedCode result;
  if (!findTarget()) return internalError("LLVM has no target " + std::string(triple));
  const std::unique_ptr<llvm::TargetMachine> machine = makeMachine(request.target);
  llvm::LLVMContext context;
  llvm::Module module("kernel", context);
  module.setTargetTriple(triple);
  module.setDataLayout(machine->createDataLayout());
  module.setPICLevel(llvm::PICLevel::BigPIC);
  llvm::Expected<std::unique_ptr<llvm::Module>> library =
      llvm::getLazyBitcodeModule(llvm::MemoryBufferRef(runtime, "runtime"), context, true);
  if (!library) return internalError(llvm::toString(library.takeError()));
  Result<KernelInterface> interface = buildKernel(module, request, **library);
  if (!interface) return interface.errors();
  result.times.lowering = watch.lap();

  const bool hasNatives = std::ranges::any_of(
      request.program->functions, [](const lang::FunctionUse& use) { return use.native && use.native->bitcode; });
  if (hasNatives) {
    if (const std::string problem = linkNatives(module, *request.program); !problem.empty())
      return internalError(problem);
  }
  if (const std::string problem = linkRuntime(module, std::move(*library), request.target); !problem.empty()) {
    return internalError(problem);
  }
  result.times.linkRuntime = watch.lap();
  std::string broken;
  llvm::raw_string_ostream brokenStream(broken);
  if (llvm::verifyModule(module, &brokenStream)) return internalError(brokenStream.str());

  optimise(module, *machine, hasNatives);
  result.times.optimisation = watch.lap();
  result.interface = std::move(*interface);
  readInterface(*module.getFunction("kernel"), result.interface);
  if (form == CodeForm::intermediate) {
    llvm::raw_string_ostream stream(result.code);
    module.print(stream, nullptr);
    return result;
  }
  result.code = emitMachineCode(module, *machine, form);
  result.times.codeGeneration = watch.lap();
  if (result.code.empty()) return internalError("LLVM cannot write objects for " + std::string(triple));
  return result;
}

std::string llvmVersion() {
  unsigned major = 0, minor = 0, patch = 0;
  LLVMGetVersion(&major, &minor, &patch);
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace aerosol::jit
