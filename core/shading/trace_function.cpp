#include "core/shading/trace_function.h"

#include <string>

#include "core/base/hash.h"
#include "core/shading/attribute_functions.h"

namespace aerosol::shading {

namespace {

using lang::Constant;
constexpr std::size_t firstOption = 2;

TraceRequest readRequest(PointCall& call, unsigned lane) {
  TraceRequest request;
  for (std::size_t i = 0; i < 3; ++i) {
    request.origin[i] = call.floating(0, lane, i);
    request.direction[i] = call.floating(1, lane, i);
  }
  for (std::size_t i = firstOption; i + 1 < call.argumentCount(); i += 2) {
    const std::string_view name = call.text(i, lane);
    if (name == "mindist") {
      request.least = call.floating(i + 1, lane);
    } else if (name == "maxdist") {
      request.greatest = call.floating(i + 1, lane);
    } else if (name == "traceset") {
      request.set = call.text(i + 1, lane);
    } else if (name != "shade") {  // What is hit is not shaded: its attributes are known without.
      call.report(lane, "unknown option \"" + std::string(name) +
                            "\": the options are \"mindist\", \"maxdist\", \"shade\", \"traceset\"");
    }
  }
  return request;
}

Constant triple(const std::array<float, 3>& values) {
  return {lang::types::vector, std::vector<float>(values.begin(), values.end())};
}

std::optional<Constant> messageOf(const TraceAnswer& answer, std::uint64_t name) {
  static const std::uint64_t hit = hashString("hit"), distance = hashString("hitdist"), p = hashString("P");
  static const std::uint64_t n = hashString("N"), ng = hashString("Ng"), u = hashString("u"), v = hashString("v");
  if (name == hit) return Constant::ofInt(answer.isHit);
  if (!answer.isHit) return std::nullopt;
  if (name == distance) return Constant::ofFloat(answer.distance);
  if (name == p) return triple(answer.position);
  if (name == n) return triple(answer.normal);
  if (name == ng) return triple(answer.geometricNormal);
  if (name == u) return Constant::ofFloat(answer.u);
  if (name == v) return Constant::ofFloat(answer.v);
  const Constant* attribute = answer.object ? answer.object->find(name) : nullptr;
  return attribute ? std::optional<Constant>(*attribute) : std::nullopt;
}

}  // namespace

void traceFunction(PointCall& call) {
  call.forEachLane([&](unsigned lane) {
    const TraceRequest request = readRequest(call, lane);
    std::int32_t isHit = 0;
    // All points of a uniform call ask the same, but each has its own surroundings.
    const std::uint32_t lanes = call.isUniform() ? call.active() : 1u << lane;
    for (std::uint32_t left = lanes; left != 0; left &= left - 1) {
      const std::uint32_t point = call.point(static_cast<unsigned>(__builtin_ctz(left)));
      TraceAnswer answer;
      isHit = call.host().facts().trace(point, request, answer);
      call.host().tracedRays()[point] = answer;
    }
    call.set(lang::HostCall::result, lane, isHit);
  });
}

bool getTraceMessage(PointCall& call, std::size_t target, unsigned lane, std::uint64_t name) {
  const TraceAnswer* answer = call.host().tracedRays().find(call.point(lane));
  const std::optional<Constant> value = answer ? messageOf(*answer, name) : std::nullopt;
  return value && assignAttribute(call, target, lane, *value) && answer->isHit;
}

}  // namespace aerosol::shading
