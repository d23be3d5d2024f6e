#include <algorithm>
#include <array>
#include <cassert>

#include "core/lang/lowerer.h"
#include "core/lang/texture_options.h"

namespace aerosol::lang {

VariableId Lowerer::componentOf(VariableId triple, int index) {
  return emit(Op::component, types::floating, {triple, constantInt(index)});
}

std::vector<Value> Lowerer::lowerArguments(const Call& called, std::size_t count) {
  const auto& parameters = called.builtin->parameters;
  const auto& arguments = called.arguments;
  std::vector<Value> values;
  for (std::size_t i = 0; i < std::min(count, arguments.size()); ++i) {
    const bool converts = i < parameters.size() && !(parameters[i] == types::none);
    Value value = converts ? lowerTo(*arguments[i], parameters[i]) : lower(*arguments[i]);
    values.push_back(protect(std::move(value), std::span(arguments).subspan(i + 1)));
  }
  return values;
}

Value Lowerer::lowerBuiltin(const Expression& expression, const Call& called) {
  const BuiltinOverload& overload = *called.builtin;
  if (overload.row->kind == BuiltinKind::special) return lowerSpecial(expression, called);
  if (overload.row->kind == BuiltinKind::host) return lowerHostCall(expression, called);
  const std::vector<Value> arguments = lowerArguments(called);
  position_ = expression.position;
  if (overload.row->kind == BuiltinKind::componentwise)
    return componentwise(overload.row->symbol, overload.result, arguments);
  std::vector<VariableId> ids;
  for (const Value& argument : arguments) ids.push_back(argument.single());
  return {overload.result, {call(overload.row->symbol, overload.result, std::move(ids))}};
}

Value Lowerer::componentwise(const std::string& base, const Type& result, const std::vector<Value>& arguments) {
  const auto callFor = [&](int component) {
    std::vector<VariableId> ids;
    for (const Value& argument : arguments)
      ids.push_back(argument.type.isTriple() ? componentOf(argument.single(), component) : argument.single());
    return call(base, result == types::integer ? types::integer : types::floating, std::move(ids));
  };
  if (!result.isTriple()) return {result, {callFor(0)}};
  const VariableId x = callFor(0), y = callFor(1), z = callFor(2);
  return {result, {emit(Op::makeTriple, result, {x, y, z})}};
}

Value Lowerer::lowerSpecial(const Expression& expression, const Call& called) {
  const std::string_view name = called.builtin->row->name;
  const Type& result = called.builtin->result;
  if (name == "atan") {
    const auto arguments = lowerArguments(called);
    return componentwise(arguments.size() == 2 ? "atan2" : "atan", result, arguments);
  }
  if (name == "sincos") return lowerSincos(called);
  if (name == "select") return lowerSelect(result, lowerArguments(called));
  if (name == "noise") return lowerNoise(expression, called, false);
  if (name == "pnoise") return lowerNoise(expression, called, true);
  if (name == "spline" || name == "splineinverse") return lowerSpline(expression, called);
  if (name == "transform") return lowerTransform(expression, called);
  if (name == "transformu") return lowerTransformUnits(expression, called);
  if (name == "getmatrix") return lowerGetMatrix(called);
  if (name == "printf" || name == "warning" || name == "error" || name == "fprintf")
    return lowerMessage(expression, called);
  if (name == "arraylength") {
    const Value array = lower(*called.arguments[0]);
    return {result, {constantInt(array.type.arrayLength)}};
  }
  if (name == "isconnected") return lowerIsConnected(expression, called);
  if (name == "exit") {
    if (!inBody_) error(expression.position, "a parameter's default value cannot end the shader");
    frames_.front().usesLeave = true;
    append(Op::leave).scopeId = frames_.front().scopeId;
    return {result, {}};
  }
  if (findTextureFunction(name)) return lowerTexture(expression, called);
  if (name == "pointcloud_search" || name == "pointcloud_get") return lowerPointQuery(expression, called);
  if (name == "getattribute") return lowerGetAttribute(expression, called);
  if (name == "isconstant") return lowerIsConstant(expression, called);
  if (name == "random") return lowerRandom(expression, called);
  if (name == "concat") return lowerConcat(expression, called);
  return lowerFormat(expression, called);
}

Value Lowerer::lowerSelect(const Type& type, const std::vector<Value>& arguments) {
  const VariableId first = arguments[0].single(), second = arguments[1].single();
  const VariableId condition = arguments[2].single();
  if (!arguments[2].type.isTriple()) return {type, {emit(Op::select, type, {toBool(condition), second, first})}};
  std::vector<VariableId> components;
  for (int i = 0; i < 3; ++i) {
    const VariableId truth = toBool(componentOf(condition, i));
    components.push_back(emit(Op::select, types::floating, {truth, componentOf(second, i), componentOf(first, i)}));
  }
  return {type, {emit(Op::makeTriple, type, std::move(components))}};
}

Value Lowerer::lowerSincos(const Call& called) {
  const Type& type = called.builtin->parameters[0];
  const Value angle = copied(lowerTo(*called.arguments[0], type));
  const Place sine = place(*called.arguments[1]), cosine = place(*called.arguments[2]);
  std::vector<VariableId> sines, cosines;
  for (int i = 0; i < (type.isTriple() ? 3 : 1); ++i) {
    const VariableId x = type.isTriple() ? componentOf(angle.single(), i) : angle.single();
    sines.push_back(temporary(types::floating));
    cosines.push_back(temporary(types::floating));
    call("sincos", types::none, {x, sines.back(), cosines.back()}, 0b110);
  }
  const auto put = [&](const Place& target, std::vector<VariableId> values) {
    const VariableId value = type.isTriple() ? emit(Op::makeTriple, type, std::move(values)) : values[0];
    store(target, {type, {value}});
  };
  put(sine, std::move(sines));
  put(cosine, std::move(cosines));
  return {types::none, {}};
}

}  // namespace aerosol::lang
