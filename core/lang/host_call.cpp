#include "core/lang/host_call.h"

#include "core/lang/fold.h"

namespace aerosol::lang {

std::size_t HostCall::componentCount(std::size_t argument) const { return leafCount(type(argument)); }

template <class T>
T* HostCall::at(std::size_t argument, unsigned lane, std::size_t component) const {
  const std::size_t place = argument == result ? 0 : argument + (site_.result == types::none ? 0 : 1);
  return static_cast<T*>(values_[place]) + component * lanes_ + lane;
}

std::int32_t HostCall::integer(std::size_t argument, unsigned lane, std::size_t component) const {
  if (type(argument).base != BaseType::integer) return 0;
  return *at<std::int32_t>(argument, lane, component);
}

float HostCall::floating(std::size_t argument, unsigned lane, std::size_t component) const {
  const BaseType base = type(argument).base;
  if (base == BaseType::integer) return static_cast<float>(*at<std::int32_t>(argument, lane, component));
  return base == BaseType::string ? 0.0f : *at<float>(argument, lane, component);
}

std::uint64_t HostCall::hash(std::size_t argument, unsigned lane, std::size_t component) const {
  return type(argument).base == BaseType::string ? *at<std::uint64_t>(argument, lane, component) : 0;
}

void HostCall::set(std::size_t argument, unsigned lane, std::int32_t value, std::size_t component) {
  *at<std::int32_t>(argument, lane, component) = value;
}

void HostCall::set(std::size_t argument, unsigned lane, float value, std::size_t component) {
  *at<float>(argument, lane, component) = value;
}

void HostCall::set(std::size_t argument, unsigned lane, std::string_view text, std::size_t component) {
  setHash(argument, lane, strings_.add(text.substr(0, maximumStringLength), lane), component);
}

void HostCall::setHash(std::size_t argument, unsigned lane, std::uint64_t hash, std::size_t component) {
  *at<std::uint64_t>(argument, lane, component) = hash;
}

}  // namespace aerosol::lang
