// Noise by name, and what of it is written in the standard library.
#include <algorithm>
#include <array>

#include "core/lang/lowerer.h"
#include "core/lang/overload.h"

namespace aerosol::lang {

namespace {

struct NoiseKind {
  std::string_view name;
  const char* symbol;
  bool periodic;    ///< Has a periodic form, whose symbol has a p in front.
  float value = 0;  ///< Of a kind without a symbol: the same everywhere.
};
constexpr std::string_view gaborKind = "gabor";
constexpr std::array<NoiseKind, 11> noiseKinds = {{
    {"perlin", "perlin", true},
    {"snoise", "perlin", true},
    {"uperlin", "uperlin", true},
    {"noise", "uperlin", true},
    {"cell", "cell", true},
    {"hash", "hash", true},
    {"simplex", "simplex", false},
    {"usimplex", "usimplex", false},
    {gaborKind, "", true},
    {"null", nullptr, true, 0},
    {"unull", nullptr, true, 0.5f},
}};

}  // namespace

Value Lowerer::noiseCall(const std::string& kind, const Type& type, const std::vector<Value>& coordinates,
                         bool periodic) {
  std::vector<VariableId> ids;
  for (const Value& coordinate : coordinates) ids.push_back(coordinate.single());
  return {type, {call((periodic ? "p" : "") + kind, type, std::move(ids))}};
}

/// The options of a call of noise, or what they are when not given.
std::vector<Value> Lowerer::lowerNoiseOptions(const Call& called, VariableId kind) {
  const auto knownKind = constantOf(kind);
  const bool mayBeGabor = !knownKind || knownKind->asString() == gaborKind;
  const auto single = [&](const Constant& value) { return Value{value.type, {constant(value)}}; };
  static constexpr std::array<std::string_view, 5> names = {"anisotropic", "direction", "bandwidth", "impulses",
                                                            "do_filter"};
  std::vector<Value> options = {single(Constant::ofInt(0)), single({types::vector, std::vector<float>{1, 0, 0}}),
                                single(Constant::ofFloat(1)), single(Constant::ofFloat(16)),
                                single(Constant::ofInt(1))};
  for (std::size_t i = called.builtin->parameters.size(); i + 1 < called.arguments.size(); i += 2) {
    const auto& key = std::get<StringLiteral>(called.arguments[i]->node).value;
    const auto* known = std::find(names.begin(), names.end(), key);
    Value& option = options[static_cast<std::size_t>(known - names.begin()) % names.size()];
    const Type& given = called.arguments[i + 1]->type;
    if (known == names.end() || !isAssignable(option.type, given)) {
      if (mayBeGabor) {  // No other kind looks at options.
        remark(called.arguments[i]->position,
               "Unknown noise optional argument: \"" + key + "\", <" + toString(given) + ">");
      }
      lower(*called.arguments[i + 1]);  // Nothing but its side effects.
      continue;
    }
    option = protect(lowerTo(*called.arguments[i + 1], option.type), std::span(called.arguments).subspan(i + 2));
  }
  return options;
}

/// How the point changes to the samples beside it in x and y; zeros where the noise is not to be filtered.
std::array<Value, 2> Lowerer::gaborFootprint(const Value& point, const Value& doFilter) {
  std::array<Value, 2> sides = {zeroValue(types::vector), zeroValue(types::vector)};
  const auto known = constantOf(doFilter.single());
  if (known && known->asInt() == 0) return sides;
  static constexpr std::array<const char*, 2> axes = {"dx", "dy"};
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const VariableId change = call(axes[i], types::vector, {point.single()});
    const VariableId chosen =
        known ? change : emit(Op::select, types::vector, {doFilter.single(), change, sides[i].single()});
    sides[i] = {types::vector, {chosen}};
  }
  return sides;
}

Value Lowerer::gaborNoise(const Expression& expression, const Call& called, std::vector<Value> coordinates,
                          bool periodic, const std::vector<Value>& options) {
  const auto number = [&](int value) { return Value{types::integer, {constantInt(value)}}; };
  // One and two floats are a point in a plane; of a point and a time, the time is left out.
  const auto asPoint = [&](std::size_t first, std::size_t count) -> Value {
    if (coordinates[first].type.isTriple()) return coordinates[first];
    const VariableId y = count > 1 ? coordinates[first + 1].single() : constantFloat(0);
    return {types::point, {emit(Op::makeTriple, types::point, {coordinates[first].single(), y, constantFloat(0)})}};
  };
  const std::size_t each = periodic ? coordinates.size() / 2 : coordinates.size();
  std::vector<Value> arguments = {asPoint(0, each), number(periodic)};
  arguments.push_back(periodic ? asPoint(each, each) : zeroValue(types::point));
  const Type type = called.builtin->result;
  if (!type.isTriple()) arguments.push_back(number(0));
  arguments.insert(arguments.end(), options.begin(), options.end() - 1);
  for (Value& side : gaborFootprint(arguments[0], options.back())) arguments.push_back(std::move(side));
  Value result = inlineFunction(*called.function, std::move(arguments), expression.position);
  result.type = type;
  return result;
}

Value Lowerer::lowerNoise(const Expression& expression, const Call& called, bool periodic) {
  const Type type = called.builtin->result;
  std::vector<Value> arguments = lowerArguments(called, called.builtin->parameters.size());
  if (!(arguments[0].type == types::string)) return noiseCall("uperlin", type, arguments, periodic);
  const VariableId kind = arguments[0].single();
  const std::vector<Value> options = lowerNoiseOptions(called, kind);
  arguments.erase(arguments.begin());
  const auto noiseOf = [&](const NoiseKind& row) {
    if (row.name == gaborKind) return gaborNoise(expression, called, arguments, periodic, options);
    if (!row.symbol) return convert({types::floating, {constantFloat(row.value)}}, type);
    return noiseCall(row.symbol, type, arguments, periodic);
  };
  if (const auto known = constantOf(kind)) {
    for (const NoiseKind& row : noiseKinds)
      if (known->asString() == row.name && (row.periodic || !periodic)) return noiseOf(row);
    remark(called.arguments[0]->position, std::string(periodic ? "periodic noise" : "noise") + " type \"" +
                                              known->asString() + "\" is unknown, called from");
    return zeroValue(type);
  }
  // A kind that is known when the program runs: a choice, which folds once the parameter does.
  for (Value& argument : arguments) argument = copied(argument);
  const Value result = localValue(type, "noise");
  if (loopDepth_ > 0) assign(result, zeroValue(type));
  const auto choose = [&](const auto& self, std::size_t row) -> void {
    if (row == noiseKinds.size()) {
      Instruction& instruction = append(Op::message);
      instruction.function = static_cast<std::uint32_t>(MessageKind::error);
      instruction.arguments = {constantString("unknown kind of noise \"%s\""), kind};
      return;
    }
    if (periodic && !noiseKinds[row].periodic) {
      self(self, row + 1);
      return;
    }
    const VariableId isKind =
        emit(Op::equal, types::integer, {kind, constantString(std::string(noiseKinds[row].name))});
    branch(isKind, [&] { assign(result, noiseOf(noiseKinds[row])); }, [&] { self(self, row + 1); });
  };
  position_ = expression.position;
  choose(choose, 0);
  return result;
}

/// Knots given one by one become an array for the standard library's function.
Value Lowerer::lowerSpline(const Expression& expression, const Call& called) {
  const Type knot = called.builtin->parameters[2];
  const auto rest = [&](std::size_t i) { return std::span(called.arguments).subspan(i + 1); };
  std::vector<Value> arguments = {protect(lower(*called.arguments[0]), rest(0)),
                                  protect(lowerTo(*called.arguments[1], types::floating), rest(1))};
  std::vector<Value> knots;
  for (std::size_t i = 2; i < called.arguments.size(); ++i)
    knots.push_back(protect(lowerTo(*called.arguments[i], knot), rest(i)));
  const auto count = static_cast<int>(knots.size());
  position_ = expression.position;
  arguments.push_back({types::integer, {constantInt(count)}});
  arguments.push_back(gatherArray(knots, knot.arrayOf(count)));
  return inlineFunction(*called.function, std::move(arguments), expression.position);
}

}  // namespace aerosol::lang
