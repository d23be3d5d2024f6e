#include "core/render/camera_frustum.h"

#include <algorithm>
#include <cmath>

namespace aerosol::render {

namespace {

/// A stretch of depths.
struct Depths {
  double near = 0, far = 0;
};

Depths depthsOf(const Camera& camera, const Matrix4& toCamera, const Box<World>& bounds) {
  Depths depths{std::numeric_limits<double>::infinity(), 0};
  for (unsigned which = 0; which < 8; ++which) {
    double z = toCamera[2][3];
    for (int r = 0; r < 3; ++r) {
      const float side = which >> r & 1u ? bounds.upper[r] : bounds.lower[r];
      z += toCamera[2][static_cast<std::size_t>(r)] * static_cast<double>(side);
    }
    depths.near = std::min(depths.near, z);
    depths.far = std::max(depths.far, z);
  }
  return {std::max(depths.near, camera.nearClip()), std::min(depths.far, camera.farClip())};
}

std::array<double, 16> flat(const Matrix4& m) {
  std::array<double, 16> result{};
  for (std::size_t i = 0; i < 16; ++i) result[i] = m[i / 4][i % 4];
  return result;
}

std::int64_t count(double size, double voxel) {
  return static_cast<std::int64_t>(std::clamp(std::ceil(size / voxel - 1e-6), 1.0, 1e9));
}

}  // namespace

Result<CameraFrustum> makeCameraFrustum(const scene::Sensor& sensor, const scene::Film& film, const Box<World>& bounds,
                                        const FrustumOptions& options) {
  scene::Sensor still = sensor;
  still.shutterOpen = options.time;
  still.shutterClose = options.time;
  const Camera camera(still, film);
  if (camera.isOrthographic())
    return Diagnostic{Severity::error, {}, "an orthographic camera has no frustum", {}, {"bake without --frustum"}};
  const Transform<World, aerosol::Camera> toWorld = camera.toWorld(options.time);
  const Matrix4 toCamera = toWorld.inverseMatrix();
  const auto [near, far] = depthsOf(camera, toCamera, bounds);
  if (!(near > 0 && near < far))
    return Diagnostic{
        Severity::error, {}, "the bounds are not in front of the camera, between its clip planes", {}, {}};
  const Camera::View view = camera.view();
  // At distance 1.
  const double width = view.x1 - view.x0, height = view.y1 - view.y0;
  const double centreX = 0.5 * (view.x0 + view.x1), centreY = 0.5 * (view.y0 + view.y1);
  CameraFrustum frustum;
  const bool isLinear = options.depth == FrustumDepth::linear;
  const double middle = isLinear ? 0.5 * (near + far) : std::sqrt(near * far);
  const std::int64_t slices =
      options.slices > 0 ? options.slices : count(far - near, options.voxelSize * middle / near);
  frustum.size = {count(width * near, options.voxelSize), count(height * near, options.voxelSize), slices};
  const auto nx = static_cast<double>(frustum.size[0]), ny = static_cast<double>(frustum.size[1]),
             nz = static_cast<double>(frustum.size[2]);
  if (isLinear) {
    grid::NewFrustum& file = frustum.file;
    file.least = {-0.5, -0.5, -0.5};
    file.greatest = {nx - 0.5, ny - 0.5, nz - 0.5};
    file.taper = near / far;
    file.depth = far - near;
    const Matrix4 second = {{{width * near, 0, centreX, centreX * near},
                             {0, height * near * nx / ny, centreY, centreY * near},
                             {0, 0, 1, near},
                             {0, 0, 0, 1}}};
    const Matrix4 secondToWorld = multiply(toWorld.matrix(), second);
    Matrix4 inverse;
    if (!invert(secondToWorld, inverse)) return Diagnostic{Severity::error, {}, "the camera's view is flat", {}, {}};
    file.secondToFile = flat(secondToWorld);
    frustum.map = VoxelMap::linearDepth(file.least, file.greatest, file.taper, file.depth, inverse);
  } else {
    // Slice k of n is at (1/near - 1/z) / (1/near - 1/far) = (k + 1/2) / n.
    const double scale = nz * far / (far - near);
    const Matrix4 fromCamera = {{{nx / width, 0, nx * (0.5 - centreX / width) - 0.5, 0},
                                 {0, ny / height, ny * (0.5 - centreY / height) - 0.5, 0},
                                 {0, 0, scale - 0.5, -scale * near},
                                 {0, 0, 1, 0}}};
    const Matrix4 fromWorld = multiply(fromCamera, toCamera);
    frustum.file.fileToIndex = flat(fromWorld);
    frustum.map = VoxelMap::projective(fromWorld);
  }
  return frustum;
}

}  // namespace aerosol::render
