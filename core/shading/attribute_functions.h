// Host functions that tell a shader about the scene and the point: getattribute, user data, raytype …
#pragma once

#include "core/lang/fold.h"
#include "core/shading/host_functions.h"

namespace aerosol::shading {

/// int ([string object,] string name, [int index,] output any): 1 when there is such an attribute whose value can
/// become the last argument's type, which then receives it.
void getAttributeFunction(PointCall& call);
/// The value into a variable of the call, where it can become one of its type.
bool assignAttribute(PointCall& call, std::size_t target, unsigned lane, const lang::Constant& value);
/// int (string name, output any): as above, of the values that the geometry carries alone.
void userDataFunction(PointCall& call);
/// int (string name, int axis, output any): how such a value changes along x (axis 0) or y (1).
void userDataChangeFunction(PointCall& call);
void rayTypeFunction(PointCall& call);      ///< int (string)
void backfacingFunction(PointCall& call);   ///< int ()
void surfaceAreaFunction(PointCall& call);  ///< float ()
void colorsFunction(PointCall& call);       ///< color (string from, string to, color)
void randomFunction(PointCall& call);       ///< float or triple (int number of the call, string shader)

}  // namespace aerosol::shading
