#include "core/shading/point_messages.h"

#include <fmt/format.h>

#include <bit>
#include <string>

#include "core/base/hash.h"
#include "core/shading/trace_function.h"

namespace aerosol::shading {

namespace {

constexpr std::size_t result = lang::HostCall::result;

/// A message's name as users write it. Closures are messages under names of their own, kept as ints.
std::string_view shownName(std::string_view name) {
  if (name.starts_with(lang::closureMessagePrefix)) name.remove_prefix(lang::closureMessagePrefix.size());
  return name;
}

bool isClosureName(std::string_view name) { return name.starts_with(lang::closureMessagePrefix); }

lang::Type shownType(std::string_view name, const lang::Type& type) {
  return isClosureName(name) ? lang::types::closure : type;
}

/// What a value of another kind goes by under the same name.
std::string otherName(std::string_view name) {
  return isClosureName(name) ? std::string(shownName(name)) : std::string(lang::closureMessagePrefix).append(name);
}

std::string place(const SourceLocation& location) { return fmt::format("{}:{}", location.file, location.line); }

void reportMismatch(PointCall& call, unsigned lane, std::string_view name, const lang::Type& created,
                    const lang::Type& wanted, const SourceLocation& origin) {
  call.report(lane, fmt::format("type mismatch for message \"{}\" (created as {} here: {}) cannot fetch as {}",
                                shownName(name), lang::toString(created), place(origin), lang::toString(wanted)));
}

std::uint64_t bitsOf(const PointCall& call, std::size_t argument, unsigned lane, std::size_t component) {
  switch (call.type(argument).base) {
    case lang::BaseType::string:
      return call.hash(argument, lane, component);
    case lang::BaseType::integer:
      return std::bit_cast<std::uint32_t>(call.integer(argument, lane, component));
    default:
      return std::bit_cast<std::uint32_t>(call.floating(argument, lane, component));
  }
}

void setBits(PointCall& call, std::size_t argument, unsigned lane, std::size_t component, std::uint64_t bits) {
  switch (call.type(argument).base) {
    case lang::BaseType::string:
      return call.setHash(argument, lane, bits, component);
    case lang::BaseType::integer:
      return call.set(argument, lane, std::bit_cast<std::int32_t>(static_cast<std::uint32_t>(bits)), component);
    default:
      return call.set(argument, lane, std::bit_cast<float>(static_cast<std::uint32_t>(bits)), component);
  }
}

}  // namespace

const PointMessages::Message* PointMessages::find(std::uint32_t point, std::uint64_t name) const {
  const auto found = messages_.find({point, name});
  return found == messages_.end() ? nullptr : &found->second;
}

void setMessageFunction(PointCall& call) {
  call.forEachLane([&](unsigned lane) {
    const std::uint32_t point = call.point(lane);
    const std::uint64_t name = call.hash(0, lane);
    PointMessages& messages = call.host().messages();
    const std::size_t count = call.componentCount(1);
    const std::string_view text = call.text(0, lane);
    const PointMessages::Message* known = messages.find(point, name);
    if (!known) known = messages.find(point, hashString(otherName(text)));
    if (known) {
      return call.report(lane, fmt::format("message \"{}\" already exists (created here: {}) cannot set again",
                                           shownName(text), place(*known->origin)));
    }
    const RuntimeStrings::Room room = call.host().strings().charge(point, count * sizeof(std::uint64_t));
    if (room == RuntimeStrings::Room::usedUp) call.report(lane, "messages take too much room: no more are kept");
    if (room != RuntimeStrings::Room::enough) return;
    PointMessages::Message& message = messages.set(point, name);
    message.type = call.type(1);
    message.origin = &call.site().location;
    for (std::size_t i = 0; i < count; ++i) message.values.push_back(bitsOf(call, 1, lane, i));
  });
}

void getMessageFunction(PointCall& call) {
  const std::size_t target = call.argumentCount() - 1;
  call.forEachLane([&](unsigned lane) {
    static const std::uint64_t trace = hashString("trace");
    const bool hasSource = target == 2 && call.hash(0, lane) != 0;
    if (hasSource && call.hash(0, lane) == trace)
      return call.set(result, lane, std::int32_t{getTraceMessage(call, target, lane, call.hash(1, lane))});
    const PointMessages& messages = call.host().messages();
    const PointMessages::Message* message =
        hasSource ? nullptr : messages.find(call.point(lane), call.hash(target - 1, lane));
    const bool found = message && message->type == call.type(target);
    if (!found && !hasSource) {
      const std::string_view name = call.text(target - 1, lane);
      const std::string other = message ? std::string(name) : otherName(name);
      const PointMessages::Message* unfit = message ? message : messages.find(call.point(lane), hashString(other));
      if (unfit) {
        reportMismatch(call, lane, name, shownType(other, unfit->type), shownType(name, call.type(target)),
                       *unfit->origin);
      }
    }
    for (std::size_t i = 0; found && i < message->values.size(); ++i)
      setBits(call, target, lane, i, message->values[i]);
    call.set(result, lane, std::int32_t{found});
  });
}

}  // namespace aerosol::shading
