// The module of image libraries, opened by the first call. Internal to the layer.
#pragma once

#include "core/base/result.h"
#include "core/image/module/table.h"

namespace aerosol::image {

const Result<const ModuleTable*>& table();

}  // namespace aerosol::image
