#include "core/jit/domain.h"

namespace aerosol::jit {

Mask NumberDomain::narrow(const Mask& mask, const Condition& condition) {
  llvm::Value* const may = e_.both(mask.may, condition.may);
  return {may, splitsMasks() ? e_.both(mask.must, condition.must) : may};
}

Mask NumberDomain::narrowNot(const Mask& mask, const Condition& condition) {
  llvm::Value* const may = e_.without(mask.may, condition.must);
  return {may, splitsMasks() ? e_.without(mask.must, condition.may) : may};
}

unsigned NumberDomain::partBytes(Kind kind, bool varying) const {
  return varying ? e_.laneBytes(kind) : kind == Kind::string ? 8 : 4;
}

unsigned NumberDomain::elementBytes(llvm::ArrayRef<Kind> element, bool varying) const {
  return componentOffset(element, static_cast<unsigned>(element.size()), varying);
}

unsigned NumberDomain::componentOffset(llvm::ArrayRef<Kind> element, unsigned component, bool varying) const {
  unsigned bytes = 0;
  for (unsigned i = 0; i < component; ++i) {
    bytes += partBytes(element[i], varying) * (varying ? partCount(element[i]) : 1);
  }
  return bytes;
}

Number NumberDomain::load(Kind kind, bool varying, llvm::Value* address) {
  const unsigned bytes = partBytes(kind, varying);
  Number number{kind, varying, {}};
  for (unsigned part = 0; part < (varying ? partCount(kind) : 1); ++part) {
    llvm::Type* const type = varying ? partType(kind, part) : e_.scalarType(kind);
    number.parts[part] =
        e_.ir.CreateAlignedLoad(type, e_.pointerAt(address, std::uint64_t{part} * bytes), llvm::Align(bytes));
  }
  return number;
}

void NumberDomain::store(const Number& number, llvm::Value* address) {
  const unsigned bytes = partBytes(number.kind, number.varying);
  for (unsigned part = 0; part < (number.varying ? partCount(number.kind) : 1); ++part) {
    e_.ir.CreateAlignedStore(number.parts[part], e_.pointerAt(address, std::uint64_t{part} * bytes),
                             llvm::Align(bytes));
  }
}

}  // namespace aerosol::jit
