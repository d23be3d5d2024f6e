// Bounds over boxes of points, one box a lane. All arithmetic is the run-time library's (runtime/range_symbols.h): a
// float is {lo, hi, lanes that may be NaN, centre, slopes, rest}, an int {lo, hi}. A string is {hash, lanes in which it
// is not one known string}.
#include <string>

#include "core/jit/domain.h"

namespace aerosol::jit {

namespace {

using lang::Op;

/// Of a float, in their order: low, high, may be NaN; centre, three slopes, rest.
constexpr unsigned floatParts = 8;
constexpr unsigned nanPart = 2;

const char* symbolOf(Op op) {
  switch (op) {
    case Op::add:
      return "add";
    case Op::subtract:
      return "sub";
    case Op::multiply:
      return "mul";
    case Op::divide:
      return "div";
    case Op::modulo:
      return "mod";
    case Op::bitAnd:
      return "and";
    case Op::bitOr:
      return "or";
    case Op::bitXor:
      return "xor";
    case Op::shiftLeft:
      return "shl";
    case Op::shiftRight:
      return "shr";
    case Op::less:
      return "lt";
    case Op::lessEqual:
      return "le";
    case Op::greater:
      return "gt";
    case Op::greaterEqual:
      return "ge";
    case Op::equal:
      return "eq";
    default:
      return "ne";
  }
}

class RangeDomain final : public NumberDomain {
 public:
  explicit RangeDomain(Emitter& emitter) : NumberDomain(emitter) {}

  char symbolPrefix() const override { return 'r'; }
  unsigned partCount(Kind kind) const override { return kind == Kind::floating ? floatParts : 2; }
  llvm::Type* partType(Kind kind, unsigned part) override {
    return e_.laneType(kind == Kind::floating && part == nanPart ? Kind::integer : kind);
  }
  bool splitsMasks() const override { return true; }
  bool widensAtBudget() const override { return true; }

  Number exact(Kind kind, llvm::Value* lanes) override {
    llvm::Value* const zero = e_.zero(partType(kind, partCount(kind) - 1));
    if (kind == Kind::integer) return {kind, true, {lanes, lanes}};
    if (kind == Kind::string) return {kind, true, {lanes, zero}};
    llvm::Value* const isNan = e_.ir.CreateFCmpUNO(lanes, lanes);
    Number number = anything(kind);
    for (unsigned part = 0; part < floatParts; ++part) {
      const bool isValue = part < nanPart || part == nanPart + 1;
      llvm::Value* const known = isValue ? lanes : e_.zero(partType(kind, part));
      number.parts[part] = e_.ir.CreateSelect(isNan, number.parts[part], known);
    }
    return number;
  }

  Number between(llvm::Value* low, llvm::Value* high) override {
    const unsigned bytes = partBytes(Kind::floating, true);
    llvm::Value* const ends[] = {e_.slot(low->getType(), "low", bytes), e_.slot(low->getType(), "high", bytes)};
    e_.ir.CreateAlignedStore(low, ends[0], llvm::Align(bytes));
    e_.ir.CreateAlignedStore(high, ends[1], llvm::Align(bytes));
    llvm::Value* const result = e_.slot(llvm::ArrayType::get(e_.laneType(Kind::floating), floatParts), "range", bytes);
    e_.callLibrary("r_between_ff", {result, ends[0], ends[1]});
    return load(Kind::floating, true, result);
  }

  Number anything(Kind kind) override {
    llvm::Type* const type = e_.laneType(kind);
    llvm::Constant* const ones =
        llvm::Constant::getAllOnesValue(partType(kind, kind == Kind::floating ? nanPart : partCount(kind) - 1));
    if (kind == Kind::string) return {kind, true, {e_.zero(type), ones}};
    if (kind == Kind::integer) {
      llvm::Constant* const lowest = llvm::ConstantInt::get(type, llvm::APInt::getSignedMinValue(32));
      return {kind, true, {lowest, llvm::ConstantInt::get(type, llvm::APInt::getSignedMaxValue(32))}};
    }
    llvm::Constant* const none = e_.zero(type);
    llvm::Constant* const infinite = llvm::ConstantFP::getInfinity(type);
    llvm::Constant* const negative = llvm::ConstantFP::getInfinity(type, true);
    return {kind, true, {negative, infinite, ones, none, none, none, none, infinite}};
  }

  Number unary(Op op, const Number& x) override {
    const std::string letter = x.kind == Kind::floating ? "f" : "i";
    switch (op) {
      case Op::negate:
        return call(x.kind, "neg_" + letter, {x});
      case Op::bitNot:
        return call(Kind::integer, "not_i", {x});
      case Op::toFloat:
        return x.kind == Kind::floating ? x : call(Kind::floating, "toFloat_i", {x});
      case Op::toInt:
        return x.kind == Kind::floating ? call(Kind::integer, "toInt_f", {x}) : x;
      case Op::logicalNot: {
        const Condition is = condition(x);
        return fromCondition({e_.ir.CreateNot(is.must), e_.ir.CreateNot(is.may)});
      }
      default:
        return fromCondition(condition(x));  // toBool
    }
  }

  Number binary(Op op, const Number& a, const Number& b) override {
    if (op == Op::logicalAnd || op == Op::logicalOr) {
      const Condition x = condition(a), y = condition(b);
      if (op == Op::logicalAnd) return fromCondition({e_.both(x.may, y.may), e_.both(x.must, y.must)});
      return fromCondition({e_.ir.CreateOr(x.may, y.may), e_.ir.CreateOr(x.must, y.must)});
    }
    if (a.kind == Kind::string) return compareStrings(op, a, b);
    const std::string symbol = std::string(symbolOf(op)) + (a.kind == Kind::floating ? "_ff" : "_ii");
    if (op >= Op::less && op <= Op::notEqual) return fromCondition(truth(call(Kind::integer, symbol, {a, b})));
    return call(a.kind, symbol, {a, b});
  }

  Number square(const Number& x) override {
    return x.kind == Kind::floating ? call(Kind::floating, "square_f", {x}) : binary(Op::multiply, x, x);
  }

  Number select(const Number& condition, const Number& a, const Number& b) override {
    // As an assignment of a over b would be.
    const Condition is = this->condition(condition);
    return blend({is.may, is.must}, a, b);
  }

  Condition condition(const Number& number) override {
    if (number.kind == Kind::string) {
      llvm::Value* const unknown = isSet(number.parts[1]);
      llvm::Value* const isText = isSet(number.parts[0]);
      return {e_.ir.CreateOr(isText, unknown), e_.without(isText, unknown)};
    }
    return truth(call(Kind::integer, number.kind == Kind::floating ? "truth_f" : "truth_i", {number}));
  }

  Number blend(const Mask& mask, const Number& value, const Number& old) override {
    if (value.kind == Kind::string) return blendStrings(mask, value, old);
    const Number must{Kind::integer, true, {lanesOf(mask.must)}};
    const Number may{Kind::integer, true, {lanesOf(mask.may)}};
    return call(value.kind, value.kind == Kind::floating ? "assign_kkff" : "assign_kkii", {must, may, value, old});
  }

  Number narrowed(const Number& number, llvm::function_ref<Number()> known) override {
    return call(Kind::floating, "meet_ff", {number, known()});
  }

  Number limited(const Number& number, const Number& limit, bool above, bool ordered) override {
    const unsigned end = above ? 1 : 0;
    if (number.kind == Kind::integer) {
      Number result = number;
      llvm::Value* const cut = e_.ir.CreateBinaryIntrinsic(above ? llvm::Intrinsic::smin : llvm::Intrinsic::smax,
                                                           number.parts[end], limit.parts[end]);
      llvm::Value* const isThere =
          above ? e_.ir.CreateICmpSLE(number.parts[0], cut) : e_.ir.CreateICmpSGE(number.parts[1], cut);
      result.parts[end] = e_.ir.CreateSelect(isThere, cut, number.parts[end]);
      return result;
    }
    Number known = anything(Kind::floating);
    llvm::Value* const unknown = isSet(limit.parts[nanPart]);
    known.parts[end] = ordered ? limit.parts[end] : e_.ir.CreateSelect(unknown, known.parts[end], limit.parts[end]);
    Number result = call(Kind::floating, "meet_ff", {number, known});
    if (ordered) result.parts[nanPart] = e_.zero(partType(Kind::floating, nanPart));
    return result;
  }

  llvm::Value* outside(const Number& index, unsigned length) override {
    llvm::Value* const below = e_.ir.CreateICmpSLT(index.parts[0], e_.zero(index.parts[0]->getType()));
    return e_.ir.CreateOr(below, e_.ir.CreateICmpSGE(index.parts[1], e_.splat(e_.ir.getInt32(length))));
  }

  Number clampIndex(const Number& index, unsigned length) override {
    Number clamped = index;
    for (unsigned part = 0; part < 2; ++part) {
      llvm::Value*& end = clamped.parts[part];
      end = e_.ir.CreateBinaryIntrinsic(llvm::Intrinsic::smax, end, e_.zero(end->getType()));
      end = e_.ir.CreateBinaryIntrinsic(llvm::Intrinsic::smin, end, e_.splat(e_.ir.getInt32(length - 1)));
    }
    return clamped;
  }

  /// The join of all elements that the index may name.
  Number readElement(const ArrayMemory& array, const Number& index, unsigned component) override {
    const Kind kind = array.element[component];
    llvm::SmallVector<llvm::AllocaInst*, 3> joined;
    const Number nothing = exact(kind, e_.zero(e_.laneType(kind)));
    for (unsigned part = 0; part < partCount(kind); ++part) {
      joined.push_back(e_.slot(partType(kind, part), "element", partBytes(kind, true)));
      e_.ir.CreateStore(nothing.parts[part], joined.back());
    }
    forElements(index, [&](llvm::Value* k) {
      const Number element = varying(load(kind, array.varying, addressOf(array, k, component)));
      Number sum{kind, true, {}};
      for (unsigned part = 0; part < partCount(kind); ++part) {
        sum.parts[part] = e_.ir.CreateLoad(partType(kind, part), joined[part]);
      }
      // The first element that a lane may name replaces what is there, the others join it.
      llvm::Value* const lanes = e_.splat(k);
      llvm::Value* const isFirst = e_.ir.CreateICmpEQ(lanes, index.parts[0]);
      llvm::Value* const isLater =
          e_.both(e_.ir.CreateICmpSGT(lanes, index.parts[0]), e_.ir.CreateICmpSLE(lanes, index.parts[1]));
      const Number next = blend({e_.ir.CreateOr(isFirst, isLater), isFirst}, element, sum);
      for (unsigned part = 0; part < partCount(kind); ++part) e_.ir.CreateStore(next.parts[part], joined[part]);
    });
    Number result{kind, true, {}};
    for (unsigned part = 0; part < partCount(kind); ++part) {
      result.parts[part] = e_.ir.CreateLoad(partType(kind, part), joined[part]);
    }
    return result;
  }

  /// Every element that the index may name may have been written; the only one it may name surely was.
  void writeElement(const ArrayMemory& array, const Number& index, unsigned component, const Number& value,
                    const Mask& mask) override {
    forElements(index, [&](llvm::Value* k) {
      llvm::Value* const lanes = e_.splat(k);
      llvm::Value* const isLow = e_.ir.CreateICmpSLE(index.parts[0], lanes);
      llvm::Value* const isHigh = e_.ir.CreateICmpSLE(lanes, index.parts[1]);
      llvm::Value* const isOnly = e_.ir.CreateICmpEQ(index.parts[0], index.parts[1]);
      llvm::Value* const may = e_.both(mask.may, e_.both(isLow, isHigh));
      llvm::Value* const address = addressOf(array, k, component);
      const Number old = load(value.kind, true, address);
      store(blend({may, e_.both(e_.both(mask.must, may), isOnly)}, value, old), address);
    });
  }

 private:
  llvm::Value* isSet(llvm::Value* lanes) { return e_.ir.CreateICmpNE(lanes, e_.zero(lanes->getType())); }
  llvm::Value* lanesOf(llvm::Value* mask) { return e_.ir.CreateSExt(mask, e_.laneType(Kind::integer)); }

  /// A truth of the library, whose parts are the masks "may be true" and "may be false".
  Condition truth(const Number& masks) { return {isSet(masks.parts[0]), e_.ir.CreateNot(isSet(masks.parts[1]))}; }

  Number fromCondition(const Condition& is) {
    llvm::Type* const type = e_.laneType(Kind::integer);
    return {Kind::integer, true, {e_.ir.CreateZExt(is.must, type), e_.ir.CreateZExt(is.may, type)}};
  }

  Number compareStrings(Op op, const Number& a, const Number& b) {
    llvm::Value* const unknown = e_.ir.CreateOr(isSet(a.parts[1]), isSet(b.parts[1]));
    llvm::Value* const holds =
        op == Op::equal ? e_.ir.CreateICmpEQ(a.parts[0], b.parts[0]) : e_.ir.CreateICmpNE(a.parts[0], b.parts[0]);
    return fromCondition({e_.ir.CreateOr(holds, unknown), e_.without(holds, unknown)});
  }

  Number blendStrings(const Mask& mask, const Number& value, const Number& old) {
    llvm::Value* const chosen = e_.ir.CreateSelect(mask.must, value.parts[0], old.parts[0]);
    llvm::Value* const differs = e_.ir.CreateICmpNE(value.parts[0], old.parts[0]);
    llvm::Value* const undecided = e_.without(mask.may, mask.must);
    llvm::Value* const valueUnknown = e_.both(isSet(value.parts[1]), mask.may);
    llvm::Value* const oldUnknown = e_.without(isSet(old.parts[1]), mask.must);
    llvm::Value* const unknown = e_.ir.CreateOr(e_.both(undecided, differs), e_.ir.CreateOr(valueUnknown, oldUnknown));
    return {Kind::string, true, {chosen, e_.ir.CreateSExt(unknown, e_.laneType(Kind::string))}};
  }

  /// Calls the library; a part that is null ends a number (masks have one part).
  Number call(Kind result, const std::string& symbol, llvm::ArrayRef<Number> arguments) {
    const auto memory = [this](unsigned parts) {
      const unsigned bytes = partBytes(Kind::integer, true);
      return e_.slot(llvm::ArrayType::get(e_.laneType(Kind::integer), parts), "range", bytes);
    };
    llvm::SmallVector<llvm::Value*, 5> pointers = {memory(partCount(result))};
    for (const Number& argument : arguments) {
      unsigned parts = 0;
      while (parts < argument.parts.size() && argument.parts[parts]) ++parts;
      pointers.push_back(memory(parts));
      for (unsigned part = 0; part < parts; ++part) {
        const unsigned bytes = partBytes(Kind::integer, true);
        e_.ir.CreateAlignedStore(argument.parts[part], e_.pointerAt(pointers.back(), std::uint64_t{part} * bytes),
                                 llvm::Align(bytes));
      }
    }
    e_.callLibrary("r_" + symbol, pointers);
    return load(result, true, pointers[0]);
  }

  llvm::Value* addressOf(const ArrayMemory& array, llvm::Value* element, unsigned component) {
    llvm::Value* const offset = e_.ir.CreateMul(e_.ir.CreateZExt(element, e_.ir.getInt64Ty()),
                                                e_.ir.getInt64(elementBytes(array.element, array.varying)));
    llvm::Value* const base = e_.ir.CreateInBoundsGEP(e_.ir.getInt8Ty(), array.base, offset);
    return e_.pointerAt(base, componentOffset(array.element, component, array.varying));
  }

  /// Emits a loop over all elements that the index may name in any lane.
  template <class Function>
  void forElements(const Number& index, Function&& emitElement) {
    const bool isOne = e_.width() == 1;
    llvm::Value* const first = isOne ? index.parts[0] : e_.ir.CreateIntMinReduce(index.parts[0], true);
    llvm::Value* const last = isOne ? index.parts[1] : e_.ir.CreateIntMaxReduce(index.parts[1], true);
    llvm::BasicBlock* const before = e_.ir.GetInsertBlock();
    llvm::BasicBlock* const loop = e_.block("elements");
    llvm::BasicBlock* const end = e_.block("elements.end");
    e_.enter(loop);
    llvm::PHINode* const element = e_.ir.CreatePHI(e_.ir.getInt32Ty(), 2);
    element->addIncoming(first, before);
    emitElement(element);
    llvm::Value* const next = e_.ir.CreateAdd(element, e_.ir.getInt32(1));
    element->addIncoming(next, e_.ir.GetInsertBlock());
    e_.ir.CreateCondBr(e_.ir.CreateICmpSLE(next, last), loop, end);
    e_.ir.SetInsertPoint(end);
  }
};

}  // namespace

std::unique_ptr<NumberDomain> makeRangeDomain(Emitter& emitter) { return std::make_unique<RangeDomain>(emitter); }

}  // namespace aerosol::jit
