// Values of shader parameters as command lines give them: text, and perhaps a type.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/lang/program.h"

namespace aerosol::app {

struct TypedValue {
  lang::Type type;
  lang::ConstantValue value;
};

/// "float", "color[2]", "int[]" … ; nothing for another text.
std::optional<lang::Type> parseType(std::string_view text);

/// The type that the text looks like: 16 numbers between commas are a matrix, 3 a vector, one without a point an int,
/// another one a float, and anything else a string.
TypedValue inferValue(const std::string& text);

/// Numbers between commas or blanks, or (for arrays) strings between commas; what is missing is 0 or empty, and an
/// array without a length is as long as the values. Nothing where numbers are expected and something else stands there.
std::optional<TypedValue> parseValue(const lang::Type& type, const std::string& text);

/// The value for a parameter of type `parameter`, as the rules of OSL have it: triples take each other's values and a
/// single float, arrays of open length any length, everything else its own type. Nothing when it does not fit.
std::optional<lang::ConstantValue> bindValue(const lang::Type& parameter, const TypedValue& given);

}  // namespace aerosol::app
