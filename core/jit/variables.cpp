#include "core/jit/variables.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "core/base/hash.h"

namespace aerosol::jit {

using lang::Storage;
using lang::VariableId;

namespace {

llvm::Constant* leaf(Emitter& e, Kind kind, const lang::ConstantValue& value, std::size_t index) {
  if (kind == Kind::floating) {
    const auto* floats = std::get_if<std::vector<float>>(&value);
    const float x = floats && index < floats->size() ? (*floats)[index] : 0.0f;
    // By its bits, so that a NaN keeps its payload.
    return llvm::ConstantFP::get(
        e.context(), llvm::APFloat(llvm::APFloat::IEEEsingle(), llvm::APInt(32, std::bit_cast<std::uint32_t>(x))));
  }
  if (kind == Kind::integer) {
    const auto* ints = std::get_if<std::vector<std::int32_t>>(&value);
    return e.ir.getInt32(static_cast<std::uint32_t>(ints && index < ints->size() ? (*ints)[index] : 0));
  }
  const auto* texts = std::get_if<std::vector<std::string>>(&value);
  return e.ir.getInt64(texts && index < texts->size() ? hashString((*texts)[index]) : 0);
}

}  // namespace

Variables::Variables(Emitter& emitter, NumberDomain& domain, KernelFrame& frame, const KernelInterface& interface,
                     const lang::Program& program, const lang::Uniformity& uniformity)
    : e_(emitter), domain_(domain), frame_(frame), interface_(interface), program_(program), uniformity_(uniformity) {
  for (const lang::Variable& variable : program.variables) kinds_.push_back(kindsOf(variable.type));
  writes_.resize(program.variables.size());
}

llvm::ArrayRef<Kind> Variables::kinds(VariableId id) { return kinds_[id]; }

Number Variables::zero(Kind kind) { return {kind, false, {e_.zero(e_.scalarType(kind))}}; }

Value Variables::constant(const lang::Type& type, const lang::ConstantValue& value) {
  Value numbers;
  const llvm::SmallVector<Kind, 4> kinds = kindsOf(type);
  for (std::size_t i = 0; i < kinds.size(); ++i) numbers.push_back({kinds[i], false, {leaf(e_, kinds[i], value, i)}});
  return numbers;
}

/// Is it known without a slot? (Temporaries become known when they are written.)
bool Variables::isDirect(VariableId id) const {
  const unsigned writes = uniformity_.writeCount(id);
  const Storage storage = program_.variables[id].storage;
  return storage == Storage::temporary ? writes <= 1 : writes == 0;
}

const InstanceField* Variables::fieldOf(const lang::Variable& variable) const {
  const auto id = static_cast<VariableId>(&variable - program_.variables.data());
  const bool isSetFlag = program_.parameters[variable.parameter].isSet == id;
  for (const InstanceField& field : interface_.fields) {
    if (field.parameter == variable.parameter && field.isSetFlag == isSetFlag) return &field;
  }
  return nullptr;
}

/// What it holds when the program starts.
Value Variables::initial(VariableId id) {
  const lang::Variable& variable = program_.variables[id];
  switch (variable.storage) {
    case Storage::constant:
      return constant(variable.type, variable.value);
    case Storage::parameter:
      if (const InstanceField* field = fieldOf(variable)) return frame_.field(*field);
      return constant(variable.type, variable.value);
    case Storage::global: {
      Value value;
      const auto first = static_cast<unsigned>(globalPointer(variable.global));
      for (unsigned i = 0; i < static_cast<unsigned>(globalComponents(variable.global)); ++i) {
        value.push_back(frame_.global(first + i));
      }
      if (!value.empty()) return value;
      break;
    }
    default:
      break;
  }
  Value zeros;
  for (const Kind kind : kinds_[id]) zeros.push_back(zero(kind));
  return zeros;
}

Value Variables::read(VariableId id) {
  assert(!isArray(id));
  if (!narrowed_.empty())
    if (const auto it = narrowed_.find(id); it != narrowed_.end()) return it->second.back();
  if (isDirect(id)) {
    const auto [it, isNew] = values_.insert({id, {}});
    if (isNew) it->second = initial(id);
    return it->second;
  }
  Value value;
  const std::vector<llvm::AllocaInst*>& numbers = slots(id);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    value.push_back(domain_.load(kinds_[id][i], isVarying(id), numbers[i]));
  return value;
}

/// Where everything that is emitted from now on finds it. Beside the first use is better than at the start of the
/// chunk: lifting a slot into registers takes a search through the block for each slot that is used in several blocks.
template <class Function>
void Variables::beforeUse(Function&& emit) {
  if (sometimes_ == 0) {
    emit();
  } else {
    frame_.atChunkStart(emit);
  }
}

std::vector<llvm::AllocaInst*>& Variables::slots(VariableId id) {
  const auto [it, isNew] = slots_.insert({id, {}});
  if (!isNew) return it->second;
  const bool varies = isVarying(id);
  for (const Kind kind : kinds_[id]) it->second.push_back(memory({kind}, 1, varies, "variable"));
  const Value start = initial(id);
  beforeUse([&] {
    for (std::size_t i = 0; i < start.size(); ++i) {
      domain_.store(varies ? domain_.varying(start[i]) : start[i], it->second[i]);
    }
  });
  return it->second;
}

void Variables::write(VariableId id, const Value& value, const Mask* blend) {
  assert(value.size() == kinds_[id].size());
  assert(!narrowed_.contains(id));
  ++writes_[id];
  if (isDirect(id)) {
    values_[id] = value;
    return;
  }
  const std::vector<llvm::AllocaInst*>& numbers = slots(id);
  const bool varies = isVarying(id);
  for (std::size_t i = 0; i < value.size(); ++i) {
    assert(varies || !value[i].varying);
    Number number = varies ? domain_.varying(value[i]) : value[i];
    if (blend) number = domain_.blend(*blend, number, domain_.load(number.kind, true, numbers[i]));
    domain_.store(number, numbers[i]);
  }
}

llvm::AllocaInst* Variables::memory(llvm::ArrayRef<Kind> element, unsigned length, bool varying, const char* name) {
  if (length == 1 && element.size() == 1 && (!varying || domain_.partCount(element[0]) == 1)) {
    llvm::Type* const type = varying ? domain_.partType(element[0], 0) : e_.scalarType(element[0]);
    return e_.slot(type, name, domain_.partBytes(element[0], varying));
  }
  const std::uint64_t bytes = std::uint64_t{domain_.elementBytes(element, varying)} * length;
  unsigned alignment = 8;
  for (const Kind kind : element) alignment = std::max(alignment, domain_.partBytes(kind, varying));
  return e_.slot(llvm::ArrayType::get(e_.ir.getInt8Ty(), bytes), name, alignment);
}

std::uint64_t Variables::offsetOf(const ArrayMemory& array, unsigned element, unsigned component) const {
  return std::uint64_t{element} * domain_.elementBytes(array.element, array.varying) +
         domain_.componentOffset(array.element, component, array.varying);
}

ArrayMemory Variables::constantArray(const lang::Variable& variable, llvm::ArrayRef<Kind> element) {
  const auto length = static_cast<unsigned>(variable.type.arrayLength);
  std::vector<llvm::Constant*> leaves;
  for (std::size_t i = 0; i < length * element.size(); ++i) {
    leaves.push_back(leaf(e_, element[i % element.size()], variable.value, i));
  }
  auto* const type = llvm::ArrayType::get(e_.scalarType(element[0]), leaves.size());
  auto* const table = new llvm::GlobalVariable(e_.module(), type, true, llvm::GlobalValue::PrivateLinkage,
                                               llvm::ConstantArray::get(type, leaves), "table");
  table->setUnnamedAddr(llvm::GlobalValue::UnnamedAddr::Global);
  return {table, element, length, false};
}

ArrayMemory Variables::array(VariableId id) {
  const auto [it, isNew] = arrays_.insert({id, {}});
  if (!isNew) return it->second;
  const lang::Variable& variable = program_.variables[id];
  const llvm::ArrayRef<Kind> element = kinds_[id];
  const bool isParameter = variable.storage == Storage::parameter;
  const InstanceField* const field = isParameter ? fieldOf(variable) : nullptr;
  if (uniformity_.writeCount(id) == 0) {
    return it->second = field ? frame_.arrayField(*field, element) : constantArray(variable, element);
  }
  const auto length = static_cast<unsigned>(variable.type.arrayLength);
  const bool varies = isVarying(id);
  it->second = {memory(element, length, varies, "array"), element, length, varies};
  const Value given = field ? frame_.field(*field) : Value();
  beforeUse([&] { initialiseArray(id, it->second, given); });
  return it->second;
}

/// `start`: the numbers that come from outside; none where the program text has them, or zeros.
void Variables::initialiseArray(VariableId id, const ArrayMemory& array, Value start) {
  const lang::Variable& variable = program_.variables[id];
  const std::uint64_t bytes = std::uint64_t{domain_.elementBytes(array.element, array.varying)} * array.length;
  const auto components = static_cast<unsigned>(array.element.size());
  if (variable.storage == Storage::parameter && start.empty()) {
    for (unsigned i = 0; i < array.length * components; ++i) {
      const Kind kind = array.element[i % components];
      start.push_back({kind, false, {leaf(e_, kind, variable.value, i)}});
    }
  }
  if (start.empty()) e_.ir.CreateMemSet(array.base, e_.ir.getInt8(0), bytes, llvm::MaybeAlign(8));
  for (unsigned i = 0; i < start.size(); ++i) {
    const Number number = array.varying ? domain_.varying(start[i]) : start[i];
    domain_.store(number, e_.pointerAt(array.base, offsetOf(array, i / components, i % components)));
  }
}

void Variables::endNarrow(VariableId id) {
  const auto it = narrowed_.find(id);
  it->second.pop_back();
  if (it->second.empty()) narrowed_.erase(it);
}

void Variables::widen(VariableId id, const Mask& mask) {
  if (!isVarying(id)) return;
  if (isArray(id)) {
    const ArrayMemory memory = array(id);
    for (unsigned element = 0; element < memory.length; ++element) {
      for (unsigned i = 0; i < memory.element.size(); ++i) {
        llvm::Value* const address = e_.pointerAt(memory.base, offsetOf(memory, element, i));
        const Number old = domain_.load(memory.element[i], true, address);
        domain_.store(domain_.blend(mask, domain_.anything(old.kind), old), address);
      }
    }
    return;
  }
  if (isDirect(id)) return;
  Value anything;
  for (const Kind kind : kinds_[id]) anything.push_back(domain_.anything(kind));
  write(id, anything, &mask);
}

}  // namespace aerosol::jit
