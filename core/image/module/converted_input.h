// Image files whose colours are converted when they are read: before they are filtered. Internal to the module.
#pragma once

#include <OpenImageIO/imagecache.h>

#include <string>

#include "core/base/color_source.h"

namespace aerosol::image {

/// Makes the file known to the cache under another name, all its texels floats. The transform must outlive the cache;
/// null: the file's own colours, not multiplied by its alpha.
void addConverted(OIIO::ImageCache& cache, OIIO::ustring name, const std::string& file,
                  const ColorTransform* transform);

}  // namespace aerosol::image
