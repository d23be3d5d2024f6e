#include "core/base/point_cloud.h"

namespace aerosol {

const PointAttribute* PointCloud::find(std::string_view name) const {
  for (const PointAttribute& attribute : attributes())
    if (attribute.name == name) return &attribute;
  return nullptr;
}

}  // namespace aerosol
