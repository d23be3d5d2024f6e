// The way of light through a body, from where it enters to where it leaves.
#pragma once

#include <array>
#include <optional>

#include "core/accel/scene.h"
#include "core/render/closure_mix.h"
#include "core/render/sample_stream.h"
#include "core/render/subsurface_body.h"

namespace aerosol::render {

/// Where light enters.
struct BodyEntry {
  SubsurfaceBody body;
  const accel::SurfaceHit& hit;
  Vector<World> direction;  ///< Unit, into the body.
  float time = 0;
};

struct WayThroughBody {
  accel::SurfaceHit hit;  ///< Where it leaves; met from inside.
  Color weight;
};

/// A random walk from collision to collision, without bias. The boundary of the body is the object that was entered;
/// what else there is in it is not seen. None where the light is lost.
std::optional<WayThroughBody> walkThroughBody(const accel::Scene& scene, const BodyEntry& entry, SampleStream& random,
                                              accel::Counters& counters);

/// The closure by which light leaves: evenly from a matte sheet; out of a dielectric as even light inside would, which
/// is dimmed by what the boundary reflects (the exitance of Jensen et al. 2001, "A Practical Model for Subsurface Light
/// Transport", equation 5, made to sum up to 1).
class BodyExit {
 public:
  /// `hit` outlives the exit.
  BodyExit(const SubsurfaceBody& body, const accel::SurfaceHit& hit);
  BodyExit(const BodyExit&) = delete;
  BodyExit& operator=(const BodyExit&) = delete;

  const ClosureMix& mix() const { return *mix_; }

 private:
  std::array<float, 5> parameters_;
  WeightedClosure term_;
  std::optional<ClosureMix> mix_;
};

/// The part of even light that a boundary with this index (far over near) lets in.
float evenTransmittance(float ior);

}  // namespace aerosol::render
