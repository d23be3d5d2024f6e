// The values that a scene file can hold, and how they are read from text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/color.h"
#include "core/base/geometry.h"

namespace aerosol::scene {

/// The space of a position that was only read: whoever takes the value knows which space it lies in.
struct Unplaced {};

/// The types of parameters, in the order of the alternatives of `Value`.
enum class ValueType : std::uint8_t { boolean, integer, number, string, color, point, vector, transform };

/// Numbers are finite. Colours are linear Rec.709 as Mitsuba's `<rgb>` is; `#rrggbb` has been decoded from sRGB.
using Value = std::variant<bool, int, float, std::string, Color, Point<Unplaced>, Vector<Unplaced>, Matrix4>;

inline ValueType typeOf(const Value& value) { return static_cast<ValueType>(value.index()); }

/// The element that writes a value of this type: boolean, integer, float, string, rgb, point, vector, transform.
std::string_view name(ValueType type);

/// The value as a scene file would write it, shortest digits that read back the same.
std::string format(const Value& value);

/// `value` as a `type`, where that loses nothing: integer → float, float → rgb (grey), boolean → integer (0 or 1).
/// `untyped` says that the writer named no type (`--set`): then three numbers serve as rgb, point and vector alike,
/// 0 and 1 as boolean, one number as any triple, and anything but text as its text.
std::optional<Value> convert(const Value& value, ValueType type, bool untyped = false);

/// What is wrong with a text, and at which byte of it.
struct TextError {
  std::size_t offset = 0;
  std::string message;
};

/// Numbers are read strictly to their end; NaN, infinities and what a float (int) cannot hold are refused.
std::optional<double> parseNumber(std::string_view text, TextError& error);
std::optional<float> parseFloat(std::string_view text, TextError& error);
std::optional<int> parseInteger(std::string_view text, TextError& error);
/// `true` or `false` in any case.
std::optional<bool> parseBoolean(std::string_view text, TextError& error);
/// Numbers between blanks or single commas.
std::optional<std::vector<double>> parseNumbers(std::string_view text, TextError& error);
/// One number for all three, or three.
std::optional<std::vector<float>> parseTriple(std::string_view text, TextError& error);
/// One number (grey), three, or `#rrggbb` encoded as sRGB.
std::optional<Color> parseColor(std::string_view text, TextError& error);
/// Text as a value of a known type; a transform is given as 16 (or 9) numbers, row by row.
std::optional<Value> parseValue(ValueType type, std::string_view text, TextError& error);
/// 16 or 9 numbers, row by row.
std::optional<Matrix4> parseMatrix(std::string_view text, TextError& error);
/// Text as whatever it looks like: integer, number, true/false, one colour or three numbers (rgb), else a string.
Value guessValue(std::string_view text);

/// `text` without blanks at both ends.
std::string_view trim(std::string_view text);

}  // namespace aerosol::scene
