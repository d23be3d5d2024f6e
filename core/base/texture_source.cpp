#include "core/base/texture_source.h"

#include <array>
#include <utility>

namespace aerosol {

namespace {

using enum TextureWrap;
constexpr std::array<std::pair<std::string_view, TextureWrap>, 5> wraps = {
    {{"default", fromFile}, {"black", black}, {"clamp", clamp}, {"periodic", periodic}, {"mirror", mirror}}};

using enum TextureInterpolation;
constexpr std::array<std::pair<std::string_view, TextureInterpolation>, 4> interpolations = {
    {{"closest", closest}, {"linear", linear}, {"cubic", cubic}, {"smartcubic", smartCubic}}};

template <class Table>
auto findName(const Table& table, std::string_view name) -> std::optional<decltype(table[0].second)> {
  for (const auto& [known, value] : table)
    if (known == name) return value;
  return {};
}

}  // namespace

std::optional<TextureWrap> textureWrap(std::string_view name) { return findName(wraps, name); }

std::optional<TextureInterpolation> textureInterpolation(std::string_view name) {
  return findName(interpolations, name);
}

}  // namespace aerosol
