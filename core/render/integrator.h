// What follows a camera ray through the scene.
#pragma once

#include "core/base/color.h"
#include "core/base/geometry.h"
#include "core/render/path_context.h"
#include "core/volume/task.h"

namespace aerosol::render {

/// The value of one sample.
struct Radiance {
  Color color;      ///< Signed where an estimator is; NaN and infinities are dropped by the film, and counted.
  float alpha = 0;  ///< 1 where the path met something.
};

/// Stateless: one object serves all threads.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// A coroutine on the path's frames.
  virtual volume::Task<Radiance> trace(PathContext& path, const Ray<World>& cameraRay) const = 0;
};

}  // namespace aerosol::render
