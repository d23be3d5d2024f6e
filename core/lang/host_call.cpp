#include "core/lang/host_call.h"

#include "core/lang/fold.h"

namespace aerosol::lang {

std::size_t HostCall::componentCount(std::size_t argument) const { return leafCount(type(argument)); }

void HostCall::set(std::size_t argument, unsigned lane, std::string_view text, std::size_t component) {
  setHash(argument, lane, strings_.add(text.substr(0, maximumStringLength), lane), component);
}

}  // namespace aerosol::lang
