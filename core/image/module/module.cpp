#include <OpenColorIO/OpenColorIO.h>
#include <OpenEXR/OpenEXRConfig.h>
#include <OpenImageIO/imageio.h>

#include "core/image/module/color_config.h"
#include "core/image/module/files.h"
#include "core/image/module/table.h"
#include "core/image/module/textures.h"

namespace aerosol::image {

namespace {

std::vector<std::string> versions() {
  const int oiio = OIIO::openimageio_version();
  const std::string oiioVersion =
      std::to_string(oiio / 10000) + "." + std::to_string(oiio / 100 % 100) + "." + std::to_string(oiio % 100);
  return {"OpenImageIO " + oiioVersion, std::string("OpenColorIO ") + OCIO_NAMESPACE::GetVersion(),
          "OpenEXR " OPENEXR_VERSION_STRING};
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const ModuleTable* aerosolImageModule() {
  static constexpr ModuleTable table{writeFile,  readFile,       versions,      makeTextures,
                                     makeColors, writePlainFile, writeDeepFile, readDeepFile};
  return &table;
}

}  // namespace aerosol::image
