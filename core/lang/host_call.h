// A host function's view of one call: its arguments and results by lane.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/lang/host_site.h"

namespace aerosol::lang {

/// No string in a shader is longer (bytes); what would be is cut off there.
inline constexpr std::size_t maximumStringLength = 65536;

/// The texts of strings that shaders know by their hashes.
class Strings {
 public:
  virtual ~Strings() = default;
  /// Empty when there is none of that hash. Valid while the kernel runs.
  virtual std::string_view text(std::uint64_t hash) const = 0;
  /// The hash of a text that a function made for a lane; from now on it is known.
  virtual std::uint64_t add(std::string_view text, unsigned lane) = 0;
};

/// Lanes are those of AerosolHostCall; components of arrays are counted element after element. Arguments of a type that
/// the accessor is not for read as 0 or "".
class HostCall {
 public:
  /// `values` as in AerosolHostCall.
  HostCall(const HostSite& site, void* const* values, std::uint32_t lanes, std::uint32_t active, Strings& strings)
      : site_(site), values_(values), lanes_(lanes), active_(active), strings_(strings) {}

  const HostSite& site() const { return site_; }
  std::size_t argumentCount() const { return site_.arguments.size(); }
  const Type& type(std::size_t argument) const { return argument == result ? site_.result : site_.arguments[argument]; }
  /// Ints, floats or strings of one lane.
  std::size_t componentCount(std::size_t argument) const;

  /// In the place of an argument's number: the result.
  static constexpr std::size_t result = ~std::size_t{0};

  bool isUniform() const { return lanes_ == 1; }
  /// Bit i: lane i's point makes the call; also of uniform calls.
  std::uint32_t active() const { return active_; }

  /// Calls `function(lane)` for each active lane, in order; of a uniform call once, for lane 0.
  template <class Function>
  void forEachLane(Function&& function) const {
    if (lanes_ == 1) {
      if (active_ != 0) function(0u);
      return;
    }
    for (std::uint32_t left = active_; left != 0; left &= left - 1)
      function(static_cast<unsigned>(__builtin_ctz(left)));
  }

  std::int32_t integer(std::size_t argument, unsigned lane, std::size_t component = 0) const {
    return type(argument).base == BaseType::integer ? *at<std::int32_t>(argument, lane, component) : 0;
  }
  float floating(std::size_t argument, unsigned lane, std::size_t component = 0) const {
    const BaseType base = type(argument).base;
    if (base == BaseType::integer) return static_cast<float>(*at<std::int32_t>(argument, lane, component));
    return base == BaseType::string ? 0.0f : *at<float>(argument, lane, component);
  }
  std::uint64_t hash(std::size_t argument, unsigned lane, std::size_t component = 0) const {
    return type(argument).base == BaseType::string ? *at<std::uint64_t>(argument, lane, component) : 0;
  }
  std::string_view text(std::size_t argument, unsigned lane, std::size_t component = 0) const {
    return strings_.text(hash(argument, lane, component));
  }

  void set(std::size_t argument, unsigned lane, std::int32_t value, std::size_t component = 0) {
    *at<std::int32_t>(argument, lane, component) = value;
  }
  void set(std::size_t argument, unsigned lane, float value, std::size_t component = 0) {
    *at<float>(argument, lane, component) = value;
  }
  void set(std::size_t argument, unsigned lane, std::string_view text, std::size_t component = 0);
  /// A string that is already known.
  void setHash(std::size_t argument, unsigned lane, std::uint64_t hash, std::size_t component = 0) {
    *at<std::uint64_t>(argument, lane, component) = hash;
  }

  Strings& strings() const { return strings_; }

 private:
  template <class T>
  T* at(std::size_t argument, unsigned lane, std::size_t component) const {
    const std::size_t place = argument == result ? 0 : argument + (site_.result == types::none ? 0 : 1);
    return static_cast<T*>(values_[place]) + component * lanes_ + lane;
  }

  const HostSite& site_;
  void* const* values_;
  std::uint32_t lanes_;
  std::uint32_t active_;
  Strings& strings_;
};

}  // namespace aerosol::lang
