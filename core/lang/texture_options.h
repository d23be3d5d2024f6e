// The optional arguments of texture functions: pairs of a name and a value behind the others.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/lang/type.h"

namespace aerosol::lang {

enum class TextureOptionKind : std::uint8_t {
  blur,
  width,
  wrap,
  firstChannel,
  subimage,
  fill,
  missingColor,
  missingAlpha,
  time,
  interpolation,
  colorSpace,
  alpha,
  errorMessage
};

struct TextureOption {
  std::string_view name;
  TextureOptionKind kind;
  Type type;              ///< Of the value; `subimage` takes a string too.
  std::int8_t axis = -1;  ///< Of s, t and r; -1: all.

  /// The value is a variable that the function writes.
  bool isOutput() const { return kind == TextureOptionKind::alpha || kind == TextureOptionKind::errorMessage; }
  /// A value of another type is as good as an unknown option.
  bool takes(const Type& given) const;
};

std::span<const TextureOption> textureOptions();
/// Null when there is none of that name.
const TextureOption* findTextureOption(std::string_view name);

/// A texture function's row, and how many arguments it has in front of the options when all derivatives are given. What
/// the host gets: these, then the variables that are written (alpha, error message), then names and values of the other
/// options.
struct TextureFunction {
  std::string_view name;
  std::size_t coordinates;  ///< Arguments behind the file name that derivatives are taken of.
  std::size_t derivatives;  ///< Derivatives of each.
  Type type;                ///< Of coordinates and derivatives.

  std::size_t argumentCount() const { return 1 + coordinates * (1 + derivatives); }
};
/// Null when the name is none of a texture function.
const TextureFunction* findTextureFunction(std::string_view name);

}  // namespace aerosol::lang
