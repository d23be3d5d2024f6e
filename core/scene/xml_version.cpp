#include "core/scene/xml_version.h"

#include <pugixml.hpp>

namespace aerosol::scene {

std::string xmlLibraryVersion() {
  // 1130 stands for 1.13, 190 for 1.9.
  constexpr int version = PUGIXML_VERSION < 1000 ? PUGIXML_VERSION * 10 : PUGIXML_VERSION;
  const int patch = version % 10;
  std::string text = "pugixml " + std::to_string(version / 1000) + "." + std::to_string(version / 10 % 100);
  if (patch > 0) text += "." + std::to_string(patch);
  return text;
}

}  // namespace aerosol::scene
