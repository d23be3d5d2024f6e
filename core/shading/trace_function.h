// Rays that shaders send: trace, and what getmessage("trace", …) tells of the last one.
#pragma once

#include <map>

#include "core/shading/attributes.h"
#include "core/shading/host_functions.h"

namespace aerosol::shading {

/// The last ray of each point of a run.
class TracedRays {
 public:
  void clear() { answers_.clear(); }
  TraceAnswer& operator[](std::uint32_t point) { return answers_[point]; }
  /// Null when the point has sent none.
  const TraceAnswer* find(std::uint32_t point) const {
    const auto found = answers_.find(point);
    return found == answers_.end() ? nullptr : &found->second;
  }

 private:
  std::map<std::uint32_t, TraceAnswer> answers_;
};

/// int (point position, vector direction, then names and values of "mindist", "maxdist", "shade", "traceset"): whether
/// the ray hits anything.
void traceFunction(PointCall& call);

/// Puts what is known of the point's last ray into the variable: "hit", "hitdist", "P", "N", "Ng", "u", "v" and the
/// attributes of what was hit. False where there is nothing of that name and type.
bool getTraceMessage(PointCall& call, std::size_t target, unsigned lane, std::uint64_t name);

}  // namespace aerosol::shading
