// Makes the voxel files of the repository: bake_voxels steps FILE (for tests of lookups) or bake_voxels cloud FILE (for
// scenes/vdb_cloud.xml).
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

namespace {

/// Grids "density", i + 10 j + 100 k at voxel (i, j, k) of 4^3, and "velocity", (i, j, k), with voxels of size 0.5.
openvdb::GridPtrVec makeSteps() {
  auto density = openvdb::FloatGrid::create(-1.0f);
  auto velocity = openvdb::Vec3SGrid::create(openvdb::Vec3f(0.0f));
  density->setName("density");
  velocity->setName("velocity");
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 4; ++k) {
        density->tree().setValue({i, j, k}, static_cast<float>(i + 10 * j + 100 * k));
        velocity->tree().setValue({i, j, k}, openvdb::Vec3f(float(i), float(j), float(k)));
      }
    }
  }
  for (const openvdb::GridBase::Ptr& grid : {openvdb::GridBase::Ptr(density), openvdb::GridBase::Ptr(velocity)})
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  return {density, velocity};
}

double hashed(int x, int y, int z) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 73856093u ^ static_cast<std::uint32_t>(y) * 19349663u ^
                    static_cast<std::uint32_t>(z) * 83492791u;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return ((h ^ (h >> 15)) & 0xffffffu) / 8388608.0 - 1;
}

/// Smooth noise of values at whole coordinates.
double noise(double x, double y, double z) {
  const double fx = std::floor(x), fy = std::floor(y), fz = std::floor(z);
  const auto fade = [](double t) { return t * t * (3 - 2 * t); };
  const double u = fade(x - fx), v = fade(y - fy), w = fade(z - fz);
  double sum = 0;
  for (int k = 0; k < 8; ++k) {
    const double weight = (k & 1 ? u : 1 - u) * (k & 2 ? v : 1 - v) * (k & 4 ? w : 1 - w);
    sum += weight * hashed(int(fx) + (k & 1), int(fy) + (k >> 1 & 1), int(fz) + (k >> 2));
  }
  return sum;
}

/// A flat-bottomed cloud with density from 0 to 1, two units wide.
openvdb::GridPtrVec makeCloud() {
  auto density = openvdb::FloatGrid::create(0.0f);
  density->setName("density");
  density->setGridClass(openvdb::GRID_FOG_VOLUME);
  density->setSaveFloatAsHalf(true);
  constexpr int size = 28;
  constexpr double voxel = 1.0 / size;
  density->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  for (int i = -size; i < size; ++i) {
    for (int j = -size / 2; j < size; ++j) {
      for (int k = -size; k < size; ++k) {
        const double x = i * voxel, y = j * voxel, z = k * voxel;
        double detail = 0, scale = 3, weight = 0.5;
        for (int octave = 0; octave < 4; ++octave, scale *= 2.1, weight *= 0.5)
          detail += weight * noise(scale * x + 7, scale * y + 3, scale * z + 1);
        const double shape = 0.5 - std::sqrt(x * x + 1.4 * (y - 0.05) * (y - 0.05) + z * z) + 0.45 * detail;
        const double base = std::fmin(1.0, std::fmax(0.0, (y + 0.38) * 8));
        const double value = std::fmin(1.0, std::fmax(0.0, shape * 4)) * base;
        // A few levels only: the file is small, and nobody sees it.
        if (value > 1.0 / 64) density->tree().setValue({i, j, k}, static_cast<float>(std::round(value * 32) / 32));
      }
    }
  }
  density->pruneGrid();
  return {density};
}

}  // namespace

int main(int count, char** arguments) {
  const std::string kind = count == 3 ? arguments[1] : "";
  if (kind != "steps" && kind != "cloud") {
    std::fprintf(stderr, "usage: bake_voxels steps|cloud FILE\n");
    return 2;
  }
  openvdb::initialize();
  openvdb::io::File file(arguments[2]);
  file.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
  file.write(kind == "steps" ? makeSteps() : makeCloud());
  file.close();
}
