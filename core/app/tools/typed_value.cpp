#include "core/app/tools/typed_value.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "core/scene/value.h"

namespace aerosol::app {

using lang::BaseType;
using lang::Type;

namespace {

std::optional<int> wholeInteger(std::string_view text) {
  scene::TextError error;
  return scene::parseInteger(text, error);
}

/// Infinities and NaN are values too.
std::optional<float> wholeFloat(std::string_view text) {
  text = scene::trim(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || read.ec == std::errc::invalid_argument || read.ptr != text.data() + text.size()) return {};
  return static_cast<float>(value);
}

std::vector<std::string_view> splitAtCommas(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// Numbers of a known type may also stand between blanks.
std::vector<std::string_view> splitNumbers(std::string_view text) {
  constexpr std::string_view blanks = " \t\n";
  std::vector<std::string_view> parts;
  for (std::string_view part : splitAtCommas(text)) {
    part = scene::trim(part);
    for (std::size_t end = part.find_first_of(blanks); end != part.npos; end = part.find_first_of(blanks)) {
      parts.push_back(part.substr(0, end));
      part = scene::trim(part.substr(end));
    }
    parts.push_back(part);
  }
  return parts;
}

std::optional<std::vector<float>> floatsOf(const std::vector<std::string_view>& parts) {
  std::vector<float> values;
  for (const std::string_view part : parts) {
    const auto value = wholeFloat(part);
    if (!value) return {};
    values.push_back(*value);
  }
  return values;
}

std::size_t componentsOf(const Type& type) {
  return type.base == BaseType::matrix ? 16 : type.element().isTriple() ? 3 : 1;
}

/// With a length, where the type is an array without one: that of so many values.
Type withLength(const Type& type, std::size_t values) {
  if (type.arrayLength != Type::unsized) return type;
  const std::size_t each = componentsOf(type);
  return type.element().arrayOf(static_cast<int>((values + each - 1) / each));
}

std::size_t elementsOf(const Type& type) { return type.isArray() ? static_cast<std::size_t>(type.arrayLength) : 1; }

}  // namespace

std::optional<Type> parseType(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, BaseType>, 8> names = {{{"int", BaseType::integer},
                                                                           {"float", BaseType::floating},
                                                                           {"string", BaseType::string},
                                                                           {"color", BaseType::color},
                                                                           {"point", BaseType::point},
                                                                           {"vector", BaseType::vector},
                                                                           {"normal", BaseType::normal},
                                                                           {"matrix", BaseType::matrix}}};
  const std::size_t bracket = text.find('[');
  for (const auto& [name, base] : names) {
    if (text.substr(0, bracket) != name) continue;
    if (bracket == std::string_view::npos) return Type{base};
    if (text.back() != ']') return {};
    if (text.ends_with("[]")) return Type{base}.arrayOf(Type::unsized);
    const auto length = wholeInteger(text.substr(bracket + 1, text.size() - bracket - 2));
    if (!length || *length < 1) return {};
    return Type{base}.arrayOf(*length);
  }
  return {};
}

TypedValue inferValue(const std::string& text) {
  if (auto floats = floatsOf(splitAtCommas(text))) {
    if (floats->size() == 16) return {lang::types::matrix, std::move(*floats)};
    if (floats->size() == 3) return {lang::types::vector, std::move(*floats)};
  }
  if (const auto integer = wholeInteger(text)) return {lang::types::integer, std::vector<std::int32_t>{*integer}};
  if (const auto number = wholeFloat(text)) return {lang::types::floating, std::vector<float>{*number}};
  return {lang::types::string, std::vector<std::string>{text}};
}

std::optional<TypedValue> parseValue(const Type& wanted, const std::string& text) {
  if (wanted == lang::types::string) return TypedValue{wanted, std::vector<std::string>{text}};
  const bool isText = wanted.base == BaseType::string;
  const std::vector<std::string_view> parts = isText ? splitAtCommas(text) : splitNumbers(text);
  const Type type = withLength(wanted, parts.size());
  const std::size_t count = componentsOf(type) * elementsOf(type);
  if (parts.size() > count) return {};
  if (isText) {
    std::vector<std::string> texts(parts.begin(), parts.end());
    texts.resize(count);
    return TypedValue{type, std::move(texts)};
  }
  if (type.base == BaseType::integer) {
    std::vector<std::int32_t> values;
    for (const std::string_view part : parts) {
      const auto value = wholeInteger(part);
      if (!value) return {};
      values.push_back(*value);
    }
    values.resize(count);
    return TypedValue{type, std::move(values)};
  }
  auto values = floatsOf(parts);
  if (!values) return {};
  values->resize(count);
  return TypedValue{type, std::move(*values)};
}

std::optional<lang::ConstantValue> bindValue(const Type& parameter, const TypedValue& given) {
  const Type to = parameter.element(), from = given.type.element();
  const bool sameElements = to == from || (to.isTriple() && from.isTriple());
  const bool sameLength = parameter.arrayLength == given.type.arrayLength ||
                          (parameter.arrayLength == Type::unsized && given.type.isArray());
  if (sameElements && sameLength) return given.value;
  if (parameter.isTriple() && !parameter.isArray() && given.type == lang::types::floating)
    return std::vector<float>(3, std::get<std::vector<float>>(given.value)[0]);
  return {};
}

}  // namespace aerosol::app
