#include "core/render/light.h"

#include <cmath>

namespace aerosol::render {

float Light::pdf(Point<World>, const LightHit&) const { return 0; }
Color Light::emitted(const LightHit&) const { return {}; }
float Light::pdfEscaped(Point<World>, Vector<World>) const { return 0; }
Color Light::escaped(Vector<World>) const { return {}; }

LightBounds boundsOfPoint(const LightPlace& place) {
  LightBounds bounds{.intensity = place.intensity};
  bounds.box.extend(place.centre);
  if (place.cone.isWhole()) return bounds;
  const std::array<double, 3>& axis = place.cone.axis;
  bounds.axis = {static_cast<float>(axis[0]), static_cast<float>(axis[1]), static_cast<float>(axis[2])};
  bounds.cosSpread = static_cast<float>(1 / std::hypot(1.0, place.cone.tangent));
  return bounds;
}

}  // namespace aerosol::render
