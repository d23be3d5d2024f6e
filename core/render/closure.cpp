#include "core/render/closure.h"

namespace aerosol::render {

Color Closure::evaluate(std::span<const float>, const ClosurePoint&, Vector<World>) const { return {}; }
Color Closure::evaluateDiffuse(std::span<const float> parameters, const ClosurePoint& point,
                               Vector<World> toLight) const {
  return traits().isDiffuse ? evaluate(parameters, point, toLight) : Color();
}
float Closure::pdf(std::span<const float>, const ClosurePoint&, Vector<World>) const { return 0; }
std::optional<ClosureSample> Closure::sample(std::span<const float>, const ClosurePoint&,
                                             const ClosureUniforms&) const {
  return {};
}
Color Closure::albedo(std::span<const float>, const ClosurePoint&) const { return {}; }
float Closure::shadowing(std::span<const float>, Vector<World>) const { return 1; }
Color Closure::emitted(std::span<const float>, const ClosurePoint&) const { return {}; }

SubsurfaceBody Closure::body(std::span<const float>) const { return {}; }

InteriorMatter Closure::interior(std::span<const float>) const { return {}; }

}  // namespace aerosol::render
