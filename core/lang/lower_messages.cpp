// printf and its kin, and functions of strings: strings exist when a shader is compiled, not when it runs, except as
// whole values. So formats are constants, and what makes new strings needs constant arguments.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <string_view>

#include "core/lang/lowerer.h"

namespace aerosol::lang {

namespace {

/// One piece of a format string: text as it is, or a conversion such as "%-6.2f".
struct FormatPiece {
  std::string text;
  char conversion = 0;  ///< 0 for plain text ("%%" is plain).
};

/// Nothing when a conversion is malformed.
std::optional<std::vector<FormatPiece>> splitFormat(std::string_view format) {
  std::vector<FormatPiece> pieces;
  std::string plain;
  for (std::size_t i = 0; i < format.size(); ++i) {
    if (format[i] != '%') {
      plain += format[i];
      continue;
    }
    if (i + 1 < format.size() && format[i + 1] == '%') {
      plain += "%%";
      ++i;
      continue;
    }
    const std::size_t end = format.find_first_not_of("-+ #0123456789.", i + 1);
    if (end == std::string_view::npos) return std::nullopt;
    const char conversion = format[end];
    if (std::string_view("dioxXcufFgGeEsaAmnpv").find(conversion) == std::string_view::npos) return std::nullopt;
    if (std::string_view("mnpv").find(conversion) != std::string_view::npos) return std::nullopt;
    if (end - i > 24) return std::nullopt;
    if (!plain.empty()) pieces.push_back({std::move(plain), 0});
    plain.clear();
    pieces.push_back({std::string(format.substr(i, end - i + 1)), conversion});
    i = end;
  }
  if (!plain.empty()) pieces.push_back({std::move(plain), 0});
  return pieces;
}

bool isIntConversion(char c) { return std::string_view("dioxXcu").find(c) != std::string_view::npos; }

/// The kind of scalar that a conversion shows.
BaseType kindOf(char conversion) {
  if (conversion == 's') return BaseType::string;
  return isIntConversion(conversion) ? BaseType::integer : BaseType::floating;
}

std::string show(const FormatPiece& piece, const Constant& value) {
  char buffer[512];
  // The conversion was checked by splitFormat and matches the kind of the value.
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wformat-nonliteral"
  if (value.type == types::integer) {
    std::snprintf(buffer, sizeof buffer, piece.text.c_str(), value.asInt());
  } else if (value.type == types::string) {
    if (piece.text == "%s") return value.asString();
    std::snprintf(buffer, sizeof buffer, piece.text.c_str(), value.asString().c_str());
  } else {
    std::snprintf(buffer, sizeof buffer, piece.text.c_str(), static_cast<double>(value.asFloat()));
  }
#pragma clang diagnostic pop
  return buffer;
}

}  // namespace

void Lowerer::scalarsOf(const Value& value, std::vector<VariableId>& scalars) {
  for (const VariableId leaf : value.leaves) {
    const Type type = typeOf(leaf);
    for (int i = 0; i < (type.isArray() ? type.arrayLength : 1); ++i) {
      const VariableId one = type.isArray() ? emit(Op::element, type.element(), {leaf, constantInt(i)}) : leaf;
      if (type.isTriple()) {
        for (int c = 0; c < 3; ++c) scalars.push_back(componentOf(one, c));
      } else if (type.base == BaseType::matrix) {
        for (int c = 0; c < 16; ++c)
          scalars.push_back(emit(Op::matrixElement, types::floating, {one, constantInt(c / 4), constantInt(c % 4)}));
      } else {
        scalars.push_back(one);
      }
      if (failed_) return;
    }
  }
}

/// The format with one conversion for each scalar (a triple's three are separated by spaces), and those scalars.
std::optional<std::string> Lowerer::expandFormat(const Call& called, std::vector<VariableId>& scalars) {
  const Position at = called.arguments[0]->position;
  const auto format = constantOf(lower(*called.arguments[0]).single());
  if (!format) {
    error(at, "the format of '" + called.name + "' must be a constant string");
    return std::nullopt;
  }
  const auto pieces = splitFormat(format->asString());
  if (!pieces) {
    error(at, "malformed format string",
          {"conversions are %d %i %o %x %c for int, %f %g %e for float, triples and matrices, %s for strings, and %% "
           "for a percent sign"});
    return std::nullopt;
  }
  std::string expanded;
  std::size_t next = 1;
  for (const FormatPiece& piece : *pieces) {
    if (piece.conversion == 0) {
      expanded += piece.text;
      continue;
    }
    if (next >= called.arguments.size()) {
      error(at, "the format has more conversions than there are values");
      return std::nullopt;
    }
    const Expression& argument = *called.arguments[next++];
    const Value value = lower(argument);
    std::vector<VariableId> parts;
    scalarsOf(value, parts);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      BaseType kind = kindOf(piece.conversion);
      if (typeOf(parts[i]) == types::integer && kind == BaseType::floating)
        parts[i] = emit(Op::toFloat, types::floating, {parts[i]});
      if (typeOf(parts[i]).closure || typeOf(parts[i]).base != kind) {
        error(argument.position,
              "the conversion " + piece.text + " does not show a value of type " + toString(argument.type));
        return std::nullopt;
      }
      scalars.push_back(parts[i]);
      expanded += (i > 0 ? " " : "") + piece.text;
    }
  }
  if (next < called.arguments.size()) {
    error(called.arguments[next]->position, "the format has no conversion for this value");
    return std::nullopt;
  }
  return expanded;
}

Value Lowerer::lowerMessage(const Expression& expression, const Call& called) {
  std::vector<VariableId> arguments = {noVariable};
  const auto format = expandFormat(called, arguments);
  if (!format) return {types::none, {}};
  arguments[0] = constantString(*format);
  position_ = expression.position;
  const std::string_view name = called.builtin->row->name;
  const MessageKind kind = name == "printf"    ? MessageKind::print
                           : name == "warning" ? MessageKind::warning
                                               : MessageKind::error;
  Instruction& instruction = append(Op::message);
  instruction.function = static_cast<std::uint32_t>(kind);
  instruction.arguments = std::move(arguments);
  return {types::none, {}};
}

namespace {

/// The number at the beginning of a text, or 0.
template <class Number>
Number numberAt(const std::string& text) {
  const char* begin = text.c_str() + std::min(text.find_first_not_of(" \t\n"), text.size());
  if (*begin == '+') ++begin;
  Number number = 0;
  const auto parsed = std::from_chars(begin, text.c_str() + text.size(), number);
  return parsed.ec == std::errc() ? number : Number{0};
}

/// A function of strings that is neither format nor concat.
Constant stringFunction(std::string_view name, const std::vector<Constant>& values) {
  const std::string& text = values[0].asString();
  const auto length = static_cast<std::int64_t>(text.size());
  if (name == "strlen") return Constant::ofInt(static_cast<std::int32_t>(length));
  if (name == "startswith") return Constant::ofInt(text.starts_with(values[1].asString()) ? 1 : 0);
  if (name == "endswith") return Constant::ofInt(text.ends_with(values[1].asString()) ? 1 : 0);
  if (name == "stoi") return Constant::ofInt(numberAt<std::int32_t>(text));
  if (name == "stof") return Constant::ofFloat(numberAt<float>(text));
  std::int64_t at = values[1].asInt();
  if (name == "getchar") {
    const bool inside = at >= 0 && at < length;
    return Constant::ofInt(inside ? static_cast<unsigned char>(text[static_cast<std::size_t>(at)]) : 0);
  }
  if (at < 0) at += length;
  at = std::clamp<std::int64_t>(at, 0, length);
  const std::int64_t wanted = values.size() > 2 ? std::max(values[2].asInt(), 0) : length;
  return Constant::ofString(text.substr(static_cast<std::size_t>(at), static_cast<std::size_t>(wanted)));
}

}  // namespace

Value Lowerer::refuseStrings(const Call& called, Position position) {
  error(position, "'" + called.name + "' needs constant arguments: strings are not made while a shader runs");
  return zeroValue(called.builtin->result);
}

Value Lowerer::lowerFormat(const Expression& expression, const Call& called) {
  std::vector<VariableId> scalars;
  const auto format = expandFormat(called, scalars);
  if (!format) return zeroValue(types::string);
  std::string text;
  std::size_t next = 0;
  const auto pieces = splitFormat(*format);
  for (const FormatPiece& piece : *pieces) {
    if (piece.conversion == 0) {
      for (std::size_t i = 0; i < piece.text.size(); ++i) {
        text += piece.text[i];
        if (piece.text[i] == '%') ++i;
      }
      continue;
    }
    const auto value = constantOf(scalars[next++]);
    if (!value) return refuseStrings(called, expression.position);
    text += show(piece, *value);
  }
  return {types::string, {constantString(text)}};
}

Value Lowerer::lowerStringFunction(const Expression& expression, const Call& called) {
  const std::string_view name = called.builtin->row->name;
  if (name == "format") return lowerFormat(expression, called);
  const std::vector<Value> arguments = lowerArguments(called);
  std::vector<Constant> values;
  std::string joined;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const Position position = called.arguments[i]->position;
    auto value = arguments[i].leaves.size() == 1 ? constantOf(arguments[i].single()) : std::nullopt;
    if (!value) return refuseStrings(called, position);
    if (name == "concat") {
      if (!(value->type == types::string)) {
        error(position, "concat takes strings only");
        return zeroValue(types::string);
      }
      joined += value->asString();
    }
    values.push_back(std::move(*value));
  }
  if (name == "concat") return {types::string, {constantString(joined)}};
  const Constant result = stringFunction(name, values);
  return {result.type, {constant(result)}};
}

}  // namespace aerosol::lang
