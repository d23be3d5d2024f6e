// A call of a host function as it stands in a compiled shader.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/lang/program.h"

namespace aerosol::lang {

struct HostSite {
  std::string function;
  SourceLocation location;
  Type result;  ///< none: it gives nothing back.
  std::vector<Type> arguments;
  std::uint32_t outputs = 0;             ///< Bit i: argument i is written.
  std::vector<ConstantValue> constants;  ///< By argument; empty (monostate) where it is not a constant.

  bool operator==(const HostSite&) const = default;
};

}  // namespace aerosol::lang
