// Text by a printf format, as printf and format of the language make it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace aerosol::lang {

/// One number or string of an argument.
using FormatScalar = std::variant<std::int32_t, float, std::string_view>;

/// An argument: its components, of arrays element after element.
using FormatArgument = std::vector<FormatScalar>;

/// One piece of a format: text as it is, or a conversion such as "%-6.2f".
struct FormatPiece {
  std::string text;
  char conversion = 0;  ///< 0 for plain text, in which "%%" stands for a percent sign.
};

/// Nothing when a conversion is malformed or none of %d %i %o %u %x %X %c %e %f %g (and capitals), %s, nor %p %n %v %m,
/// which show points, normals, vectors and matrices as %g does, and %c colours.
std::optional<std::vector<FormatPiece>> splitFormat(std::string_view format);

enum class FormatKind : std::uint8_t { integer, floating, string };
FormatKind kindOf(char conversion);

/// One value by a conversion of its kind; one of another kind is replaced by %d, %f or %s with the same width. Widths
/// and precisions are at most 1000.
std::string formatScalar(std::string_view conversion, const FormatScalar& value);

/// A conversion takes one argument and shows all its components, separated by blanks. Conversions that are malformed or
/// have no argument stand in the text as they are.
std::string formatText(std::string_view format, std::span<const FormatArgument> arguments);

}  // namespace aerosol::lang
