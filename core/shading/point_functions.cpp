#include "core/shading/point_functions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

namespace aerosol::shading {

namespace {

using Base = PointAttribute::Base;

/// Puts values of points into an array argument: as many as there is room for, never a part of one.
class Destination {
 public:
  Destination(PointCall& call, std::size_t argument, unsigned lane) : call_(call), argument_(argument), lane_(lane) {
    const lang::Type& type = call.type(argument);
    element_ = type.isArray() ? type.element() : type;
    room_ = call.componentCount(argument);
  }

  bool isInteger() const { return element_.base == lang::BaseType::integer; }
  bool isString() const { return element_.base == lang::BaseType::string; }
  /// Points of so many components each that there is room for.
  std::size_t pointsOf(int components) const { return room_ / static_cast<std::size_t>(components); }

  /// Whether values of the attribute go in here: elements of the same type, triples into triples, and any number of
  /// floats (or ints) one after the other into a plain array.
  bool fits(const PointAttribute& attribute) const {
    if (element_.isTriple()) return attribute.base != Base::string && attribute.components == 3;
    if (element_.base == lang::BaseType::matrix) return attribute.base != Base::string && attribute.components == 16;
    if (isString()) return attribute.base == Base::string;
    if (isInteger()) return attribute.base == Base::integer;
    return attribute.base != Base::string;
  }

  void put(std::size_t place, const PointAttribute& attribute, std::size_t point) {
    const auto n = static_cast<std::size_t>(attribute.components);
    for (std::size_t c = 0; c < n; ++c) {
      const std::size_t to = place * n + c, from = point * n + c;
      if (attribute.base == Base::string) {
        call_.set(argument_, lane_, std::string_view(attribute.strings[from]), to);
      } else if (attribute.base == Base::floating) {
        call_.set(argument_, lane_, attribute.floats[from], to);
      } else if (isInteger()) {
        call_.set(argument_, lane_, attribute.integers[from], to);
      } else {
        call_.set(argument_, lane_, static_cast<float>(attribute.integers[from]), to);
      }
    }
  }
  void put(std::size_t place, float value) {
    if (!isInteger()) call_.set(argument_, lane_, value, place);
  }
  void put(std::size_t place, std::int32_t value) {
    if (isInteger()) {
      call_.set(argument_, lane_, value, place);
    } else {
      call_.set(argument_, lane_, static_cast<float>(value), place);
    }
  }

 private:
  PointCall& call_;
  std::size_t argument_;
  unsigned lane_;
  lang::Type element_;
  std::size_t room_ = 0;
};

/// Arrays and names behind the `fixed` first arguments.
struct Outputs {
  std::size_t fixed;
  std::size_t count;

  Outputs(const PointCall& call, std::size_t first) : fixed(first), count((call.argumentCount() - first) / 2) {}
  std::size_t array(std::size_t i) const { return fixed + i; }
  std::size_t name(std::size_t i) const { return fixed + count + i; }
};

/// Nothing where the attribute does not exist or does not fit: reported.
const PointAttribute* findAttribute(PointCall& call, unsigned lane, const PointCloud& cloud, std::string_view name,
                                    const Destination& destination) {
  const PointAttribute* attribute = cloud.find(name);
  if (!attribute) {
    std::string known;
    for (const PointAttribute& each : cloud.attributes()) known += " \"" + each.name + "\"";
    call.report(lane, "\"" + std::string(call.text(0, lane)) + "\" has no attribute \"" + std::string(name) +
                          "\"; it has" + known);
  } else if (!destination.fits(*attribute)) {
    call.report(lane, "attribute \"" + std::string(name) + "\" is not of the array's type");
    attribute = nullptr;
  }
  return attribute;
}

bool isReserved(std::string_view name) { return name == "distance" || name == "index"; }

void searchLane(PointCall& call, unsigned lane, std::vector<FoundPoint>& found) {
  call.set(PointCall::result, lane, std::int32_t{0});
  std::string problem;
  const PointCloud* cloud = call.host().services().points(call.text(0, lane), problem);
  if (!cloud) return call.report(lane, problem);
  const Outputs outputs(call, 5);
  std::size_t most = static_cast<std::size_t>(std::max(call.integer(3, lane), 0));
  std::vector<const PointAttribute*> attributes;
  for (std::size_t i = 0; i < outputs.count; ++i) {
    const std::string_view name = call.text(outputs.name(i), lane);
    const Destination destination(call, outputs.array(i), lane);
    const PointAttribute* attribute = nullptr;
    if (!isReserved(name)) {
      attribute = findAttribute(call, lane, *cloud, name, destination);
      if (!attribute) return;
    } else if (destination.isString() || (name == "distance" && destination.isInteger())) {
      return call.report(lane, "\"" + std::string(name) + "\" is not of the array's type");
    }
    most = std::min(most, destination.pointsOf(attribute ? attribute->components : 1));
    attributes.push_back(attribute);
  }
  const float position[3] = {call.floating(1, lane, 0), call.floating(1, lane, 1), call.floating(1, lane, 2)};
  cloud->search(position, call.floating(2, lane), most, found);
  for (std::size_t i = 0; i < outputs.count; ++i) {
    Destination destination(call, outputs.array(i), lane);
    const bool isDistance = call.text(outputs.name(i), lane) == "distance";
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (attributes[i]) {
        destination.put(k, *attributes[i], found[k].index);
      } else if (isDistance) {
        destination.put(k, static_cast<float>(std::sqrt(found[k].distanceSquared)));
      } else {
        destination.put(k, static_cast<std::int32_t>(found[k].index));
      }
    }
  }
  call.set(PointCall::result, lane, static_cast<std::int32_t>(found.size()));
}

void getLane(PointCall& call, unsigned lane) {
  call.set(PointCall::result, lane, std::int32_t{0});
  std::string problem;
  const PointCloud* cloud = call.host().services().points(call.text(0, lane), problem);
  if (!cloud) return call.report(lane, problem);
  const std::int32_t count = call.integer(2, lane);
  if (count < 0 || static_cast<std::size_t>(count) > call.componentCount(1)) return;
  const auto isWrong = [&](std::size_t i) {
    const std::int32_t index = call.integer(1, lane, i);
    return index < 0 || static_cast<std::size_t>(index) >= cloud->size();
  };
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    if (isWrong(i)) return;
  const Outputs outputs(call, 3);
  for (std::size_t i = 0; i < outputs.count; ++i) {
    Destination destination(call, outputs.array(i), lane);
    const std::string_view name = call.text(outputs.name(i), lane);
    if (name == "index") {
      for (std::size_t k = 0; k < std::min(static_cast<std::size_t>(count), destination.pointsOf(1)); ++k)
        destination.put(k, call.integer(1, lane, k));
      continue;
    }
    const PointAttribute* attribute = findAttribute(call, lane, *cloud, name, destination);
    if (!attribute) return;
    if (destination.pointsOf(attribute->components) < static_cast<std::size_t>(count)) {
      return call.report(lane, "the array is too short for " + std::to_string(count) + " points");
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
      destination.put(k, *attribute, static_cast<std::size_t>(call.integer(1, lane, k)));
  }
  call.set(PointCall::result, lane, std::int32_t{1});
}

/// An argument as an attribute of one point.
PointAttribute attributeOf(const PointCall& call, std::string_view name, std::size_t argument, unsigned lane) {
  PointAttribute attribute;
  attribute.name = name;
  const std::size_t count = call.componentCount(argument);
  attribute.components = static_cast<int>(count);
  const lang::Type& type = call.type(argument);
  const lang::BaseType base = type.isArray() ? type.element().base : type.base;
  attribute.base = base == lang::BaseType::integer  ? Base::integer
                   : base == lang::BaseType::string ? Base::string
                                                    : Base::floating;
  for (std::size_t c = 0; c < count; ++c) {
    if (attribute.base == Base::integer) {
      attribute.integers.push_back(call.integer(argument, lane, c));
    } else if (attribute.base == Base::string) {
      attribute.strings.emplace_back(call.text(argument, lane, c));
    } else {
      attribute.floats.push_back(call.floating(argument, lane, c));
    }
  }
  return attribute;
}

bool writeLane(PointCall& call, unsigned lane, std::string& problem) {
  std::vector<PointAttribute> point = {attributeOf(call, "position", 1, lane)};
  for (std::size_t i = 2; i + 1 < call.argumentCount(); i += 2) {
    if (!(call.type(i) == lang::types::string)) {
      problem = "an attribute has no name";
      return false;
    }
    point.push_back(attributeOf(call, call.text(i, lane), i + 1, lane));
  }
  return call.host().services().writePoint(call.text(0, lane), std::move(point), problem);
}

}  // namespace

/// (cloud, position, radius, most, sort, arrays …, names …) → how many were found.
void pointcloudSearch(PointCall& call) {
  std::vector<FoundPoint> found;
  call.forEachLane([&](unsigned lane) { searchLane(call, lane, found); });
}

/// (cloud, indices, count, arrays …, names …) → 1 when all is there.
void pointcloudGet(PointCall& call) {
  call.forEachLane([&](unsigned lane) { getLane(call, lane); });
}

/// (cloud, position, name, value …) → 1 when the point was taken. Of a uniform call every point writes one.
void pointcloudWrite(PointCall& call) {
  call.forEachLane([&](unsigned lane) {
    bool isWritten = true;
    std::string problem;
    const int times = call.isUniform() ? std::popcount(call.active()) : 1;
    for (int i = 0; i < times && isWritten; ++i) isWritten = writeLane(call, lane, problem);
    if (!isWritten) call.report(lane, problem);
    call.set(PointCall::result, lane, std::int32_t{isWritten ? 1 : 0});
  });
}

}  // namespace aerosol::shading
