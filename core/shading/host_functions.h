// The functions that the host answers for running kernels, by name.
//
// A new one is a row in core/lang/builtins_host.cpp and an entry in host_functions.cpp (or, when its results depend on
// its arguments alone, in core/lang/pure_functions.cpp). It answers for all active lanes of a call, the same for a
// point whatever lane it stands in and whatever its neighbours are, and must bear any argument.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/jit/kernel_interface.h"
#include "core/lang/host_call.h"
#include "core/lang/pure_functions.h"
#include "core/shading/runtime_strings.h"
#include "core/shading/services.h"

namespace aerosol::shading {

/// Leaves a text about a point: (host site, point, text).
using HostReport = std::function<void(std::uint32_t site, std::uint32_t point, std::string_view text)>;

class HostCalls;
struct ObjectFunction;
class PointFacts;
class PointMessages;
class SceneAttributes;
class TracedRays;

/// A call as a host function sees it: besides its values, whose points they are and what the host knows of these.
class PointCall : public lang::HostCall {
 public:
  PointCall(const AerosolHostCall& raw, const lang::HostSite& site, lang::Strings& strings, HostCalls& host)
      : HostCall(site, raw.values, raw.lanes, raw.active, strings), raw_(raw), host_(host) {}

  /// Index in the batch of a lane's point. (All points of a uniform call have its values.)
  std::uint32_t point(unsigned lane) const { return pointOf(raw_, lane); }
  /// Index of the point's instance in its family.
  std::uint32_t instance(unsigned lane) const;
  /// Leaves an error about the lane's point, with the position of the call; of uniform calls, about all points.
  void report(unsigned lane, std::string_view text);
  HostCalls& host() const { return host_; }

  static std::uint32_t pointOf(const AerosolHostCall& raw, unsigned lane) {
    const std::uint32_t place = raw.first + lane;
    return raw.points ? static_cast<std::uint32_t>(raw.points[place]) : place;
  }

 private:
  const AerosolHostCall& raw_;
  HostCalls& host_;
};

using HostFunction = void (*)(PointCall& call);

/// Null when there is none of that name.
HostFunction findHostFunction(std::string_view name);

/// Answers the calls of the kernels of one thread.
class HostCalls {
 public:
  /// `services` may be null: then there are no files.
  explicit HostCalls(HostReport report, Services* services = nullptr);
  ~HostCalls();
  HostCalls(const HostCalls&) = delete;
  HostCalls& operator=(const HostCalls&) = delete;

  /// A kernel is about to run on points 0 to count - 1. What is given must stay while it runs.
  /// `program`: where functions of plugins are found; without it they are not answered.
  void begin(const jit::KernelInterface& interface, const StringList* stringsOfInstances, std::size_t count,
             const lang::Program* program = nullptr);
  /// AerosolHostServices::call.
  void call(const AerosolHostCall& raw) noexcept;

  ServicesOfThread& services() { return services_; }
  /// What shaders may ask for by name; null: nothing. It must stay.
  void setAttributes(const SceneAttributes* attributes) { attributes_ = attributes; }
  const SceneAttributes* attributes() const { return attributes_; }
  /// What is known of the points of the next runs; null: nothing.
  void setFacts(const PointFacts* facts);
  const PointFacts& facts() const { return *facts_; }
  /// Of the points of this run.
  PointMessages& messages() { return *messages_; }
  TracedRays& tracedRays() { return *tracedRays_; }

  RuntimeStrings& strings() { return strings_; }
  const RuntimeStrings& strings() const { return strings_; }
  void report(std::uint32_t site, std::uint32_t point, std::string_view text) { report_(site, point, text); }

 private:
  struct Function {
    lang::PureFunction pure;
    HostFunction other;
    const ObjectFunction* native;
  };
  void callRange(const AerosolHostCall& raw, const Function& function, PointCall& call);

  HostReport report_;
  ServicesOfThread services_;
  RuntimeStrings strings_;
  const SceneAttributes* attributes_ = nullptr;
  const PointFacts* facts_;
  std::unique_ptr<PointMessages> messages_;
  std::unique_ptr<TracedRays> tracedRays_;
  const jit::KernelInterface* interface_ = nullptr;
  std::vector<Function> functions_;  ///< By host site.
};

}  // namespace aerosol::shading
