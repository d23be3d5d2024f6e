#include "core/shading/attribute_functions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/hash.h"
#include "core/base/random.h"
#include "core/shading/attributes.h"
#include "core/shading/ray_type.h"

namespace aerosol::shading {

namespace {

using lang::BaseType;
using lang::Type;
constexpr std::size_t result = lang::HostCall::result;

/// Numbers of an attribute: those of a table or of user data.
struct Numbers {
  Type type;
  const std::int32_t* ints = nullptr;
  const float* floats = nullptr;

  float floating(std::size_t i) const { return floats ? floats[i] : static_cast<float>(ints[i]); }
  std::int32_t integer(std::size_t i) const {
    if (ints) return ints[i];
    const float x = floats[i];
    if (std::isnan(x)) return 0;
    if (x >= 2147483648.0f) return std::numeric_limits<std::int32_t>::max();
    if (x <= -2147483648.0f) return std::numeric_limits<std::int32_t>::min();
    return static_cast<std::int32_t>(x);
  }
};

std::size_t componentsOf(const Type& type) { return lang::leafCount(type); }

bool isPair(const Type& type) { return type.base == BaseType::floating && type.arrayLength == 2; }

/// Numbers into the variable: what an assignment converts, float to int, one number to two, two to a triple.
bool assignNumbers(PointCall& call, std::size_t target, unsigned lane, const Numbers& from) {
  const Type& to = call.type(target);
  if (to.base == BaseType::string) return false;
  const std::size_t count = componentsOf(to);
  const bool replicates = from.type.isNumber() && (!to.isArray() || isPair(to)) && to.base != BaseType::matrix;
  const bool pads = isPair(from.type) && to.isTriple() && !to.isArray();
  const bool sameShape = from.type.isArray() == to.isArray() && componentsOf(from.type) == count &&
                         from.type.element().isTriple() == to.element().isTriple() &&
                         (from.type.base == BaseType::matrix) == (to.base == BaseType::matrix);
  if (!replicates && !pads && !sameShape) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t source = replicates ? 0 : i;
    if (to.base == BaseType::integer) {
      call.set(target, lane, from.integer(source), i);
    } else {
      call.set(target, lane, pads && i == 2 ? 0.0f : from.floating(source), i);
    }
  }
  return true;
}

/// `index` picks an element of an array; -1: the whole value.
bool assign(PointCall& call, std::size_t target, unsigned lane, const lang::Constant& value, std::int32_t index) {
  Type type = value.type;
  std::size_t first = 0;
  if (index >= 0) {
    if (!type.isArray() || index >= type.arrayLength) return false;
    type = type.element();
    first = static_cast<std::size_t>(index) * componentsOf(type);
  }
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value.value)) {
    if (call.type(target) != type) return false;
    for (std::size_t i = 0; i < componentsOf(type); ++i)
      call.set(target, lane, std::string_view((*texts)[first + i]), i);
    return true;
  }
  Numbers numbers{type, nullptr, nullptr};
  if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&value.value)) numbers.ints = ints->data() + first;
  if (const auto* floats = std::get_if<std::vector<float>>(&value.value)) numbers.floats = floats->data() + first;
  return (numbers.ints || numbers.floats) && assignNumbers(call, target, lane, numbers);
}

bool assignUserData(PointCall& call, std::size_t target, unsigned lane, std::uint64_t name) {
  std::array<float, PointFacts::maximumUserData> values{};
  const std::optional<Type> type = call.host().facts().userData(call.point(lane), name, values);
  return type && assignNumbers(call, target, lane, {*type, nullptr, values.data()});
}

/// One look-up: where, what, and which element.
struct Query {
  std::uint64_t object = 0;  ///< 0: the point's own, then the scene's.
  std::uint64_t name = 0;
  std::int32_t index = -1;
};

bool answer(PointCall& call, std::size_t target, unsigned lane, const Query& query) {
  static const std::uint64_t global = hashString("global");
  const SceneAttributes* scene = call.host().attributes();
  const auto from = [&](const AttributeTable* table) {
    const lang::Constant* value = table ? table->find(query.name) : nullptr;
    return value && assign(call, target, lane, *value, query.index);
  };
  if (query.object == global) return scene && from(&scene->global);
  if (query.object != 0) return scene && from(scene->find(query.object));
  if (query.index < 0 && assignUserData(call, target, lane, query.name)) return true;
  return from(call.host().facts().attributes(call.point(lane))) || (scene && from(&scene->global));
}

}  // namespace

void getAttributeFunction(PointCall& call) {
  const std::size_t target = call.argumentCount() - 1;
  const bool hasIndex = target > 1 && call.type(target - 1) == lang::types::integer;
  const std::size_t name = target - (hasIndex ? 2 : 1);
  call.forEachLane([&](unsigned lane) {
    Query query;
    query.name = call.hash(name, lane);
    if (name == 1) query.object = call.hash(0, lane);
    if (hasIndex) query.index = call.integer(target - 1, lane);
    const bool isValid = !hasIndex || query.index >= 0;
    call.set(result, lane, std::int32_t{isValid && answer(call, target, lane, query)});
  });
}

bool assignAttribute(PointCall& call, std::size_t target, unsigned lane, const lang::Constant& value) {
  return assign(call, target, lane, value, -1);
}

void userDataFunction(PointCall& call) {
  call.forEachLane(
      [&](unsigned lane) { call.set(result, lane, std::int32_t{assignUserData(call, 1, lane, call.hash(0, lane))}); });
}

void userDataChangeFunction(PointCall& call) {
  call.forEachLane([&](unsigned lane) {
    std::array<float, PointFacts::maximumUserData> values{};
    const PointFacts& facts = call.host().facts();
    const std::optional<Type> type = facts.userData(call.point(lane), call.hash(0, lane), values);
    const int axis = call.integer(1, lane);
    if (type) facts.userDataChange(call.point(lane), call.hash(0, lane), axis, values);
    call.set(result, lane, std::int32_t{type && assignNumbers(call, 2, lane, {*type, nullptr, values.data()})});
  });
}

void rayTypeFunction(PointCall& call) {
  call.forEachLane([&](unsigned lane) {
    const auto known = std::find(rayTypeNames.begin(), rayTypeNames.end(), call.text(0, lane));
    const auto bit = static_cast<std::uint32_t>(known - rayTypeNames.begin());
    const bool isKnown = known != rayTypeNames.end();
    call.set(result, lane, std::int32_t{isKnown && (call.host().facts().rayTypes(call.point(lane)) >> bit & 1u) != 0});
  });
}

void backfacingFunction(PointCall& call) {
  call.forEachLane(
      [&](unsigned lane) { call.set(result, lane, std::int32_t{call.host().facts().isBackfacing(call.point(lane))}); });
}

void surfaceAreaFunction(PointCall& call) {
  call.forEachLane([&](unsigned lane) { call.set(result, lane, call.host().facts().surfaceArea(call.point(lane))); });
}

/// A space that is not known leaves the colour as it is.
void colorsFunction(PointCall& call) {
  const ColorTransform* transform = nullptr;
  std::uint64_t from = 0, to = 0;
  std::string problem;
  bool isKnown = false;
  call.forEachLane([&](unsigned lane) {
    if (!isKnown || call.hash(0, lane) != from || call.hash(1, lane) != to) {
      from = call.hash(0, lane);
      to = call.hash(1, lane);
      transform = call.host().services().colors(call.text(0, lane), call.text(1, lane), problem);
      isKnown = true;
    }
    std::array<float, 3> color{};
    for (std::size_t c = 0; c < 3; ++c) color[c] = call.floating(2, lane, c);
    if (transform) {
      transform->apply(color.data(), 1);
    } else {
      call.report(lane, fmt::format("Unknown color space transformation \"{}\" -> \"{}\": {}", call.text(0, lane),
                                    call.text(1, lane), problem));
    }
    for (std::size_t c = 0; c < 3; ++c) call.set(result, lane, color[c], c);
  });
}

void randomFunction(PointCall& call) {
  const std::size_t components = call.componentCount(result);
  call.forEachLane([&](unsigned lane) {
    const auto number = static_cast<std::uint32_t>(call.integer(0, lane));
    const std::uint64_t key = combineHashes(call.host().facts().randomKey(call.point(lane)), call.hash(1, lane));
    for (std::size_t c = 0; c < components; ++c)
      call.set(result, lane, randomFloat(key, number, static_cast<std::uint32_t>(c)), c);
  });
}

}  // namespace aerosol::shading
