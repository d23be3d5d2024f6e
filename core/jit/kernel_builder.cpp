#include "core/jit/kernel_builder.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>

#include "core/base/hash.h"
#include "core/jit/lowering.h"
#include "core/jit/spaces.h"
#include "core/lang/analysis.h"
#include "core/lang/derivatives.h"
#include "core/lang/uniformity.h"

namespace aerosol::jit {

using lang::Program;
using lang::Storage;
using lang::VariableId;

namespace {

unsigned alignUp(unsigned value, unsigned alignment) { return (value + alignment - 1) / alignment * alignment; }

/// Instance blocks: the header, then every parameter that is not folded, in the program's order.
void layOutInstances(const KernelRequest& request, KernelInterface& interface) {
  unsigned offset = sizeof(AerosolInstanceHeader);
  const auto add = [&](std::uint32_t parameter, bool isSetFlag, const lang::Type& type) {
    const llvm::SmallVector<Kind, 4> kinds = kindsOf(type);
    if (kinds.empty()) return;
    const unsigned bytes = kinds[0] == Kind::string ? 8 : 4;
    offset = alignUp(offset, bytes);
    interface.fields.push_back({parameter, isSetFlag, offset, type});
    offset += bytes * static_cast<unsigned>(kinds.size()) * static_cast<unsigned>(std::max(type.arrayLength, 1));
  };
  const std::vector<lang::Parameter>& parameters = request.program->parameters;
  for (std::uint32_t i = 0; i < parameters.size(); ++i) {
    const bool isFolded = std::any_of(request.folded.begin(), request.folded.end(),
                                      [i](const FoldedParameter& folded) { return folded.parameter == i; });
    if (isFolded) continue;
    add(i, false, parameters[i].type);
    if (!parameters[i].hasConstantDefault) add(i, true, lang::types::integer);
  }
  interface.instanceStride = alignUp(offset, 16);
}

/// The program with the folded parameters in place, cut down to the outputs.
Program prepare(const KernelRequest& request) {
  lang::ParameterValues values;
  for (const FoldedParameter& folded : request.folded) values[folded.parameter] = folded.value;
  const bool keepsMessages = request.messages && request.domain == Domain::wide;
  // Outputs keep their places, but may name other variables once the program is specialised.
  Program special = lang::specialise(*request.program, values);
  std::vector<lang::Output> outputs = request.outputs;
  for (lang::Output& output : outputs) {
    for (std::size_t i = 0; i < request.program->outputs.size(); ++i) {
      const lang::Output& original = request.program->outputs[i];
      if (original.kind == output.kind && original.index == output.index && original.subIndex == output.subIndex) {
        output = special.outputs[i];
      }
    }
  }
  const lang::Messages messages = keepsMessages ? lang::Messages::keep : lang::Messages::drop;
  Program needed = lang::slice(special, outputs, messages);
  if (lang::dropVoxelFootprints(needed)) needed = lang::slice(needed, needed.outputs, messages);
  if (!lang::readsDerivatives(needed)) return needed;
  const Program expanded = lang::expandDerivatives(std::move(needed));
  return lang::slice(expanded, expanded.outputs, messages);
}

std::optional<Diagnostic> checkLimits(const Program& program, const KernelRequest& request) {
  const std::size_t instructions = [&] {
    std::size_t count = 0;
    lang::forEachInstruction(program.body, [&](const lang::Instruction&) { ++count; });
    return count;
  }();
  if (instructions > request.limits.instructions) {
    Diagnostic error;
    if (!program.locations.empty()) error.location = program.locations.front();
    error.message =
        "the shader is too large: " + std::to_string(instructions) + " instructions with all functions inlined";
    error.notes.push_back("at most " + std::to_string(request.limits.instructions) + " are allowed");
    return error;
  }
  const std::uint64_t parts = request.domain == Domain::range ? 8 : 1;
  std::uint64_t bytes = 0;
  for (const lang::Variable& variable : program.variables) {
    if (variable.storage == Storage::constant || variable.storage == Storage::temporary) continue;
    std::uint64_t size = 0;
    for (const Kind kind : kindsOf(variable.type)) size += kind == Kind::string ? 8 : 4;
    bytes += size * parts * static_cast<std::uint64_t>(std::max(variable.type.arrayLength, 1)) *
             static_cast<std::uint64_t>(request.target.width);
    if (bytes <= request.limits.frameBytes) continue;
    Diagnostic error;
    error.location = program.locations.at(variable.location);
    error.message = "the variables of this shader take too much room: with '" + variable.name + "' " +
                    std::to_string(bytes) + " bytes at " + std::to_string(request.target.width) + " lanes";
    error.notes.push_back("at most " + std::to_string(request.limits.frameBytes) + " are allowed");
    return error;
  }
  return {};
}

void collectStrings(const Program& program, KernelInterface& interface) {
  const auto add = [&](const lang::ConstantValue& value) {
    const auto* texts = std::get_if<std::vector<std::string>>(&value);
    if (!texts) return;
    for (const std::string& text : *texts) interface.strings.emplace(hashString(text), text);
  };
  for (const lang::Variable& variable : program.variables) add(variable.value);
}

lang::Uniformity::Inputs uniformityInputs(const Program& program, const KernelInterface& interface,
                                          const KernelRequest& request) {
  lang::Uniformity::Inputs inputs;
  inputs.startsVarying = [&](VariableId id) {
    const lang::Variable& variable = program.variables[id];
    if (variable.storage == Storage::global) return globalComponents(variable.global) > 0;
    if (variable.storage != Storage::parameter || !request.severalInstances) return false;
    return std::any_of(interface.fields.begin(), interface.fields.end(),
                       [&](const InstanceField& field) { return field.parameter == variable.parameter; });
  };
  inputs.callVaries = [&](const lang::Instruction& instruction) {
    const lang::FunctionUse& function = program.functions[instruction.function];
    // Over boxes the results of a host function are not known, whatever its arguments are.
    if (function.host) return request.domain == Domain::range || !function.dependsOnArgumentsAlone();
    if (function.symbol != "getmatrix_i_ssm") return false;
    return spacesVary(program, instruction, request.severalInstances);
  };
  return inputs;
}

class OutputWriter {
 public:
  OutputWriter(Emitter& emitter, NumberDomain& domain, KernelFrame& frame, Variables& variables,
               KernelInterface& interface, llvm::Value* lanes)
      : e_(emitter), domain_(domain), frame_(frame), variables_(variables), interface_(interface), lanes_(lanes) {}

  void write(const lang::Output& asked, VariableId variable) {
    if (!variables_.isArray(variable)) {
      const Value value = variables_.read(variable);
      for (unsigned i = 0; i < value.size(); ++i) write(asked, i, value[i]);
      return;
    }
    const ArrayMemory array = variables_.array(variable);
    const auto components = static_cast<unsigned>(array.element.size());
    for (unsigned i = 0; i < array.length * components; ++i) {
      const std::uint64_t offset = variables_.offsetOf(array, i / components, i % components);
      write(asked, i, domain_.load(array.element[i % components], array.varying, e_.pointerAt(array.base, offset)));
    }
  }

 private:
  void write(const lang::Output& asked, unsigned component, const Number& number) {
    constexpr std::array rangeParts = {OutputPart::low, OutputPart::high, OutputPart::mayBeNan};
    constexpr std::array stringParts = {OutputPart::value, OutputPart::unknown};
    const Number lanes = domain_.varying(number);
    const unsigned parts = std::min<unsigned>(domain_.partCount(number.kind), rangeParts.size());
    for (unsigned part = 0; part < parts; ++part) {
      const auto type = number.kind == Kind::floating  ? lang::BaseType::floating
                        : number.kind == Kind::integer ? lang::BaseType::integer
                                                       : lang::BaseType::string;
      const bool isPlain = parts == 1 || number.kind == Kind::string;
      const OutputPart what = isPlain ? stringParts[part] : rangeParts[part];
      frame_.storeOutput(static_cast<unsigned>(interface_.outputs.size()), lanes.parts[part], lanes_);
      interface_.outputs.push_back({asked.kind, asked.index, asked.subIndex, component, type, what});
    }
  }

  Emitter& e_;
  NumberDomain& domain_;
  KernelFrame& frame_;
  Variables& variables_;
  KernelInterface& interface_;
  llvm::Value* lanes_;
};

/// Emits a kernel's loops over its points.
class KernelLoops {
 public:
  KernelLoops(Emitter& emitter, NumberDomain& domain, const Program& program, const lang::Uniformity& uniformity,
              const KernelRequest& request, KernelInterface& interface)
      : e_(emitter),
        domain_(domain),
        program_(program),
        uniformity_(uniformity),
        request_(request),
        interface_(interface),
        options_{request.counters, request.messages && request.domain == Domain::wide, {}},
        entryEnd_(beginEntry(emitter)) {}

  void emitPlain() {
    KernelFrame frame = makeFrame(interface_);
    emitLoop(frame, {e_.ir.getInt32(0), frame.count()}, interface_, options_);
    e_.ir.CreateRetVoid();
  }

  /// Blocks of points, each in two loops: the first settles the points that do not come to the dear part and lists the
  /// others, the second runs those of the list.
  void emitPacked(const DearPart& dearPart) {
    llvm::Type* const word = e_.ir.getInt32Ty();
    llvm::AllocaInst* const list = e_.slot(llvm::ArrayType::get(word, blockPoints), "list", 64);
    llvm::AllocaInst* const listed = e_.slot(word, "listed");
    KernelInterface unused = interface_;
    KernelFrame first = makeFrame(unused);
    KernelFrame second = makeFrame(interface_);
    llvm::BasicBlock* const before = e_.ir.GetInsertBlock();
    llvm::BasicBlock* const block = e_.block("block");
    llvm::BasicBlock* const exit = e_.block("blocks.end");
    llvm::Value* const count = first.count();
    e_.ir.CreateCondBr(e_.ir.CreateICmpSGT(count, e_.ir.getInt32(0)), block, exit);

    e_.ir.SetInsertPoint(block);
    llvm::PHINode* const begin = e_.ir.CreatePHI(word, 2, "block.begin");
    begin->addIncoming(e_.ir.getInt32(0), before);
    llvm::Value* const size =
        e_.ir.CreateBinaryIntrinsic(llvm::Intrinsic::umin, e_.ir.CreateSub(count, begin), e_.ir.getInt32(blockPoints));
    llvm::Value* const end = e_.ir.CreateAdd(begin, size);
    e_.ir.CreateStore(e_.ir.getInt32(0), listed);
    LoweringOptions settling = options_;
    settling.leftOut = dearPart;
    settling.reports = false;
    emitLoop(first, {begin, end}, unused, settling, [&](llvm::Value* stopped) { first.append(stopped, list, listed); });
    emitLoop(second, {e_.ir.getInt32(0), e_.ir.CreateLoad(word, listed), list}, interface_, options_);
    begin->addIncoming(end, e_.ir.GetInsertBlock());
    e_.ir.CreateCondBr(e_.ir.CreateICmpSLT(end, count), block, exit);
    e_.ir.SetInsertPoint(exit);
    e_.ir.CreateRetVoid();
  }

 private:
  static constexpr unsigned blockPoints = 1024;

  KernelFrame makeFrame(const KernelInterface& interface) {
    return {e_, domain_, interface, request_.severalInstances, entryEnd_};
  }

  void emitLoop(KernelFrame& frame, const PointRange& points, KernelInterface& interface,
                const LoweringOptions& options, const std::function<void(llvm::Value*)>& handleStopped = {}) {
    frame.begin(points);
    Variables variables(e_, domain_, frame, interface, program_, uniformity_);
    Lowering lowering(e_, domain_, frame, variables, program_, uniformity_, interface, options);
    lowering.run();
    llvm::Value* const stopped = lowering.stopped();
    OutputWriter writer(e_, domain_, frame, variables, interface, e_.without(frame.active().may, stopped));
    for (const lang::Output& output : program_.outputs) writer.write(output, output.variable);
    if (handleStopped) handleStopped(stopped);
    frame.end();
  }

  Emitter& e_;
  NumberDomain& domain_;
  const Program& program_;
  const lang::Uniformity& uniformity_;
  const KernelRequest& request_;
  KernelInterface& interface_;
  LoweringOptions options_;
  llvm::Instruction* entryEnd_;
};

}  // namespace

Result<KernelInterface> buildKernel(llvm::Module& module, const KernelRequest& request, const llvm::Module& library) {
  const Program program = prepare(request);
  if (auto error = checkLimits(program, request)) return std::move(*error);
  KernelInterface interface;
  interface.domain = request.domain;
  interface.width = request.target.width;
  interface.closureSites = request.program->closureSites;
  interface.staticCost = Cost(program).of(program.body);
  layOutInstances(request, interface);
  collectStrings(program, interface);
  for (const FoldedParameter& folded : request.folded) {
    if (const auto* texts = std::get_if<std::vector<std::string>>(&folded.value)) {
      for (const std::string& text : *texts) interface.strings.emplace(hashString(text), text);
    }
  }

  const lang::Uniformity::Inputs inputs = uniformityInputs(program, interface, request);
  const lang::Uniformity uniformity(program, program.body, inputs);
  Emitter emitter(*declareKernel(module), request.target, library);
  const std::unique_ptr<NumberDomain> domain =
      request.domain == Domain::range ? makeRangeDomain(emitter) : makeWideDomain(emitter);
  KernelLoops loops(emitter, *domain, program, uniformity, request, interface);
  const bool mayPack = request.domain == Domain::wide && request.target.width > 1;
  const std::optional<DearPart> dearPart = mayPack ? findDearPart(program, uniformity) : std::nullopt;
  dearPart ? loops.emitPacked(*dearPart) : loops.emitPlain();
  return interface;
}

void readInterface(const llvm::Function& kernel, KernelInterface& interface) {
  const llvm::DataLayout& layout = kernel.getParent()->getDataLayout();
  const auto offsetFrom = [&](const llvm::Value* pointer, const llvm::Value*& base) {
    llvm::APInt offset(64, 0);
    base = pointer->stripAndAccumulateConstantOffsets(layout, offset, true);
    return offset.getZExtValue();
  };
  const llvm::Value* globals = nullptr;
  std::vector<const llvm::LoadInst*> loads;
  for (const llvm::BasicBlock& block : kernel) {
    for (const llvm::Instruction& instruction : block) {
      const auto* load = llvm::dyn_cast<llvm::LoadInst>(&instruction);
      if (!load) continue;
      loads.push_back(load);
      const llvm::Value* base = nullptr;
      const std::uint64_t offset = offsetFrom(load->getPointerOperand(), base);
      if (base != kernel.getArg(0)) continue;
      if (offset == offsetof(AerosolKernelArguments, globals)) globals = load;
      if (offset == offsetof(AerosolKernelArguments, instances)) interface.readsInstances = true;
      if (offset == offsetof(AerosolKernelArguments, instanceData)) interface.readsInstanceData = true;
    }
  }
  const std::uint64_t pointers = interface.domain == Domain::range ? 2 : 1;
  for (const llvm::LoadInst* load : loads) {
    const llvm::Value* base = nullptr;
    const std::uint64_t offset = offsetFrom(load->getPointerOperand(), base);
    if (!globals || base != globals) continue;
    const std::uint64_t component = offset / (sizeof(void*) * pointers);
    // What lies behind the globals of a range kernel is P in another form.
    interface.globalsRead |= component < globalPointerCount ? std::uint64_t{1} << component : 7u;
  }
}

}  // namespace aerosol::jit
