#include "core/lang/texture_options.h"

#include <algorithm>
#include <array>

#include "core/lang/overload.h"

namespace aerosol::lang {

namespace {

using enum TextureOptionKind;
const std::array optionTable = {
    TextureOption{"blur", blur, types::floating},
    TextureOption{"sblur", blur, types::floating, 0},
    TextureOption{"tblur", blur, types::floating, 1},
    TextureOption{"rblur", blur, types::floating, 2},
    TextureOption{"width", width, types::floating},
    TextureOption{"swidth", width, types::floating, 0},
    TextureOption{"twidth", width, types::floating, 1},
    TextureOption{"rwidth", width, types::floating, 2},
    TextureOption{"wrap", wrap, types::string},
    TextureOption{"swrap", wrap, types::string, 0},
    TextureOption{"twrap", wrap, types::string, 1},
    TextureOption{"rwrap", wrap, types::string, 2},
    TextureOption{"firstchannel", firstChannel, types::integer},
    TextureOption{"subimage", subimage, types::integer},
    TextureOption{"fill", fill, types::floating},
    TextureOption{"missingcolor", missingColor, types::color},
    TextureOption{"missingalpha", missingAlpha, types::floating},
    TextureOption{"time", time, types::floating},
    TextureOption{"interp", interpolation, types::string},
    TextureOption{"colorspace", colorSpace, types::string},
    TextureOption{"alpha", alpha, types::floating},
    TextureOption{"errormessage", errorMessage, types::string},
};

const std::array functionTable = {
    TextureFunction{"texture", 2, 2, types::floating},
    TextureFunction{"texture3d", 1, 3, types::vector},
    TextureFunction{"environment", 1, 2, types::vector},
};

template <class Table>
auto findName(const Table& table, std::string_view name) -> decltype(table.data()) {
  const auto found = std::ranges::find_if(table, [&](const auto& row) { return row.name == name; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace

bool TextureOption::takes(const Type& given) const {
  if (isOutput()) return given == type;
  return isAssignable(type, given) || (kind == TextureOptionKind::subimage && given == types::string);
}

std::span<const TextureOption> textureOptions() { return optionTable; }

const TextureOption* findTextureOption(std::string_view name) { return findName(optionTable, name); }

const TextureFunction* findTextureFunction(std::string_view name) { return findName(functionTable, name); }

}  // namespace aerosol::lang
