// setmessage and getmessage of closures. Which closures a value may be made of has to be known when the program is
// compiled, so that such a message is a variable, by a name that is known then; whether it was set is a message of the
// host, which also keeps layers of a group in their order.
#include "core/lang/lowerer.h"

namespace aerosol::lang {

bool isClosureMessage(const Variable& variable) {
  return variable.type.closure && variable.name.starts_with(closureMessagePrefix);
}

/// The name is that of the message as users write it.
std::optional<std::string> Lowerer::messageName(const Expression& name) {
  const VariableId value = lowerTo(name, types::string).single();
  if (const auto known = constantOf(value)) return known->asString();
  error(name.position, "the name of a message that is a closure has to be a constant");
  return std::nullopt;
}

VariableId Lowerer::closureMessage(const std::string& name) {
  const auto [known, isNew] = closureMessages_.emplace(name, noVariable);
  if (isNew) known->second = local(types::closure, std::string(closureMessagePrefix) + name);
  return known->second;
}

Value Lowerer::lowerSetClosureMessage(const Expression& expression, const Call& called) {
  const auto name = messageName(*called.arguments[0]);
  const Value value = lower(*called.arguments[1]);
  position_ = expression.position;
  if (!name) return {types::none, {}};
  const VariableId kept = constantString(std::string(closureMessagePrefix) + *name);
  // What was set first stays; that there is another one is for the host to tell.
  const VariableId known = callHost("getmessage", types::integer, {kept, local(types::integer, "")},
                                    {.outputs = 1u << 1, .traits = dependsOnPoint | readsMessages});
  branch(known, [] {}, [&] { assign(closureMessage(*name), value.single()); });
  callHost("setmessage", types::none, {kept, constantInt(1)}, {.traits = writesMessages, .pure = false});
  return {types::none, {}};
}

/// Rays that shaders send come back without closures.
Value Lowerer::lowerGetClosureMessage(const Expression& expression, const Call& called) {
  const auto& arguments = called.arguments;
  const Place target = place(*arguments.back());
  const auto name = messageName(*arguments[arguments.size() - 2]);
  if (!name) return zeroValue(types::integer);
  if (arguments.size() == 3) {
    const VariableId source = lowerTo(*arguments[0], types::string).single();
    const auto known = constantOf(source);
    if (!known || !known->asString().empty()) return {types::integer, {constantInt(0)}};
  }
  position_ = expression.position;
  const VariableId kept = local(types::integer, "");
  const VariableId found =
      callHost("getmessage", types::integer, {constantString(std::string(closureMessagePrefix) + *name), kept},
               {.outputs = 1u << 1, .traits = dependsOnPoint | readsMessages});
  const VariableId message = closureMessage(*name);
  branch(found, [&] { store(target, {types::closure, {message}}); }, [] {});
  return {types::integer, {found}};
}

}  // namespace aerosol::lang
