#include "core/scene/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace aerosol::scene {

namespace {

void checkSide(const Film& film, const char* side, int offset, int cropped, int whole, Reporter& reporter) {
  const bool horizontal = side[0] == 'w';
  const std::string offsetName = horizontal ? "crop_offset_x" : "crop_offset_y";
  const std::string sizeName = std::string("crop_") + side;
  if (cropped >= 1 && offset <= whole - cropped) return;
  const SourceLocation& at = film.origin.has(sizeName)     ? film.origin.of(sizeName)
                             : film.origin.has(offsetName) ? film.origin.of(offsetName)
                                                           : film.origin.of(side);
  reporter.error(at, cropped < 1 ? fmt::format("the crop starts at {} {}, outside the film's {} of {}",
                                               horizontal ? "x" : "y", offset, side, whole)
                                 : fmt::format("the crop of {} pixels from {} {} does not fit into the film's {} of {}",
                                               cropped, horizontal ? "x" : "y", offset, side, whole));
}

/// The columns of the linear part are orthonormal to about a thousandth.
bool isRigid(const Matrix4& m) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      const double product = m[0][i] * m[0][j] + m[1][i] * m[1][j] + m[2][i] * m[2][j];
      if (!(std::fabs(product - (i == j ? 1 : 0)) < 2e-3)) return false;
    }
  }
  return true;
}

}  // namespace

void checkFilm(const Film& film, Reporter& reporter) {
  checkSide(film, "width", film.cropOffsetX, film.croppedWidth(), film.width, reporter);
  checkSide(film, "height", film.cropOffsetY, film.croppedHeight(), film.height, reporter);
}

void checkSensor(const Sensor& sensor, Reporter& reporter) {
  if (!(sensor.nearClip < sensor.farClip)) {
    const char* const name = sensor.origin.has("far_clip") ? "far_clip" : "near_clip";
    reporter.error(sensor.origin.of(name), fmt::format("'near_clip' ({}) has to be less than 'far_clip' ({})",
                                                       sensor.nearClip, sensor.farClip));
  }
  const auto isStiff = [](const MotionKey& key) { return isRigid(key.matrix); };
  if (sensor.type != SensorType::orthographic &&
      (!isRigid(sensor.toWorld.matrix()) || !std::ranges::all_of(sensor.toWorld.keys, isStiff))) {
    reporter.error(sensor.origin.of("to_world"), "the transform of a camera must not scale or shear");
  }
  if (sensor.shutter().close < sensor.shutter().open) {
    reporter.error(sensor.origin.of("shutter_close"), fmt::format("the shutter closes ({} s) before it opens ({} s)",
                                                                  sensor.shutter().close, sensor.shutter().open));
  }
  if (sensor.origin.has("fov_axis") && !sensor.fov) {
    reporter.error(sensor.origin.of("fov_axis"), "'fov_axis' has no meaning without 'fov'");
  }
}

void completeFilter(ReconstructionFilter& filter) {
  if (filter.origin.has("radius")) return;
  switch (filter.type) {
    case FilterType::box:
      filter.radius = 0.5f;
      break;
    case FilterType::tent:
      filter.radius = 1;
      break;
    case FilterType::gaussian:
      filter.radius = 4 * filter.stddev;
      break;
    case FilterType::mitchell:
    case FilterType::catmullrom:
      filter.radius = 2;
      break;
    case FilterType::lanczos:
      filter.radius = static_cast<float>(filter.lobes);
      break;
  }
}

}  // namespace aerosol::scene
