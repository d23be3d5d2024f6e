#include "core/shading/host_functions.h"

#include <array>
#include <bit>
#include <exception>
#include <span>
#include <utility>

#include "core/lang/native.h"
#include "core/lang/texture_options.h"
#include "core/shading/attribute_functions.h"
#include "core/shading/attributes.h"
#include "core/shading/dictionary_functions.h"
#include "core/shading/native_call.h"
#include "core/shading/point_functions.h"
#include "core/shading/point_messages.h"
#include "core/shading/range_functions.h"
#include "core/shading/texture_functions.h"
#include "core/shading/trace_function.h"

namespace aerosol::shading {

namespace {

using Entry = std::pair<std::string_view, HostFunction>;
constexpr std::array table = {
    Entry{"texture", texture},
    Entry{"texture3d", texture3d},
    Entry{"environment", environment},
    Entry{"gettextureinfo", getTextureInfo},
    Entry{"pointcloud_search", pointcloudSearch},
    Entry{"pointcloud_get", pointcloudGet},
    Entry{"pointcloud_write", pointcloudWrite},
    Entry{"getattribute", getAttributeFunction},
    Entry{"userdata", userDataFunction},
    Entry{"userdatachange", userDataChangeFunction},
    Entry{"raytype", rayTypeFunction},
    Entry{"backfacing", backfacingFunction},
    Entry{"surfacearea", surfaceAreaFunction},
    Entry{"colors", colorsFunction},
    Entry{"random", randomFunction},
    Entry{"setmessage", setMessageFunction},
    Entry{"getmessage", getMessageFunction},
    Entry{"trace", traceFunction},
    Entry{"dict_find", dictionaryFindFunction},
    Entry{"dict_next", dictionaryNextFunction},
    Entry{"dict_value", dictionaryValueFunction},
};

const PointFacts nothingKnown;

/// The table of strings as one call sees it: what its points make is charged to them.
class StringsOfCall final : public lang::Strings {
 public:
  StringsOfCall(const AerosolHostCall& raw, HostCalls& host) : raw_(raw), host_(host) {}

  std::string_view text(std::uint64_t hash) const override { return host_.strings().text(hash); }

  std::uint64_t add(std::string_view text, unsigned lane) override {
    bool fits = true;
    const std::uint32_t lanes = raw_.lanes == 1 ? raw_.active : 1u << lane;
    for (std::uint32_t left = lanes; left != 0; left &= left - 1) {
      const std::uint32_t point = PointCall::pointOf(raw_, static_cast<unsigned>(std::countr_zero(left)));
      const RuntimeStrings::Room room = host_.strings().charge(point, text.size());
      fits = fits && room == RuntimeStrings::Room::enough;
      if (room == RuntimeStrings::Room::usedUp)
        host_.report(raw_.site, point, "strings take too much room: they are empty from here on");
    }
    return fits ? host_.strings().add(text) : 0;
  }

 private:
  const AerosolHostCall& raw_;
  HostCalls& host_;
};

}  // namespace

HostFunction findHostFunction(std::string_view name) {
  for (const auto& [known, function] : table)
    if (known == name) return function;
  return nullptr;
}

std::uint32_t PointCall::instance(unsigned lane) const {
  const std::int32_t* instances = raw_.arguments->instances;
  return instances ? static_cast<std::uint32_t>(instances[point(lane)]) : 0;
}

void PointCall::report(unsigned lane, std::string_view text) {
  if (raw_.high) return;  // What is wrong with a box may not be with its points.
  const std::uint32_t lanes = isUniform() ? active() : 1u << lane;
  for (std::uint32_t left = lanes; left != 0; left &= left - 1)
    host_.report(raw_.site, point(static_cast<unsigned>(std::countr_zero(left))), text);
}

HostCalls::HostCalls(HostReport report, Services* services)
    : report_(std::move(report)),
      services_(services),
      facts_(&nothingKnown),
      messages_(std::make_unique<PointMessages>()),
      tracedRays_(std::make_unique<TracedRays>()) {}
HostCalls::~HostCalls() = default;

void HostCalls::setFacts(const PointFacts* facts) { facts_ = facts ? facts : &nothingKnown; }

static const ObjectFunction* findNative(const std::string& symbol, const lang::Program* program) {
  if (!program || !lang::parseNativeSymbol(symbol)) return nullptr;
  for (const lang::FunctionUse& use : program->functions)
    if (use.symbol == symbol) return dynamic_cast<const ObjectFunction*>(use.native.get());
  return nullptr;
}

void HostCalls::begin(const jit::KernelInterface& interface, const StringList* stringsOfInstances, std::size_t count,
                      const lang::Program* program) {
  interface_ = &interface;
  functions_.clear();
  messages_->clear();
  tracedRays_->clear();
  for (const lang::HostSite& site : interface.hostSites)
    functions_.push_back(
        {lang::findPureFunction(site.function), findHostFunction(site.function), findNative(site.function, program)});
  strings_.begin(interface, stringsOfInstances, count);
}

void HostCalls::call(const AerosolHostCall& raw) noexcept {
  if (!interface_ || raw.site >= interface_->hostSites.size() || raw.active == 0) return;
  const lang::HostSite& site = interface_->hostSites[raw.site];
  try {
    StringsOfCall strings(raw, *this);
    PointCall call(raw, site, strings, *this);
    const Function& function = functions_[raw.site];
    if (raw.high) return callRange(raw, function, call);
    if (function.native) return callNativeFunction(*function.native, raw, call);
    if (function.pure) return function.pure(call);
    if (function.other) return function.other(call);
  } catch (const std::exception& error) {
    // Out of memory, in all likelihood: the results stay what they were.
    report_(raw.site, PointCall::pointOf(raw, static_cast<unsigned>(std::countr_zero(raw.active))), error.what());
  }
}

/// What has no rule gives what it is given: nothing is known of it, which kernels do not ask for.
void HostCalls::callRange(const AerosolHostCall& raw, const Function& function, PointCall& call) {
  if (function.native) return callNativeFunction(*function.native, raw, call);
  AerosolHostCall ends = raw;
  ends.values = raw.high;
  StringsOfCall strings(raw, *this);
  PointCall high(ends, call.site(), strings, *this);
  if (lang::findTextureFunction(call.site().function)) boundLookup(call, high);
}

}  // namespace aerosol::shading
