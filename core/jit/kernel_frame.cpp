#include "core/jit/kernel_frame.h"

#include <algorithm>
#include <cstddef>

#include "core/lang/abi.h"

namespace aerosol::jit {

llvm::SmallVector<Kind, 4> kindsOf(const lang::Type& type) {
  if (type.closure) return {};
  switch (type.base) {
    case lang::BaseType::integer:
      return {Kind::integer};
    case lang::BaseType::floating:
      return {Kind::floating};
    case lang::BaseType::string:
      return {Kind::string};
    case lang::BaseType::matrix:
      return llvm::SmallVector<Kind, 4>(16, Kind::floating);
    case lang::BaseType::color:
    case lang::BaseType::point:
    case lang::BaseType::vector:
    case lang::BaseType::normal:
      return {Kind::floating, Kind::floating, Kind::floating};
    default:
      return {};
  }
}

llvm::Function* declareKernel(llvm::Module& module) {
  llvm::LLVMContext& context = module.getContext();
  llvm::Type* const pointer = llvm::PointerType::getUnqual(context);
  auto* const type = llvm::FunctionType::get(llvm::Type::getVoidTy(context), {pointer}, false);
  auto* const function = llvm::Function::Create(type, llvm::Function::ExternalLinkage, "kernel", module);
  function->setDoesNotThrow();
  function->addParamAttr(0, llvm::Attribute::NoAlias);
  function->addParamAttr(0, llvm::Attribute::ReadOnly);
  function->addParamAttr(0, llvm::Attribute::getWithDereferenceableBytes(context, sizeof(AerosolKernelArguments)));
  function->addParamAttr(0, llvm::Attribute::getWithAlignment(context, llvm::Align(alignof(AerosolKernelArguments))));
  return function;
}

llvm::Instruction* beginEntry(Emitter& emitter) {
  emitter.ir.SetInsertPoint(emitter.block("entry"));
  llvm::BasicBlock* const start = emitter.block("start");
  llvm::Instruction* const end = emitter.ir.CreateBr(start);
  emitter.ir.SetInsertPoint(start);
  return end;
}

KernelFrame::KernelFrame(Emitter& emitter, NumberDomain& domain, const KernelInterface& interface,
                         bool severalInstances, llvm::Instruction* entryEnd)
    : e_(emitter),
      domain_(domain),
      interface_(interface),
      severalInstances_(severalInstances),
      entryEnd_(entryEnd),
      arguments_(emitter.function().getArg(0)) {
  atEntry([&] {
    count_ = argument(offsetof(AerosolKernelArguments, count), e_.ir.getInt32Ty());
    context_ = argument(offsetof(AerosolKernelArguments, context), e_.ir.getPtrTy());
  });
}

llvm::Value* KernelFrame::argument(unsigned offset, llvm::Type* type) {
  llvm::LoadInst* const load = e_.ir.CreateLoad(type, e_.pointerAt(arguments_, offset));
  load->setMetadata(llvm::LLVMContext::MD_invariant_load, llvm::MDNode::get(e_.context(), {}));
  return load;
}

void KernelFrame::begin(const PointRange& points) {
  llvm::BasicBlock* const before = e_.ir.GetInsertBlock();
  chunk_ = e_.block("chunk");
  llvm::BasicBlock* const chunkStart = e_.block("chunk.start");
  latch_ = llvm::BasicBlock::Create(e_.context(), "chunk.next");
  exit_ = llvm::BasicBlock::Create(e_.context(), "exit");
  last_ = points.end;
  list_ = points.list;
  e_.ir.CreateCondBr(e_.ir.CreateICmpSLT(points.first, points.end), chunk_, exit_);

  e_.ir.SetInsertPoint(chunk_);
  base_ = e_.ir.CreatePHI(e_.ir.getInt32Ty(), 2, "base");
  base_->addIncoming(points.first, before);
  llvm::Value* const inside = lanesBefore(points.end);
  auto* const places = e_.ir.CreateAdd(e_.splat(static_cast<llvm::Value*>(base_)), e_.laneNumbers());
  llvm::Value* lanes = inside;
  if (list_) {
    llvm::Value* const offset = e_.ir.CreateShl(e_.ir.CreateZExt(base_, e_.ir.getInt64Ty()), 2);
    llvm::Value* const listed = e_.loadAt(e_.laneType(Kind::integer), list_, offset, e_.laneBytes(Kind::integer));
    indices_ = e_.ir.CreateSelect(inside, listed, e_.zero(listed->getType()));
    e_.ir.CreateBr(chunkStart);
    e_.ir.SetInsertPoint(chunkStart);
  } else {
    indices_ = places;
    lanes = lanesWithFlag(inside, chunkStart);
  }
  active_ = {lanes, lanes};
  llvm::BasicBlock* const body = e_.block("body");
  chunkStartEnd_ = e_.ir.CreateBr(body);
  e_.ir.SetInsertPoint(body);
}

/// Lanes whose points come before the end: whole numbers of a scalar, which has room beside the work on lanes.
llvm::Value* KernelFrame::lanesBefore(llvm::Value* end) {
  llvm::Value* const left = e_.ir.CreateSub(end, base_);
  if (e_.width() == 1) return e_.ir.CreateICmpNE(left, e_.ir.getInt32(0));
  llvm::Value* const some = e_.ir.CreateSub(e_.ir.CreateShl(e_.ir.getInt32(1), left), e_.ir.getInt32(1));
  llvm::Value* const isWhole = e_.ir.CreateICmpUGE(left, e_.ir.getInt32(e_.width()));
  llvm::Value* const bits = e_.ir.CreateSelect(isWhole, e_.ir.getInt32((1u << e_.width()) - 1), some);
  return e_.ir.CreateBitCast(e_.ir.CreateTrunc(bits, e_.ir.getIntNTy(e_.width())), e_.maskType());
}

/// Where there are flags, lanes whose flag is set; a chunk without any is left out. Goes on in `start`.
llvm::Value* KernelFrame::lanesWithFlag(llvm::Value* inside, llvm::BasicBlock* start) {
  const auto [flags, isGiven] = atEntry([&] {
    llvm::Value* const given = argument(offsetof(AerosolKernelArguments, active), e_.ir.getPtrTy());
    return std::pair(given, e_.ir.CreateICmpNE(given, e_.zero(e_.ir.getPtrTy())));
  });
  llvm::BasicBlock* const before = e_.ir.GetInsertBlock();
  llvm::BasicBlock* const flagged = llvm::BasicBlock::Create(e_.context(), "chunk.flags", &e_.function(), start);
  e_.ir.CreateCondBr(isGiven, flagged, start);
  e_.ir.SetInsertPoint(flagged);
  llvm::Value* const offset = e_.ir.CreateShl(e_.ir.CreateZExt(base_, e_.ir.getInt64Ty()), 2);
  llvm::Value* const flag = e_.loadAt(e_.laneType(Kind::integer), flags, offset, e_.laneBytes(Kind::integer));
  llvm::Value* const set = e_.both(inside, e_.ir.CreateICmpNE(flag, e_.zero(flag->getType())));
  e_.ir.CreateCondBr(e_.any(set), start, latch_);
  e_.ir.SetInsertPoint(start);
  llvm::PHINode* const lanes = e_.ir.CreatePHI(inside->getType(), 2);
  lanes->addIncoming(inside, before);
  lanes->addIncoming(set, flagged);
  return lanes;
}

void KernelFrame::end() {
  e_.ir.CreateBr(latch_);
  latch_->insertInto(&e_.function());
  exit_->insertInto(&e_.function());
  e_.ir.SetInsertPoint(latch_);
  llvm::Value* const next = e_.ir.CreateNUWAdd(base_, e_.ir.getInt32(e_.width()));
  base_->addIncoming(next, latch_);
  llvm::BasicBlock* const finish = llvm::BasicBlock::Create(e_.context(), "finish", &e_.function(), exit_);
  e_.ir.CreateCondBr(e_.ir.CreateICmpULT(next, last_), chunk_, finish);
  e_.ir.SetInsertPoint(finish);
  flushCounters();
  e_.ir.CreateBr(exit_);
  e_.ir.SetInsertPoint(exit_);
}

void KernelFrame::append(llvm::Value* lanes, llvm::Value* array, llvm::AllocaInst* place) {
  llvm::Value* const old = e_.ir.CreateLoad(e_.ir.getInt32Ty(), place);
  llvm::Value* const address = e_.ir.CreateInBoundsGEP(e_.ir.getInt32Ty(), array, old);
  e_.ir.CreateMaskedCompressStore(indices_, address, lanes);
  llvm::Value* const added = e_.ir.CreateUnaryIntrinsic(llvm::Intrinsic::ctpop, e_.bits(lanes));
  e_.ir.CreateStore(e_.ir.CreateAdd(old, added), place);
}

llvm::Value* KernelFrame::loopBudget() {
  if (!loopBudget_) {
    loopBudget_ = atEntry([&] {
      return e_.ir.CreateLoad(e_.ir.getInt32Ty(), e_.pointerAt(context_, offsetof(AerosolKernelContext, loopBudget)));
    });
  }
  return loopBudget_;
}

/// Of each lane's element in an array of points.
llvm::Value* KernelFrame::pointAddresses(llvm::Value* pointer, unsigned bytes) {
  llvm::Value* const indices = e_.ir.CreateZExt(indices_, e_.laneType(e_.ir.getInt64Ty()));
  return e_.ir.CreateInBoundsGEP(e_.ir.getIntNTy(bytes * 8), pointer, indices);
}

/// The chunk's lanes of an array of points.
llvm::Value* KernelFrame::lanesAt(llvm::Value* pointer, llvm::Type* type, unsigned bytes) {
  if (list_) {
    return e_.ir.CreateMaskedGather(type, pointAddresses(pointer, bytes), llvm::Align(bytes), active_.may,
                                    e_.zero(type));
  }
  llvm::Value* const offset = e_.ir.CreateMul(e_.ir.CreateZExt(base_, e_.ir.getInt64Ty()), e_.ir.getInt64(bytes));
  return e_.loadAt(type, pointer, offset, bytes * e_.width());
}

Number KernelFrame::global(unsigned component) {
  const auto [it, isNew] = globalNumbers_.insert({component, {}});
  if (!isNew) return it->second;
  if (!globals_) {
    globals_ = atEntry([&] { return argument(offsetof(AerosolKernelArguments, globals), e_.ir.getPtrTy()); });
  }
  const auto input = [&](std::size_t pointer) {
    llvm::Value* const array =
        atEntry([&] { return e_.ir.CreateLoad(e_.ir.getPtrTy(), e_.pointerAt(globals_, sizeof(void*) * pointer)); });
    return atChunkStart([&] { return lanesAt(array, e_.laneType(Kind::floating), 4); });
  };
  if (!domain_.splitsMasks()) return it->second = {Kind::floating, true, {input(component)}};
  // Bounds come as two pointers, low and high, and those of P with their line over the box.
  llvm::Value* const low = input(2 * std::size_t{component});
  llvm::Value* const high = input(2 * std::size_t{component} + 1);
  const auto point = static_cast<unsigned>(globalPointer(lang::Global::P));
  if (component < point || component >= point + 3) {
    return it->second = atChunkStart([&] { return domain_.between(low, high); });
  }
  Number number{Kind::floating, true, {low, high, e_.zero(domain_.partType(Kind::floating, 2))}};
  for (std::size_t part = 0; part < rangeLineParts; ++part) {
    number.parts[3 + part] = input(rangeLineStart + (component - point) * rangeLineParts + part);
  }
  return it->second = number;
}

void KernelFrame::prepareInstances() {
  if (!instanceData_) {
    instanceData_ = atEntry([&] { return argument(offsetof(AerosolKernelArguments, instanceData), e_.ir.getPtrTy()); });
  }
  if (!severalInstances_ || instances_) return;
  llvm::Value* const pointer =
      atEntry([&] { return argument(offsetof(AerosolKernelArguments, instances), e_.ir.getPtrTy()); });
  llvm::IRBuilder<>::InsertPointGuard guard(e_.ir);
  e_.ir.SetInsertPoint(chunkStartEnd_);
  llvm::Value* const given = lanesAt(pointer, e_.laneType(Kind::integer), 4);
  instances_ = e_.ir.CreateSelect(active_.may, given, e_.zero(given->getType()));
  llvm::Value* const first =
      instanceOf(e_.ir.CreateBinaryIntrinsic(llvm::Intrinsic::cttz, e_.bits(active_.may), e_.ir.getTrue()));
  llvm::Value* const stride = e_.ir.getInt64(interface_.instanceStride);
  llvm::Value* const firstOffset = e_.ir.CreateMul(e_.ir.CreateZExt(first, e_.ir.getInt64Ty()), stride);
  firstInstance_ = e_.ir.CreateInBoundsGEP(e_.ir.getInt8Ty(), instanceData_, firstOffset);
  if (e_.width() == 1) return;
  llvm::Type* const longs = e_.laneType(e_.ir.getInt64Ty());
  blockOffsets_ = e_.ir.CreateMul(e_.ir.CreateZExt(instances_, longs), e_.splat(stride));
  llvm::Value* const others = e_.both(active_.may, e_.ir.CreateICmpNE(instances_, e_.splat(first)));
  llvm::Value* const isMixed = e_.any(others);

  llvm::BasicBlock* const start = chunkStartEnd_->getParent();
  llvm::BasicBlock* const body = chunkStartEnd_->getSuccessor(0);
  llvm::BasicBlock* const same = llvm::BasicBlock::Create(e_.context(), "instance.same", &e_.function(), body);
  llvm::BasicBlock* const mixed = llvm::BasicBlock::Create(e_.context(), "instance.mixed", &e_.function(), body);
  joined_ = llvm::BasicBlock::Create(e_.context(), "instance.joined", &e_.function(), body);
  chunkStartEnd_->eraseFromParent();
  e_.ir.SetInsertPoint(start);
  e_.ir.CreateCondBr(isMixed, mixed, same);
  e_.ir.SetInsertPoint(same);
  sameEnd_ = e_.ir.CreateBr(joined_);
  e_.ir.SetInsertPoint(mixed);
  mixedEnd_ = e_.ir.CreateBr(joined_);
  e_.ir.SetInsertPoint(joined_);
  chunkStartEnd_ = e_.ir.CreateBr(body);
}

llvm::Value* KernelFrame::instanceOf(llvm::Value* lane) {
  if (!severalInstances_) return e_.ir.getInt32(0);
  prepareInstances();
  return e_.width() == 1 ? instances_ : e_.ir.CreateExtractElement(instances_, lane);
}

Number KernelFrame::instanceNumber(Kind kind, unsigned offset) {
  const auto [it, isNew] = instanceNumbers_.insert({{offset, kind}, {}});
  if (!isNew) return it->second;
  prepareInstances();
  llvm::Type* const type = e_.scalarType(kind);
  const unsigned bytes = kind == Kind::string ? 8 : 4;
  const auto load = [&](llvm::Value* block) {
    return e_.ir.CreateAlignedLoad(type, e_.pointerAt(block, offset), llvm::Align(bytes));
  };
  if (!severalInstances_) {
    return it->second = {kind, false, {atEntry([&] { return load(instanceData_); })}};
  }
  llvm::Value* lanes = nullptr;
  if (e_.width() == 1) {
    lanes = atChunkStart([&] { return load(firstInstance_); });
  } else {
    llvm::IRBuilder<>::InsertPointGuard guard(e_.ir);
    e_.ir.SetInsertPoint(sameEnd_);
    llvm::Value* const one = e_.splat(static_cast<llvm::Value*>(load(firstInstance_)));
    e_.ir.SetInsertPoint(mixedEnd_);
    llvm::Value* const offsets = e_.ir.CreateAdd(blockOffsets_, e_.splat(e_.ir.getInt64(offset)));
    llvm::Value* const addresses = e_.ir.CreateInBoundsGEP(e_.ir.getInt8Ty(), instanceData_, offsets);
    llvm::Value* const many =
        e_.ir.CreateMaskedGather(one->getType(), addresses, llvm::Align(bytes), e_.allLanes(), e_.zero(one->getType()));
    e_.ir.SetInsertPoint(joined_, joined_->begin());
    llvm::PHINode* const phi = e_.ir.CreatePHI(one->getType(), 2);
    phi->addIncoming(one, sameEnd_->getParent());
    phi->addIncoming(many, mixedEnd_->getParent());
    lanes = phi;
  }
  return it->second = atChunkStart([&] { return domain_.exact(kind, lanes); });
}

Number KernelFrame::header(unsigned index) { return instanceNumber(Kind::floating, index * 4); }

Value KernelFrame::field(const InstanceField& field) {
  Value value;
  unsigned offset = field.offset;
  for (int element = 0; element < std::max(field.type.arrayLength, 1); ++element) {
    for (const Kind kind : kindsOf(field.type)) {
      value.push_back(instanceNumber(kind, offset));
      offset += kind == Kind::string ? 8 : 4;
    }
  }
  return value;
}

ArrayMemory KernelFrame::arrayField(const InstanceField& field, llvm::ArrayRef<Kind> element) {
  const auto length = static_cast<unsigned>(field.type.arrayLength);
  prepareInstances();
  if (!severalInstances_) {
    llvm::Value* const base = atEntry([&] { return e_.pointerAt(instanceData_, field.offset); });
    return {base, element, length, false};
  }
  const Value numbers = this->field(field);
  const unsigned bytes = domain_.elementBytes(element, true);
  auto* const memory = e_.slot(llvm::ArrayType::get(e_.ir.getInt8Ty(), std::uint64_t{bytes} * length), "parameter",
                               AEROSOL_MAXIMUM_WIDTH * 8);
  atChunkStart([&] {
    for (unsigned i = 0; i < numbers.size(); ++i) {
      const auto components = static_cast<unsigned>(element.size());
      const std::uint64_t offset =
          std::uint64_t{i / components} * bytes + domain_.componentOffset(element, i % components, true);
      domain_.store(numbers[i], e_.pointerAt(memory, offset));
    }
  });
  return {memory, element, length, true};
}

void KernelFrame::storeOutput(unsigned index, llvm::Value* lanes, llvm::Value* mask) {
  if (!outputs_) {
    outputs_ = atEntry([&] { return argument(offsetof(AerosolKernelArguments, outputs), e_.ir.getPtrTy()); });
  }
  llvm::Value* const pointer =
      atEntry([&] { return e_.ir.CreateLoad(e_.ir.getPtrTy(), e_.pointerAt(outputs_, sizeof(void*) * index)); });
  const unsigned bytes = lanes->getType()->getScalarSizeInBits() / 8;
  if (list_) {
    e_.ir.CreateMaskedScatter(lanes, pointAddresses(pointer, bytes), llvm::Align(bytes), mask);
    return;
  }
  llvm::Value* const offset = e_.ir.CreateMul(e_.ir.CreateZExt(base_, e_.ir.getInt64Ty()), e_.ir.getInt64(bytes));
  llvm::Value* const address = e_.ir.CreateInBoundsGEP(e_.ir.getInt8Ty(), pointer, offset);
  if (e_.width() == 1) {
    e_.ir.CreateAlignedStore(lanes, address, llvm::Align(bytes));
  } else {
    e_.ir.CreateMaskedStore(lanes, address, llvm::Align(bytes * e_.width()), mask);
  }
}

void KernelFrame::count(unsigned cost, const Mask& mask) {
  if (cost == 0) return;
  if (!lanesRun_) {
    lanesRun_ = e_.slot(e_.ir.getInt64Ty(), "lanes.run");
    lanesUsed_ = e_.slot(e_.ir.getInt64Ty(), "lanes.used");
    atEntry([&] {
      e_.ir.CreateStore(e_.ir.getInt64(0), lanesRun_);
      e_.ir.CreateStore(e_.ir.getInt64(0), lanesUsed_);
    });
  }
  const auto add = [&](llvm::AllocaInst* counter, llvm::Value* amount) {
    e_.ir.CreateStore(e_.ir.CreateAdd(e_.ir.CreateLoad(e_.ir.getInt64Ty(), counter), amount), counter);
  };
  add(lanesRun_, e_.ir.getInt64(std::uint64_t{cost} * e_.width()));
  llvm::Value* const lanes = e_.ir.CreateUnaryIntrinsic(llvm::Intrinsic::ctpop, e_.bits(mask.may));
  add(lanesUsed_, e_.ir.CreateMul(e_.ir.CreateZExt(lanes, e_.ir.getInt64Ty()), e_.ir.getInt64(cost)));
}

void KernelFrame::flushCounters() {
  if (!lanesRun_) return;
  constexpr std::size_t counters = offsetof(AerosolKernelContext, counters);
  const auto flush = [&](llvm::AllocaInst* counter, std::size_t offset) {
    llvm::Value* const address = e_.pointerAt(context_, counters + offset);
    llvm::Value* const sum =
        e_.ir.CreateAdd(e_.ir.CreateLoad(e_.ir.getInt64Ty(), address), e_.ir.CreateLoad(e_.ir.getInt64Ty(), counter));
    e_.ir.CreateStore(sum, address);
    e_.ir.CreateStore(e_.ir.getInt64(0), counter);
  };
  flush(lanesRun_, offsetof(AerosolKernelCounters, lanesRun));
  flush(lanesUsed_, offsetof(AerosolKernelCounters, lanesUsed));
}

}  // namespace aerosol::jit
