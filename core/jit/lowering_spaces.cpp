// Matrices between named spaces. The language multiplies row vectors from the left; blocks of instances and the host
// give three rows of a map on column vectors, so matrices are transposed on the way in.
#include <cstddef>

#include "core/jit/lowering.h"
#include "core/jit/spaces.h"

namespace aerosol::jit {

using lang::Instruction;
using lang::Op;

namespace {

constexpr unsigned rowNumbers = 12;   // Of an instance: three rows.
constexpr unsigned hostNumbers = 16;  // Of a host: four, as of projections.

}  // namespace

Value Lowering::fromRows(llvm::ArrayRef<Number> rows) {
  Value matrix(16, floating(0));
  matrix[15] = floating(1);
  for (std::size_t i = 0; i < rows.size(); ++i) matrix[i % 4 * 4 + i / 4] = rows[i];
  return matrix;
}

Lowering::SpaceMatrix Lowering::headerMatrix(unsigned first) {
  Value rows;
  for (unsigned i = 0; i < rowNumbers; ++i) rows.push_back(frame_.header(first + i));
  return {fromRows(rows), integer(1)};
}

Lowering::SpaceMatrix Lowering::spaceMatrix(lang::VariableId space, bool toWorld, const Instruction& instruction) {
  const std::optional<std::string> name = constantName(program_, space);
  const std::optional<Space> known = name ? findSpace(*name) : std::nullopt;
  if (!known) return hostMatrix(number(space), toWorld, instruction);
  if (*known == Space::common) return {{}, integer(1)};
  // In the order of AerosolInstanceHeader.
  return headerMatrix((*known == Space::object ? 0 : 2 * rowNumbers) + (toWorld ? 0 : rowNumbers));
}

/// Asks the host for each active lane.
Lowering::SpaceMatrix Lowering::hostMatrix(const Number& space, bool toWorld, const Instruction& instruction) {
  if (domain_.splitsMasks()) {
    // Time is a range here, and no rule bounds what the host would answer.
    return {fromRows(Value(hostNumbers, domain_.anything(Kind::floating))), domain_.anything(Kind::integer)};
  }
  interface_.asksHostForSpaces = true;
  const llvm::SmallVector<Kind, 4> floats(hostNumbers, Kind::floating);
  llvm::Value* const rows = variables_.memory(floats, 1, true, "space");
  llvm::Value* const found = variables_.memory({Kind::integer}, 1, true, "space.known");
  llvm::Value* const one = e_.slot(llvm::ArrayType::get(e_.ir.getFloatTy(), hostNumbers), "space.lane");
  llvm::Value* const times = variables_.memory({Kind::floating}, 1, true, "space.time");
  llvm::Value* const names = variables_.memory({Kind::string}, 1, true, "space.name");
  for (unsigned i = 0; i < hostNumbers; ++i) {
    domain_.store(domain_.varying(floating(i % 5 == 0 ? 1 : 0)),
                  e_.pointerAt(rows, domain_.componentOffset(floats, i, true)));
  }
  domain_.store(domain_.varying(integer(0)), found);
  domain_.store(frame_.global(static_cast<unsigned>(globalPointer(lang::Global::time))), times);
  domain_.store(domain_.varying(space), names);

  llvm::Type* const wordType = e_.ir.getInt32Ty();
  auto* const serviceType = llvm::FunctionType::get(
      wordType, {e_.ir.getPtrTy(), e_.ir.getInt64Ty(), wordType, e_.ir.getFloatTy(), e_.ir.getPtrTy()}, false);
  llvm::Value* const service =
      hostService(e_, frame_.context(),
                  toWorld ? offsetof(AerosolHostServices, spaceToWorld) : offsetof(AerosolHostServices, worldToSpace));
  const auto laneOf = [&](llvm::Value* memory, llvm::Type* type, llvm::Value* lane) {
    return e_.ir.CreateInBoundsGEP(type, memory, lane);
  };
  llvm::BasicBlock* const before = e_.ir.GetInsertBlock();
  llvm::Value* const lanes = e_.bits(mask().may);
  llvm::BasicBlock* const loop = e_.block("space.ask");
  llvm::BasicBlock* const end = e_.block("space.asked");
  e_.ir.CreateCondBr(e_.ir.CreateICmpNE(lanes, e_.ir.getInt32(0)), loop, end);
  e_.ir.SetInsertPoint(loop);
  llvm::PHINode* const left = e_.ir.CreatePHI(wordType, 2);
  left->addIncoming(lanes, before);
  llvm::Value* const lane = e_.ir.CreateBinaryIntrinsic(llvm::Intrinsic::cttz, left, e_.ir.getTrue());
  llvm::Value* const name = e_.ir.CreateLoad(e_.ir.getInt64Ty(), laneOf(names, e_.ir.getInt64Ty(), lane));
  llvm::Value* const time = e_.ir.CreateLoad(e_.ir.getFloatTy(), laneOf(times, e_.ir.getFloatTy(), lane));
  llvm::CallInst* const known =
      e_.ir.CreateCall(serviceType, service, {frame_.context(), name, frame_.instanceOf(lane), time, one});
  known->setDoesNotThrow();
  llvm::BasicBlock* const keep = e_.block("space.keep");
  llvm::BasicBlock* const next = e_.block("space.next");
  e_.ir.CreateStore(known, laneOf(found, wordType, lane));
  e_.ir.CreateCondBr(e_.ir.CreateICmpNE(known, e_.ir.getInt32(0)), keep, next);
  e_.ir.SetInsertPoint(keep);
  for (unsigned i = 0; i < hostNumbers; ++i) {
    llvm::Value* const x = e_.ir.CreateLoad(e_.ir.getFloatTy(), e_.pointerAt(one, std::uint64_t{i} * 4));
    e_.ir.CreateStore(x,
                      laneOf(e_.pointerAt(rows, domain_.componentOffset(floats, i, true)), e_.ir.getFloatTy(), lane));
  }
  e_.ir.CreateBr(next);
  e_.ir.SetInsertPoint(next);
  llvm::Value* const rest = e_.ir.CreateAnd(left, e_.ir.CreateSub(left, e_.ir.getInt32(1)));
  left->addIncoming(rest, next);
  e_.ir.CreateCondBr(e_.ir.CreateICmpNE(rest, e_.ir.getInt32(0)), loop, end);
  e_.ir.SetInsertPoint(end);
  const Number isKnown = unary(Op::toBool, domain_.load(Kind::integer, true, found));
  const Condition isSure = domain_.condition(domain_.varying(isKnown));
  if (!instruction.quiet) {
    report(AEROSOL_REPORT_SPACE, instruction.location, {}, {lang::types::string}, {space},
           e_.without(mask().may, isSure.must));
  }
  return {fromRows(loadValue(rows, floats, true)), isKnown};
}

/// int getmatrix(string from, string to, output matrix m): m is left alone where a space is unknown.
void Lowering::emitMatrixOfSpaces(const Instruction& instruction) {
  const SpaceMatrix from = spaceMatrix(instruction.arguments[0], true, instruction);
  const SpaceMatrix to = spaceMatrix(instruction.arguments[1], false, instruction);
  const lang::VariableId target = instruction.arguments[2];
  Value matrix;
  if (from.matrix.empty() && to.matrix.empty()) {
    matrix.assign(16, floating(0));
    for (std::size_t i = 0; i < 16; i += 5) matrix[i] = floating(1);
  } else if (from.matrix.empty()) {
    matrix = to.matrix;
  } else if (to.matrix.empty()) {
    matrix = from.matrix;
  } else {
    matrix = multiplyMatrices(from.matrix, to.matrix);
  }
  const auto nameOf = [&](std::size_t i) { return constantName(program_, instruction.arguments[i]); };
  const bool isTemporary = program_.variables[target].storage == lang::Storage::temporary;
  const std::optional<std::string> toName = nameOf(1);
  if (isTemporary && from.matrix.empty() && toName && findSpace(*toName) == Space::object)
    objectMatrices_.insert(target);
  const Number known = binary(Op::logicalAnd, from.known, to.known);
  if (program_.variables[target].storage != lang::Storage::temporary) {
    const Value old = variables_.read(target);
    for (std::size_t i = 0; i < matrix.size(); ++i) matrix[i] = select(known, matrix[i], old[i]);
  }
  write(instruction, target, matrix);
  if (instruction.result != lang::noVariable) write(instruction, instruction.result, {known});
}

}  // namespace aerosol::jit
