#include "core/shading/point_messages.h"

#include <bit>

#include "core/base/hash.h"
#include "core/shading/trace_function.h"

namespace aerosol::shading {

namespace {

constexpr std::size_t result = lang::HostCall::result;

/// Triples of all kinds are one.
bool sameType(const lang::Type& a, const lang::Type& b) {
  return a == b || (a.element().isTriple() && b.element().isTriple() && a.arrayLength == b.arrayLength);
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
    if (!messages.find(point, name)) {
      const RuntimeStrings::Room room = call.host().strings().charge(point, count * sizeof(std::uint64_t));
      if (room == RuntimeStrings::Room::usedUp) call.report(lane, "messages take too much room: no more are kept");
      if (room != RuntimeStrings::Room::enough) return;
    }
    PointMessages::Message& message = messages.set(point, name);
    message.type = call.type(1);
    message.values.clear();
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
    const PointMessages::Message* message =
        hasSource ? nullptr : call.host().messages().find(call.point(lane), call.hash(target - 1, lane));
    const bool found = message && sameType(message->type, call.type(target));
    for (std::size_t i = 0; found && i < message->values.size(); ++i)
      setBits(call, target, lane, i, message->values[i]);
    call.set(result, lane, std::int32_t{found});
  });
}

}  // namespace aerosol::shading
