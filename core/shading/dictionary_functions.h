// Host functions that search dictionaries.
#pragma once

#include "core/shading/host_functions.h"

namespace aerosol::shading {

void dictionaryFindFunction(PointCall& call);   ///< int (string dictionary | int node, string query)
void dictionaryNextFunction(PointCall& call);   ///< int (int node)
void dictionaryValueFunction(PointCall& call);  ///< int (int node, string attribute, output any)

}  // namespace aerosol::shading
