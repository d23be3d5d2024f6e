// What lies below a surface that light enters and leaves elsewhere.
#pragma once

#include "core/base/color.h"

namespace aerosol::render {

/// A homogeneous medium that fills the shape up to its surface.
struct SubsurfaceBody {
  Color albedo;          ///< Of one collision, each channel in [0, 1].
  Color extinction{1};   ///< Per scene unit, > 0.
  float anisotropy = 0;  ///< Mean cosine of a collision, in (-1, 1).
  float ior = 0;         ///< Of the body over what is around it; 0: a matte sheet without reflection bounds it.
};

/// The body that reflects `albedo` of even light through a matte boundary, where it is thick: van de Hulst 1980,
/// "Multiple Light Scattering", volume 2, inverted. With s² = (1 - α) / (1 - g α), α the albedo of one collision, half
/// a space reflects (1 - s) (1 - 0.139 s) / (1 + 1.17 s), to 0.2% of the light. Artists give the reflected colour for
/// the reasons of Chiang, Kutz and Burley 2016, "Practical and Controllable Subsurface Scattering for Production Path
/// Tracing"; their fit is the same curve to 1%, for g = 0 alone. `radius` is the mean free path (scene units) by
/// channel.
SubsurfaceBody bodyThatReflects(Color albedo, Color radius, float anisotropy);

}  // namespace aerosol::render
