#include "core/render/light.h"

namespace aerosol::render {

float Light::pdf(Point<World>, const LightHit&) const { return 0; }
Color Light::emitted(const LightHit&) const { return {}; }
float Light::pdfEscaped(Point<World>, Vector<World>) const { return 0; }
Color Light::escaped(Vector<World>) const { return {}; }

}  // namespace aerosol::render
