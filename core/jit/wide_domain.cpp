// One value a point, one point a lane.
#include "core/jit/domain.h"

namespace aerosol::jit {

namespace {

using lang::Op;

class WideDomain final : public NumberDomain {
 public:
  explicit WideDomain(Emitter& emitter) : NumberDomain(emitter), arithmetic_(emitter) {}

  char symbolPrefix() const override { return 'w'; }
  unsigned partCount(Kind) const override { return 1; }
  llvm::Type* partType(Kind kind, unsigned) override { return e_.laneType(kind); }
  bool splitsMasks() const override { return false; }
  bool widensAtBudget() const override { return false; }

  Number exact(Kind kind, llvm::Value* lanes) override { return {kind, true, {lanes}}; }
  Number between(llvm::Value* low, llvm::Value*) override { return exact(Kind::floating, low); }

  Number anything(Kind kind) override { return {kind, true, {e_.zero(e_.laneType(kind))}}; }

  Number unary(Op op, const Number& x) override {
    const Kind kind = op == Op::toFloat ? Kind::floating : op == Op::negate ? x.kind : Kind::integer;
    return {kind, true, {arithmetic_.unary(op, x.kind, x.parts[0])}};
  }

  Number binary(Op op, const Number& a, const Number& b) override {
    const bool isComparison = op >= Op::less && op <= Op::logicalOr;
    return {isComparison ? Kind::integer : a.kind, true, {arithmetic_.binary(op, a.kind, a.parts[0], b.parts[0])}};
  }

  Number select(const Number& condition, const Number& a, const Number& b) override {
    return {a.kind, true, {e_.ir.CreateSelect(arithmetic_.isTrue(condition.parts[0]), a.parts[0], b.parts[0])}};
  }

  Condition condition(const Number& number) override {
    llvm::Value* const lanes = arithmetic_.isTrue(number.parts[0]);
    return {lanes, lanes};
  }

  Number blend(const Mask& mask, const Number& value, const Number& old) override {
    return {value.kind, true, {e_.ir.CreateSelect(mask.may, value.parts[0], old.parts[0])}};
  }

  llvm::Value* outside(const Number& index, unsigned length) override {
    return e_.ir.CreateICmpUGE(index.parts[0], e_.splat(e_.ir.getInt32(length)));
  }

  Number clampIndex(const Number& index, unsigned length) override {
    llvm::Value* const low =
        e_.ir.CreateBinaryIntrinsic(llvm::Intrinsic::smax, index.parts[0], e_.zero(e_.laneType(Kind::integer)));
    llvm::Value* const last = e_.splat(e_.ir.getInt32(length - 1));
    return {Kind::integer, true, {e_.ir.CreateBinaryIntrinsic(llvm::Intrinsic::smin, low, last)}};
  }

  Number readElement(const ArrayMemory& array, const Number& index, unsigned component) override {
    const Kind kind = array.element[component];
    llvm::Type* const type = e_.laneType(kind);
    const llvm::Align alignment(kind == Kind::string ? 8 : 4);
    if (e_.width() > 1 && !array.varying && array.length * (kind == Kind::string ? 2 : 1) <= chosenElements)
      return chooseElement(array, index, component);
    llvm::Value* const addresses = addressesOf(array, index, component);
    if (e_.width() == 1) return {kind, true, {e_.ir.CreateAlignedLoad(type, addresses, alignment)}};
    return {kind, true, {e_.ir.CreateMaskedGather(type, addresses, alignment, e_.allLanes(), e_.zero(type))}};
  }

  void writeElement(const ArrayMemory& array, const Number& index, unsigned component, const Number& value,
                    const Mask& mask) override {
    const llvm::Align alignment(value.kind == Kind::string ? 8 : 4);
    llvm::Value* const addresses = addressesOf(array, index, component);
    if (e_.width() == 1) {
      llvm::Value* const old = e_.ir.CreateAlignedLoad(e_.laneType(value.kind), addresses, alignment);
      e_.ir.CreateAlignedStore(e_.ir.CreateSelect(mask.may, value.parts[0], old), addresses, alignment);
      return;
    }
    e_.ir.CreateMaskedScatter(value.parts[0], addresses, alignment, mask.may);
  }

 private:
  /// So few elements are compared by number; that is faster than to gather them.
  static constexpr unsigned chosenElements = 8;

  Number chooseElement(const ArrayMemory& array, const Number& index, unsigned component) {
    const Kind kind = array.element[component];
    const unsigned stride = elementBytes(array.element, false),
                   first = componentOffset(array.element, component, false);
    const auto element = [&](unsigned i) {
      llvm::Value* const address = e_.pointerAt(array.base, std::uint64_t{i} * stride + first);
      const llvm::Align alignment(kind == Kind::string ? 8 : 4);
      return e_.splat(static_cast<llvm::Value*>(e_.ir.CreateAlignedLoad(e_.scalarType(kind), address, alignment)));
    };
    llvm::Value* value = element(0);
    for (unsigned i = 1; i < array.length; ++i) {
      llvm::Value* const isIt = e_.ir.CreateICmpEQ(index.parts[0], e_.splat(e_.ir.getInt32(i)));
      value = e_.ir.CreateSelect(isIt, element(i), value);
    }
    return {kind, true, {value}};
  }

  /// One address a lane, of the component in the lane's own element.
  llvm::Value* addressesOf(const ArrayMemory& array, const Number& index, unsigned component) {
    const Kind kind = array.element[component];
    const unsigned stride = elementBytes(array.element, array.varying);
    llvm::Value* offsets = e_.ir.CreateMul(index.parts[0], e_.splat(e_.ir.getInt32(stride)));
    llvm::Constant* const first = e_.splat(e_.ir.getInt32(componentOffset(array.element, component, array.varying)));
    offsets = e_.ir.CreateAdd(offsets, first);
    if (array.varying && e_.width() > 1) {
      llvm::Constant* const size = e_.splat(e_.ir.getInt32(kind == Kind::string ? 8 : 4));
      offsets = e_.ir.CreateAdd(offsets, e_.ir.CreateMul(e_.laneNumbers(), size));
    }
    offsets = e_.ir.CreateZExt(offsets, e_.laneType(e_.ir.getInt64Ty()));
    return e_.ir.CreateInBoundsGEP(e_.ir.getInt8Ty(), array.base, offsets);
  }

  Arithmetic arithmetic_;
};

}  // namespace

std::unique_ptr<NumberDomain> makeWideDomain(Emitter& emitter) { return std::make_unique<WideDomain>(emitter); }

}  // namespace aerosol::jit
