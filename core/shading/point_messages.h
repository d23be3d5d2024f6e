// What setmessage leaves for getmessage, point by point, while a kernel runs.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/shading/host_functions.h"

namespace aerosol::shading {

class PointMessages {
 public:
  /// Numbers as their bits, strings as hashes.
  struct Message {
    lang::Type type;
    std::vector<std::uint64_t> values;
    const SourceLocation* origin = nullptr;  ///< Where it was set.
  };

  void clear() { messages_.clear(); }
  Message& set(std::uint32_t point, std::uint64_t name) { return messages_[{point, name}]; }
  /// Null when there is none.
  const Message* find(std::uint32_t point, std::uint64_t name) const;

 private:
  std::map<std::pair<std::uint32_t, std::uint64_t>, Message> messages_;
};

/// void (string, any): what was set first stays, and a second value is an error.
void setMessageFunction(PointCall& call);
/// int ([string source,] string, output any): that a message is of another type is an error.
void getMessageFunction(PointCall& call);

}  // namespace aerosol::shading
