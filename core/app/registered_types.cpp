#include "core/app/registered_types.h"

namespace aerosol::app {

scene::KnownTypes registeredTypes(const render::Registry& registry) {
  scene::KnownTypes types;
  types.volumes.clear();
  for (const render::VolumeType& type : registry.volumes()) types.volumes.push_back(type.described);
  return types;
}

}  // namespace aerosol::app
