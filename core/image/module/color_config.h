// OpenColorIO's configurations. Internal to the module.
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <memory>
#include <string>

#include "core/base/color_source.h"

namespace aerosol::image {

/// The file's, else that which $OCIO names, else the built-in one. May throw OpenColorIO's exceptions.
OCIO_NAMESPACE::ConstConfigRcPtr openColorConfig(const std::string& file);

/// IEC 61966-2-1: linear below 0.0031308, then 1.055 x^(1/2.4) - 0.055.
OCIO_NAMESPACE::TransformRcPtr linearToSrgb();

/// "'a', 'b'": names of a config by their index.
template <class NameAt>
std::string joinNames(int count, NameAt&& nameAt) {
  std::string list;
  for (int i = 0; i < count; ++i) list += std::string(i == 0 ? "" : ", ") + "'" + nameAt(i) + "'";
  return list;
}

/// See ModuleTable. Null, with a message, when the settings are refused.
std::unique_ptr<ColorSource> makeColors(const ColorSettings& settings, std::string& message);

}  // namespace aerosol::image
