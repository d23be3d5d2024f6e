// Next-event estimation: light that reaches a scattering vertex straight from a light, by multiple importance sampling.
#pragma once

#include <optional>

#include "core/render/closure_mix.h"
#include "core/render/path_context.h"
#include "core/volume/medium.h"
#include "core/volume/phase.h"
#include "core/volume/task.h"

namespace aerosol::render {

/// Balance heuristic (Veach 1995) for one sample of each of two techniques.
inline float balance(float pdf, float otherPdf) { return pdf > 0 ? pdf / (pdf + otherPdf) : 0; }

/// Where a path scatters: in a medium, or on a surface.
class ScatteringVertex {
 public:
  virtual ~ScatteringVertex() = default;

  /// Seen from where lights are sampled.
  virtual Point<World> position() const = 0;
  /// Where a ray in this direction starts.
  virtual Point<World> originTowards(Vector<World> direction) const = 0;
  /// Phase function, or closures times |cos|; without delta parts.
  virtual Color evaluate(Vector<World> direction) const = 0;
  /// Per steradian, with which the path goes on in `direction`.
  virtual float pdf(Vector<World> direction) const = 0;
};

class MediumVertex final : public ScatteringVertex {
 public:
  MediumVertex(const volume::PhaseFunction& phase, Point<World> position, Vector<World> before, float anisotropy)
      : phase_(phase), position_(position), before_(before), parameters_{anisotropy} {}

  Point<World> position() const override { return position_; }
  Point<World> originTowards(Vector<World>) const override { return position_; }
  Color evaluate(Vector<World> direction) const override {
    return Color(phase_.evaluate(parameters_, before_, direction));
  }
  float pdf(Vector<World> direction) const override { return phase_.pdf(parameters_, before_, direction); }
  volume::PhaseSample sample(std::array<float, 2> u) const { return phase_.sample(parameters_, before_, u); }

 private:
  const volume::PhaseFunction& phase_;
  Point<World> position_;
  Vector<World> before_;
  std::array<float, 1> parameters_;
};

class SurfaceVertex final : public ScatteringVertex {
 public:
  /// Both outlive the vertex.
  SurfaceVertex(const accel::SurfaceHit& hit, const ClosureMix& closures) : hit_(hit), closures_(closures) {}

  Point<World> position() const override { return hit_.point; }
  Point<World> originTowards(Vector<World> direction) const override { return hit_.originTowards(direction); }
  Color evaluate(Vector<World> direction) const override { return closures_.evaluate(direction); }
  float pdf(Vector<World> direction) const override { return closures_.pdf(direction); }

 private:
  const accel::SurfaceHit& hit_;
  const ClosureMix& closures_;
};

/// One sample of one light: radiance · evaluate · transmittance / pdf, weighted against the direction sampling of the
/// vertex. `boundaryMedium` is the surface-defined medium around the vertex. Two numbers of the path's stream.
volume::Task<Color> estimateDirectLight(PathContext& path, const ScatteringVertex& vertex, float time,
                                        const volume::Medium* boundaryMedium);

/// What the path found by its own direction sampling needs to weight light that it meets.
struct DirectionRecord {
  Point<World> from;
  float pdf = 0;        ///< Per steradian.
  bool isDelta = true;  ///< No light sample could have found the direction (or there was none): full weight.
};

/// Radiance of lights at infinity along a ray that leaves the scene, weighted.
Color escapedLight(const PreparedScene& scene, Vector<World> direction, const DirectionRecord& record);

/// Radiance of an area light that a ray has met, weighted.
Color metLight(const PreparedScene& scene, std::uint32_t light, const accel::SurfaceHit& hit, Vector<World> direction,
               const DirectionRecord& record);

}  // namespace aerosol::render
