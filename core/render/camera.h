// The cameras: perspective, with a pinhole or a thin lens, and orthographic.
#pragma once

#include <array>
#include <optional>

#include "core/base/geometry.h"
#include "core/render/optional_effects.h"
#include "core/render/ray_footprint.h"
#include "core/scene/description.h"
#include "core/shading/kernel_host.h"

namespace aerosol::render {

/// What one camera ray is made of.
struct CameraSample {
  float x = 0, y = 0;           ///< Place on the whole film, pixels, from the upper left corner, y downwards.
  std::array<float, 2> lens{};  ///< In [0, 1)².
  float time = 0;               ///< Seconds.
};

/// Tangent of half the horizontal angle of view; `aspect` is width / height.
double horizontalTangent(const scene::FieldOfView& fov, double aspect);

/// Mitsuba's conventions: the camera looks along +z of its space with +y up; seen from it, +x is to the left. The field
/// of view spans the whole film, whatever is cropped.
class Camera {
 public:
  Camera(const scene::Sensor& sensor, const scene::Film& film);

  /// How it moves while its shutter is open, if it does.
  const std::optional<MovingTransform<World, aerosol::Camera>>& motion() const { return motion_; }
  /// At a time, in seconds.
  Transform<World, aerosol::Camera> toWorld(float time) const { return motion_ ? motion_->at(time) : toWorld_; }

  /// Unit direction, origin on the lens. `tMin` and `tMax` lie on the clip planes, which are at right angles to the
  /// view.
  Ray<World> ray(const CameraSample& sample) const;

  /// How far from the camera's place rays begin at most, at a time: at the corners of the near clip plane, seen from
  /// the lens's rim.
  double startReach(float time) const;

  /// How that ray changes from pixel to pixel.
  RayFootprint footprint(const CameraSample& sample) const;

  /// From camera space to a plane (of a perspective view: at distance 1) on which the picture spans -1 to 1 across its
  /// width, x to the right and y upwards, and depth 0 to 1 from clip plane to clip plane; then to the picture, from its
  /// upper left corner.
  shading::CameraProjection projection() const;

  /// Tangent of half the angle of view across the film's width; half the width of the view of an orthographic one.
  double tangentX() const { return tangentX_; }
  bool isOrthographic() const { return isOrthographic_; }

  /// What a pinhole sees at distance 1 in camera space.
  struct View {
    double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  };
  View view() const {
    const double x = 2 * shiftX_ / width_, y = 2 * shiftY_ / height_;
    return {(-1 - x) * tangentX_, (1 - x) * tangentX_, (-1 - y) * tangentY_, (1 - y) * tangentY_};
  }
  double nearClip() const { return nearClip_; }
  double farClip() const { return farClip_; }

  /// Whether `ray` uses `CameraSample::lens`.
  bool hasLens() const { return hasOptionalEffects && apertureRadius_ > 0; }
  double aperture() const { return apertureRadius_; }  ///< Radius of the lens.

 private:
  /// A ray in camera space, its direction not normalised.
  struct Unplaced {
    std::array<double, 2> lens{};
    std::array<double, 3> direction{0, 0, 1};
  };
  Unplaced unplacedRay(const CameraSample& sample) const;

  Transform<World, aerosol::Camera> toWorld_;  ///< When the shutter opens.
  std::optional<MovingTransform<World, aerosol::Camera>> motion_;
  double width_, height_;  ///< Pixels of the whole film.
  bool isOrthographic_;
  double tangentX_, tangentY_;  ///< Of half the angle of view; half the sides of an orthographic view.
  double shiftX_, shiftY_;      ///< Of the film against the axis, pixels.
  double nearClip_, farClip_;
  double apertureRadius_, focusDistance_;
};

}  // namespace aerosol::render
