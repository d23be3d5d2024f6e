// Operations on constants, with the bits that the compiled program would compute.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/lang/program.h"

namespace aerosol::lang {

struct Constant {
  Type type;
  ConstantValue value;

  static Constant ofInt(std::int32_t value) { return {types::integer, std::vector<std::int32_t>{value}}; }
  static Constant ofFloat(float value) { return {types::floating, std::vector<float>{value}}; }
  static Constant ofString(std::string value) { return {types::string, std::vector<std::string>{std::move(value)}}; }

  std::int32_t asInt() const { return std::get<std::vector<std::int32_t>>(value).at(0); }
  float asFloat() const { return std::get<std::vector<float>>(value).at(0); }
  const std::string& asString() const { return std::get<std::vector<std::string>>(value).at(0); }
};

/// Number of floats, ints or strings in a value of the type (closures: 0).
std::size_t leafCount(const Type& type);

/// All zeros and empty strings; the null closure for closures.
Constant zeroConstant(const Type& type);

/// Sets one element of a constant array (or a number of a triple or a matrix); `element` has their type.
void setElement(Constant& array, std::size_t index, const Constant& element);

/// Same type and same bits (so -0 differs from 0 and a NaN equals itself).
bool sameBits(const Constant& a, const Constant& b);

/// Bytes that tell constants apart: equal keys, the same type and bits.
std::string bitsKey(const Constant& constant);

/// The result of a pure operation on constants, or nothing when it is not folded (library calls, control flow, matrix
/// products, indices out of range). `result` is the type of the instruction's result; `previous` is the value of the
/// result before a setComponent, setMatrixElement or setElement.
std::optional<Constant> foldOperation(Op op, const Type& result, std::span<const Constant* const> arguments,
                                      const Constant* previous = nullptr);

/// Conversion as an assignment or a cast makes it; nothing when there is none.
std::optional<Constant> convertConstant(const Constant& value, const Type& type);

}  // namespace aerosol::lang
