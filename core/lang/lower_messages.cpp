// printf and its kin, format, and concat. A format that is known here is checked and taken apart here; any other is the
// host's when the shader runs.
#include <algorithm>
#include <string_view>

#include "core/lang/format_text.h"
#include "core/lang/lowerer.h"

namespace aerosol::lang {

namespace {

/// Whether a conversion shows numbers or strings of that type. %c shows colours.
bool suits(char conversion, BaseType shown) {
  const FormatKind kind = conversion == 'c' ? FormatKind::floating : kindOf(conversion);
  if (kind == FormatKind::string) return shown == BaseType::string;
  return shown == (kind == FormatKind::integer ? BaseType::integer : BaseType::floating);
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

/// The format, which is the value of argument number `first`, with one conversion for each scalar (a triple's three are
/// separated by spaces), and those scalars. A literal's conversions must suit the values; those of other formats become
/// %d, %f or %s where they do not.
std::optional<std::string> Lowerer::expandFormat(const Call& called, std::size_t first, std::string_view format,
                                                 std::vector<VariableId>& scalars) {
  const Position at = called.arguments[first]->position;
  const bool isLiteral = std::holds_alternative<StringLiteral>(called.arguments[first]->node);
  const auto pieces = splitFormat(format);
  if (!pieces) {
    error(
        at, "malformed format string",
        {"conversions are %d %i %o %x for int, %f %g %e for float, triples and matrices, %s for strings, and %% for a "
         "percent sign"});
    return std::nullopt;
  }
  std::string expanded;
  std::size_t next = first + 1;
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
    std::vector<VariableId> parts;
    scalarsOf(protect(lower(argument), std::span(called.arguments).subspan(next)), parts);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const BaseType shown = typeOf(parts[i]).closure ? BaseType::string : typeOf(parts[i]).base;
      std::string shownBy = piece.text;
      if (!suits(piece.conversion, shown)) {
        if (isLiteral) {
          error(argument.position,
                "the conversion " + piece.text + " does not show a value of type " + toString(argument.type));
          return std::nullopt;
        }
        shownBy.back() = shown == BaseType::integer ? 'd' : shown == BaseType::floating ? 'f' : 's';
      }
      if (std::string_view("cpnvm").find(shownBy.back()) != std::string_view::npos) shownBy.back() = 'f';
      scalars.push_back(parts[i]);
      expanded += (i > 0 ? " " : "") + shownBy;
    }
  }
  if (next < called.arguments.size()) {
    error(called.arguments[next]->position, "the format has no conversion for this value");
    return std::nullopt;
  }
  return expanded;
}

/// The text by the format that is argument number `first` and lowered already.
VariableId Lowerer::formatted(const Call& called, std::size_t first, VariableId format, Position position) {
  std::vector<VariableId> arguments = {format};
  if (const auto known = constantOf(format)) {
    const auto expanded = expandFormat(called, first, known->asString(), arguments);
    if (!expanded) return constantString("");
    arguments[0] = constantString(*expanded);
  } else {
    for (std::size_t i = first + 1; i < called.arguments.size(); ++i) {
      const Value value = protect(lower(*called.arguments[i]), std::span(called.arguments).subspan(i + 1));
      if (value.leaves.size() != 1 || value.type.base == BaseType::structure) {
        error(called.arguments[i]->position, "a format cannot show a value of type " + toString(value.type));
        return constantString("");
      }
      arguments.push_back(value.single());
    }
  }
  position_ = position;
  return callHost("format", types::string, std::move(arguments), {});
}

Value Lowerer::lowerFormat(const Expression& expression, const Call& called) {
  const VariableId format = protect(lower(*called.arguments[0]), std::span(called.arguments).subspan(1)).single();
  return {types::string, {formatted(called, 0, format, expression.position)}};
}

Value Lowerer::lowerConcat(const Expression& expression, const Call& called) {
  const std::vector<Value> values = lowerArguments(called);
  std::vector<VariableId> strings;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i].type == types::string)) {
      error(called.arguments[i]->position, "concat takes strings only");
      return zeroValue(types::string);
    }
    strings.push_back(values[i].single());
  }
  position_ = expression.position;
  return {types::string, {callHost("concat", types::string, std::move(strings), {})}};
}

Value Lowerer::lowerMessage(const Expression& expression, const Call& called) {
  const std::string_view name = called.builtin->row->name;
  const MessageKind kind = name == "printf"    ? MessageKind::print
                           : name == "warning" ? MessageKind::warning
                           : name == "error"   ? MessageKind::error
                                               : MessageKind::file;
  const std::size_t first = kind == MessageKind::file ? 1 : 0;
  std::vector<VariableId> arguments = {noVariable};
  for (std::size_t i = 0; i < first; ++i)
    arguments.push_back(protect(lower(*called.arguments[i]), std::span(called.arguments).subspan(i + 1)).single());
  const VariableId format =
      protect(lower(*called.arguments[first]), std::span(called.arguments).subspan(first + 1)).single();
  if (const auto known = constantOf(format)) {
    const auto expanded = expandFormat(called, first, known->asString(), arguments);
    if (!expanded) return {types::none, {}};
    arguments[0] = constantString(*expanded);
  } else {
    arguments[0] = constantString("%s");
    arguments.push_back(formatted(called, first, format, expression.position));
  }
  position_ = expression.position;
  Instruction& instruction = append(Op::message);
  instruction.function = static_cast<std::uint32_t>(kind);
  instruction.arguments = std::move(arguments);
  return {types::none, {}};
}

}  // namespace aerosol::lang
