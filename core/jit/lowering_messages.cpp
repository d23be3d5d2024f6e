// Records for the host: messages of the program, and reports of what its code did wrong. Cold code, kept small.
#include <cstddef>

#include "core/base/hash.h"
#include "core/jit/lowering.h"

namespace aerosol::jit {

using lang::Instruction;

llvm::Value* Lowering::hostService(Emitter& emitter, llvm::Value* context, std::size_t offset) {
  llvm::Type* const pointer = emitter.ir.getPtrTy();
  llvm::Value* const services =
      emitter.ir.CreateLoad(pointer, emitter.pointerAt(context, offsetof(AerosolKernelContext, services)));
  return emitter.ir.CreateLoad(pointer, emitter.pointerAt(services, offset));
}

void Lowering::emitMessage(const Instruction& instruction) {
  const lang::Variable& format = program_.variables[instruction.arguments[0]];
  const auto& texts = std::get<std::vector<std::string>>(format.value);
  std::vector<lang::Type> types;
  Value values;
  for (std::size_t i = 1; i < instruction.arguments.size(); ++i) {
    const lang::VariableId argument = instruction.arguments[i];
    types.push_back(program_.variables[argument].type);
    if (!variables_.isArray(argument)) {
      const Value value = variables_.read(argument);
      values.append(value.begin(), value.end());
      continue;
    }
    const ArrayMemory array = variables_.array(argument);
    for (unsigned element = 0; element < array.length; ++element) {
      for (unsigned c = 0; c < array.element.size(); ++c) {
        llvm::Value* const address = e_.pointerAt(array.base, variables_.offsetOf(array, element, c));
        values.push_back(domain_.load(array.element[c], array.varying, address));
      }
    }
  }
  static_assert(static_cast<int>(lang::MessageKind::print) == AEROSOL_MESSAGE_PRINT &&
                static_cast<int>(lang::MessageKind::warning) == AEROSOL_MESSAGE_WARNING &&
                static_cast<int>(lang::MessageKind::error) == AEROSOL_MESSAGE_ERROR &&
                static_cast<int>(lang::MessageKind::file) == AEROSOL_MESSAGE_FILE);
  report(instruction.function, instruction.location, texts.at(0), std::move(types), values, mask().may);
}

/// As the 8 bytes of a record's value, in lanes.
llvm::Value* Lowering::recordValue(const Number& number) {
  llvm::Value* lanes = domain_.varying(number).parts[0];
  if (number.kind == Kind::string) return lanes;
  if (number.kind == Kind::floating) lanes = e_.ir.CreateBitCast(lanes, e_.laneType(Kind::integer));
  return e_.ir.CreateZExt(lanes, e_.laneType(Kind::string));
}

/// Leaves a record for each of the lanes, in their order.
void Lowering::report(std::uint32_t kind, std::uint32_t location, const std::string& text,
                      std::vector<lang::Type> types, const Value& values, llvm::Value* lanes) {
  const bool isReport = kind == AEROSOL_REPORT_INDEX || kind == AEROSOL_REPORT_BUDGET || kind == AEROSOL_REPORT_SPACE;
  if (isReport && !options_.reports) return;
  const auto* known = llvm::dyn_cast<llvm::Constant>(lanes);
  if (known && known->isNullValue()) return;
  const auto site = static_cast<std::uint32_t>(interface_.sites.size());
  interface_.sites.push_back({kind, program_.locations[location], text, std::move(types)});

  llvm::BasicBlock* const leave = e_.block("record");
  llvm::BasicBlock* const end = e_.block("recorded");
  llvm::MDNode* const weights = isReport ? llvm::MDBuilder(e_.context()).createBranchWeights(1, 1u << 30) : nullptr;
  e_.ir.CreateCondBr(e_.any(lanes), leave, end, weights);
  e_.ir.SetInsertPoint(leave);
  // One row of lanes a value, and room for the values of one lane behind them.
  const auto count = static_cast<unsigned>(values.size());
  llvm::Value* const memory = e_.slot(llvm::ArrayType::get(e_.ir.getInt64Ty(), std::uint64_t{count} * (e_.width() + 1)),
                                      "record", e_.laneBytes(Kind::string));
  for (unsigned i = 0; i < count; ++i) {
    llvm::Value* const row = e_.pointerAt(memory, std::uint64_t{i} * e_.laneBytes(Kind::string));
    e_.ir.CreateAlignedStore(recordValue(values[i]), row, llvm::Align(e_.laneBytes(Kind::string)));
  }
  e_.ir.CreateCall(recordFunction(), {frame_.context(), e_.bits(lanes), e_.ir.getInt32(kind), e_.ir.getInt32(site),
                                      frame_.base(), memory, e_.ir.getInt32(count), frame_.list()});
  e_.ir.CreateBr(end);
  e_.ir.SetInsertPoint(end);
}

llvm::Function* Lowering::recordFunction() {
  if (recordFunction_) return recordFunction_;
  llvm::Type* const pointer = e_.ir.getPtrTy();
  llvm::Type* const word = e_.ir.getInt32Ty();
  auto* const type =
      llvm::FunctionType::get(e_.ir.getVoidTy(), {pointer, word, word, word, word, pointer, word, pointer}, false);
  recordFunction_ = llvm::Function::Create(type, llvm::Function::InternalLinkage, "record", e_.module());
  recordFunction_->setDoesNotThrow();
  recordFunction_->addFnAttr(llvm::Attribute::NoInline);
  recordFunction_->addFnAttr(llvm::Attribute::Cold);
  recordFunction_->addFnAttr(llvm::Attribute::WillReturn);
  // The host's table and what the host keeps are nothing that a kernel looks at.
  recordFunction_->setMemoryEffects(llvm::MemoryEffects::inaccessibleOrArgMemOnly());
  fillRecordFunction(*recordFunction_);
  return recordFunction_;
}

/// void record(context, bits, kind, site, base, values, count, list): calls the host for each set bit from the lowest
/// on. The bits' points are those from `base` on, or what the list holds there.
void Lowering::fillRecordFunction(llvm::Function& function) {
  Emitter f(function, e_.target(), e_.library());
  llvm::Value* const context = function.getArg(0);
  llvm::Value* const bits = function.getArg(1);
  llvm::Value* const values = function.getArg(5);
  llvm::Value* const count = function.getArg(6);
  llvm::Type* const word = f.ir.getInt32Ty();
  llvm::Type* const value = f.ir.getInt64Ty();
  llvm::BasicBlock* const entry = f.block("entry");
  llvm::BasicBlock* const lanes = f.block("lanes");
  llvm::BasicBlock* const copy = f.block("copy");
  llvm::BasicBlock* const call = f.block("call");
  llvm::BasicBlock* const exit = f.block("exit");
  const auto at = [&](llvm::Value* index) {
    return f.ir.CreateInBoundsGEP(value, values, f.ir.CreateZExt(index, value));
  };

  f.ir.SetInsertPoint(entry);
  llvm::Value* const row = f.ir.CreateMul(count, f.ir.getInt32(f.width()));
  llvm::Value* const isEmpty = f.ir.CreateICmpEQ(count, f.ir.getInt32(0));
  llvm::Value* const list = function.getArg(7);
  llvm::Value* const unlisted = f.slot(word, "unlisted");
  llvm::Value* const isListed = f.ir.CreateICmpNE(list, f.zero(f.ir.getPtrTy()));
  f.ir.CreateBr(lanes);

  f.ir.SetInsertPoint(lanes);
  llvm::PHINode* const left = f.ir.CreatePHI(word, 2);
  left->addIncoming(bits, entry);
  llvm::Value* const lane = f.ir.CreateBinaryIntrinsic(llvm::Intrinsic::cttz, left, f.ir.getTrue());
  f.ir.CreateCondBr(isEmpty, call, copy);

  f.ir.SetInsertPoint(copy);
  llvm::PHINode* const index = f.ir.CreatePHI(word, 2);
  index->addIncoming(f.ir.getInt32(0), lanes);
  llvm::Value* const source = f.ir.CreateAdd(f.ir.CreateMul(index, f.ir.getInt32(f.width())), lane);
  f.ir.CreateStore(f.ir.CreateLoad(value, at(source)), at(f.ir.CreateAdd(row, index)));
  llvm::Value* const next = f.ir.CreateAdd(index, f.ir.getInt32(1));
  index->addIncoming(next, copy);
  f.ir.CreateCondBr(f.ir.CreateICmpULT(next, count), copy, call);

  f.ir.SetInsertPoint(call);
  auto* const type =
      llvm::FunctionType::get(f.ir.getVoidTy(), {f.ir.getPtrTy(), word, word, word, f.ir.getPtrTy(), word}, false);
  llvm::Value* const service = hostService(f, context, offsetof(AerosolHostServices, record));
  llvm::Value* const place = f.ir.CreateAdd(function.getArg(4), lane);
  f.ir.CreateStore(place, unlisted);
  llvm::Value* const listed = f.ir.CreateGEP(word, list, f.ir.CreateZExt(place, value));
  llvm::Value* const point = f.ir.CreateLoad(word, f.ir.CreateSelect(isListed, listed, unlisted));
  f.ir.CreateCall(type, service, {context, function.getArg(2), function.getArg(3), point, at(row), count})
      ->setDoesNotThrow();
  llvm::Value* const rest = f.ir.CreateAnd(left, f.ir.CreateSub(left, f.ir.getInt32(1)));
  left->addIncoming(rest, call);
  f.ir.CreateCondBr(f.ir.CreateICmpNE(rest, f.ir.getInt32(0)), lanes, exit);

  f.ir.SetInsertPoint(exit);
  f.ir.CreateRetVoid();
}

}  // namespace aerosol::jit
